#!/usr/bin/env python3
"""Print the pose of a frame in another one, from tf, ten times a second, until Ctrl-C or for a number of times.

where.py [OUTER INNER [TIMES]]    where.py odom base_camera_link 10
"""

import sys

import rospy
import tf2_ros

arguments = rospy.myargv(sys.argv)[1:]
outer, inner, times = (arguments + ["odom", "base_camera_link", "0"][len(arguments) :])[:3]
rospy.init_node("where")
buffer = tf2_ros.Buffer()
listener = tf2_ros.TransformListener(buffer)
rospy.sleep(0.5)  # wait until the simulated clock runs, because before that every timeout would expire at once
rate, said = rospy.Rate(10), 0
while not rospy.is_shutdown() and (times == "0" or said < int(times)):
    try:
        found = buffer.lookup_transform(outer, inner, rospy.Time(0), rospy.Duration(5))
    except tf2_ros.TransformException as error:
        sys.exit(f"{error}")
    place, turn = found.transform.translation, found.transform.rotation
    print(f"{inner} in {outer} at {found.header.stamp.to_sec():.2f} s: {place.x:.3f} {place.y:.3f} {place.z:.3f}", end="")
    print(f", quaternion {turn.x:.4f} {turn.y:.4f} {turn.z:.4f} {turn.w:.4f}", flush=True)
    said += 1
    rate.sleep()
