#!/usr/bin/env python3
"""The TurtleBot's launch file as in the tutorials, and scans that tf can place, as mapping and navigation require.
Needs a master at ROS_MASTER_URI."""

import math
import os
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import rosgraph
import rosnode
import rospy
import tf2_ros
from gazebo_msgs.srv import GetModelState
from geometry_msgs.msg import Twist
from listener import Listener
from nav_msgs.msg import Odometry
from processes import Process, bridge, eventually, simulator, subscribers_of_streams
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String

DOMAIN = f"turtlebot-{os.getpid()}"
#: A world like those of turtlebot_gazebo, with a mesh from Gazebo's model database that is missing here.
THEIRS = """<sdf version="1.4"><world name="default"><model name="dumpster"><link name="link"><visual name="v"><geometry><mesh>
<uri>model://dumpster/meshes/dumpster.dae</uri></mesh></geometry></visual></link></model></world></sdf>"""
#: The robot's pose in front of the bookshelf of the playground, whose back begins at y = 1.72 m.
POSE = "-x 0.05 -y 0.0 -Y 1.5707963"
BACK_Y, KINECT_X = 1.72, -0.087
#: Inner walls of a test room, in metres.
ROOM = {"x": (-2.0, 3.0), "y": (-2.5, 1.5)}
WALLS = [("w", -2.05, -0.5, 0.1, 4.2), ("e", 3.05, -0.5, 0.1, 4.2), ("s", 0.5, -2.55, 5.2, 0.1), ("n", 0.5, 1.55, 5.2, 0.1)]
STARTS = {"robot1": (-1.0, 0.0, 30.0), "robot2": (1.5, -1.0, -60.0)}
SCAN_NOISE_M = 0.01  # noise of the RPLidar
MAP_TOLERANCE_M = 0.03  # for the mean distance of a scan's points from the walls


def room():
    walls = "".join(
        f"""<model name="{name}"><static>true</static><pose>{x} {y} 0.5 0 0 0</pose><link name="link"><collision name="c"><geometry>
        <box><size>{dx} {dy} 1</size></box></geometry></collision></link></model>"""
        for name, x, y, dx, dy in WALLS
    )
    return f"""<sdf version="1.6"><world name="room"><include><uri>model://ground_plane</uri></include>{walls}</world></sdf>"""


def drive(topic, forward=0.0, turn=0.0):
    """Start a publisher that repeats a command at 10 Hz, as keyboards and planners do, until it is shut down."""
    publisher = rospy.Publisher(topic, Twist, queue_size=1)
    assert eventually(lambda: publisher.get_num_connections() > 0, 20), f"{topic} has no subscriber"
    twist = Twist()
    twist.linear.x, twist.angular.z = forward, turn
    return rospy.Timer(rospy.Duration(0.1), lambda _: publisher.publish(twist)), publisher


def yaw_of(q):
    return math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))


