"""Frames of a live simulator."""

from __future__ import annotations

import gc
import signal
import time
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

import belvedere
from belvedere import Encoding

if TYPE_CHECKING:
    from conftest import Simulator

TOPICS = {
    "camera_info": ("camera_info", "struct", 30.0),
    "clock": ("clock", "struct", 100.0),
    "cmd_vel": ("velocity_command", "struct", None),
    "image_raw": ("image", "rgb8", 30.0),
    "joint_states": ("joint_states", "struct", 50.0),
    "mobile_base/commands/motor_power": ("motor_power", "struct", None),
    "mobile_base/commands/reset_odometry": ("reset_odometry", "struct", None),
    "mobile_base/events/bumper": ("robot_event", "struct", None),
    "mobile_base/events/cliff": ("robot_event", "struct", None),
    "mobile_base/events/wheel_drop": ("robot_event", "struct", None),
    "mobile_base/sensors/core": ("core_sensors", "struct", 50.0),
    "mobile_base/sensors/imu_data": ("imu", "struct", 50.0),
    "odom": ("odometry", "struct", 50.0),
    "scan": ("laser_scan", "ranges_f32", 5.5),
    "simulation/command": ("simulation_command", "struct", None),
    "simulation/link_states": ("model_states", "struct", 50.0),
    "simulation/model_states": ("model_states", "struct", 50.0),
    "simulation/sensor_settings": ("sensor_settings", "struct", None),
    "simulation/result": ("simulation_result", "struct", None),
    "tf": ("transforms", "struct", 50.0),
    "tf_static": ("static_transforms", "struct", None),
}
#: Streams of commands, their results, and events that do not occur here.
SILENT = {
    "velocity_command",
    "motor_power",
    "reset_odometry",
    "robot_event",
    "simulation_command",
    "simulation_result",
}


def first(node: belvedere.Node, topic: str) -> belvedere.Frame:
    with node.subscribe(topic) as subscriber:
        return next(subscriber.frames(timeout=30))


def test_all_streams_are_listed_and_read(node: belvedere.Node) -> None:
    first(node, "image_raw")
    listed = {stream.topic: (stream.kind, stream.encoding, stream.rate_hz) for stream in node.streams()}
    assert listed == TOPICS
    for topic, (kind, _, _) in TOPICS.items():
        if kind not in SILENT:
            frame = first(node, topic)
            assert frame.kind.name.lower() == kind
            assert frame.array.size > 0
            assert not frame.array.flags.writeable


def test_an_image_is_a_view_of_shared_memory(node: belvedere.Node) -> None:
    with first(node, "/image_raw") as frame:
        image = frame.array
        assert (image.shape, image.dtype) == ((480, 640, 3), np.uint8)
        assert frame.encoding == Encoding.RGB8
        assert frame.frame_id == "base_camera_link_optical"
        assert frame.intrinsics.fx == pytest.approx(frame.intrinsics.fy)
        assert (frame.intrinsics.cx, frame.intrinsics.cy) == (319.5, 239.5)
        address = image.__array_interface__["data"][0]
        assert address % 64 == 0
        assert address == frame.array.__array_interface__["data"][0]
        mapped = next(
            line
            for line in Path("/proc/self/maps").read_text().splitlines()
            if int(line.split("-")[0], 16) <= address < int(line.split("-")[1].split()[0], 16)
        )
        assert "/dev/shm/" in mapped
        assert mapped.split()[1] == "r--s"
        assert np.unique(image).size > 10
        del image
    with pytest.raises(belvedere.ReleasedError):
        _ = frame.array


def test_an_array_that_outlives_its_block_is_an_error_and_stays_readable(node: belvedere.Node) -> None:
    frame = first(node, "image_raw")
    with pytest.raises(belvedere.FrameInUseError, match="copy"), frame:
        row = frame.array[240]
    before = row.copy()
    time.sleep(0.3)
    assert (row == before).all()


def test_too_many_held_frames_are_an_error(node: belvedere.Node) -> None:
    with node.subscribe("image_raw") as subscriber:
        held = []
        with pytest.raises(belvedere.LimitError, match="2 frames of image_raw are held"):
            held.extend(subscriber.frames(timeout=30))
        assert len(held) == 2
        held.clear()
        gc.collect()
        assert next(subscriber.frames(timeout=30)).width == 640


