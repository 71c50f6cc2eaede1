"""Reads recordings of profile ros2 with independent readers: read_ros2.py run.mcap…

Every message decodes with mcap-ros2-support and with rosbags, to the same values. Types are those of Jazzy, and rosbags
encodes each message to the same bytes by Jazzy's own definitions. Every field is that of the frame in shared memory, whose
payload has the recorded hash.
"""

import sys

import numpy as np
import xxhash
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from ros2_frames import Frame, check_frame, layout, same
from rosbags.interfaces import QosDurability, QosHistory, QosReliability
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

FRAME = "belvedere/msg/Frame"
#: Types that Jazzy does not have.
VISION = {
    f"vision_msgs/msg/{name}"
    for name in (
        "BoundingBox2D",
        "Detection2D",
        "Detection2DArray",
        "ObjectHypothesis",
        "ObjectHypothesisWithPose",
        "Point2D",
        "Pose2D",
    )
}
ELSEWHERE = VISION | {
    FRAME,
    "gazebo_msgs/msg/ContactState",
    "gazebo_msgs/msg/ContactsState",
    "gazebo_msgs/msg/LinkStates",
    "gazebo_msgs/msg/ModelStates",
    "kobuki_ros_interfaces/msg/SensorState",
}
WANTED = ELSEWHERE - VISION - {"gazebo_msgs/msg/ContactState"} | {
    "geometry_msgs/msg/PointStamped",
    "geometry_msgs/msg/PoseStamped",
    "geometry_msgs/msg/Vector3Stamped",
    "geometry_msgs/msg/WrenchStamped",
    "nav_msgs/msg/Odometry",
    "rosgraph_msgs/msg/Clock",
    "sensor_msgs/msg/CameraInfo",
    "sensor_msgs/msg/FluidPressure",
    "sensor_msgs/msg/Image",
    "sensor_msgs/msg/Imu",
    "sensor_msgs/msg/JointState",
    "sensor_msgs/msg/LaserScan",
    "sensor_msgs/msg/MagneticField",
    "sensor_msgs/msg/NavSatFix",
    "sensor_msgs/msg/PointCloud2",
    "sensor_msgs/msg/Range",
    "tf2_msgs/msg/TFMessage",
    "vision_msgs/msg/Detection2DArray",
}


def flat(value) -> list:
    """Returns the values of a message in the order of its fields, without their structure."""
    if isinstance(value, (str, bool, int, float)):
        return [value]
    if isinstance(value, (bytes, bytearray, memoryview)):
        return [bytes(value)]
    if isinstance(value, np.ndarray):
        return [value.tobytes()] if value.dtype == np.uint8 else value.tolist()
    if isinstance(value, (list, tuple)):
        return [each for item in value for each in flat(item)]
    names = getattr(type(value), "__slots__", None) or vars(value)
    return [
        each
        for name in names
        # Constants have capital letters.
        if not name.isupper() and name not in ("__msgtype__", "structure_needs_at_least_one_member")
        for each in flat(getattr(value, name))
    ]


def typestore(reader: Reader):
    """Returns Jazzy's types and those of other packages; checks that the file has Jazzy's definitions."""
    store = get_typestore(Stores.ROS2_JAZZY)
    for connection in reader.connections:
        own = get_types_from_msg(connection.msgdef.data, connection.msgtype)
        described = get_typestore(Stores.EMPTY)
        described.register(own)
        for name in own:
            if name in ELSEWHERE:
                store.register({name: own[name]})
            else:
                assert described.hash_rihs01(name) == store.hash_rihs01(name), name
    return store


def check_file(path: str) -> tuple[set[str], set[str]]:
    """Reads one file; returns the types of its messages, and the special numbers in them."""
    seen: dict[str, int] = {}
    special: set[str] = set()
    last = {}
    hashes: dict[str, xxhash.xxh3_128] = {}
    with open(path, "rb") as file, Reader(path) as reader:
        store = typestore(reader)
        for connection in reader.connections:
            (qos,) = connection.ext.offered_qos_profiles
            assert connection.ext.serialization_format == "cdr"
            assert (qos.history, qos.reliability) == (QosHistory.KEEP_LAST, QosReliability.RELIABLE)
            latched = connection.topic == "/tf_static"
            assert qos.durability == (QosDurability.TRANSIENT_LOCAL if latched else QosDurability.VOLATILE)
        bag = reader.messages()
        official = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        assert official.get_header().profile == "ros2"
        for schema, channel, message, decoded in official.iter_decoded_messages():
            assert (schema.encoding, channel.message_encoding) == ("ros2msg", "cdr")
            connection, time, data = next(bag)
            assert (connection.topic, time, bytes(data)) == (channel.topic, message.log_time, message.data)
            again = store.deserialize_cdr(data, connection.msgtype)
            assert same(flat(decoded), flat(again)), f"{path}: {schema.name}"
            assert bytes(store.serialize_cdr(again, connection.msgtype)) == message.data, schema.name
            seen[schema.name] = seen.get(schema.name, 0) + 1
            if schema.name != FRAME:
                last[channel.topic] = message, decoded
                continue
            topic = channel.topic.removeprefix("/belvedere/frames").replace("/simulation/", "/gazebo/")
            payload, (whole, of_ros) = bytes(decoded.payload), last.pop(topic, (None, None))
            length = int(np.frombuffer(bytes(decoded.header), layout.HEADER)[0]["payload_len"])
            if length and not payload:
                payload = whole.data[decoded.payload_offset :][:length]
            frame = Frame(bytes(decoded.header), payload)
            assert len(payload) == length and frame.stamp == message.publish_time
            digest = xxhash.xxh3_128_intdigest(payload, seed=frame.stamp)
            own = hashes.setdefault(channel.topic.removeprefix("/belvedere/frames/"), xxhash.xxh3_128())
            own.update(digest.to_bytes(16, "little"))
            if of_ros is not None:
                special |= check_frame(of_ros, frame)
        assert next(bag, None) is None
        recorded = {record.name: record.metadata for record in official.iter_metadata()}["belvedere.hashes"]
        assert all(own.hexdigest() == recorded[topic] for topic, own in hashes.items())
        assert not last, f"{path}: no frame has the messages of {', '.join(last)}"
    print(f"{path}: {seen}")
    return set(seen), special


if __name__ == "__main__":
    results = [check_file(path) for path in sys.argv[1:]]
    kinds, special = (set().union(*found) for found in zip(*results))
    assert WANTED <= kinds, f"no message of {sorted(WANTED - kinds)}"
    wanted = {"depth nan", "depth inf", "ranges inf", "range inf", "range -inf"}
    assert wanted <= special, f"no number is {sorted(wanted - special)}"
    print(f"{len(kinds)} types, also with {', '.join(sorted(special))}")
