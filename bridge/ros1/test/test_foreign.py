#!/usr/bin/env python3
"""Unmodified external nodes on our topics. Needs a master at ROS_MASTER_URI."""

import json
import math
import os
import re
import struct
import subprocess
import tempfile
import threading
import time
import unittest
from collections import defaultdict
from pathlib import Path

import cv2
import message_filters
import numpy
import rosbag
import rospy
from apriltag import apriltag
from geometry_msgs.msg import Twist
from listener import published
from processes import SIMULATOR, Process, bridge, eventually, simulator
from programs import program
from sensor_msgs.msg import CameraInfo, Image, PointCloud2
from std_srvs.srv import Empty
from tf2_msgs.msg import TFMessage

HERE = Path(__file__).resolve().parent
TAGS = HERE.parents[2] / "models" / "worlds" / "tag_ceiling.tags.json"
DOMAIN = f"foreign-{os.getpid()}"
SENSORS = {"TURTLEBOT_STACKS": "hexagons", "TURTLEBOT_3D_SENSOR": "KinectHokuyo"}
CLOCK = "/clock", "rosgraph_msgs/Clock"
IMAGE_BYTES = 640 * 480 * 3
TF_ECHO_TOLERANCE = 1e-3  # it prints three decimals, of metres and of quaternions
ODOMETRY_TOLERANCE_M = 0.01  # wheels slip when they start and stop
CAMERA_TOLERANCE_M, CAMERA_TOLERANCE_DEG = 0.001, 0.03  # by all tags in view
TAG_TOLERANCE_M = 0.03  # by one tag, 0.28 m wide and 2.1 m away, that fills 50 pixels


def pair(one, two, timeout=20):
    """Return messages of two topics with the same stamp."""
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
    """Yield some points of a cloud."""
    x = next(field.offset for field in cloud.fields if field.name == "x")
    for row in range(0, cloud.height, every):
        for column in range(0, cloud.width, every):
            yield struct.unpack_from("<3f", cloud.data, row * cloud.row_step + column * cloud.point_step + x)


def states(domain):
    """Return the true pose of every link: position and x, y, z, w."""
    command = SIMULATOR, "control", "states", "--links", "--json", "--domain", domain
    done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=20)
    lines = map(json.loads, done.stdout.splitlines())
    return {line["name"]: (numpy.array(line["position"]), numpy.array(line["orientation"])) for line in lines}


def rotation(quaternion):
    """Return the matrix of a quaternion."""
    x, y, z, w = quaternion
    return numpy.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip


def turn_in(parent, child):
    """Return the rotation of a frame in its parent, by tf_static."""
    fixed = rospy.wait_for_message("/tf_static", TFMessage, timeout=20).transforms
    q = next(edge for edge in fixed if (edge.header.frame_id, edge.child_frame_id) == (parent, child)).transform.rotation
    return rotation((q.x, q.y, q.z, q.w))


class Running(unittest.TestCase):
    """A simulator and a bridge for all tests of a class."""

    arguments, environment, topic = (), {}, "/odom"

    @classmethod
    def setUpClass(cls):
        cls.domain = f"{DOMAIN}-{cls.__name__}"
        cls.simulator = simulator(cls.domain, *cls.arguments, **cls.environment)
        cls.node = bridge(cls.domain)
        assert eventually(lambda: cls.topic in published()), cls.node.output() + cls.simulator.output()

    @classmethod
    def tearDownClass(cls):
        cls.node.stop()
        cls.simulator.stop()


