#!/usr/bin/env python3
"""Settings of sensors through dynamic_reconfigure, as dynparam and rqt_reconfigure use it; rangefinders and lidars.

Needs a master at ROS_MASTER_URI.
"""

import functools
import math
import os
import subprocess
import unittest

import roslib.packages
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from dynamic_reconfigure.client import Client
from listener import Listener
from processes import SIMULATOR, bridge, eventually, simulator
from sensor_msgs import point_cloud2
from sensor_msgs.msg import CameraInfo, LaserScan, PointCloud2, Range

DOMAIN = f"settings-{os.getpid()}"
ROBOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../tests/rangefinders.urdf")


def told(client):
    return client.get_configuration(timeout=10)


def configure(domain, sensor, *words):
    subprocess.run([SIMULATOR, "control", "configure", sensor, *words, "--domain", domain], check=True, timeout=20)


def dynparam(*arguments):
    """Run `rosrun dynamic_reconfigure dynparam`."""
    program = roslib.packages.find_node("dynamic_reconfigure", "dynparam")[0]
    return subprocess.run(["/usr/bin/python3", program, *arguments], capture_output=True, text=True, timeout=20, check=False)


class Settings(unittest.TestCase):
    maxDiff = None

    def test_settings_are_served_and_changed(self):
        with simulator(DOMAIN) as running, bridge(DOMAIN) as node:
            laser, camera = Client("/belvedere/laser", timeout=20), Client("/belvedere/camera1", timeout=20)
            self.assertEqual(
                {key: value for key, value in told(camera).items() if key != "groups"},
                {"update_rate": 30.0, "noise_mean": 0.0, "noise_stddev": 0.007, "exposure": 1.0},
            )
            parameters = {parameter["name"]: parameter for parameter in laser.get_parameter_descriptions(timeout=10)}
            self.assertEqual(set(parameters), {"update_rate", "noise_mean", "noise_stddev"})
            rate, noise = parameters["update_rate"], parameters["noise_mean"]
            self.assertEqual((rate["type"], rate["min"], rate["max"], rate["default"]), ("double", 0.01, 1000.0, 5.5))
            self.assertEqual((noise["min"], noise["max"]), (-6.0, 6.0))

            with Listener("/scan", LaserScan) as scans, Listener("/camera_info", CameraInfo) as infos:
                self.assertEqual(laser.update_configuration({"update_rate": 20})["update_rate"], 20.0)
                self.assertTrue(eventually(lambda: abs((scans.period() or 0) - 0.05) < 1e-6))
                self.assertAlmostEqual(scans.last.scan_time, 0.05, 6)
                # A mean of −1 m shortens ranges by one metre.
                before = min(scans.last.ranges)
                laser.update_configuration({"noise_mean": -1.0, "noise_stddev": 0.0})
                self.assertTrue(eventually(lambda: abs(before - 1.0 - min(scans.last.ranges)) < 0.1))
                # Printed and set by the command line.
                self.assertIn("'noise_mean': -1.0", dynparam("get", "/belvedere/laser").stdout)
                self.assertEqual(dynparam("set", "/belvedere/camera1", "update_rate", "10").returncode, 0)
                self.assertTrue(eventually(lambda: abs((infos.period() or 0) - 0.1) < 1e-6))

                # A value beyond the limits is refused: the reply has the current values.
                held = laser.update_configuration({"update_rate": 5000.0, "noise_mean": 0.0})
                self.assertEqual((held["update_rate"], held["noise_mean"]), (20.0, -1.0))
                self.assertTrue(node.says("/belvedere/laser/set_parameters: update_rate is '5000'; it must be a number from"))

                # Diagnostics expect the new, slower rate.
                statuses = {}
                diagnostics = rospy.Subscriber(
                    "/diagnostics", DiagnosticArray, lambda array: statuses.update({status.name: status for status in array.status})
                )
                self.assertTrue(
                    eventually(
                        lambda: "belvedere: scan" in statuses
                        and {value.key: value.value for value in statuses["belvedere: scan"].values}["nominal rate (Hz)"] == "20.00"
                        and statuses["belvedere: scan"].level == 0
                    ),
                    statuses.get("belvedere: scan"),
                )
                diagnostics.unregister()

            # Other programs change it, too.
            configure(DOMAIN, "scan", "noise_mean=0.25")
            self.assertTrue(eventually(lambda: told(laser)["noise_mean"] == 0.25))
            self.assertEqual(running.stop(), 0)
            # Without a simulator, the reply has the last known values.
            self.assertEqual(laser.update_configuration({"noise_mean": 0.5})["noise_mean"], 0.25)
            self.assertTrue(node.says(f"no simulator answers in domain {DOMAIN}"))
            with simulator(DOMAIN, "--robot", "kobuki_hexagons_kinect"):
                # A simulator of another robot: its sensors replace the old ones.
                depth = Client("/belvedere/camera", timeout=20)
                self.assertEqual(told(depth)["update_rate"], 10.0)
                self.assertTrue(eventually(lambda: not rospy_service_exists("/belvedere/laser/set_parameters")))
                self.assertEqual(depth.update_configuration({"exposure": 2.5})["exposure"], 2.5)
                self.assertTrue(eventually(lambda: told(depth)["exposure"] == 2.5))

    def test_given_parameters_are_applied_to_each_simulator(self):
        domain = f"{DOMAIN}-given"
        rospy.set_param("/given/laser", {"update_rate": 8.0})
        rospy.set_param("/given/camera1", {"exposure": 1e6})
        with bridge(domain, "__name:=given") as node:
            for _ in range(2):
                with simulator(domain):
                    laser = Client("/given/laser", timeout=20)
                    self.assertTrue(eventually(lambda: told(laser)["update_rate"] == 8.0))  # noqa: B023
                    laser.close()
            self.assertTrue(node.says("parameters of /given/camera1: exposure is '1e+06'; it must be a number from 0.01 to 100"))


