#!/usr/bin/env python3
"""Life cycles: simulator, node and roscore start late, end, are killed and restart in any order. Starts its own roscore."""

import os
import signal
import subprocess
import tempfile
import time
import unittest
import xmlrpc.client

import rosbag
import rospy
from processes import BRIDGE, Process, bridge, eventually, free_port, roscore, simulator, subscribers_of_streams
from std_msgs.msg import String

CYCLES = int(os.environ.get("BELVEDERE_ROS_CYCLES", "20"))


class Lives(unittest.TestCase):
    def setUp(self):
        self.domain = f"lives-{os.getpid()}"
        self.port = free_port()
        os.environ["ROS_MASTER_URI"] = f"http://127.0.0.1:{self.port}"
        self.master = xmlrpc.client.ServerProxy(os.environ["ROS_MASTER_URI"])

    def master_answers(self):
        try:
            return self.master.getPid("/test")[0] == 1
        except OSError:
            return False

    def knows_node(self, name="/belvedere"):
        try:
            return self.master.lookupNode("/test", name)[0] == 1
        except OSError:
            return False

    def topics(self):
        """Return the topics that have a publisher now."""
        try:
            return {topic for topic, _ in self.master.getSystemState("/test")[2][0]}
        except OSError:
            return set()

    def registered(self, name="/belvedere"):
        """Return the master's entries of a node: published topics, subscribed topics, services."""
        return tuple({entry for entry, nodes in kind if name in nodes} for kind in self.master.getSystemState("/test")[2])

    def turns(self):
        """Return whether the robot follows a turn command, as seen by a program that starts now."""
        command = ["rostopic", "echo", "-n", "1", "/odom/twist/twist/angular/z"]
        said = subprocess.run(command, capture_output=True, text=True, timeout=20).stdout.split()
        return bool(said) and abs(float(said[0]) - 0.5) < 0.1

    def flows(self, topic="/odom", timeout=20):
        """Return whether a program that starts now receives a message."""
        command = ["rostopic", "echo", "-n", "1", "--noarr", topic]
        try:
            return subprocess.run(command, capture_output=True, timeout=timeout).returncode == 0
        except subprocess.TimeoutExpired:
            return False

    def started(self, process):
        """Register a process to be stopped at the end in any case."""
        self.addCleanup(process.stop)
        return process

    def test_each_may_start_late_and_be_killed(self):
        node = bridge(self.domain)
        with node:
            self.assertTrue(node.says(f"waiting for roscore at http://127.0.0.1:{self.port}"), node.output())
            core = self.started(roscore(self.port))
            self.assertTrue(node.says(f"waiting for a simulator in domain {self.domain}"), node.output())
            robot = self.started(simulator(self.domain))
            self.assertTrue(eventually(lambda: "/odom" in self.topics()), node.output())
            self.assertTrue(self.flows(), node.output())

            robot.stop(signal.SIGKILL)
            self.assertTrue(node.says("the simulator has gone"), node.output())
            self.assertTrue(node.running())
            robot = self.started(simulator(self.domain))
            self.assertTrue(self.flows(), node.output())

            address = self.master.lookupNode("/test", "/belvedere")[2]
            core.stop(signal.SIGKILL)
            self.assertTrue(node.says("is gone; waiting for it"), node.output())
            core = self.started(roscore(self.port))
            # roscpp repeats a pending registration with the new master, which then lists the node.
            self.assertTrue(eventually(self.master_answers))
            self.master.registerPublisher("/belvedere", "/late", "std_msgs/String", address)
            self.assertTrue(eventually(lambda: "/odom" in self.topics()), node.output())
            self.assertTrue(self.flows(), node.output())

            node.stop(signal.SIGKILL)
            with bridge(self.domain) as successor:
                self.assertTrue(self.flows(), successor.output())

    def test_a_new_roscore_gets_all_registrations(self):
        """Parameters, topics and services are registered again, and connections continue. The parameters are where roslaunch puts
        them: on the server, and not on the command line."""
        core = self.started(roscore(self.port))
        self.assertTrue(eventually(self.master_answers))
        parameters = {"domain": self.domain, "transforms": "odometry", "laser": {"noise_stddev": 0.02}}
        self.master.setParam("/test", "/belvedere", parameters)
        with simulator(self.domain), Process(BRIDGE, BELVEDERE_DOMAIN="") as node:
            # The last of all registrations.
            topics, services = {"/odom", "/gazebo/link_states", "/gazebo/model_states"}, {"/belvedere/laser/set_parameters"}
            self.assertTrue(eventually(lambda: topics <= self.topics() and services <= self.registered()[2]), node.output())
            before = self.registered()
            self.assertIn("/gazebo/delete_model", before[2])
            turn = "rostopic", "pub", "-r", "10", "/cmd_vel", "geometry_msgs/Twist", "{angular: {z: 0.5}}"
            with Process("rostopic", "hz", "/odom") as hz, Process(*turn) as driver:
                measured = lambda: hz.output().count("average rate")  # noqa: E731
                self.assertTrue(eventually(lambda: measured() > 1 and self.turns(), 20.0), hz.output() + driver.output())
                core.stop(signal.SIGKILL)
                self.assertTrue(node.says("is gone; waiting for it"), node.output())
                core = self.started(roscore(self.port))
                self.assertTrue(node.says("registered with the new roscore"), node.output())
                self.assertEqual(self.registered(), before)
                self.assertEqual(self.master.getParam("/test", "/belvedere")[2], parameters)
                self.assertTrue(self.master.getParam("/test", "/use_sim_time")[2])
                now = measured()
                self.assertTrue(eventually(lambda: measured() > now + 2), hz.output())
                self.assertTrue(self.turns(), node.output())
            with self.subTest("programs that start now"):
                call = ["rosservice", "call", "/gazebo/get_world_properties"]
                done = subprocess.run(call, capture_output=True, text=True, timeout=20)
                self.assertIn("success: True", done.stdout + done.stderr)
                led = ["rostopic", "pub", "-1", "/mobile_base/commands/led1", "kobuki_msgs/Led", "value: 3"]
                subprocess.run(led, check=True, capture_output=True, timeout=20)
                self.assertTrue(node.says("led1 is set to red"), node.output())
            self.assertEqual(node.stop(), 0, node.output())
            self.assertEqual(self.registered(), (set(), set(), set()))

    def test_a_subscriber_survives_restarts(self):
        """The subscriber stays the same throughout; simulator and node are killed and restarted."""
        with roscore(self.port), simulator(self.domain) as robot, bridge(self.domain) as node:
            self.assertTrue(eventually(lambda: "/odom" in self.topics()), node.output())
            with Process("rostopic", "echo", "-p", "/odom/header/stamp") as echo:
                lines = lambda: echo.output().count("\n")  # noqa: E731
                self.assertTrue(eventually(lambda: lines() > 20, 20.0), echo.output())
                robot.stop(signal.SIGKILL)
                time.sleep(0.5)
                before = lines()
                with simulator(self.domain):
                    self.assertTrue(eventually(lambda: lines() > before + 20, 20.0), node.output())
                    node.stop(signal.SIGKILL)
                    before = lines()
                    with bridge(self.domain) as successor:
                        self.assertTrue(eventually(lambda: lines() > before + 20, 20.0), successor.output())

    def test_starts_and_stops(self):
        with roscore(self.port), simulator(self.domain):
            for cycle in range(CYCLES):
                with bridge(self.domain) as node:
                    self.assertTrue(eventually(lambda: "/odom" in self.topics()), node.output())
                    how = (signal.SIGINT, signal.SIGTERM)[cycle % 2]
                    self.assertEqual(node.stop(how), 0, node.output())
                    self.assertFalse(self.knows_node(), f"{how.name} left the node registered")
                    self.assertNotIn("/odom", self.topics())

    def test_it_ends_soon_with_many_subscriptions(self):
        """roslaunch kills nodes 15 s after SIGINT, which would stay registered. Each topic once took a second."""
        with roscore(self.port), simulator(self.domain, "--robot", "kobuki_hexagons_kinect"), bridge(self.domain) as node:
            self.assertTrue(eventually(lambda: "/camera/depth/points" in self.topics()), node.output())
            with tempfile.TemporaryDirectory() as folder, Process("rosbag", "record", "--all", "-O", f"{folder}/all.bag"):
                followed = lambda: sum(subscribers_of_streams(self.domain).values())  # noqa: E731
                self.assertTrue(eventually(lambda: followed() > 16, 30.0), node.output())
                self.assertEqual(node.stop(timeout=15.0), 0, node.output())
            self.assertFalse(self.knows_node())

    def test_it_ends_while_it_waits_for_roscore(self):
        with roscore(self.port) as core, bridge(self.domain) as node:
            self.assertTrue(node.says("waiting for a simulator"), node.output())
            core.stop(signal.SIGKILL)
            self.assertTrue(node.says("is gone; waiting for it"), node.output())
            with simulator(self.domain):
                self.assertTrue(node.says("Failed to contact master"), node.output())
                self.assertEqual(node.stop(), 0, node.output())

    def test_external_time_may_loop(self):
        """Topics and diagnostics continue while a bag's /clock jumps back repeatedly."""
        with tempfile.TemporaryDirectory() as folder, roscore(self.port), simulator(self.domain):
            bag = os.path.join(folder, "second.bag")
            with rosbag.Bag(bag, "w") as out:
                for tenth in range(11):
                    out.write("/tick", String("tick"), rospy.Time(100, tenth * 100_000_000))
            self.assertTrue(eventually(self.master_answers))
            self.master.setParam("/test", "/use_sim_time", True)
            with (
                Process("rosbag", "play", "--clock", "--loop", "--quiet", bag) as play,
                bridge(self.domain, "_publish_clock:=false") as node,
                Process("rostopic", "echo", "-p", "/odom/header/stamp") as odometry,
                Process("rostopic", "echo", "-p", "/diagnostics/header/stamp") as diagnostics,
            ):
                lines = lambda echo: echo.output().count("\n")  # noqa: E731
                self.assertTrue(eventually(lambda: lines(odometry) > 20, 20.0), odometry.output())
                before = lines(odometry), lines(diagnostics)
                time.sleep(5.0)  # about five loops, or fewer messages in them on a busy machine
                go_on = lambda: lines(odometry) > before[0] + 200 and lines(diagnostics) >= before[1] + 4  # noqa: E731
                self.assertTrue(eventually(go_on, 15.0), f"{lines(odometry)}, {lines(diagnostics)}, {before}: {node.output()}")
                self.assertTrue(play.running(), play.output())

    def test_a_slow_master_blocks_nothing(self):
        """Diagnostics continue while the node waits for the master to register topics; once this was a deadlock."""
        with roscore(self.port) as core, bridge(self.domain) as node:
            with simulator(self.domain):
                self.assertTrue(eventually(lambda: "/odom" in self.topics()), node.output())
            self.assertTrue(node.says("the simulator has gone"), node.output())
            # Diagnostics report topics now. Those of another robot appear while the master is stopped.
            with Process("rostopic", "echo", "-p", "/diagnostics/header/stamp") as echo:
                diagnostics = lambda: echo.output().count("\n")  # noqa: E731
                self.assertTrue(eventually(lambda: diagnostics() > 1), echo.output())
                core.child.send_signal(signal.SIGSTOP)
                try:
                    robot = self.started(simulator(self.domain, "--robot", "kobuki_hexagons_kinect"))
                    self.assertTrue(eventually(lambda: node.output().count("found a simulator") == 2), robot.output())
                    before = diagnostics()
                    self.assertTrue(eventually(lambda: diagnostics() > before + 2, 5.0), node.output())
                finally:
                    core.child.send_signal(signal.SIGCONT)
                self.assertTrue(eventually(lambda: "/camera/depth/points" in self.topics()), node.output())
            self.assertEqual(node.stop(), 0, node.output())

    def test_rosnode_sees_it_and_ends_it(self):
        with roscore(self.port), bridge(self.domain) as node:
            self.assertTrue(eventually(self.knows_node), node.output())
            ping = subprocess.run(["rosnode", "ping", "-c", "1", "/belvedere"], capture_output=True, text=True, timeout=20)
            self.assertIn("reply from", ping.stdout)
            info = subprocess.run(["rosnode", "info", "/belvedere"], capture_output=True, text=True, timeout=20)
            self.assertIn("/diagnostics [diagnostic_msgs/DiagnosticArray]", info.stdout)
            subprocess.run(["rosnode", "kill", "/belvedere"], check=True, capture_output=True, timeout=20)
            self.assertTrue(eventually(lambda: not node.running()), node.output())
            self.assertEqual(node.stop(), 0)

    def test_bad_parameters_are_named(self):
        with roscore(self.port):
            for argument, said in {
                "_transforms:=some": "/belvedere/transforms is some; it must be all, odometry or none",
                "_publish_clock:=7": "/belvedere/publish_clock is 7; it must be true or false",
                "_velocity_topics:=cmd_vel": "/belvedere/velocity_topics is cmd_vel; it must be a list of topics",
            }.items():
                with self.subTest(argument), bridge(self.domain, argument) as node:
                    self.assertTrue(node.says(said), node.output())
                    self.assertEqual(node.child.wait(10), 1)
                self.master.deleteParam("/test", "/belvedere/" + argument[1:].split(":=")[0])
            with self.subTest("a domain that cannot be one"), bridge("no/domain") as node:
                self.assertEqual(node.child.wait(10), 1)
                self.assertIn("no/domain", node.output())
            with self.subTest("one that there is not"), bridge(self.domain, "_domian:=lab") as node:
                self.assertTrue(node.says("/belvedere/domian is not a parameter of this node"), node.output())


if __name__ == "__main__":
    unittest.main(verbosity=2, warnings="ignore")  # rospy leaves sockets to the garbage collector
