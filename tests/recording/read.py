"""Reads recordings with independent readers: every message decodes, has its type's MD5 sum, and agrees with its frame."""

import math
import struct
import sys

from mcap.reader import make_reader
from mcap_ros1._vendor.genpy.dynamic import generate_dynamic
from mcap_ros1.decoder import DecoderFactory

# The output of rosmsg md5 in Noetic.
SUMS = {
    "sensor_msgs/Image": "060021388200f6f0f447d0fcd9c64743",
    "sensor_msgs/CameraInfo": "c9a58c1b0b154e0e6da7578cb991d214",
    "sensor_msgs/LaserScan": "90c7ef2dc6895d81024acba2ac42f369",
    "sensor_msgs/PointCloud2": "1158d486dd51d683ce2f1be655c3c181",
    "sensor_msgs/JointState": "3066dcd76a6cfaef579bd0f34173e9fd",
    "sensor_msgs/Imu": "6a62c6daae103f4ff57a132d6f95cec2",
    "sensor_msgs/Range": "c005c34273dc426c67a020a87bc24148",
    "sensor_msgs/NavSatFix": "2d3a8cd499b9b4a0249fb98fd05cfa48",
    "sensor_msgs/MagneticField": "2f3b0b43eed0c9501de0fa3ff89a45aa",
    "sensor_msgs/FluidPressure": "804dc5cea1c5306d6a2eb80b9833befe",
    "geometry_msgs/PointStamped": "c63aecb41bfdfd6b7e1fac37c7cbe7bf",
    "geometry_msgs/PoseStamped": "d3812c3cbc69362b77dc0b19b345f8f5",
    "geometry_msgs/Vector3Stamped": "7b324c7325e683bf02a9b14b01090ec7",
    "geometry_msgs/WrenchStamped": "d78d3cb249ce23087ade7e7d0c40cfa7",
    "nav_msgs/Odometry": "cd5e73d190d741a2f92e81eda573aca7",
    "tf2_msgs/TFMessage": "94810edda583a504dfda3829e70d7eec",
    "rosgraph_msgs/Clock": "a9c97c1d230cfc112e270351a944ee47",
    "geometry_msgs/Twist": "9f195f881246fdfa2798d1d3eebca84a",
    "gazebo_msgs/ContactsState": "acbcb1601a8e525bf72509f18e6f668d",
    "gazebo_msgs/ModelStates": "48c080191eb15c41858319b4d8a609c2",
    "gazebo_msgs/LinkStates": "48c080191eb15c41858319b4d8a609c2",
    "kobuki_msgs/SensorState": "430a4bfd78449c8740bfef32b26613a6",
}


def check_file(path: str) -> set[str]:
    """Reads one file; returns the types of its messages."""
    seen: dict[str, int] = {}
    frames = 0
    last = {}
    instruments = {}
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
                    check_instrument(*instruments.pop(topic, (None, None)), bytes(decoded.payload))
                continue
            seen[schema.name] = seen.get(schema.name, 0) + 1
            last[channel.topic] = message
            if seen[schema.name] == 1:
                types = generate_dynamic(schema.name, schema.data.decode())
                if schema.name in SUMS:
                    assert types[schema.name]._md5sum == SUMS[schema.name], schema.name
            check_message(schema.name, decoded)
            instruments[channel.topic] = schema.name, decoded
        statistics = reader.get_summary().statistics
        assert statistics.message_count == frames + sum(seen.values())
        names = {record.name for record in reader.iter_metadata()}
        assert {"belvedere", "belvedere.stream", "belvedere.hashes"} <= names, names
    print(f"{path}: {frames} frames, {seen}")
    return set(seen)


def check_instrument(name: str | None, message, payload: bytes) -> None:
    """Compares a message of an instrument with the frame that follows it; offsets are those of WIRE.md."""

    def numbers(offset: int, count: int) -> tuple[float, ...]:
        return struct.unpack_from(f"<{count}d", payload, offset)

    if name == "sensor_msgs/NavSatFix":
        assert (message.latitude, message.longitude, message.altitude) == numbers(0, 3)
        assert tuple(message.position_covariance) == numbers(48, 9)
        assert message.position_covariance_type == 2 and message.position_covariance[0] > 0
        assert (message.status.status, message.status.service) == (0, 1)
        assert abs(message.latitude - 47.3667) < 0.01 and abs(message.longitude - 8.55) < 0.01
    elif name == "sensor_msgs/MagneticField":
        field = message.magnetic_field
        assert (field.x, field.y, field.z) == numbers(0, 3) and 2e-5 < math.hypot(*numbers(0, 3)) < 7e-5
        assert tuple(message.magnetic_field_covariance) == numbers(24, 9)
    elif name == "sensor_msgs/FluidPressure":
        assert (message.fluid_pressure, message.variance) == numbers(0, 2)
        assert 9e4 < message.fluid_pressure < 1e5
    elif name == "geometry_msgs/PointStamped":
        assert (message.point.x, message.point.y, message.point.z) == (0, 0, *numbers(0, 1))
    elif name == "geometry_msgs/PoseStamped":
        at, turn = message.pose.position, message.pose.orientation
        assert (at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w) == numbers(0, 7)
        assert message.header.frame_id == "world" and math.hypot(*numbers(24, 4)) > 0.999999
    elif name == "geometry_msgs/Vector3Stamped":
        assert (message.vector.x, message.vector.y, message.vector.z) == numbers(0, 3)
    elif name == "geometry_msgs/WrenchStamped":
        force, torque = message.wrench.force, message.wrench.torque
        assert (force.x, force.y, force.z, torque.x, torque.y, torque.z) == numbers(0, 6)
    elif name == "gazebo_msgs/ContactsState":
        assert sum(len(state.depths) for state in message.states) == len(payload) // 360
        for state in message.states[:1]:
            own = payload[:128].rstrip(b"\0").decode()
            assert state.collision1_name == own == "instruments::base_link::base_link_collision"
            place, normal, force = state.contact_positions[0], state.contact_normals[0], state.wrenches[0].force
            assert (place.x, place.y, place.z, normal.x, normal.y, normal.z) == numbers(256, 6)
            assert (state.depths[0], force.x, force.y, force.z) == numbers(304, 4)
            assert abs(state.total_wrench.force.z - sum(each.force.z for each in state.wrenches)) < 1e-9


def check_message(name: str, message) -> None:
    """Checks the rules for any message of a type."""
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
