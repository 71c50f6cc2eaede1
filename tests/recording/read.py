"""Reads recordings as others do: every message decodes, bears the sum of its type in Noetic, and agrees with its frame."""

import math
import struct
import sys

from mcap.reader import make_reader
from mcap_ros1._vendor.genpy.dynamic import generate_dynamic
from mcap_ros1.decoder import DecoderFactory

# What rosmsg md5 prints in Noetic.
SUMS = {
    "sensor_msgs/Image": "060021388200f6f0f447d0fcd9c64743",
    "sensor_msgs/CameraInfo": "c9a58c1b0b154e0e6da7578cb991d214",
    "sensor_msgs/LaserScan": "90c7ef2dc6895d81024acba2ac42f369",
    "sensor_msgs/PointCloud2": "1158d486dd51d683ce2f1be655c3c181",
    "sensor_msgs/JointState": "3066dcd76a6cfaef579bd0f34173e9fd",
    "sensor_msgs/Imu": "6a62c6daae103f4ff57a132d6f95cec2",
    "sensor_msgs/Range": "c005c34273dc426c67a020a87bc24148",
    "nav_msgs/Odometry": "cd5e73d190d741a2f92e81eda573aca7",
    "tf2_msgs/TFMessage": "94810edda583a504dfda3829e70d7eec",
    "rosgraph_msgs/Clock": "a9c97c1d230cfc112e270351a944ee47",
    "geometry_msgs/Twist": "9f195f881246fdfa2798d1d3eebca84a",
    "gazebo_msgs/ModelStates": "48c080191eb15c41858319b4d8a609c2",
    "gazebo_msgs/LinkStates": "48c080191eb15c41858319b4d8a609c2",
    "kobuki_msgs/SensorState": "430a4bfd78449c8740bfef32b26613a6",
}


def check_file(path: str) -> set[str]:
    """Reads one file; gives the types that it has messages of."""
    seen: dict[str, int] = {}
    frames = 0
    last = {}
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros1"
        for schema, channel, message, decoded in reader.iter_decoded_messages():
            if schema.name == "belvedere/Frame":
                frames += 1
                assert len(decoded.header) == 384 and bytes(decoded.header[:4]) == b"BLVD"
                stamp = struct.unpack_from("<Q", decoded.header, 32)[0]
                length = struct.unpack_from("<Q", decoded.header, 64)[0]
                assert message.publish_time == stamp
                topic = channel.topic.removeprefix("/belvedere/frames")
                if length and not decoded.payload:
                    whole = last[topic]
                    assert len(whole.data) >= decoded.payload_offset + length, topic
                else:
                    assert len(decoded.payload) == length, topic
                continue
            seen[schema.name] = seen.get(schema.name, 0) + 1
            last[channel.topic] = message
            if seen[schema.name] == 1:
                types = generate_dynamic(schema.name, schema.data.decode())
                if schema.name in SUMS:
                    assert types[schema.name]._md5sum == SUMS[schema.name], schema.name
            check_message(schema.name, decoded)
        statistics = reader.get_summary().statistics
        assert statistics.message_count == frames + sum(seen.values())
        names = {record.name for record in reader.iter_metadata()}
        assert {"belvedere", "belvedere.stream", "belvedere.hashes"} <= names, names
    print(f"{path}: {frames} frames, {seen}")
    return set(seen)


def check_message(name: str, message) -> None:
    """What must hold of any message of a type."""
    if name == "sensor_msgs/Image":
        assert len(message.data) == message.step * message.height and message.width > 0
        assert any(message.data)
    elif name == "sensor_msgs/LaserScan":
        beams = round((message.angle_max - message.angle_min) / message.angle_increment) + 1
        assert len(message.ranges) == beams
        assert any(math.isfinite(value) and value > message.range_min for value in message.ranges)
    elif name == "sensor_msgs/PointCloud2":
        assert len(message.data) == message.row_step * message.height
        assert [field.name for field in message.fields][:3] == ["x", "y", "z"]
    elif name in ("nav_msgs/Odometry", "sensor_msgs/Imu"):
        turn = message.pose.pose.orientation if name == "nav_msgs/Odometry" else message.orientation
        assert abs(turn.x**2 + turn.y**2 + turn.z**2 + turn.w**2 - 1) < 1e-6
    elif name == "tf2_msgs/TFMessage":
        assert all(each.child_frame_id and each.header.frame_id for each in message.transforms)


if __name__ == "__main__":
    kinds = set().union(*(check_file(path) for path in sys.argv[1:]))
    wanted = set(SUMS) - {"geometry_msgs/Twist"}
    assert wanted <= kinds, f"no message of {sorted(wanted - kinds)}"
