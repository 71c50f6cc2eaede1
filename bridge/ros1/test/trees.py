#!/usr/bin/env python3
"""Prints the transforms that arrive on tf and tf_static below some prefixes, as JSON: for each prefix an object of edges."""

import json
import sys
import threading
import time

import rospy
from tf2_msgs.msg import TFMessage


def matrix(transform):
    """Return rotation and translation as twelve numbers, the same for a quaternion and its negative."""
    q, t = transform.rotation, transform.translation
    x, y, z, w = q.x, q.y, q.z, q.w
    return [
        1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), t.x,
        2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), t.y,
        2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), t.z,
    ]  # fmt: skip


def collect(prefix, trees, lock):
    def receive(message, topic):
        with lock:
            for edge in message.transforms:
                name = f"{edge.header.frame_id} {edge.child_frame_id}"
                trees[prefix][name] = {"topic": topic, "matrix": matrix(edge.transform)}

    return [rospy.Subscriber(prefix + topic, TFMessage, receive, topic) for topic in ("tf", "tf_static")]


def main():
    rospy.init_node("trees", disable_signals=True)
    prefixes, lock = rospy.myargv(sys.argv)[1:], threading.Lock()
    trees = {prefix: {} for prefix in prefixes}
    subscribers = [collect(prefix, trees, lock) for prefix in prefixes]
    time.sleep(2)
    with lock:
        print(json.dumps([trees[prefix] for prefix in prefixes]))
    return subscribers


if __name__ == "__main__":
    main()
