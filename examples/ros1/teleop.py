#!/usr/bin/env python3
"""Drives the robot by keys: w and s forward and back, a and d round, space stops, q ends."""

import os
import select
import sys
import termios
import tty

import rospy
from geometry_msgs.msg import Twist

SPEED, TURN = 0.3, 1.0  # m/s, rad/s
KEYS = {"w": (SPEED, 0), "s": (-SPEED, 0), "a": (0, TURN), "d": (0, -TURN), " ": (0, 0)}


def key(seconds):
    """Return the key that is pressed within this time, or None; q at the end of the input."""
    if not select.select([sys.stdin], [], [], seconds)[0]:
        return None
    return os.read(sys.stdin.fileno(), 1).decode(errors="replace") or "q"


def main():
    rospy.init_node("teleop")
    commands, twist = rospy.Publisher("cmd_vel", Twist, queue_size=1), Twist()
    print(__doc__.strip(), flush=True)
    while not rospy.is_shutdown():
        pressed = key(0.1)  # commands are repeated, because the robot stops 0.6 s after the last one
        if pressed == "q":
            break
        twist.linear.x, twist.angular.z = KEYS.get(pressed, (twist.linear.x, twist.angular.z))
        commands.publish(twist)
    commands.publish(Twist())


if __name__ == "__main__":
    settings = termios.tcgetattr(sys.stdin) if sys.stdin.isatty() else None
    try:
        if settings:
            tty.setcbreak(sys.stdin)
        main()
    finally:
        if settings:
            termios.tcsetattr(sys.stdin, termios.TCSADRAIN, settings)
