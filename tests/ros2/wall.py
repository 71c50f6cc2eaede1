"""The example `follow_the_wall.py` takes the same path in each run in lock-step (`.ci/ros2`): wall.py BELVEDERE."""

import os
import subprocess
import sys
from pathlib import Path

import kit
import rclpy
from nav_msgs.msg import Odometry
from rclpy.qos import ReliabilityPolicy

sys.path.insert(0, str(Path(__file__).parents[2] / "examples/ros2"))
from follow_the_wall import WallFollower, lockstep

BELVEDERE = sys.argv[1]
# The corridor of the example, from a place nearer to its end.
START = ["--world", "corridor", "--robot", "kobuki_nostack_rplidar", "--pose", "9,1", "--paused", "--rate", "max"]
START += ["--wait-for", "ros2"]  # so that no odometry is lost either
# Where the lidar, 0.1 m before the middle of the robot, is at most 0.9 m from the end of the corridor, and at least 0.5 m.
END_M = (10.15, 10.55)


class Watched(WallFollower):
    """The example, and what it saw and where it was."""

    def __init__(self):
        self.scans, self.path = {}, {}
        super().__init__()
        self.create_subscription(Odometry, "/odom", self.locate, 1000)

    def come(self, scan):
        """Keeps a scan. What came before the simulation began again is overwritten."""
        self.scans[scan.header.stamp.sec, scan.header.stamp.nanosec] = scan.ranges.tobytes()
        super().come(scan)

    def locate(self, odometry):
        """Keeps a place."""
        stamp, pose = odometry.header.stamp, odometry.pose.pose
        self.path[stamp.sec, stamp.nanosec] = (pose.position.x, pose.position.y, pose.orientation.z, pose.orientation.w)


def drive():
    """Drives through the corridor, and returns the node with what it saw, and the line that says where the robot is."""
    node = Watched()
    with kit.program(BELVEDERE, "run", "--ros2", *START):
        lockstep(node, BELVEDERE)
        kit.spin(node, lambda: False, 0.5)
        kinds = {info.qos_profile.reliability for info in node.get_subscriptions_info_by_topic("/cmd_vel")}
        assert kinds == {ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT}, kinds
        said = subprocess.run([BELVEDERE, "control", "states"], check=True, capture_output=True, text=True).stdout
    node.destroy_node()
    return node, next(line for line in said.splitlines() if line.startswith("turtlebot"))


os.environ["BELVEDERE_DOMAIN"] = kit.DOMAIN
rclpy.init()
(first, end), (second, other_end) = drive(), drive()
rclpy.shutdown()
assert END_M[0] < float(end.split()[1]) < END_M[1], end
assert end == other_end, f"{end}\n{other_end}"
assert first.scans == second.scans, "the scans differ"
common = first.path.keys() & second.path.keys()
assert len(common) > 100, len(common)
differ = [stamp for stamp in sorted(common) if first.path[stamp] != second.path[stamp]]
assert not differ, f"the paths differ from {differ[0]} on"
print(f"at the end of the corridor after {len(first.scans)} scans, twice on the same path: {end}")
print("1 passed, 0 failed")
