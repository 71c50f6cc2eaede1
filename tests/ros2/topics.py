"""rclpy reads what `belvedere run --ros2` publishes beside its streams, descriptions of robots and compressed images, and
drives a robot with TwistStamped (`.ci/ros2`).

topics.py BELVEDERE FOLDER FORMAT: the program, a folder for images as they came, which pixels.py compares, and the format
of a second camera, BAYER_RGGB8 or L16.
"""

import json
import math
import subprocess
import sys
from functools import partial
from pathlib import Path
from xml.etree import ElementTree

import kit
import numpy as np
import rclpy
from geometry_msgs.msg import TwistStamped
from kit import LIST_S, spin
from nav_msgs.msg import Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import String

BELVEDERE, FOLDER = sys.argv[1], Path(sys.argv[2])
SPAWNED = sys.argv[3], {"BAYER_RGGB8": "bayer_rggb8", "L16": "mono16"}[sys.argv[3]] + "; png compressed "
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
readers = partial(kit.readers, BELVEDERE)


def control(*words):
    subprocess.run([BELVEDERE, "control", *words, "--domain", kit.DOMAIN], check=True)


def urdf():
    return subprocess.run([BELVEDERE, "urdf"], capture_output=True, text=True, check=True).stdout


def check_hash(name, endpoint):
    """Compares the hash of a type with that of its package."""
    package, _, kind = name.split("/")
    share = Path(sys.prefix, "share", package, "msg", f"{kind}.json")
    expected = next(each["hash_string"] for each in json.loads(share.read_text())["type_hashes"] if each["type_name"] == name)
    assert endpoint.topic_type == name and expected in str(endpoint.topic_type_hash), endpoint


def described(node, topic):
    """Returns the description on a topic, and its subscription."""
    texts = []
    subscription = node.create_subscription(String, topic, texts.append, LATCHED)
    assert spin(node, lambda: texts, 10) is not None, topic
    check_hash("std_msgs/msg/String", node.get_publishers_info_by_topic(topic)[0])
    node.destroy_subscription(subscription)
    return texts[-1].data


def judge_description(node):
    """The description is the URDF that `belvedere urdf` prints, and whoever comes later gets it."""
    text = described(node, "/robot_description")
    robot = ElementTree.fromstring(text)
    assert robot.tag == "robot" and text.strip() == urdf().strip()
    links = {link.get("name") for link in robot.findall("link")}
    assert {"base_footprint", "base_link", "base_camera_link_optical"} <= links, links
    for mesh in robot.iter("mesh"):
        path = mesh.get("filename")
        assert path.startswith("file://") and Path(path.removeprefix("file://")).is_file(), path


def judge_velocities(node):
    """TwistStamped drives; numbers that are not finite do not."""
    odometry = []
    node.create_subscription(Odometry, "/odom", odometry.append, 10)
    commands = node.create_publisher(TwistStamped, "/cmd_vel", 1)
    assert spin(node, lambda: odometry, 15) is not None

    def drive(forward):
        stamped = TwistStamped()
        stamped.header.stamp = node.get_clock().now().to_msg()
        stamped.header.frame_id = "base_link"
        stamped.twist.linear.x = forward
        commands.publish(stamped)
        return odometry[-1].pose.pose.position.x

    spin(node, lambda: commands.get_subscription_count() > 0, 10)
    spin(node, lambda: drive(math.nan) and False, 0.5)
    assert abs(drive(math.inf)) < 0.01, "it was driven by a number that is not finite"
    assert spin(node, lambda: drive(0.3) > 0.1, 15) is not None, odometry[-1].pose.pose.position
    listening = node.get_subscriptions_info_by_topic("/cmd_vel")
    assert {each.topic_type for each in listening} == {"geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"}
    for each in listening:
        check_hash(each.topic_type, each)


def judge_compressed(node, topic, form):
    """The camera is rendered while somebody reads the compressed images, which are those of the topic itself."""
    stream = topic.strip("/")
    assert readers(stream) == 0, f"{topic} is read although nobody asked for it"
    small, large = {}, {}

    def keep(images, image):
        images[image.header.stamp.sec, image.header.stamp.nanosec] = image

    compressed = node.create_subscription(CompressedImage, f"{topic}/compressed", partial(keep, small), 10)
    assert spin(node, lambda: len(small) > 1, 15) is not None, len(small)
    assert readers(stream) == 1, readers(stream)
    plain = node.create_subscription(Image, topic, partial(keep, large), 10)
    assert spin(node, lambda: len(small.keys() & large.keys()) > 1, 15) is not None, (len(small), len(large))
    check_hash("sensor_msgs/msg/CompressedImage", node.get_publishers_info_by_topic(f"{topic}/compressed")[0])
    last = max(small.keys() & large.keys())
    for subscription in (plain, compressed):
        node.destroy_subscription(subscription)
    assert (small[last].format, small[last].header) == (form, large[last].header), small[last].format
    image = large[last]
    numbers = np.frombuffer(image.data, np.dtype("<u2") if "16" in image.encoding else np.uint8)
    pixels = numbers.reshape(image.height, image.width, -1).squeeze()
    encoded = np.frombuffer(small[last].data, np.uint8)
    np.savez(FOLDER / f"{stream.replace('/', '_')}.npz", pixels=pixels, encoded=encoded, form=form)
    assert spin(node, lambda: readers(stream) == 0, 5, LIST_S) is not None, f"{topic} is still read"


def judge_spawned(node, namespace, camera_format, form):
    """The description and the compressed images of a robot come and go with it."""
    robot = FOLDER / f"{namespace}.urdf"
    robot.write_text(urdf().replace("R8G8B8", camera_format))
    control("spawn", str(robot), "--namespace", namespace, "--pose", "2,1")
    assert camera_format in described(node, f"/{namespace}/robot_description")
    judge_compressed(node, f"/{namespace}/image_raw", form)
    control("delete", namespace)
    topics = [f"/{namespace}/{topic}" for topic in ("robot_description", "image_raw/compressed")]
    assert spin(node, lambda: not any(map(node.count_publishers, topics)), 5) is not None, f"one of {topics} is still there"


def judge_options(node):
    """`run --ros2` has the options of `belvedere ros2`."""
    options = ("--remap", "/odom:=/pose", "--qos", "/pose=sensor_data", "--ros-namespace", "other", "--no-commands")
    with kit.program(BELVEDERE, "run", "--ros2", "--drive", "still", *options):
        assert spin(node, lambda: node.count_publishers("/pose"), 15) is not None, node.get_topic_names_and_types()
        endpoint = node.get_publishers_info_by_topic("/pose")[0]
        assert endpoint.qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT, endpoint
        assert spin(node, lambda: node.count_publishers("/other/image_raw"), 15) is not None
        assert not node.count_subscribers("/other/cmd_vel") and not node.count_subscribers("/cmd_vel")


rclpy.init()
judge = rclpy.create_node("judge")
with kit.program(BELVEDERE, "run", "--ros2", "--drive", "still") as said:
    judge_description(judge)
    judge_velocities(judge)
    judge_compressed(judge, "/image_raw", "rgb8; jpeg compressed bgr8")
    judge_spawned(judge, "spawned", *SPAWNED)
assert said().count("not a geometry_msgs/msg/TwistStamped of finite numbers") == 1, said()
judge_options(judge)
judge.destroy_node()
rclpy.shutdown()
print("descriptions, compressed images, TwistStamped and options: 1 passed, 0 failed")
