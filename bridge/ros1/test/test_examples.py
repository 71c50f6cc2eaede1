#!/usr/bin/env python3
"""The launch files and the examples, each as a user runs it. Brings its own roscore."""

import os
import subprocess
import tempfile
import unittest
import xmlrpc.client
from pathlib import Path

from processes import Process, bridge, eventually, free_port, roscore, simulator

ROOT = Path(__file__).resolve().parents[3]
EXAMPLES = ROOT / "examples" / "ros1"


class Examples(unittest.TestCase):
    def setUp(self):
        self.domain = f"examples-{os.getpid()}"
        self.port = free_port()
        os.environ["ROS_MASTER_URI"] = f"http://127.0.0.1:{self.port}"
        self.master = xmlrpc.client.ServerProxy(os.environ["ROS_MASTER_URI"])

    def topics(self):
        """Topics that have a publisher now."""
        try:
            return {topic for topic, _ in self.master.getSystemState("/test")[2][0]}
        except OSError:
            return set()

    def run_example(self, *command, timeout=90):
        done = subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def flows(self, topic):
        self.run_example("rostopic", "echo", "-n", "1", "--noarr", topic, timeout=20)

    def roslaunch(self, *arguments, **environment):
        return Process("roslaunch", "-p", self.port, *arguments, **environment)

    def test_the_turtlebots_launch_file(self):
        sensors = {"TURTLEBOT_STACKS": "hexagons", "TURTLEBOT_3D_SENSOR": "KinectHokuyo"}
        arguments = "gui:=false", f"domain:={self.domain}", "world_file:=playground", "simulator_args:=--gazebo-compat --seed 7"
        with self.roslaunch("belvedere_ros", "turtlebot_world.launch", *arguments, **sensors) as launch:
            self.assertTrue(eventually(lambda: "/camera/depth/points" in self.topics(), 20), launch.output())
            self.flows("/rrbot/laser/scan")
            # As turtlebot_gazebo's launch file spawns it.
            known = self.run_example("rosservice", "call", "/gazebo/get_model_state", "mobile_base", "", timeout=20)
            self.assertIn("success: True", known)
            self.assertTrue(self.master.getParam("/test", "/use_sim_time")[2])

    def test_with_a_description_the_robots_transforms_come_from_robot_state_publisher(self):
        urdf = """<robot name="r"><link name="base_footprint"/><link name="base_link"/>
            <joint name="j" type="fixed"><parent link="base_footprint"/><child link="base_link"/></joint></robot>"""
        with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
            file.write(urdf)
            file.flush()
            arguments = "gui:=false", f"domain:={self.domain}", f"robot_description:={file.name}"
            with self.roslaunch("belvedere_ros", "turtlebot_world.launch", *arguments) as launch:
                self.assertTrue(eventually(lambda: "/odom" in self.topics(), 20), launch.output())
                senders = lambda topic: dict(self.master.getSystemState("/test")[2][0]).get(topic, [])  # noqa: E731
                self.assertTrue(eventually(lambda: senders("/tf_static") == ["/robot_state_publisher"]), launch.output())
                self.assertTrue(eventually(lambda: "/belvedere" in senders("/tf")), launch.output())

    def test_nodelet(self):
        with simulator(self.domain), self.roslaunch(EXAMPLES / "nodelet.launch", BELVEDERE_DOMAIN=self.domain) as launch:
            self.assertTrue(eventually(lambda: "/image_raw" in self.topics(), 20), launch.output())
            self.flows("/image_raw")

    def test_two_robots(self):
        with self.roslaunch(EXAMPLES / "two_robots.launch") as launch:
            topics = "image_raw", "odom", "tf", "tf_static", "gazebo/model_states"
            wanted = {f"/robot{n}/{topic}" for n in (1, 2) for topic in topics} | {"/clock"}
            self.assertTrue(eventually(lambda: wanted <= self.topics(), 20), launch.output())
            self.assertNotIn("/tf", self.topics())
            self.flows("/robot1/image_raw")
            self.flows("/robot2/odom")
            self.flows("/robot1/gazebo/model_states")
            self.run_example("rosservice", "call", "/robot2/gazebo/pause_physics", timeout=20)

    def test_programs(self):
        with roscore(self.port), simulator(self.domain), bridge(self.domain) as node:
            self.assertTrue(eventually(lambda: {"/odom", "/image_raw"} <= self.topics()), node.output())
            pictures = self.run_example(EXAMPLES / "first.py").splitlines()
            self.assertEqual(len(pictures), 10)
            self.assertTrue(all(line.startswith("640 x 480 at ") and "fx 381.36" in line for line in pictures), pictures)
            back = self.run_example(EXAMPLES / "drive_square.py")
            self.assertLess(float(back.split()[1]), 0.2, back)

    def test_a_bag_gives_the_same_topics(self):
        with tempfile.TemporaryDirectory() as folder, roscore(self.port):
            bag = os.path.join(folder, "run.bag")
            with simulator(self.domain), bridge(self.domain) as node:
                self.assertTrue(eventually(lambda: {"/odom", "/image_raw", "/scan"} <= self.topics()), node.output())
                # Nothing happens to the base here, and a topic without messages is not in a bag.
                sensed = {topic for topic in self.topics() - {"/diagnostics", "/rosout"} if "/events/" not in topic}
                self.run_example("rosbag", "record", "--all", "--duration=3", "-O", bag, "__name:=record")
            self.assertTrue(eventually(lambda: not sensed & self.topics()))
            with Process("rosbag", "play", "--clock", "--loop", bag) as play:
                self.assertTrue(eventually(lambda: sensed <= self.topics(), 20), play.output())
                for topic in ("/image_raw", "/scan", "/tf_static"):
                    self.flows(topic)


if __name__ == "__main__":
    unittest.main(verbosity=2, warnings="ignore")
