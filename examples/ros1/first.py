#!/usr/bin/env python3
"""Receive ten images of a running simulator with their camera_infos, in rospy."""

import message_filters
import rospy
from sensor_msgs.msg import CameraInfo, Image

left = 10


def look(image, info):
    global left
    red, green, blue = image.data[:3]
    print(f"{image.width} x {image.height} at {image.header.stamp.to_sec():.3f} s, fx {info.K[0]:.2f}, first pixel {red} {green} {blue}")
    left -= 1
    if left == 0:
        rospy.signal_shutdown("ten are enough")


rospy.init_node("first")
topics = message_filters.Subscriber("image_raw", Image), message_filters.Subscriber("camera_info", CameraInfo)
message_filters.TimeSynchronizer(topics, 10).registerCallback(look)
rospy.spin()
