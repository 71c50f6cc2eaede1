"""Reads a topic with rclpy and prints what came, as JSON: reader.py KIND RELIABILITY SAMPLES SECONDS."""

import json
import statistics
import sys
import time

import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Image, PointCloud2
from std_msgs.msg import String

TOPICS = {
    "image": ("/camera/image_raw", Image),
    "cloud": ("/points", PointCloud2),
    "latched": ("/robot_description", String),
}


def main():
    kind, reliability, samples, seconds = sys.argv[1], sys.argv[2], int(sys.argv[3]), float(sys.argv[4])
    topic, message = TOPICS[kind]
    qos = QoSProfile(depth=5, reliability=ReliabilityPolicy[reliability.upper()])
    if kind == "latched":
        qos.durability = DurabilityPolicy.TRANSIENT_LOCAL
    latencies = []
    wrong = 0

    def come(sample):
        nonlocal wrong
        now = time.time_ns()
        if kind == "latched":
            wrong += sample.data != "written before anyone listened"
            latencies.append(0.0)
            return
        stamp = sample.header.stamp
        latencies.append((now - stamp.sec * 10**9 - stamp.nanosec) / 1e6)
        size = {"image": 3, "cloud": 16}[kind] * 640 * 480
        wrong += len(sample.data) != size or sample.data[0] != 7 or sample.data[-1] != 7

    rclpy.init()
    node = rclpy.create_node("judge")
    node.create_subscription(message, topic, come, qos)
    end = time.monotonic() + seconds
    used = 0.0
    writers = []
    while time.monotonic() < end and len(latencies) < samples:
        rclpy.spin_once(node, timeout_sec=0.1)
        if not latencies:
            used = time.process_time()
        elif len(latencies) in (1, samples // 2):
            writers = node.get_publishers_info_by_topic(topic)
    report = {
        "came": len(latencies),
        "wrong": wrong,
        "median": statistics.median(latencies) if latencies else None,
        "largest": max(latencies, default=None),
        "processor": (time.process_time() - used) * 1e3 / max(len(latencies), 1),
        "nodes": [writer.node_name for writer in writers],
        "hashes": [str(writer.topic_type_hash) for writer in writers],
    }
    print(json.dumps(report), flush=True)
    node.destroy_node()
    rclpy.shutdown()


main()
