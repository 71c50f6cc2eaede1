"""Compares a log as read by Rerun with the recording of the same run, frame by frame: compare.py run.rrd run.mcap."""

import sys
from collections import defaultdict

import numpy as np
from mcap.reader import make_reader
from mcap_ros1.decoder import DecoderFactory
from rerun.chunk import RrdReader

TYPES = ("sensor_msgs/Image", "sensor_msgs/LaserScan")


def logged(path: str) -> dict[str, dict[str, dict[int, np.ndarray]]]:
    """Values of the log by topic, component and simulated time."""
    found = defaultdict(lambda: defaultdict(dict))
    for chunk in RrdReader(path).stream().to_chunks():
        batch = chunk.to_record_batch()
        if "simulation" not in batch.schema.names:
            continue
        times = batch.column("simulation").cast("int64").to_pylist()
        for component in ("Image:buffer", "DepthImage:buffer", "Points3D:positions", "Pinhole:image_from_camera"):
            if component not in batch.schema.names:
                continue
            column = batch.column(component)
            for index, time in enumerate(times):
                values = column[index].values
                while hasattr(values, "flatten") and "list" in str(values.type):
                    values = values.flatten()
                found[chunk.entity_path[1:]][component][time] = values.to_numpy()
    return found


def recorded(path: str) -> dict[str, dict[int, object]]:
    """Messages of the recording by topic and simulated time."""
    found = defaultdict(dict)
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for schema, channel, _, message in reader.iter_decoded_messages():
            if schema.name in TYPES:
                stamp = message.header.stamp
                found[channel.topic[1:]][stamp.secs * 10**9 + stamp.nsecs] = message
    return found


def points(scan: object) -> np.ndarray:
    """The points of a scan, computed from the message."""
    rays = ((scan.angle_min + index * scan.angle_increment, r) for index, r in enumerate(scan.ranges))
    there = [
        (r * np.cos(angle), r * np.sin(angle), 0.0) for angle, r in rays if scan.range_min <= r <= scan.range_max
    ]
    return np.array(there)


log, recording = logged(sys.argv[1]), recorded(sys.argv[2])
assert sorted(log) == sorted(recording), (sorted(log), sorted(recording))
assert len(log) == 3
for topic, messages in recording.items():
    components = log[topic]
    assert all(sorted(times) == sorted(messages) for times in components.values()), topic
    for time, message in messages.items():
        if "Points3D:positions" in components:
            found = components["Points3D:positions"][time].reshape(-1, 3)
            assert len(found) > 50
            np.testing.assert_allclose(found, points(message), atol=1e-5)
        else:
            buffer = components.get("Image:buffer") or components["DepthImage:buffer"]
            assert bytes(buffer[time]) == bytes(message.data), (topic, time)
            focal = components["Pinhole:image_from_camera"][time][0]
            assert 400 < focal < 800, focal
    print(f"{topic}: {len(messages)} frames")
