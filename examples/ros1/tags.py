#!/usr/bin/env python3
"""Find the AprilTags on the ceiling with the AprilTag library, and publish a tf frame for each: tag_0 and so on.

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

EDGE_M = 0.28  # edge of the tags in tag_ceiling: see tag_ceiling.tags.json
# Corners from the bottom left, in the library's order. A tag's x points right, its y up, and its z out of it.
SQUARE = numpy.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * EDGE_M / 2
IPPE_ORDER = [3, 2, 1, 0]  # OpenCV starts at the top left


def quaternion(turn):
    """Convert a rotation matrix to a quaternion: x, y, z, w."""
    vector = cv2.Rodrigues(turn)[0][:, 0]
    angle = numpy.linalg.norm(vector)
    axis = vector / angle if angle > 0 else vector
    return *(axis * numpy.sin(angle / 2)), numpy.cos(angle / 2)


def look(image, info):
    grey = bridge.imgmsg_to_cv2(image, "mono8")
    camera, lens = numpy.reshape(info.K, (3, 3)), numpy.array(info.D)
    frames = []
    for tag in detector.detect(grey):
        # The library's origin is the corner of the first pixel, that of ROS its centre.
        corners = tag["lb-rb-rt-lt"] - 0.5
        _, turn, place = cv2.solvePnP(SQUARE[IPPE_ORDER], corners[IPPE_ORDER], camera, lens, flags=cv2.SOLVEPNP_IPPE_SQUARE)
        frame = TransformStamped()
        frame.header, frame.child_frame_id = image.header, f"tag_{tag['id']}"
        to, by = frame.transform.translation, frame.transform.rotation
        # The frame of the image has the axes of OpenCV: x to the right, y down, z forward.
        to.x, to.y, to.z = place[:, 0]
        by.x, by.y, by.z, by.w = quaternion(cv2.Rodrigues(turn)[0])
        frames.append(frame)
    broadcaster.sendTransform(frames)
    print(" ".join(frame.child_frame_id for frame in frames), flush=True)


rospy.init_node("tags")
bridge, detector, broadcaster = CvBridge(), apriltag("tag36h11"), tf2_ros.TransformBroadcaster()
# Process only the newest image, because detection takes longer than a frame period on a small machine.
newest = {"queue_size": 1, "buff_size": 1 << 24}
topics = message_filters.Subscriber("image_raw", Image, **newest), message_filters.Subscriber("camera_info", CameraInfo)
message_filters.TimeSynchronizer(topics, 30).registerCallback(look)
rospy.spin()
