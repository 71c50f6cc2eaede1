"""Subscribers for tests."""

import collections
import threading

import rosgraph
import roslib.message
import rospy


class Listener:
    """A subscriber to a topic that keeps the stamps of all messages, and the last `most` of them (None: all)."""

    def __init__(self, topic, kind, most=1):
        self.lock, self.stamps_ns, self.messages = threading.Lock(), [], collections.deque(maxlen=most)
        message_class = roslib.message.get_message_class(kind) if isinstance(kind, str) else kind
        self.subscriber = rospy.Subscriber(topic, message_class, self.receive, buff_size=1 << 25, tcp_nodelay=True)

    def receive(self, message):
        with self.lock:
            self.stamps_ns.append(stamp_of(message).to_nsec())
            self.messages.append(message)

    def count(self):
        with self.lock:
            return len(self.stamps_ns)

    @property
    def last(self):
        with self.lock:
            return self.messages[-1] if self.messages else None

    def all(self):
        with self.lock:
            return list(self.messages)

    def period(self, count=4):
        """Return the period of the last stamps in seconds, if it is constant."""
        with self.lock:
            last = self.stamps_ns[-count:]
        periods = [after - before for before, after in zip(last, last[1:])]
        return periods[0] * 1e-9 if len(last) == count and max(periods) - min(periods) < 1000 else None

    def connected(self):
        return self.subscriber.get_num_connections() > 0

    def close(self):
        self.subscriber.unregister()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def stamp_of(message):
    """Return the stamp of a message; 0 if it has none."""
    if hasattr(message, "header"):
        return message.header.stamp
    if hasattr(message, "clock"):
        return message.clock
    if hasattr(message, "transforms"):
        return message.transforms[0].header.stamp
    return rospy.Time()


def published():
    """Return the topics that have a publisher now."""
    return {topic for topic, _ in rosgraph.Master("/test").getSystemState()[0]}