def test_each_frame_arrives_once_and_in_order(node: belvedere.Node) -> None:
    with node.subscribe("odom") as subscriber:
        frames = subscriber.frames(timeout=30)
        last = next(frames)
        for _ in range(40):
            frame = next(frames)
            assert frame.seq == last.seq + 1 + frame.missed
            assert frame.stamp_ns > last.stamp_ns
            last = frame


def test_the_newest_skips_queued_frames(node: belvedere.Node) -> None:
    with node.subscribe("odom") as subscriber:
        assert subscriber.wait(30)
        for taken, frame in enumerate(subscriber.frames(timeout=30, newest=True)):
            if taken == 1:
                assert frame.missed >= 5
                break
            time.sleep(0.5)
        assert subscriber.missed_total >= 5


def test_a_command_moves_the_robot(node: belvedere.Node) -> None:
    commands = node.velocity_publisher("/cmd_vel")
    assert commands.wait(30)
    with commands, node.subscribe("odom") as subscriber:
        start = next(subscriber.frames(timeout=30)).array[0]["position"].copy()
        frames = subscriber.frames(timeout=30)
        for _ in range(50):
            frame = next(frames)
            assert commands.send(forward=0.3)
        moved = np.linalg.norm(frame.array[0]["position"] - start)
        assert 0.1 < moved < 1.0
        assert frame.array[0]["linear"][0] == pytest.approx(0.3, abs=0.05)


def test_a_killed_simulator_is_followed_to_its_next_life(simulator: Simulator) -> None:
    with belvedere.Node(domain=simulator.domain) as node, node.subscribe("image_raw") as subscriber:
        frames = subscriber.frames(timeout=30)
        session = next(frames).session
        simulator.stop(signal.SIGKILL)
        simulator.start()
        for frame in frames:
            if frame.session != session:
                assert frame.restarted
                break
        assert next(frames).session != session


def test_a_missing_stream_is_a_timeout(alone: belvedere.Node) -> None:
    with alone.subscribe("nothing/of/this") as subscriber:
        assert not subscriber.wait(0.1)
        assert subscriber.take() is None
        with pytest.raises(belvedere.StreamTimeoutError, match=r"nothing/of/this for 0.1 s; publishers: 0"):
            next(subscriber.frames(timeout=0.1))


def test_a_closed_node_raises_an_error(alone: belvedere.Node) -> None:
    alone.close()
    with pytest.raises(belvedere.BridgeError, match="closed"):
        alone.subscribe("image_raw")


@pytest.mark.parametrize("name", ["", "a b", "a//b", "a/", "//a", "ä"])
def test_invalid_names(alone: belvedere.Node, name: str) -> None:
    with pytest.raises(belvedere.InvalidNameError):
        alone.subscribe(name)
    with pytest.raises(belvedere.InvalidNameError):
        alone.velocity_publisher(name)
    with pytest.raises(belvedere.InvalidNameError):
        belvedere.Node(domain=name)


@pytest.mark.parametrize(
    ("camera", "model", "parameters"),
    [
        (
            "tilted",
            belvedere.DistortionModel.RATIONAL_POLYNOMIAL,
            (0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.009, 0.01, 0.011, 0.012, 0.013, 0.014),
        ),
        ("fisheye", belvedere.DistortionModel.EQUIDISTANT, (0.05, -0.01, 0.002, 0.0001)),
        ("spheres", belvedere.DistortionModel.DOUBLE_SPHERE, (-0.2, 0.6)),
    ],
)
def test_images_and_infos_contain_the_lens(
    lenses: belvedere.Node, camera: str, model: belvedere.DistortionModel, parameters: tuple[float, ...]
) -> None:
    with first(lenses, f"{camera}/image_raw") as picture:
        lens = picture.intrinsics
    assert (lens.distortion_model, lens.distortion) == (model, parameters)
    with first(lenses, f"{camera}/camera_info") as frame:
        info = frame.array[0].copy()
    assert info["distortion_model"] == model.name.lower().encode()
    assert tuple(info["d"][: info["d_len"]]) == parameters
    assert info["k"].tolist() == [[lens.fx, lens.skew, lens.cx], [0, lens.fy, lens.cy], [0, 0, 1]]
