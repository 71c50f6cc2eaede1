#!/usr/bin/env python3
"""The base with the interface of a Kobuki's driver: bumpers, cliffs, wheels, core sensors, motors and odometry. Needs a master at
ROS_MASTER_URI."""

import math
import os
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import rospy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Twist
from kobuki_msgs.msg import (
    BumperEvent,
    ButtonEvent,
    CliffEvent,
    DigitalOutput,
    ExternalPower,
    Led,
    MotorPower,
    SensorState,
    Sound,
    WheelDropEvent,
)
from listener import Listener
from nav_msgs.msg import Odometry
from processes import SIMULATOR, bridge, eventually, simulator, subscribers_of_streams
from std_msgs.msg import Empty

WANDER = Path(__file__).resolve().parents[3] / "examples" / "ros1" / "wander.py"
DOMAIN = f"kobuki-{os.getpid()}"
ROBOT = "turtlebot"
#: Resolution of a Kobuki's encoders.
TICKS_PER_METRE = 11724.41658
WALL = """<sdf version="1.6"><model name="wall"><static>true</static><link name="link"><collision name="c"><geometry>
    <box><size>0.1 2 1</size></box></geometry></collision></link></model></sdf>"""


def publisher(topic, kind):
    """Return a connected publisher."""
    publisher = rospy.Publisher(topic, kind, queue_size=1)
    assert eventually(lambda: publisher.get_num_connections() > 0), topic
    return publisher


