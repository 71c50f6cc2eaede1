"""rclpy reads what `belvedere run --ros2` publishes while something goes wrong: trouble.py BELVEDERE FOLDER [all].

`.ci/rtps` runs it. FOLDER is for files. It needs a network and a /dev/shm of its own: it cuts the network, and looks what is left in shared memory.
"""

import contextlib
import os
import re
import socket
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import kit
import rclpy
from kit import spin, tried
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Image, PointCloud2

BELVEDERE, FOLDER = sys.argv[1:3]
# A cut that is longer than the lease of both, after which each has forgotten the other, and one that is about as long.
CUTS_S = [1.5, 21.0, 22.0, 26.0] if sys.argv[3:] == ["all"] else [1.5]
BACK_S = 2.0  # from a network that is mended, or a new reader, to the first message
LIDAR = """
<robot name="mast">
  <link name="base_link">
    <inertial><mass value="5"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
    <collision><origin xyz="0 0 0.5"/><geometry><box size="0.2 0.2 1"/></geometry></collision>
  </link>
  <gazebo reference="base_link">
    <sensor type="ray" name="lidar">
      <topic>ouster</topic>
      <pose>0 0 1.2 0 0 0</pose>
      <plugin name="device" filename="belvedere"><preset>os1_128</preset></plugin>
    </sensor>
  </gazebo>
</robot>
"""
CLOUDS = 30

run = partial(kit.program, BELVEDERE, "run", "--ros2")


@contextlib.contextmanager
def subscribed(node, kind, topic):
    """Subscribes to a topic, and gives the list of its messages."""
    messages = []
    subscription = node.create_subscription(kind, topic, messages.append, 10)
    try:
        yield messages
    finally:
        node.destroy_subscription(subscription)


@contextlib.contextmanager
def listener(pause):
    """Runs a reader of images that sleeps after each, and kills it."""
    command = [sys.executable, Path(__file__).with_name("listener.py"), "/image_raw", str(pause)]
    child = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        yield child
    finally:
        child.kill()
        child.communicate()


def lo(*words):
    """Changes the only network that there is."""
    subprocess.run(["ip", "link", "set", "lo", *words], check=True)


def missing(stamps, rate):
    """Returns how many frames are missing between the first and the last."""
    numbers = {round(stamp * rate / 1e9) for stamp in stamps}
    return max(numbers) - min(numbers) + 1 - len(numbers)


def nanoseconds(message):
    """Returns the timestamp of a message."""
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def judge_cut(node, seconds):
    """After the network was cut, messages come again in time."""
    with run(), subscribed(node, Odometry, "/odom") as odometry:
        assert spin(node, lambda: odometry, 20) is not None
        lo("down")
        spin(node, lambda: False, seconds)
        odometry.clear()
        lo("up")
        took = spin(node, lambda: odometry, 30)
    print(f"network cut for {seconds} s: messages again after {took} s", flush=True)
    return None if took is not None and took <= BACK_S else f"messages again after {took} s"


def judge_killed(node):
    """A reader that is killed disturbs nobody, and another one gets frames in time."""
    with run() as said, subscribed(node, Image, "/image_raw") as images:
        with listener(0) as first:
            assert first.stdout.readline()
        assert spin(node, lambda: images, 20) is not None
        images.clear()
        spin(node, lambda: False, 1)
        lost, count = missing(map(nanoseconds, images), 30), len(images)
        begin = time.monotonic()
        with listener(0) as second:
            assert second.stdout.readline()
            took = time.monotonic() - begin
    left = [name for name in os.listdir("/dev/shm") if name.startswith("iox2")]
    assert not left, f"left in shared memory: {left}\n{said()}"
    print(f"a reader was killed: {lost} of {count} images missing beside it; another one had its first image {took:.2f} s "
          f"after its start", flush=True)
    return None if not lost and took < 2 * BACK_S else f"{lost} of {count} images missing, {took} s"


