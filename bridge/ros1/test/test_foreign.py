#!/usr/bin/env python3
"""Nodes that nobody here wrote, unchanged on our topics. Needs a master at ROS_MASTER_URI."""

import math
import os
import struct
import threading
import unittest

import message_filters
import roslib.packages
import rospy
from processes import Process, bridge, eventually, simulator
from sensor_msgs.msg import Image, PointCloud2

DOMAIN = f"foreign-{os.getpid()}"
SENSORS = {"TURTLEBOT_STACKS": "hexagons", "TURTLEBOT_3D_SENSOR": "KinectHokuyo"}


def program(package, name):
    return roslib.packages.find_node(package, name)[0]


def pair(one, two, timeout=20):
    """A message of each of two topics, of the same stamp."""
    got, arrived = [], threading.Event()

    def receive(*messages):
        if not arrived.is_set():
            got.extend(messages)
            arrived.set()

    subscribers = [message_filters.Subscriber(topic, kind, buff_size=1 << 25) for topic, kind in (one, two)]
    message_filters.TimeSynchronizer(subscribers, 10).registerCallback(receive)
    arrived.wait(timeout)
    for subscriber in subscribers:
        subscriber.unregister()
    return got


def points(cloud, every):
    """Some of its points."""
    x = next(field.offset for field in cloud.fields if field.name == "x")
    for row in range(0, cloud.height, every):
        for column in range(0, cloud.width, every):
            yield struct.unpack_from("<3f", cloud.data, row * cloud.row_step + column * cloud.point_step + x)


class Foreign(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.simulator = simulator(DOMAIN, "--world", "playground", **SENSORS)
        cls.node = bridge(DOMAIN)
        assert eventually(lambda: "/camera/depth/points" in dict(rospy.get_published_topics())), cls.node.output()

    @classmethod
    def tearDownClass(cls):
        cls.node.stop()
        cls.simulator.stop()

    def test_depth_image_proc_makes_our_cloud(self):
        names = {
            "rgb/camera_info": "/camera/rgb/camera_info",
            "rgb/image_rect_color": "/camera/rgb/image_raw",
            "depth_registered/image_rect": "/camera/depth/image_raw",
            "depth_registered/points": "/theirs",
        }
        command = [program("nodelet", "nodelet"), "standalone", "depth_image_proc/point_cloud_xyzrgb"]
        with Process(*command, *(f"{a}:={b}" for a, b in names.items())) as theirs:
            clouds = pair(("/camera/depth/points", PointCloud2), ("/theirs", PointCloud2))
            self.assertEqual(len(clouds), 2, theirs.output())
        ours, made = clouds
        self.assertEqual((ours.width, ours.height, ours.header.frame_id), (made.width, made.height, made.header.frame_id))
        distances = [math.dist(a, b) for a, b in zip(points(ours, 5), points(made, 5)) if all(map(math.isfinite, a + b))]
        self.assertGreater(len(distances), 2000)
        print(f"{len(distances)} points, at most {max(distances) * 1000:.4f} mm apart")
        self.assertLess(max(distances), 1e-3)

    def test_image_proc_leaves_an_undistorted_picture_as_it_is(self):
        with Process(program("image_proc", "image_proc"), ROS_NAMESPACE="/camera/rgb") as theirs:
            images = pair(("/camera/rgb/image_raw", Image), ("/camera/rgb/image_rect_color", Image))
            self.assertEqual(len(images), 2, theirs.output())
        ours, rectified = images
        self.assertEqual((rectified.width, rectified.height), (640, 480))
        difference = max(abs(a - b) for a, b in zip(ours.data, rectified.data)) if rectified.encoding == ours.encoding else None
        self.assertEqual(difference, 0, rectified.encoding)


if __name__ == "__main__":
    rospy.init_node("belvedere_test", disable_signals=True)
    unittest.main(verbosity=2, warnings="ignore")
