#!/usr/bin/env python3
"""Drives a robot along the wall at its left to the end of a corridor: a node of ROS 2 that uses /scan and /cmd_vel.

    belvedere run --ros2 --world corridor --robot kobuki_nostack_rplidar --pose 5,1
    ./follow_the_wall.py

The same node in lock-step: simulated time stands still while the node computes, so every run takes the same path, however
busy the machine is:

    belvedere run --ros2 --world corridor --robot kobuki_nostack_rplidar --pose 5,1 --paused --rate max
    ./follow_the_wall.py --lockstep
"""

import math
import re
import subprocess
import sys
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.duration import Duration
from rclpy.node import Node
from sensor_msgs.msg import LaserScan

SPEED = 0.5  # m/s
DISTANCE = 0.7  # from the wall, in metres
AHEAD = 0.8  # how far the robot looks ahead along the wall, in metres
STOP = 0.9  # the robot stops at this distance from the end, in metres


class WallFollower(Node):
    """Answers each scan with a velocity."""

    def __init__(self):
        super().__init__("follow_the_wall")
        self.scan = None
        self.has_arrived = False
        self.commands = self.create_publisher(Twist, "/cmd_vel", 1)
        self.create_subscription(LaserScan, "/scan", self.come, 10)

    def come(self, scan):
        """Takes a scan, and sends the velocity that follows from it."""
        self.scan = scan
        command = Twist()
        self.has_arrived = distance(scan, 0.0) < STOP
        if not self.has_arrived:
            # Two distances give the direction of the wall, and how far away it will be a little ahead.
            slanted, beside = distance(scan, math.radians(50)), distance(scan, math.radians(90))
            angle = math.atan2(slanted * math.cos(math.radians(40)) - beside, slanted * math.sin(math.radians(40)))
            wall = beside * math.cos(angle) + AHEAD * math.sin(angle)
            command.linear.x = SPEED
            command.angular.z = max(-1.0, min(1.0, 1.5 * (wall - DISTANCE)))
        self.commands.publish(command)


def distance(scan, angle):
    """Returns the median distance of the beams around an angle, which is positive to the left."""
    middle = round((angle - scan.angle_min) / scan.angle_increment)
    beams = sorted(min(scan.ranges[beam], scan.range_max) for beam in range(middle - 3, middle + 4))
    return beams[3]


def seconds(stamp):
    """Returns a timestamp in seconds."""
    return stamp.sec + stamp.nanosec / 1e9


def spin_until(node, done, timeout):
    """Handles messages until `done()` is true. Returns False if that takes longer than the timeout in seconds."""
    end = time.monotonic() + timeout
    while not done():
        if time.monotonic() > end:
            return False
        rclpy.spin_once(node, timeout_sec=0.05)
    return True


def control(*words, belvedere="belvedere"):
    """Runs `belvedere control`, and returns the simulated time in seconds at which the command was done."""
    said = subprocess.run([belvedere, "control", *words], check=True, capture_output=True, text=True).stdout
    return float(re.search(r"at ([\d.]+) s", said)[1])


def lockstep(node, belvedere="belvedere"):
    """Steps a paused simulation from scan to scan: time goes on only after the velocity has arrived there."""
    if not spin_until(node, lambda: node.commands.get_subscription_count() > 0, 10):
        raise TimeoutError("no simulation listens to /cmd_vel: start it with belvedere run --ros2")
    now = control("step", belvedere=belvedere)
    step = control("step", belvedere=belvedere) - now
    # A lidar is simulated only while its topic has a reader, so step until the first scan shows that it has. Then begin
    # again at time 0, where all is as after a fresh start, so that every run is the same.
    while not spin_until(node, lambda: node.scan, 0.2):
        control("step", "100", belvedere=belvedere)
    period, node.scan = node.scan.scan_time, None
    now = control("reset", belvedere=belvedere)
    due = period
    while not node.has_arrived:
        now = control("step", str(math.ceil((due + 1e-6 - now) / step)), belvedere=belvedere)
        is_there = lambda: node.scan and abs(seconds(node.scan.header.stamp) - due) < period / 2  # noqa: B023, E731
        if not spin_until(node, is_there, 10):
            raise TimeoutError(f"the scan at {due:.3f} s has not arrived")
        if not node.commands.wait_for_all_acked(Duration(seconds=10)):
            raise TimeoutError("the velocity has not arrived")
        due = seconds(node.scan.header.stamp) + period


def main():
    """Drives to the end of the corridor."""
    rclpy.init()
    node = WallFollower()
    if "--lockstep" in sys.argv[1:]:
        lockstep(node)
    else:
        while rclpy.ok() and not node.has_arrived:
            rclpy.spin_once(node)
    print(f"at the end of the corridor, {seconds(node.scan.header.stamp):.3f} s after the start")
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