def read_images(node, beside):
    """Reads the images of three seconds beside others. Returns how many came, how many are missing, and the speed."""
    with run("--duration", "3.5") as said, beside as other, subscribed(node, Image, "/image_raw") as images:
        assert other is None or other.stdout.readline()
        assert spin(node, lambda: images, 20) is not None
        spin(node, lambda: nanoseconds(images[-1]) > 34e8, 10)
    return len(images), missing(map(nanoseconds, images), 30), float(re.search(r"real-time factor ([\d.]+)", said())[1])


def judge_slow_reader(node):
    """A reader that sleeps costs neither others nor the simulation anything."""
    _, _, alone = read_images(node, contextlib.nullcontext())
    came, lost, factor = read_images(node, listener(1))
    said = f"{came} images, {lost} missing; real-time factor {factor}, and {alone} without it"
    print(f"beside a reader that sleeps: {said}", flush=True)
    return None if not lost and came > 30 and factor > 0.97 * alone else said


def judge_beams(node):
    """The clouds of a lidar with 128 beams arrive whole, on stock buffers of the kernel."""
    robot = Path(FOLDER, "mast.urdf")
    robot.write_text(LIDAR)
    with run("--robot", str(robot)), subscribed(node, PointCloud2, "/ouster/points") as clouds:
        assert spin(node, lambda: clouds, 20) is not None
        clouds.clear()
        assert spin(node, lambda: len(clouds) >= CLOUDS, 20) is not None, len(clouds)
    lost = missing(map(nanoseconds, clouds), 10)
    assert all(len(cloud.data) == cloud.width * cloud.height * cloud.point_step for cloud in clouds)
    points, size = min(cloud.width * cloud.height for cloud in clouds), min(len(cloud.data) for cloud in clouds)
    print(f"128 beams: {len(clouds)} clouds of {points} points, {size / 1e6:.1f} MB; {lost} missing", flush=True)
    return None if not lost and points > 100_000 else f"{lost} missing, {points} points"


@contextlib.contextmanager
def ports_in_use():
    """Listens at every port of domain 0 at which nobody else does, such as this program's own node."""
    with contextlib.ExitStack() as sockets:
        for port in range(7410, 7650):
            taken = sockets.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            with contextlib.suppress(OSError):
                taken.bind(("", port))
        yield


def judge_bad_input(node):
    """What ROS 2 or the network forbid is said in a sentence, and the simulation goes on."""
    for words, expected in [
        (["ros2", "--qos", "/scan=fast"], "expected TOPIC=sensor_data or TOPIC=reliable, such as /scan=sensor_data"),
        (["ros2", "--remap", "/scan:=/my-robot/scan"], "ROS 2 forbids /my-robot/scan: '-' is not a letter, a digit or _"),
    ]:
        done = subprocess.run([BELVEDERE, *words], capture_output=True, text=True)
        assert done.returncode == 2 and expected in done.stderr, done.stderr
    remap = kit.program(BELVEDERE, "ros2", "--wait", "--remap", "/scan:=/odom")
    with kit.program(BELVEDERE, "run", "--robot", "kobuki_nostack_rplidar"), remap as said:
        assert spin(node, lambda: "already, so it is left out; --remap gives it another name" in said(), 20) is not None, said()
    with subscribed(node, Odometry, "/odom") as odometry:
        lo("down")
        with contextlib.ExitStack() as simulator:
            with ports_in_use():
                said = simulator.enter_context(run())
                assert spin(node, lambda: "UDP ports" in said(), 60) is not None, said()
            assert spin(node, lambda: "multicast" in said(), 60) is not None, said()
            assert not odometry
            lo("up")
            came = spin(node, lambda: odometry, 20)
    for expected in ["UDP ports", "ROS_DOMAIN_ID", "no network takes multicast datagrams", "ip link set lo up"]:
        assert said().count(expected) == 1, f"{expected}:\n{said()}"
    assert came is not None, said()
    print(f"without a port and without a network the simulation goes on; {came:.2f} s later its messages came", flush=True)


rclpy.init()
judge = rclpy.create_node("judge")
tried(judge_killed, judge)
for cut in CUTS_S:
    tried(judge_cut, judge, cut)
tried(judge_slow_reader, judge)
tried(judge_beams, judge)
judge_bad_input(judge)
judge.destroy_node()
rclpy.shutdown()
print("1 passed, 0 failed")
