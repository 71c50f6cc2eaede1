"""Nodes on two networks find each other by ROS_STATIC_PEERS, without multicast (`.ci/ros2`).

peers.py BELVEDERE: the program. It runs here, and rclpy in a network namespace of its own, which a cable connects.
"""

import contextlib
import os
import subprocess
import sys
import time

import kit

NEAR, FAR = "10.77.0.1", "10.77.0.2"
SECONDS = 15.0
# A node that can be found needs a tenth of this time.
NOBODY_S = 2.0


def read(seconds):
    """Says whether the clock of a simulation comes within this time."""
    import rclpy
    from rosgraph_msgs.msg import Clock

    rclpy.init()
    node, clock = rclpy.create_node("far"), []
    node.create_subscription(Clock, "/clock", clock.append, 10)
    came = kit.spin(node, lambda: clock, seconds) is not None
    node.destroy_node()
    rclpy.shutdown()
    print("came" if came else "nothing")


@contextlib.contextmanager
def cable():
    """Makes another network namespace and a cable to it, and gives the words that run a program there."""
    with subprocess.Popen(["unshare", "--net", "sleep", "infinity"]) as holder:
        try:
            while os.readlink(f"/proc/{holder.pid}/ns/net") == os.readlink("/proc/self/ns/net"):
                time.sleep(0.01)
            there = ["nsenter", f"--net=/proc/{holder.pid}/ns/net"]
            for words in (
                ["ip", "link", "add", "near", "type", "veth", "peer", "name", "far", "netns", str(holder.pid)],
                ["ip", "address", "add", f"{NEAR}/24", "dev", "near"],
                ["ip", "link", "set", "near", "up"],
                [*there, "ip", "address", "add", f"{FAR}/24", "dev", "far"],
                [*there, "ip", "link", "set", "far", "up"],
                [*there, "ip", "link", "set", "lo", "up"],
            ):
                subprocess.run(words, check=True)
            # DDS overlooks an interface until the kernel says that it runs, which takes up to a second.
            for words in (["ip", "link", "show", "near"], [*there, "ip", "link", "show", "far"]):
                while b"state UP" not in subprocess.run(words, check=True, capture_output=True).stdout:
                    time.sleep(0.01)
            yield there
        finally:
            holder.kill()


def judge(belvedere, there, ours, theirs, expected):
    """Runs a simulator with these variables here, and a reader with others there."""
    os.environ.update(ours)
    with kit.program(belvedere, "run", "--ros2", "--drive", "still"):
        for name in ours:
            del os.environ[name]
        seconds = SECONDS if expected == "came" else NOBODY_S
        words = [*there, sys.executable, __file__, "read", str(seconds)]
        said = subprocess.run(words, env=os.environ | theirs, capture_output=True, text=True)
    assert said.stdout.strip() == expected, f"{ours}, {theirs}: {said.stdout}{said.stderr}"


if sys.argv[1] == "read":
    read(float(sys.argv[2]))
    sys.exit()
RANGE, PEERS = "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_STATIC_PEERS"
local = {RANGE: "LOCALHOST"}
with cable() as away:
    judge(sys.argv[1], away, local | {PEERS: f"10.77.0.9;{FAR}"}, local, "came")
    judge(sys.argv[1], [], {RANGE: "OFF", PEERS: "127.0.0.1"}, local, "nothing")
wrong = subprocess.run(
    [sys.argv[1], "ros2", "--domain", kit.DOMAIN], env=os.environ | {PEERS: "127.0.0.1;10.77.0.300"}, capture_output=True, text=True
)
assert wrong.returncode == 1 and wrong.stderr.count("ROS_STATIC_PEERS") == 1 and "10.77.0.300" in wrong.stderr, wrong
print("peers: 1 passed, 0 failed")