class Kinect(Running):
    arguments, environment, topic = ("--world", "playground"), SENSORS, "/camera/depth/points"

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

    def test_image_proc_does_not_change_an_undistorted_image(self):
        with Process(program("image_proc", "image_proc"), ROS_NAMESPACE="/camera/rgb") as theirs:
            images = pair(("/camera/rgb/image_raw", Image), ("/camera/rgb/image_rect_color", Image))
            self.assertEqual(len(images), 2, theirs.output())
        ours, rectified = images
        self.assertEqual((rectified.width, rectified.height), (640, 480))
        difference = max(abs(a - b) for a, b in zip(ours.data, rectified.data)) if rectified.encoding == ours.encoding else None
        self.assertEqual(difference, 0, rectified.encoding)

    def tf_echo(self, outer, inner):
        """Return the last output of tf_echo: translation and quaternion."""
        with Process("stdbuf", "-oL", program("tf", "tf_echo"), outer, inner) as theirs:
            self.assertTrue(eventually(lambda: theirs.output().count("RPY (degree)") >= 2, 15), theirs.output())
            said = theirs.output()
        numbers = r"\[(\S+), (\S+), (\S+)(?:, (\S+))?\]"
        translation = re.findall(f"Translation: {numbers}", said)[-1][:3]
        quaternion = re.findall(f"in Quaternion {numbers}", said)[-1]
        return numpy.array(translation, float), numpy.array(quaternion, float)

    def test_tf_echo_prints_the_truth(self):
        # The data of the Kinect's mount: reference/turtlebot.md; the optical frame is rotated by rpy −90°, 0, −90°.
        for inner, position, quaternion in (
            ("camera_depth_optical_frame", [-0.087, 0.0125, 0.2972], [-0.5, 0.5, -0.5, 0.5]),
            ("hokuyo_link", [0.10, 0.0, 0.4352], [0, 0, 0, 1]),
        ):
            translation, turn = self.tf_echo("base_footprint", inner)
            self.assertLess(numpy.abs(translation - position).max(), TF_ECHO_TOLERANCE, inner)
            self.assertLess(numpy.abs(rotation(turn) - rotation(quaternion)).max(), 2 * TF_ECHO_TOLERANCE, inner)
        # After a turn and a drive, compared with the physics.
        commands, twist = rospy.Publisher("cmd_vel", Twist, queue_size=1), Twist()
        before, _ = states(self.domain)["turtlebot::base_footprint"]
        self.assertTrue(eventually(lambda: commands.get_num_connections() > 0))
        for twist.linear.x, twist.angular.z in ((0, 1), (0.3, 0)):
            for _ in range(10):
                commands.publish(twist)
                time.sleep(0.1)
        time.sleep(1)
        after, _ = states(self.domain)["turtlebot::base_footprint"]
        translation, _ = self.tf_echo("odom", "base_footprint")
        moved = numpy.hypot(*(after - before)[:2])
        print(f"moved {moved:.3f} m, by tf_echo {numpy.hypot(*translation[:2]):.3f} m")
        self.assertGreater(moved, 0.2)
        self.assertAlmostEqual(numpy.hypot(*translation[:2]), moved, delta=ODOMETRY_TOLERANCE_M)


class Ceiling(Running):
    """The camera that sees tags."""

    topic = "/image_raw"

    def test_image_saver_saves_our_pixels(self):
        sent, lock = set(), threading.Lock()  # noise makes each image different

        def receive(message):
            with lock:
                sent.add(bytes(message.data))

        with tempfile.TemporaryDirectory() as folder:
            subscriber = rospy.Subscriber("/image_raw", Image, receive, buff_size=1 << 24)
            arguments = "image:=/image_raw", "_save_all_image:=false", f"_filename_format:={folder}/%04i.png", "__name:=saver"
            with Process(program("image_view", "image_saver"), *arguments) as theirs:
                save = rospy.ServiceProxy("/saver/save", Empty)
                save.wait_for_service(15)
                self.assertTrue(eventually(lambda: sent), theirs.output())
                save()
                saved = lambda: next((file for file in Path(folder).glob("*.png")), None)  # noqa: E731
                self.assertTrue(eventually(saved), theirs.output())
            subscriber.unregister()
            picture = cv2.cvtColor(cv2.imread(str(saved())), cv2.COLOR_BGR2RGB)
        self.assertIn(picture.tobytes(), sent, "it is none of ours")

    def test_the_april_tag_library_finds_tags_and_camera(self):
        image, info = pair(("/image_raw", Image), ("/camera_info", CameraInfo))
        links = states(self.domain)
        grey = cv2.cvtColor(numpy.frombuffer(image.data, numpy.uint8).reshape(image.height, image.width, 3), cv2.COLOR_RGB2GRAY)
        camera = numpy.reshape(info.K, (3, 3))
        # The library's origin is the corner of the first pixel, that of ROS its centre.
        seen = {tag["id"]: tag["lb-rb-rt-lt"] - 0.5 for tag in apriltag("tag36h11").detect(grey)}
        listed = {code["id"]: code for code in json.loads(TAGS.read_text())["codes"] if code["family"] == "tag36h11"}
        seen = {tag: corners for tag, corners in seen.items() if tag in listed}
        self.assertGreaterEqual(len(seen), 3)
        # tf gives the pose of the image's frame on its link; it looks along z, as in OpenCV.
        position, quaternion = links["turtlebot::base_camera_link"]
        world_from_optical = rotation(quaternion) @ turn_in("base_camera_link", info.header.frame_id)
        for tag, corners in seen.items():
            half = listed[tag]["edge_m"] / 2
            square = numpy.array([[-half, half, 0], [half, half, 0], [half, -half, 0], [-half, -half, 0]])
            # The library's own corners begin at the bottom left.
            _, _, place = cv2.solvePnP(square, corners[[3, 2, 1, 0]], camera, None, flags=cv2.SOLVEPNP_IPPE_SQUARE)
            truth = numpy.mean(listed[tag]["corners_m"], axis=0)
            off = numpy.linalg.norm(world_from_optical @ place[:, 0] + position - truth)
            print(f"tag {tag}: {off * 1000:.1f} mm off")
            self.assertLess(off, TAG_TOLERANCE_M)
        points = numpy.concatenate([listed[tag]["corners_m"] for tag in seen])
        pixels = numpy.concatenate([seen[tag] for tag in seen])
        _, turn, move = cv2.solvePnP(points, pixels, camera, None)
        optical_from_world = cv2.Rodrigues(turn)[0]
        off_m = numpy.linalg.norm(-optical_from_world.T @ move[:, 0] - position)
        off_deg = numpy.degrees(numpy.linalg.norm(cv2.Rodrigues(optical_from_world @ world_from_optical)[0]))
        print(f"camera by {len(seen)} tags: {off_m * 1000:.2f} mm and {off_deg:.3f} degrees off")
        self.assertLess(off_m, CAMERA_TOLERANCE_M)
        self.assertLess(off_deg, CAMERA_TOLERANCE_DEG)