class World(unittest.TestCase):
    """turtlebot_world.launch with only the arguments that the tutorials use."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        worlds = Path(cls.folder.name) / "turtlebot_gazebo" / "worlds"
        worlds.mkdir(parents=True)
        (worlds.parent / "package.xml").write_text("<package><name>turtlebot_gazebo</name></package>")
        (worlds / "playground.world").write_text(THEIRS)
        environment = {
            "ROS_PACKAGE_PATH": f"{cls.folder.name}:{os.environ['ROS_PACKAGE_PATH']}",
            "BELVEDERE_DOMAIN": DOMAIN,
            "ROBOT_INITIAL_POSE": POSE,
        }
        arguments = "gui:=false", "world_file:=playground"
        cls.launch = Process("roslaunch", "belvedere_ros", "turtlebot_world.launch", *arguments, **environment)
        cls.odometry = Listener("odom", Odometry)
        assert eventually(lambda: cls.odometry.last is not None, 30), cls.launch.output()

    @classmethod
    def tearDownClass(cls):
        cls.odometry.close()
        cls.launch.stop()
        cls.folder.cleanup()

    def test_a_the_nodes_of_the_tutorials(self):
        wanted = {f"/{name}" for name in ("mobile_base_nodelet_manager", "cmd_vel_mux", "robot_state_publisher")}
        wanted |= {"/laserscan_nodelet_manager", "/depthimage_to_laserscan"}
        self.assertTrue(eventually(lambda: wanted <= set(rosnode.get_node_names())), rosnode.get_node_names())
        rospy.wait_for_service("/gazebo/get_model_state", 20)
        state = rospy.ServiceProxy("/gazebo/get_model_state", GetModelState)("mobile_base", "")
        place = state.pose.position
        self.assertTrue(state.success, state.status_message)
        self.assertAlmostEqual(place.x, 0.05, delta=0.01)
        self.assertAlmostEqual(place.y, 0.0, delta=0.01)
        self.assertAlmostEqual(yaw_of(state.pose.orientation), math.pi / 2, delta=0.01)
        self.assertIn("our own world of its name is used instead", self.launch.output())

    def test_b_the_fake_laser(self):
        subscribers = lambda: subscribers_of_streams(DOMAIN)["/camera/depth/image_raw"]  # noqa: E731
        self.assertEqual(subscribers(), 0, "the scan has no subscribers")
        with Listener("/scan", LaserScan) as scans:
            self.assertTrue(eventually(lambda: scans.count() > 5, 20), self.launch.output())
            scan, period = scans.last, scans.period()
        self.assertEqual(scan.header.frame_id, "camera_depth_frame")
        self.assertEqual((len(scan.ranges), scan.range_min), (640, 0.44999998807907104))
        self.assertAlmostEqual(scan.angle_max, math.radians(30), delta=0.01)
        self.assertTrue(period is None or abs(period - 0.1) < 1e-3, period)
        # The back of the shelf is straight ahead.
        ahead = [range_ * math.cos(scan.angle_min + i * scan.angle_increment) for i, range_ in enumerate(scan.ranges)][250:390]
        self.assertLess(max(abs(x - (BACK_Y - KINECT_X)) for x in ahead), 0.02, ahead)
        self.assertTrue(eventually(lambda: subscribers() == 0), "rendered without subscribers")

    def test_c_the_active_source_moves_it(self):
        velocity = lambda: self.odometry.last.twist.twist.linear.x  # noqa: E731
        with Listener("cmd_vel_mux/active", String, most=None) as active:
            self.assertTrue(eventually(lambda: [m.data for m in active.all()] == ["idle"]), active.all())
            navigation, _navi = drive("cmd_vel_mux/input/navi", forward=-0.1)
            self.assertTrue(eventually(lambda: velocity() < -0.08), velocity())
            keyboard, _teleop = drive("cmd_vel_mux/input/teleop", forward=0.2)
            self.assertTrue(eventually(lambda: velocity() > 0.18), "the tutorial's robot does not move")
            for _ in range(20):
                self.assertGreater(velocity(), 0.15, "of lower priority")
                time.sleep(0.05)
            keyboard.shutdown()
            self.assertTrue(eventually(lambda: velocity() < -0.08), "the silent one is heard for ever")
            navigation.shutdown()
            self.assertTrue(eventually(lambda: active.last.data == "idle"), active.all())
            # Between the keyboard's last command and the next one of navigation, no source may be active.
            self.assertEqual([m.data for m in active.all() if m.data != "idle"], ["navi", "teleop", "navi"])
        self.assertTrue(eventually(lambda: velocity() == 0.0), "the base forgets commands that are not repeated")


class TwoThatMap(unittest.TestCase):
    """Two robots and one bridge. Like slam_gmapping, places each scan by tf at its stamp, in the robot's own odom."""

    def test_each_draws_the_room_by_its_own_frames(self):
        with tempfile.NamedTemporaryFile("w", suffix=".world") as world:
            world.write(room())
            world.flush()
            robots = [word for name in STARTS for word in ("--robot", "kobuki_nostack_rplidar", "--name", name)]
            poses = [word for x, y, yaw in STARTS.values() for word in ("--pose", f"{x},{y},{yaw}")]
            with simulator(DOMAIN, "--world", world.name, *robots, *poses), bridge(DOMAIN) as node:
                self.map(node)

    def map(self, node):
        buffer = tf2_ros.Buffer(rospy.Duration(30))
        listener = tf2_ros.TransformListener(buffer)
        scans = {name: Listener(f"/{name}/scan", LaserScan, most=None) for name in STARTS}
        self.assertTrue(eventually(lambda: all(scan.count() > 0 for scan in scans.values()), 20), node.output())
        turning = [drive(f"/{name}/mobile_base/commands/velocity", 0.1, turn) for name, turn in zip(STARTS, (0.8, -0.6))]
        time.sleep(5)
        for timer, _ in turning:
            timer.shutdown()
        time.sleep(0.5)
        for name, start in STARTS.items():
            errors, turned = [], set()
            for scan in scans[name].all()[:-2]:
                self.assertEqual(scan.header.frame_id, f"{name}/base_laser_link")
                try:
                    place = buffer.lookup_transform(f"{name}/odom", scan.header.frame_id, scan.header.stamp).transform
                except tf2_ros.ExtrapolationException:
                    self.assertEqual(turned, set(), "tf was there before, and is not now")
                    continue
                turned.add(round(yaw_of(place.rotation), 1))
                errors.append(self.off_the_walls(scan, place, start))
            print(f"{name}: {len(errors)} scans, {1000 * sum(errors) / len(errors):.1f} mm off the walls, {1000 * max(errors):.1f} at most")
            self.assertGreater(len(errors), 20)
            self.assertGreater(len(turned), 10, "it has hardly turned")
            self.assertLess(max(errors), MAP_TOLERANCE_M)
            scans[name].close()
        listener.unregister()

    def off_the_walls(self, scan, place, start):
        """Return the mean distance of a scan's points from the nearest wall, without those on the other robot."""
        x0, y0, yaw0 = start[0], start[1], math.radians(start[2])
        yaw, offs = yaw_of(place.rotation), []
        for i, range_ in enumerate(scan.ranges):
            if not math.isfinite(range_):
                continue
            angle = yaw + scan.angle_min + i * scan.angle_increment
            x, y = place.translation.x + range_ * math.cos(angle), place.translation.y + range_ * math.sin(angle)
            x, y = x0 + x * math.cos(yaw0) - y * math.sin(yaw0), y0 + x * math.sin(yaw0) + y * math.cos(yaw0)
            off = min(*(abs(x - wall) for wall in ROOM["x"]), *(abs(y - wall) for wall in ROOM["y"]))
            if off < 0.3:
                offs.append(off)
        self.assertGreater(len(offs), 300, "walls are all around")
        return sum(offs) / len(offs)


if __name__ == "__main__":
    rospy.init_node("belvedere_test", disable_signals=True)
    assert rosgraph.is_master_online()
    unittest.main(verbosity=2, warnings="ignore")
