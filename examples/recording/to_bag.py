#!/usr/bin/env python3
"""Convert a recording to a rosbag 1 file: to_bag.py run.mcap run.bag (pip install mcap rosbags)."""

import sys

from mcap.reader import make_reader
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore


def convert(source: str, target: str) -> int:
    """Copy every ROS message unchanged; return the number of messages."""
    store = get_typestore(Stores.EMPTY)
    connections = {}
    count = 0
    with open(source, "rb") as file:
        profile = make_reader(file).get_header().profile
    if profile != "ros1":
        sys.exit(f"{source}: its profile is {profile}; a bag of ROS 1 needs a recording with --profile ros1")
    with open(source, "rb") as file, Writer(target) as bag:
        for schema, channel, message in make_reader(file).iter_messages():
            if channel.message_encoding != "ros1" or schema is None:
                continue
            if channel.id not in connections:
                package, name = schema.name.split("/")
                msgtype = f"{package}/msg/{name}"
                store.register(get_types_from_msg(schema.data.decode(), msgtype))
                connections[channel.id] = bag.add_connection(
                    channel.topic,
                    msgtype,
                    typestore=store,
                    callerid=channel.metadata["callerid"],
                    latching=int(channel.metadata["latching"] == "true"),
                )
            bag.write(connections[channel.id], message.log_time, message.data)
            count += 1
    return count


if __name__ == "__main__":
    print(f"{convert(sys.argv[1], sys.argv[2])} messages")