class Kobuki(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.simulator, cls.node = simulator(DOMAIN, "--world", "empty"), bridge(DOMAIN)
        cls.velocity = publisher("mobile_base/commands/velocity", Twist)
        cls.odometry = Listener("odom", Odometry)
        assert eventually(lambda: cls.odometry.last is not None), cls.node.output()

    @classmethod
    def tearDownClass(cls):
        cls.odometry.close()
        cls.node.stop()
        cls.simulator.stop()

    @classmethod
    def control(cls, *arguments):
        command = [SIMULATOR, "control", *arguments, "--domain", DOMAIN]
        done = subprocess.run(command, capture_output=True, text=True, timeout=20, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    def drive_until(self, condition, forward=0.2, timeout=10.0, turn=0.0):
        """Send a velocity repeatedly; return whether the condition became true in time."""
        twist = Twist()
        twist.linear.x, twist.angular.z = forward, turn
        end = time.monotonic() + timeout
        while time.monotonic() < end and not condition():
            self.velocity.publish(twist)
            time.sleep(0.05)
        return condition()

    def stand(self):
        self.velocity.publish(Twist())
        self.assertTrue(eventually(lambda: abs(self.odometry.last.twist.twist.linear.x) < 1e-3))

    def x(self):
        return self.odometry.last.pose.pose.position.x

    def test_a_wall_presses_the_bumper(self):
        core, events = Listener("mobile_base/sensors/core", SensorState), Listener("mobile_base/events/bumper", BumperEvent, most=None)
        with core, events, tempfile.NamedTemporaryFile("w", suffix=".sdf") as wall:
            wall.write(WALL)
            wall.flush()
            self.assertTrue(eventually(lambda: core.last is not None and events.connected()))
            # The relay must have subscribed before the event.
            self.assertTrue(eventually(lambda: subscribers_of_streams(DOMAIN)["/mobile_base/events/bumper"] == 1))
            self.control("spawn", wall.name, "--pose", "0.5,0,0.5", "--relative-to", ROBOT)
            try:
                self.assertTrue(self.drive_until(lambda: events.all()), "nothing was pressed")
                self.assertTrue(eventually(lambda: core.last.bumper == SensorState.BUMPER_CENTRE), core.last)
                self.assertTrue(self.drive_until(lambda: len(events.all()) > 1, forward=-0.2), "it is pressed for ever")
                self.assertTrue(eventually(lambda: core.last.bumper == 0), core.last)
            finally:
                self.stand()
                self.control("delete", "wall")
            told = [(event.bumper, event.state) for event in events.all()]
            self.assertEqual(told[0], (BumperEvent.CENTER, BumperEvent.PRESSED))
            self.assertEqual(told[-1], (BumperEvent.CENTER, BumperEvent.RELEASED))
        with Listener("mobile_base/events/bumper", BumperEvent, most=None) as late:
            self.assertTrue(eventually(lambda: subscribers_of_streams(DOMAIN)["/mobile_base/events/bumper"] == 1))
            time.sleep(0.5)
            self.assertEqual(late.all(), [], "what happened before is no event")

    def test_wandering(self):
        """Run the example in front of a wall."""
        with tempfile.NamedTemporaryFile("w", suffix=".sdf") as wall:
            wall.write(WALL)
            wall.flush()
            self.control("move", ROBOT, "0,0")
            self.control("spawn", wall.name, "--pose", "0.45,0,0.5")
            try:
                done = subprocess.run([WANDER, "4"], capture_output=True, text=True, timeout=30, check=False)
            finally:
                self.control("delete", "wall")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("bumped ahead\n", done.stdout)

    def test_simultaneous_events_have_a_message_each(self):
        """In the air, all cliff sensors lose the floor and both wheels drop in one report; on the ground they recover."""
        topics = {"cliff": CliffEvent, "wheel_drop": WheelDropEvent}
        listeners = {name: Listener(f"mobile_base/events/{name}", kind, most=None) for name, kind in topics.items()}
        with listeners["cliff"] as cliffs, listeners["wheel_drop"] as wheels:
            following = lambda: all(subscribers_of_streams(DOMAIN)[f"/mobile_base/events/{name}"] == 1 for name in topics)  # noqa: E731
            self.assertTrue(eventually(following))
            self.control("move", ROBOT, "0,0,0.5,0")
            self.assertTrue(eventually(lambda: len(cliffs.all()) >= 6 and len(wheels.all()) >= 4), (cliffs.all(), wheels.all()))
        lost, found = cliffs.all()[:3], cliffs.all()[-3:]
        self.assertEqual({(e.sensor, e.state) for e in lost}, {(sensor, CliffEvent.CLIFF) for sensor in (0, 1, 2)})
        self.assertEqual({(e.sensor, e.state) for e in found}, {(sensor, CliffEvent.FLOOR) for sensor in (0, 1, 2)})
        self.assertTrue(all(a.bottom < b.bottom for a in lost for b in found), "the farther, the smaller")
        both = {WheelDropEvent.LEFT, WheelDropEvent.RIGHT}
        self.assertEqual({(e.wheel, e.state) for e in wheels.all()[:2]}, {(wheel, WheelDropEvent.DROPPED) for wheel in both})
        self.assertEqual({(e.wheel, e.state) for e in wheels.all()[-2:]}, {(wheel, WheelDropEvent.RAISED) for wheel in both})

    def test_the_core_sensors(self):
        with Listener("mobile_base/sensors/core", SensorState) as core:
            self.assertTrue(eventually(lambda: core.last is not None))
            self.stand()
            time.sleep(0.1)
            before, x = core.last, self.x()
            self.assertTrue(self.drive_until(lambda: self.x() > x + 0.3))
            self.stand()
            time.sleep(0.1)
            after, way = core.last, self.x() - x
        # By the stamps, since a busy machine may lose some messages.
        stamps = core.stamps_ns
        gaps = {b - a for a, b in zip(stamps, stamps[1:])}
        self.assertEqual(min(gaps), 20_000_000, "50 Hz")
        self.assertGreater(len(stamps), 0.9 * ((stamps[-1] - stamps[0]) / 20e6 + 1))
        for side in ("left_encoder", "right_encoder"):
            ticks = (getattr(after, side) - getattr(before, side)) % 65536
            self.assertAlmostEqual(ticks / TICKS_PER_METRE, way, delta=0.01 * way + 0.002, msg=side)
        self.assertEqual(after.time_stamp, after.header.stamp.to_nsec() // 1_000_000 % 65536)
        self.assertEqual((after.battery, after.charger, after.buttons), (165, SensorState.DISCHARGING, 0))
        self.assertEqual((len(after.bottom), len(after.current), len(after.analog_input)), (3, 2, 4))

    def test_commands_of_lamps_and_sounds_are_reported(self):
        """Accessories are not simulated: diagnostics report the last command of each."""
        commands = {
            "led1": (Led(Led.GREEN), ("led1", "green")),
            "led2": (Led(Led.RED), ("led2", "red")),
            "sound": (Sound(Sound.CLEANINGSTART), ("sound", "cleaning start")),
            "digital_output": (DigitalOutput([True] * 4, [False, False, True, False]), ("digital_output 2", "on")),
            "external_power": (ExternalPower(ExternalPower.PWR_5V1A, ExternalPower.OFF), ("external_power 5 V 1 A", "off")),
        }
        for topic, (message, _) in commands.items():
            publisher(f"mobile_base/commands/{topic}", type(message)).publish(message)
        told = {}

        def keep(array):
            for status in array.status:
                if status.name.endswith(": mobile_base"):
                    told.update((pair.key, pair.value) for pair in status.values)

        expected = dict(words for _, words in commands.values())
        listener = rospy.Subscriber("/diagnostics", DiagnosticArray, keep)
        self.assertTrue(eventually(lambda: told == expected), told)
        listener.unregister()
        with Listener("mobile_base/events/button", ButtonEvent, most=None) as buttons:
            self.assertTrue(eventually(buttons.connected), "button events are advertised, as by the driver")
            self.assertEqual(buttons.all(), [])

    def test_odometry_is_reset(self):
        for topic in ("commands/reset_odometry", "mobile_base/commands/reset_odometry"):
            with self.subTest(topic):
                self.assertTrue(self.drive_until(lambda: abs(self.x()) > 0.2, turn=0.3))
                self.stand()
                publisher(topic, Empty).publish(Empty())
                pose = lambda: self.odometry.last.pose.pose  # noqa: E731
                self.assertTrue(eventually(lambda: math.hypot(pose().position.x, pose().position.y) < 1e-3), pose())
                self.assertAlmostEqual(pose().orientation.z, 0.0, delta=1e-3)

    def test_without_power_it_stands(self):
        speed = lambda: self.odometry.last.twist.twist.linear.x  # noqa: E731
        for topic in ("commands/motor_power", "mobile_base/commands/motor_power"):
            with self.subTest(topic):
                power = publisher(topic, MotorPower)
                self.assertTrue(self.drive_until(lambda: speed() > 0.15))
                power.publish(MotorPower(MotorPower.OFF))
                self.assertTrue(self.drive_until(lambda: speed() == 0.0))
                self.assertFalse(self.drive_until(lambda: speed() != 0.0, timeout=1.0), "it moves without power")
                power.publish(MotorPower(7))
                self.assertTrue(self.node.says("a state of 7, neither on nor off, is ignored"), self.node.output())
                self.assertFalse(self.drive_until(lambda: speed() != 0.0, timeout=0.5), "7 is not on")
                power.publish(MotorPower(MotorPower.ON))
                self.assertTrue(self.drive_until(lambda: speed() > 0.15))
                self.stand()


if __name__ == "__main__":
    rospy.init_node("belvedere_test", disable_signals=True)
    unittest.main(verbosity=2, warnings="ignore")  # rospy leaves sockets to the garbage collector