class Ranges(unittest.TestCase):
    """Rangefinders, a lidar of several layers, and the parameters of laser scanners."""

    def test_ranges_and_scans_in_ros(self):
        domain = f"{DOMAIN}-ranges"
        rospy.set_param("/ranges", {"frame_id": "laser", "time_offset": -0.001})
        rospy.set_param("/ranges/scan", {"angle_min": -0.5235988, "angle_max": 0.5235988, "publish_intensity": False})
        with simulator(domain, "--robot", ROBOT, "--world", "empty"), bridge(domain, "__name:=ranges") as node:
            first = functools.partial(rospy.wait_for_message, timeout=20)
            down = first("/sonar/down", Range)
            self.assertEqual((down.radiation_type, down.header.frame_id), (Range.ULTRASOUND, "sonar_link"))
            # The box must have settled on the ground.
            self.assertTrue(eventually(lambda: abs(first("/sonar/down", Range).range - 0.55) < 0.005))
            self.assertAlmostEqual(down.field_of_view, 0.2, 6)
            self.assertEqual(first("/infrared/short", Range).range, math.inf)
            self.assertEqual(first("/infrared/far", Range).range, -math.inf)

            # A little more than half a radian to either side in steps of a degree; the same stamps as before, less a
            # millisecond.
            scan = first("/scan", LaserScan)
            self.assertEqual((len(scan.ranges), len(scan.intensities)), (61, 0))
            self.assertAlmostEqual(scan.angle_min, math.radians(-30), 5)
            self.assertAlmostEqual(scan.angle_max, math.radians(30), 5)
            self.assertEqual((scan.header.frame_id, scan.header.stamp.to_nsec() % 100_000_000), ("laser", 99_000_000))

            cloud = first("/velodyne_points", PointCloud2)
            self.assertEqual((cloud.width, cloud.height, cloud.point_step, cloud.is_dense), (8, 4, 22, False))
            points = list(point_cloud2.read_points(cloud))
            self.assertEqual([field.name for field in cloud.fields], ["x", "y", "z", "intensity", "ring", "time"])
            # The two lower layers hit the ground a metre below; the others have no return.
            for x, y, z, _, ring, time in points:
                self.assertEqual(time, 0.0)
                if ring < 2:
                    self.assertAlmostEqual(z, -1.0, 2)
                    self.assertGreater(math.hypot(x, y), 1.0)
                else:
                    self.assertTrue(math.isnan(x))

            statuses = {}
            rospy.Subscriber(
                "/diagnostics", DiagnosticArray, lambda array: statuses.update({status.name: status for status in array.status})
            )
            self.assertTrue(eventually(lambda: "ranges: scan" in statuses))
            keys = {value.key: value.value for value in statuses["ranges: scan"].values}
            self.assertEqual((keys["User Time Offset"], keys["Device ID"]), ("-0.001 s", f"{domain}/scan"))
            self.assertNotIn("is not a parameter", node.output())

    def test_a_bad_parameter_is_named(self):
        rospy.set_param("/bad", {"angle_min": "left"})
        with bridge(f"{DOMAIN}-bad", "__name:=bad") as node:
            self.assertTrue(node.says("/bad/angle_min is left; it must be a number"))
            self.assertEqual(node.child.wait(10), 1)


def rospy_service_exists(name):
    return rospy.get_master().lookupService(name)[0] == 1


if __name__ == "__main__":
    rospy.init_node("test", anonymous=True, disable_signals=True)
    unittest.main(verbosity=2, warnings="ignore")
