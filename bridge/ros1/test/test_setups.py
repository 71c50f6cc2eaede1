#!/usr/bin/env python3
"""The articles' set-ups as seen by a ROS program: every topic, with its type, frame, rate, sizes and numbers.

Needs a master at ROS_MASTER_URI. BELVEDERE_ROS_SECONDS sets how long each set-up is recorded. `Described` and
`AsGazeboHasIt`, of a master each, can run at the same time.
"""

import operator
import os
import unittest

import rospy
from listener import Listener, published
from processes import bridge, eventually, simulator, subscribers_of_streams
from setups import SETUPS

SECONDS = float(os.environ.get("BELVEDERE_ROS_SECONDS", "20"))
DOMAIN = f"setups-{os.getpid()}"
RATE_TOLERANCE = 0.005
LOSS_TOLERANCE = 0.05  # image streams buffer two frames, 66 ms at 30 Hz, which a busy machine may exceed
NUMBER_TOLERANCE = 1e-5  # LaserScan is of float32


class Table:
    """Every topic of every set-up, in one mode."""

    maxDiff = None

    def test_every_set_up(self):
        for index, (name, make) in enumerate(SETUPS.items()):
            setup, domain = make(self.compat), f"{DOMAIN}-{index}"
            with self.subTest(name), simulator(domain, *self.arguments, **setup.environment), bridge(domain) as node:
                self.check_set_up(setup, domain, node)

    def check_set_up(self, setup, domain, node):
        # A latched topic is served like the others, but its message need not be repeated.
        self.assertTrue(eventually(lambda: setup.topics.keys() <= published()), node.output())
        idle = subscribers_of_streams(domain)
        self.assertEqual({topic for topic, count in idle.items() if count}, {"/clock"}, "read without subscribers")

        listeners = {topic: Listener(topic, expected.type) for topic, expected in setup.topics.items()}
        self.assertTrue(
            eventually(lambda: all(listeners[topic].count() > 0 for topic in setup.topics if not setup.topics[topic].is_event())),
            {topic: listener.count() for topic, listener in listeners.items()},
        )
        now = lambda: listeners["/clock"].last.clock.to_sec()  # noqa: E731
        begin = now()
        self.assertTrue(eventually(lambda: now() >= begin + SECONDS, 2 * SECONDS), "the simulator falls behind")
        for listener in listeners.values():
            listener.close()
        for topic, expected in setup.topics.items():
            with self.subTest(topic=topic):
                self.check_topic(listeners[topic], expected)

        relieved = lambda: not any(n for t, n in subscribers_of_streams(domain).items() if t != "/clock")  # noqa: E731
        self.assertTrue(eventually(relieved, 5.0), f"still read: {subscribers_of_streams(domain)}")

    def check_topic(self, listener, expected):
        stamps = listener.stamps_ns
        if expected.is_event():
            return self.assertEqual(stamps, [], "nothing has happened to it")
        if expected.rate > 0:
            self.assertGreater(stamps[0], 0)
            self.assertTrue(all(a < b for a, b in zip(stamps, stamps[1:])), "stamps do not rise")
            # By the stamps, since a busy machine may lose some messages.
            gaps = [round((b - a) * 1e-9 * expected.rate) for a, b in zip(stamps, stamps[1:])]
            rate = sum(gaps) * 1e9 / (stamps[-1] - stamps[0])
            self.assertAlmostEqual(rate, expected.rate, delta=RATE_TOLERANCE * expected.rate)
            self.assertGreater(stamps[-1] - stamps[0], (1 - LOSS_TOLERANCE) * SECONDS * 1e9, "it came late, or stopped")
            self.assertLessEqual(sum(gaps) - len(gaps), 1 + LOSS_TOLERANCE * len(gaps), "messages lost")
        else:
            self.assertEqual(len(stamps), 1, "a latched topic comes once")
        message = listener.last
        if expected.frame:
            self.assertEqual(message.header.frame_id, expected.frame)
        for name, value in expected.fields.items():
            self.check_field(name, operator.attrgetter(name)(message), value)
        if expected.length >= 0:
            payload = message.ranges if hasattr(message, "ranges") else message.data
            self.assertEqual(len(payload), expected.length)

    def check_field(self, name, is_there, value):
        if isinstance(value, float):
            self.assertAlmostEqual(is_there, value, delta=NUMBER_TOLERANCE, msg=name)
        elif isinstance(value, list) and value and not isinstance(value[0], str):
            self.assertEqual(len(is_there), len(value), name)
            for a, b in zip(is_there, value):
                self.assertAlmostEqual(a, b, delta=NUMBER_TOLERANCE, msg=name)
        else:
            self.assertEqual(is_there, value, name)


class Described(Table, unittest.TestCase):
    compat, arguments = False, ()


class AsGazeboHasIt(Table, unittest.TestCase):
    compat, arguments = True, ("--gazebo-compat",)


if __name__ == "__main__":
    rospy.init_node("belvedere_test", disable_signals=True)
    unittest.main(verbosity=2, warnings="ignore")  # rospy leaves sockets to the garbage collector
