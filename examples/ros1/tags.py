#!/usr/bin/env python3
"""Where the AprilTags on the ceiling are, by the AprilTag library: each tag becomes a frame of tf, tag_0 and so on.

apt install python3-apriltag python3-opencv python3-cv-bridge python3-tf2-ros
"""

import cv2
import message_filters
import numpy
import rospy
import tf2_ros
from apriltag import apriltag
from cv_bridge import CvBridge
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import CameraInfo, Image

EDGE_M = 0.28  # of the tags in tag_ceiling: see tag_ceiling.tags.json
# Corners from the bottom left, as the library gives them; a tag's x points right, its y up, its z out of it.
SQUARE = numpy.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * EDGE_M / 2
IPPE_ORDER = [3, 2, 1, 0]  # OpenCV begins at the top left


def quaternion(turn):
    """x, y, z, w of a rotation matrix."""
    vector = cv2.Rodrigues(turn)[0][:, 0]
    angle = numpy.linalg.norm(vector)
    axis = vector / angle if angle > 0 else vector
    return *(axis * numpy.sin(angle / 2)), numpy.cos(angle / 2)


def look(image, info):
    grey = bridge.imgmsg_to_cv2(image, "mono8")
    camera, lens = numpy.reshape(info.K, (3, 3)), numpy.array(info.D)
    frames = []
    for tag in detector.detect(grey):
        # The library counts from the corner of the first pixel, ROS from its centre.
        corners = tag["lb-rb-rt-lt"] - 0.5
        _, turn, place = cv2.solvePnP(SQUARE[IPPE_ORDER], corners[IPPE_ORDER], camera, lens, flags=cv2.SOLVEPNP_IPPE_SQUARE)
        frame = TransformStamped()
        frame.header, frame.child_frame_id = image.header, f"tag_{tag['id']}"
        to, by = frame.transform.translation, frame.transform.rotation
        # The picture's frame is OpenCV's: x to the right, y down, z forward.
        to.x, to.y, to.z = place[:, 0]
        by.x, by.y, by.z, by.w = quaternion(cv2.Rodrigues(turn)[0])
        frames.append(frame)
    broadcaster.sendTransform(frames)
    print(" ".join(frame.child_frame_id for frame in frames), flush=True)


rospy.init_node("tags")
bridge, detector, broadcaster = CvBridge(), apriltag("tag36h11"), tf2_ros.TransformBroadcaster()
# The newest picture and no other, as finding tags takes longer than a frame on a small machine.
newest = {"queue_size": 1, "buff_size": 1 << 24}
topics = message_filters.Subscriber("image_raw", Image, **newest), message_filters.Subscriber("camera_info", CameraInfo)
message_filters.TimeSynchronizer(topics, 30).registerCallback(look)
rospy.spin()
