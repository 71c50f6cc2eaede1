#!/usr/bin/env python3
"""Drives the robot round a square of 1 m, by odometry, and says how well it came back."""

from math import atan2, cos, hypot, pi, sin

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry

SIDE_M, SPEED, TURN = 1.0, 0.25, 0.8  # m, m/s, rad/s


def pose():
    """Where odometry says that the robot is: x, y, yaw."""
    at = rospy.wait_for_message("odom", Odometry, timeout=10).pose.pose
    q = at.orientation
    return at.position.x, at.position.y, atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y**2 + q.z**2))


def move(commands, forward, turn, until):
    twist = Twist()
    twist.linear.x, twist.angular.z = forward, turn
    while not rospy.is_shutdown() and not until(*pose()):
        commands.publish(twist)
    commands.publish(Twist())


def main():
    rospy.init_node("drive_square")
    commands = rospy.Publisher("cmd_vel", Twist, queue_size=1)
    x0, y0, heading = start = pose()
    for _ in range(4):
        x0, y0, _ = pose()
        move(commands, SPEED, 0, lambda x, y, _: hypot(x - x0, y - y0) >= SIDE_M)
        heading += pi / 2
        move(commands, 0, TURN, lambda _x, _y, yaw: sin(heading - yaw) <= 0.02 and cos(heading - yaw) > 0)
    x, y, _ = pose()
    print(f"back, {hypot(x - start[0], y - start[1]):.2f} m from where it began")


if __name__ == "__main__":
    main()
