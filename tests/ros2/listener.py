"""Reads the images of a topic with rclpy, and prints the timestamp of each: listener.py TOPIC PAUSE.

PAUSE is how long it sleeps after each, in seconds. It runs until it is killed.
"""

import sys
import time

import rclpy
from sensor_msgs.msg import Image

TOPIC, PAUSE = sys.argv[1], float(sys.argv[2])


def come(image):
    """Takes an image."""
    print(image.header.stamp.sec * 10**9 + image.header.stamp.nanosec, flush=True)
    time.sleep(PAUSE)


rclpy.init()
node = rclpy.create_node("listener")
node.create_subscription(Image, TOPIC, come, 5)
rclpy.spin(node)