class Bags(unittest.TestCase):
    """A recording, and a recording of its replay."""

    @staticmethod
    def contents(bag):
        """Return the bytes of every message, by topic."""
        messages = defaultdict(list)
        with rosbag.Bag(bag) as file:
            for topic, (kind, content, *_), _ in file.read_messages(raw=True):
                messages[topic, kind].append(content)
        return {topic: sent for topic, sent in messages.items() if not topic[0].startswith("/rosout")}

    def test_a_replay_has_the_same_contents(self):
        domain = f"{DOMAIN}-bag"
        with tempfile.TemporaryDirectory() as folder:
            first, again = os.path.join(folder, "first.bag"), os.path.join(folder, "again.bag")
            with simulator(domain) as robot, bridge(domain) as node:
                self.assertTrue(
                    eventually(lambda: {"/odom", "/image_raw", "/scan"} <= published()), node.output() + robot.output()
                )
                with Process("rosbag", "record", "--all", "-O", first, "__name:=recorder") as recorder:
                    # A busy machine records fewer images a second, so wait for their bytes instead of for a time.
                    written = lambda: sum(file.stat().st_size for file in Path(folder).glob("first.bag*"))  # noqa: E731
                    self.assertTrue(eventually(lambda: written() > 70 * IMAGE_BYTES, 30), recorder.output())
                    self.assertEqual(recorder.stop(), 0, recorder.output())
            self.assertTrue(eventually(lambda: not {"/odom", "/tf_static"} & published()))
            # In simulated time the recorder would wait for the clock, and the player for the recorder.
            rospy.set_param("/use_sim_time", False)
            with Process("rosbag", "record", "--all", "-O", again, "__name:=recorder") as recorder:
                with Process("rosbag", "play", "--delay=1.5", "--wait-for-subscribers", first) as player:
                    self.assertEqual(player.child.wait(40), 0, player.output())
                time.sleep(0.5)
            recorded, replayed = self.contents(first), self.contents(again)
        self.assertEqual(recorded.keys(), replayed.keys())
        print({topic: len(messages) for (topic, _), messages in recorded.items()})
        self.assertGreater(len(recorded["/image_raw", "sensor_msgs/Image"]), 60)
        # In simulated time several clocks are received at the same time, some of which rosbag play leaves out.
        clocks, replayed_clocks = recorded.pop(CLOCK), replayed.pop(CLOCK)
        self.assertLessEqual(set(replayed_clocks), set(clocks))
        self.assertGreater(len(replayed_clocks), 0.8 * len(clocks))
        for topic, messages in recorded.items():
            self.assertTrue(
                messages == replayed[topic], f"{topic}: {len(messages)} and {len(replayed[topic])} messages, or other bytes"
            )


class Rates(unittest.TestCase):
    def test_hztest_of_rostest(self):
        done = subprocess.run(
            ["rostest", "--text", HERE / "rates.test"],
            env={**os.environ, "BELVEDERE_DOMAIN": f"{DOMAIN}-rates"},
            capture_output=True, text=True, timeout=120, check=False,
        )  # fmt: skip
        # With --text the exit code is always 0, so check the output.
        results = re.findall(r"\* RESULT: (\w+)", done.stdout)
        self.assertEqual(results, ["SUCCESS", "SUCCESS"], done.stdout + done.stderr)


if __name__ == "__main__":
    rospy.init_node("belvedere_test", disable_signals=True)
    unittest.main(verbosity=2, warnings="ignore")
