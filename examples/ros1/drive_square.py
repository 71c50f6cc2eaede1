#!/usr/bin/env python3
"""Drive the robot around a square of 1 m by odometry, and print its distance from the start at the end."""

from math import atan2, cos, hypot, pi, remainder, sin

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry

SIDE_M, SPEED, TURN = 1.0, 0.25, 0.8  # side in m, highest speed in m/s, highest turn in rad/s
NEAR_M, AHEAD = 0.03, 0.2  # a corner is reached at this distance; the robot drives if it faces the corner within this angle


class Robot:
    def __init__(self):
        self.commands = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.keep(rospy.wait_for_message("odom", Odometry, timeout=10))
        rospy.Subscriber("odom", Odometry, self.keep, queue_size=1)

    def keep(self, odometry):
        """Store the pose of the robot in odometry: x, y, yaw."""
        at = odometry.pose.pose
        q = at.orientation
        self.pose = at.position.x, at.position.y, atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y**2 + q.z**2))

    def drive_to(self, goal_x, goal_y):
        """Drive to a point, slower as the robot comes near, so that late odometry costs time but not accuracy."""
        rate = rospy.Rate(20)
        while not rospy.is_shutdown():
            x, y, yaw = self.pose
            left = hypot(goal_x - x, goal_y - y)
            if left < NEAR_M:
                break
            off = remainder(atan2(goal_y - y, goal_x - x) - yaw, 2 * pi)
            twist = Twist()
            twist.angular.z = max(-TURN, min(2 * off, TURN))
            twist.linear.x = min(left, SPEED) if abs(off) < AHEAD else 0
            self.commands.publish(twist)
            rate.sleep()
        self.commands.publish(Twist())


def main():
    rospy.init_node("drive_square")
    robot = Robot()
    x0, y0, heading = robot.pose
    x, y = x0, y0
    for side in range(4):
        x += SIDE_M * cos(heading + side * pi / 2)
        y += SIDE_M * sin(heading + side * pi / 2)
        robot.drive_to(x, y)
    x, y, _ = robot.pose
    print(f"back, {hypot(x - x0, y - y0):.2f} m from where it began")


if __name__ == "__main__":
    main()
