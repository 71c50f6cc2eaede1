#!/usr/bin/env python3
"""The launch files and the examples, each run as by a user. Starts its own roscore."""

import json
import os
import signal
import subprocess
import tempfile
import time
import unittest
import xmlrpc.client
from pathlib import Path
from xml.etree import ElementTree

from processes import Process, bridge, eventually, free_port, roscore, simulator

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
EXAMPLES = ROOT / "examples" / "ros1"
TRANSFORM_TOLERANCE = 1e-6  # m, and of a rotation matrix; URDF's angles go through other arithmetic there
MAST = """<robot xmlns:xacro="http://ros.org/wiki/xacro"><xacro:macro name="mast" params="parent height">
  <link name="mast_top"/>
  <joint name="mast" type="fixed"><parent link="${parent}"/><child link="mast_top"/><origin xyz="0.1 0 ${height - 0.0102}"/></joint>
</xacro:macro></robot>"""
MINE = """<robot name="mine" xmlns:xacro="http://ros.org/wiki/xacro">
  <xacro:include filename="$(find turtlebot_description)/urdf/turtlebot_library.urdf.xacro"/>
  <xacro:include filename="$(find my_description)/mast.xacro"/>
  <kobuki/><sensor_rplidar parent="base_link"/><xacro:mast parent="base_link" height="${0.5 + 0.01}"/>
</robot>"""


