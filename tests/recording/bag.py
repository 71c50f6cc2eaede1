"""Checks that a bag converted from a recording has all its messages: bag.py run.bag run.mcap."""

import sys

from mcap.reader import make_reader
from rosbags.rosbag1 import Reader

with Reader(sys.argv[1]) as bag, open(sys.argv[2], "rb") as file:
    found = [(connection.topic, time, data) for connection, time, data in bag.messages()]
    wanted = [
        (channel.topic, message.log_time, message.data)
        for _, channel, message in make_reader(file).iter_messages()
    ]
assert sorted(found) == sorted(wanted), f"{len(found)} of {len(wanted)}"
print(f"{len(found)} messages are the same")
