"""Writes a topic with rclpy, to compare with: writer.py KIND RELIABILITY SAMPLES."""

import array
import sys
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Image, PointCloud2, PointField


def make(kind):
    """The topic, the message and its rate."""
    if kind == "twist":
        return "/cmd_vel", Twist(), 100
    if kind == "image":
        image = Image(height=480, width=640, encoding="rgb8", step=3 * 640)
        image.data = array.array("B", bytes([7]) * (3 * 640 * 480))
        return "/camera/image_raw", image, 30
    cloud = PointCloud2(height=480, width=640, point_step=16, row_step=16 * 640, is_dense=True)
    names = ["x", "y", "z", "intensity"]
    cloud.fields = [PointField(name=name, offset=4 * n, datatype=7, count=1) for n, name in enumerate(names)]
    cloud.data = array.array("B", bytes([7]) * (16 * 640 * 480))
    return "/points", cloud, 10


def main():
    kind, reliability, samples = sys.argv[1], sys.argv[2], int(sys.argv[3])
    topic, message, rate = make(kind)
    rclpy.init()
    node = rclpy.create_node("writer")
    qos = QoSProfile(depth=5, reliability=ReliabilityPolicy[reliability.upper()])
    writer = node.create_publisher(type(message), topic, qos)
    while writer.get_subscription_count() == 0:
        rclpy.spin_once(node, timeout_sec=0.02)
    time.sleep(1.0)
    start, used = time.monotonic(), time.process_time()
    for number in range(samples):
        time.sleep(max(0.0, start + number / rate - time.monotonic()))
        if kind == "twist":
            message.linear.x = number / 10
        else:
            now = time.time_ns()
            message.header.stamp.sec, message.header.stamp.nanosec = divmod(now, 10**9)
        writer.publish(message)
    time.sleep(0.1)
    print(f"processor time of a sample: {(time.process_time() - used) * 1e3 / samples:.3f} ms", flush=True)
    time.sleep(0.9)
    node.destroy_node()
    rclpy.shutdown()


main()