class Examples(unittest.TestCase):
    def setUp(self):
        self.domain = f"examples-{os.getpid()}"
        self.port = free_port()
        os.environ["ROS_MASTER_URI"] = f"http://127.0.0.1:{self.port}"
        self.master = xmlrpc.client.ServerProxy(os.environ["ROS_MASTER_URI"])

    def topics(self):
        """Return the topics that have a publisher now."""
        try:
            return {topic for topic, _ in self.master.getSystemState("/test")[2][0]}
        except OSError:
            return set()

    def master_answers(self):
        try:
            return self.master.getPid("/test")[0] == 1
        except OSError:
            return False

    def pid(self, node):
        """Return the pid of a node; None if it does not answer."""
        try:
            return xmlrpc.client.ServerProxy(self.master.lookupNode("/test", node)[2]).getPid("/test")[2]
        except OSError:
            return None

    def subscribed(self):
        """Return the topics that have a subscriber now."""
        return {topic for topic, _ in self.master.getSystemState("/test")[2][1]}

    def run_example(self, *command, timeout=90):
        done = subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def flows(self, topic):
        self.run_example("rostopic", "echo", "-n", "1", "--noarr", topic, timeout=20)

    def x(self):
        """Return the distance that the robot went, in metres, by tf."""
        said = self.run_example(EXAMPLES / "where.py", "odom", "base_footprint", "1")
        return float(said.split(": ")[1].split()[0])

    def roslaunch(self, *arguments, **environment):
        return Process("roslaunch", "-p", self.port, *arguments, **environment)

    def test_the_turtlebots_launch_file(self):
        sensors = {"TURTLEBOT_STACKS": "hexagons", "TURTLEBOT_3D_SENSOR": "KinectHokuyo"}
        arguments = "gui:=false", f"domain:={self.domain}", "world_file:=playground", "simulator_args:=--gazebo-compat --seed 7"
        with self.roslaunch("belvedere_ros", "turtlebot_world.launch", *arguments, **sensors) as launch:
            self.assertTrue(eventually(lambda: "/camera/depth/points" in self.topics(), 20), launch.output())
            self.flows("/rrbot/laser/scan")
            # The name that turtlebot_gazebo's launch file spawns it with.
            known = self.run_example("rosservice", "call", "/gazebo/get_model_state", "mobile_base", "", timeout=20)
            self.assertIn("success: True", known)
            self.assertTrue(self.master.getParam("/test", "/use_sim_time")[2])

    def test_dead_nodes_are_restarted(self):
        arguments = "gui:=false", f"domain:={self.domain}", "world_file:=playground"
        with self.roslaunch("belvedere_ros", "turtlebot_world.launch", *arguments) as launch:
            told = "/cmd_vel_mux/active"  # of the nodelet in the manager
            self.assertTrue(eventually(lambda: {"/odom", told} <= self.topics(), 30), launch.output())
            # Only a nodelet's loader whose heartbeats the manager has answered notices that the manager dies, and ends.
            time.sleep(5)
            for node in "/belvedere", "/mobile_base_nodelet_manager":
                first = self.pid(node)
                os.kill(first, signal.SIGKILL)
                self.assertTrue(eventually(lambda: self.pid(node) not in (None, first), 20), launch.output())
            # The master drops the registrations of the dead node when the next one of that name registers.
            self.assertTrue(eventually(lambda: {"/odom", told} <= self.topics(), 30), launch.output())
            self.flows("/odom")
            self.flows(told)

    def test_launch_files_clear_old_parameters(self):
        """Parameters remain on a roscore that several launches share: a node must only see its own launch file's."""
        for file in {*EXAMPLES.rglob("*.launch"), *(HERE.parent / "launch").glob("*.launch")}:
            for node in ElementTree.parse(file).iter("node"):
                if node.get("type") == "bridge" or node.get("args", "").startswith("load ") or node.find("param") is not None:
                    self.assertEqual(node.get("clear_params"), "true", f"{node.get('name')} of {file.name}")

    def test_robot_state_publisher_sends_the_tree_that_the_simulator_would(self):
        arguments = "gui:=false", f"domain:={self.domain}", "world_file:=playground"
        sensors = {"TURTLEBOT_STACKS": "hexagons", "TURTLEBOT_3D_SENSOR": "KinectHokuyo"}
        with self.roslaunch("belvedere_ros", "turtlebot_world.launch", *arguments, **sensors) as launch:
            senders = lambda topic: dict(self.master.getSystemState("/test")[2][0]).get(topic, [])  # noqa: E731
            self.assertTrue(eventually(lambda: "/odom" in self.topics(), 20), launch.output())
            self.assertTrue(eventually(lambda: senders("/tf_static") == ["/robot_state_publisher"]), launch.output())
            self.assertTrue(eventually(lambda: set(senders("/tf")) == {"/belvedere", "/robot_state_publisher"}), launch.output())
            # A second bridge publishes all of the simulator's transforms, on its own topics.
            names = "__ns:=/own", "/tf:=/own/tf", "/tf_static:=/own/tf_static", "_publish_clock:=false"
            with bridge(self.domain, *names) as node:
                self.assertTrue(eventually(lambda: {"/own/tf", "/own/tf_static"} <= self.topics()), node.output())
                trees = json.loads(self.run_example("/usr/bin/python3", HERE / "trees.py", "/", "/own/", timeout=40))
        ours, theirs = trees
        self.assertEqual(set(ours), set(theirs))
        self.assertGreater(len(ours), 30)
        self.assertEqual(ours["odom base_footprint"]["topic"], "tf")
        self.assertEqual(ours["base_link hokuyo_link"]["topic"], "tf_static")
        for edge, transform in ours.items():
            self.assertEqual(transform["topic"], theirs[edge]["topic"], edge)
            # Moving transforms may have another time: the robot settles on its wheels.
            tolerance = TRANSFORM_TOLERANCE if transform["topic"] == "tf_static" else 1e-3
            for a, b in zip(transform["matrix"], theirs[edge]["matrix"]):
                self.assertAlmostEqual(a, b, delta=tolerance, msg=edge)

    def test_a_custom_robot(self):
        with tempfile.TemporaryDirectory() as folder:
            package = Path(folder) / "my_description"
            package.mkdir()
            (package / "package.xml").write_text("<package><name>my_description</name></package>")
            (package / "mast.xacro").write_text(MAST)
            robot = package / "robot.urdf.xacro"
            robot.write_text(MINE)
            environment = {"ROS_PACKAGE_PATH": f"{folder}:{os.environ['ROS_PACKAGE_PATH']}"}
            arguments = "gui:=false", f"domain:={self.domain}", "world_file:=empty", f"robot:={robot}"
            with self.roslaunch("belvedere_ros", "turtlebot_world.launch", *arguments, **environment) as launch:
                self.assertTrue(eventually(lambda: "/scan" in self.topics(), 20), launch.output())
                described = self.master.getParam("/test", "/robot_description")[2]
                self.assertIn('<link name="mast_top"', described)
                self.assertNotIn("xacro", described)
                self.assertTrue(eventually(lambda: "/tf_static" in self.topics()), launch.output())
                said = self.run_example(EXAMPLES / "where.py", "base_footprint", "mast_top", "1")
                self.assertIn(": 0.100 0.000 0.510, ", said)

    def test_nodelet(self):
        with simulator(self.domain), self.roslaunch(EXAMPLES / "nodelet.launch", BELVEDERE_DOMAIN=self.domain) as launch:
            self.assertTrue(eventually(lambda: "/image_raw" in self.topics(), 20), launch.output())
            self.flows("/image_raw")

    def test_two_robots(self):
        self.enterContext(roscore(self.port))
        self.assertTrue(eventually(self.master_answers))
        # A parameter that turtlebot_world.launch leaves on a shared roscore: /tf_static would be missing.
        self.master.setParam("/test", "/belvedere/transforms", "odometry")
        with self.roslaunch(EXAMPLES / "two_robots.launch") as launch:
            topics = "image_raw", "odom", "joint_states"
            wanted = {f"/robot{n}/{topic}" for n in (1, 2) for topic in topics}
            wanted |= {"/clock", "/tf", "/tf_static", "/gazebo/model_states"}
            self.assertTrue(eventually(lambda: wanted <= self.topics(), 20), launch.output())
            self.flows("/robot1/image_raw")
            self.flows("/robot2/odom")
            # Late subscribers know the frames of both robots, which stand side by side.
            for n in (1, 2):
                said = self.run_example(EXAMPLES / "where.py", f"robot{n}/base_footprint", f"robot{n}/base_link", "1")
                self.assertIn(": ", said)
            commands = {f"/robot{n}/{topic}" for n in (1, 2) for topic in ("cmd_vel", "mobile_base/commands/velocity")}
            self.assertLessEqual(commands, self.subscribed())
            self.assertNotIn("/mobile_base/commands/velocity", self.subscribed())
            self.run_example("rosservice", "call", "/gazebo/pause_physics", timeout=20)

    def test_programs(self):
        with roscore(self.port), simulator(self.domain), bridge(self.domain) as node:
            self.assertTrue(eventually(lambda: {"/odom", "/image_raw"} <= self.topics()), node.output())
            pictures = self.run_example(EXAMPLES / "first.py").splitlines()
            self.assertEqual(len(pictures), 10)
            self.assertTrue(all(line.startswith("640 x 480 at ") and "fx 381.36" in line for line in pictures), pictures)
            with tempfile.TemporaryDirectory() as folder:
                self.run_example(EXAMPLES / "pictures.py", f"{folder}/picture.png")
                self.assertGreater(os.path.getsize(f"{folder}/picture.png"), 20_000)
            with Process(EXAMPLES / "tags.py") as tags:
                self.assertTrue(eventually(lambda: "tag_" in tags.output(), 20), tags.output())
                tag = tags.output().split()[0]
                x, y, z = self.run_example(EXAMPLES / "where.py", "odom", tag, "1").split(": ")[1].split(",")[0].split()
                self.assertAlmostEqual(float(z), 2.498, delta=0.05)  # the ceiling
            before = self.x()
            with subprocess.Popen([EXAMPLES / "teleop.py"], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL) as teleop:
                os.write(teleop.stdin.fileno(), b"w")
                self.assertTrue(eventually(lambda: self.x() - before > 0.3, 30))
                os.write(teleop.stdin.fileno(), b" q")
                self.assertEqual(teleop.wait(10), 0)
            back = self.run_example(EXAMPLES / "drive_square.py")
            self.assertLess(float(back.split()[1]), 0.2, back)

    def test_a_bag_gives_the_same_topics(self):
        with tempfile.TemporaryDirectory() as folder, roscore(self.port):
            bag = os.path.join(folder, "run.bag")
            with simulator(self.domain), bridge(self.domain) as node:
                self.assertTrue(eventually(lambda: {"/odom", "/image_raw", "/scan"} <= self.topics()), node.output())
                # The base has no events here, and a topic without messages is not in a bag.
                sensed = {topic for topic in self.topics() - {"/diagnostics", "/rosout"} if "/events/" not in topic}
                self.run_example("rosbag", "record", "--all", "--duration=3", "-O", bag, "__name:=record")
            self.assertTrue(eventually(lambda: not sensed & self.topics()))
            with Process("rosbag", "play", "--clock", "--loop", bag) as play:
                self.assertTrue(eventually(lambda: sensed <= self.topics(), 20), play.output())
                for topic in ("/image_raw", "/scan", "/tf_static"):
                    self.flows(topic)


if __name__ == "__main__":
    unittest.main(verbosity=2, warnings="ignore")
