#!/usr/bin/env python3
"""Drive the robot straight until it bumps into something or reaches a cliff; then back up, turn, and repeat.

    wander.py [seconds]
"""

import queue
import sys

import rospy
from geometry_msgs.msg import Twist
from kobuki_msgs.msg import BumperEvent, CliffEvent

SPEED, TURN = 0.3, 1.2  # m/s, rad/s
PLACES = {BumperEvent.LEFT: "left", BumperEvent.CENTER: "middle", BumperEvent.RIGHT: "right"}


def main():
    rospy.init_node("wander")
    commands = rospy.Publisher("mobile_base/commands/velocity", Twist, queue_size=1)
    obstacles = queue.Queue()
    take = lambda what, place, state: obstacles.put((what, PLACES[place])) if state else None  # noqa: E731
    rospy.Subscriber("mobile_base/events/bumper", BumperEvent, lambda e: take("bumped", e.bumper, e.state))
    rospy.Subscriber("mobile_base/events/cliff", CliffEvent, lambda e: take("a cliff", e.sensor, e.state))

    def drive(forward, turn, seconds):
        twist = Twist()
        twist.linear.x, twist.angular.z = forward, turn
        until = rospy.Time.now() + rospy.Duration.from_sec(seconds)
        while not rospy.is_shutdown() and rospy.Time.now() < until and (forward <= 0 or obstacles.empty()):
            commands.publish(twist)
            rospy.sleep(0.05)

    rospy.sleep(0.5)  # wait until all subscribers are connected
    end = rospy.Time.now() + rospy.Duration.from_sec(float(rospy.myargv(sys.argv)[1]) if len(sys.argv) > 1 else 60)
    while not rospy.is_shutdown() and rospy.Time.now() < end:
        drive(SPEED, 0, (end - rospy.Time.now()).to_sec())
        if obstacles.empty():
            break
        what, place = obstacles.get()
        print(f"{what} on the {place}" if place != "middle" else f"{what} ahead", flush=True)
        drive(-SPEED, 0, 1.0)
        drive(0, TURN if place == "right" else -TURN, 1.5)
        while not obstacles.empty():  # discard events of the way back
            obstacles.get()
    commands.publish(Twist())


if __name__ == "__main__":
    main()
