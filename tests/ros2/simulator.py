"""rclpy reads what `belvedere ros2` publishes, and drives a robot (`.ci/ros2`).

simulator.py BELVEDERE RECORDING...: the program, and recordings with messages of ROS 2, whose bytes every message that is
received from a replay must have.
"""

import contextlib
import importlib
import json
import sys
from collections import defaultdict
from functools import partial
from pathlib import Path

import kit
import rclpy
from geometry_msgs.msg import Twist
from kit import LIST_S, spin
from mcap.reader import make_reader
from nav_msgs.msg import Odometry
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Image

BELVEDERE, RECORDINGS = sys.argv[1], sys.argv[2:]
RETURN_S = 2.0  # from the start of a simulator until its first message


program = partial(kit.program, BELVEDERE)
streams = partial(kit.streams, BELVEDERE)
readers = partial(kit.readers, BELVEDERE)


def message_class(name):
    """Returns the class of a type, or None if its package is not installed here."""
    package, _, kind = name.split("/")
    with contextlib.suppress(ImportError):
        return getattr(importlib.import_module(f"{package}.msg"), kind)
    return None


def type_hash(name):
    """Returns the hash of a type that its package has."""
    package, _, kind = name.split("/")
    share = Path(sys.prefix, "share", package, "msg", f"{kind}.json")
    if not share.is_file():  # made by interfaces.py
        return json.loads(Path(importlib.import_module(package).__file__).with_name("hashes.json").read_text())[name]
    return next(each["hash_string"] for each in json.loads(share.read_text())["type_hashes"] if each["type_name"] == name)


def significant(sample):
    """Returns the bytes of a message without those that only fill it up, whose number is in its fourth byte."""
    return bytes(sample[4 : len(sample) - (sample[3] & 3)])


def judge_replay(node, recording):
    recorded, types = defaultdict(set), {}
    with open(recording, "rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            if channel.topic.startswith("/belvedere/"):
                continue
            types[channel.topic] = schema.name
            recorded[channel.topic].add(significant(message.data))
    known = {topic: message_class(name) for topic, name in types.items()}
    known = {topic: kind for topic, kind in known.items() if kind}
    received = defaultdict(list)
    with program("replay", recording, "--loop"), program("ros2", "--wait"):
        for topic, kind in known.items():
            qos = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE)
            node.create_subscription(kind, topic, received[topic].append, qos, raw=True)
        assert spin(node, lambda: all(received[topic] for topic in known), 30) is not None, {
            topic: len(received[topic]) for topic in known
        }
        spin(node, lambda: False, 2)
        named = dict(node.get_topic_names_and_types())
        for topic, name in types.items():
            assert named.get(topic) == [name], f"{topic}: {named.get(topic)}, expected {name}"
        for topic in known:
            info = node.get_publishers_info_by_topic(topic)[0]
            assert info.node_name == "belvedere" and type_hash(types[topic]) in str(info.topic_type_hash), f"{topic}: {info}"
    for subscription in list(node.subscriptions):
        if subscription.topic_name in known:
            node.destroy_subscription(subscription)
    for topic, messages in received.items():
        wrong = sum(significant(message) not in recorded[topic] for message in messages)
        assert not wrong, f"{topic}: {wrong} of {len(messages)} messages have other bytes than the recording"
    print(f"{Path(recording).name}: {sum(map(len, received.values()))} messages of {len(known)} topics, "
          f"and {len(types) - len(known)} topics of types that are not installed", flush=True)


def judge_simulator(node):
    """What nobody reads is not rendered, velocities drive, and messages come again after the simulator is started again."""
    images, odometry = [], []
    commands = node.create_publisher(Twist, "/cmd_vel", 1)
    node.create_subscription(Odometry, "/odom", odometry.append, 10)
    with program("ros2", "--wait"):
        with program("run", "--drive", "still"):
            assert spin(node, lambda: odometry, 15) is not None
            assert readers("image_raw") == 0, "the camera is read although nobody asked for it"
            camera = node.create_subscription(Image, "/image_raw", images.append, 10)
            assert spin(node, lambda: len(images) > 30, 15) is not None, len(images)
            assert (images[0].width, images[0].height, images[0].encoding) == (640, 480, "rgb8")
            node.destroy_subscription(camera)
            assert spin(node, lambda: readers("image_raw") == 0, 5, LIST_S) is not None, "the camera is still read"

            def driven():
                commands.publish(Twist(linear=Twist().linear.__class__(x=0.3)))
                return odometry[-1].pose.pose.position.x > 0.2

            assert spin(node, driven, 15) is not None, odometry[-1].pose.pose.position
        # Messages of the first simulator may still be queued.
        spin(node, lambda: False, 0.5)
        odometry.clear()
        with program("run", "--drive", "still"):
            took = spin(node, lambda: odometry, 15)
            assert took is not None
    print(f"a robot was driven; {took:.2f} s after the simulator was started again, its odometry came", flush=True)
    return took


def judge_full_stream(node):
    """A stream without a place for another subscriber is published later, and the others go on meanwhile."""
    odometry, clock = [], []
    subscriptions = [
        node.create_subscription(Odometry, "/odom", odometry.append, 10),
        node.create_subscription(Clock, "/clock", clock.append, 10),
    ]
    with program("run", "--drive", "still"), contextlib.ExitStack() as others:
        assert spin(node, lambda: any(line["topic"].strip("/") == "odom" for line in streams()), 15, LIST_S) is not None
        for _ in range(8):
            others.enter_context(program("echo", "/odom"))
        assert spin(node, lambda: readers("odom") == 8, 15, LIST_S) is not None, readers("odom")
        with program("ros2"):
            assert spin(node, lambda: len(clock) > 100, 15) is not None, len(clock)
            assert not odometry
            others.close()
            assert spin(node, lambda: odometry, 15) is not None, "it is not published although there is a place"
    for subscription in subscriptions:
        node.destroy_subscription(subscription)


rclpy.init()
judge = rclpy.create_node("judge")
for path in RECORDINGS:
    judge_replay(judge, path)
judge_full_stream(judge)
took = [judge_simulator(judge)]
while took[-1] > RETURN_S and len(took) < 3:
    took.append(judge_simulator(judge))
assert took[-1] <= RETURN_S, f"odometry came {took} s after the simulator was started again"
judge.destroy_node()
rclpy.shutdown()
print("1 passed, 0 failed")
