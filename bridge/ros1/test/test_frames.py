#!/usr/bin/env python3
"""Frames that nodelets receive without a copy: inside one program, and in an example's nodelet. Needs a master at ROS_MASTER_URI,
the program of test_frames.cpp in BELVEDERE_ROS_TEST_FRAMES, and examples/ros1/brightness installed."""

import os
import subprocess
import threading
import unittest

import roslib.packages
import rospy
from processes import Process, eventually, simulator, subscribers_of_streams
from sensor_msgs.msg import Image
from std_msgs.msg import Float64

DOMAIN = f"frames-{os.getpid()}"


class Frames(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.simulator = simulator(DOMAIN)

    @classmethod
    def tearDownClass(cls):
        cls.simulator.stop()

    def test_inside_one_program(self):
        program = os.environ["BELVEDERE_ROS_TEST_FRAMES"]
        done = subprocess.run(
            [program], env={**os.environ, "BELVEDERE_DOMAIN": DOMAIN}, capture_output=True, text=True, timeout=120, check=False
        )
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_in_a_nodelet(self):
        nodelet = roslib.packages.find_node("nodelet", "nodelet")[0]
        means, arrived = [], threading.Event()

        def receive(mean):
            means.append(mean.data)
            if len(means) > 5:
                arrived.set()

        subscriber = rospy.Subscriber("/eyes/brightness", Float64, receive)
        with Process(nodelet, "manager", "__name:=manager") as manager:
            # The consumer starts first, with topic names that differ from the streams'.
            look = Process(nodelet, "load", "brightness/brightness", "/manager", "__ns:=/eyes", "image_raw:=left/picture")
            names = "__ns:=/eyes", "__name:=bridge", f"_domain:={DOMAIN}", "_publish_clock:=false", "image_raw:=left/picture"
            with look, Process(nodelet, "load", "belvedere_ros/bridge", "/manager", *names):
                self.assertTrue(arrived.wait(20), manager.output() + look.output())
                # The only subscriber is the nodelet, not the message's relay.
                self.assertEqual(subscribers_of_streams(DOMAIN)["/image_raw"], 1)
                picture = rospy.wait_for_message("/eyes/left/picture", Image, 10).data
                self.assertAlmostEqual(means[-1], sum(picture) / len(picture), delta=0.2)
                look.stop()
                self.assertTrue(eventually(lambda: subscribers_of_streams(DOMAIN)["/image_raw"] == 0), manager.output())
            self.assertTrue(manager.running(), manager.output())
        subscriber.unregister()


if __name__ == "__main__":
    rospy.init_node("belvedere_test", disable_signals=True)
    unittest.main(verbosity=2, warnings="ignore")
