"""Commands to a robot and to a simulation, and their effects."""

from __future__ import annotations

import signal
import time
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

import numpy as np
import pytest
from conftest import Simulator, running

import belvedere

if TYPE_CHECKING:
    from collections.abc import Iterator

CRATE = """<sdf version="1.6"><model name="crate"><static>true</static><link name="link"><collision name="box">
    <geometry><box><size>0.2 0.2 0.2</size></box></geometry></collision></link></model></sdf>"""


@pytest.fixture(scope="module")
def shared_still() -> Iterator[Simulator]:
    """Start a simulator whose robot stands still. Each test leaves it running."""
    yield from running("control", "--drive", "still")


@pytest.fixture
def still(shared_still: Simulator) -> Iterator[belvedere.Node]:
    with belvedere.Node("pytest", domain=shared_still.domain) as node:
        yield node


def structs(node: belvedere.Node, topic: str) -> np.ndarray:
    """Return the next structs of a stream."""
    with node.subscribe(topic) as subscriber:
        return next(subscriber.frames(timeout=30)).array.copy()


def test_power_and_odometry(still: belvedere.Node) -> None:
    velocity = still.velocity_publisher()
    power, zero = (
        still.motor_power_publisher(),
        still.reset_odometry_publisher("/mobile_base/commands/reset_odometry"),
    )
    assert all(publisher.wait(30) for publisher in (velocity, power, zero))
    assert (power.topic, zero.topic) == ("mobile_base/commands/motor_power", "mobile_base/commands/reset_odometry")
    with velocity, power, zero, still.subscribe("odom") as odometry:
        frames = odometry.frames(timeout=30)

        def drive(count: int) -> np.void:
            for _ in range(count):
                state = next(frames).array[0].copy()
                assert velocity.send(forward=0.3)
            return state

        assert drive(60)["position"][0] > 0.1
        assert power.send(False)
        stood = drive(40)
        later = drive(20)
        assert later["linear"][0] == 0.0
        assert later["position"][0] == pytest.approx(stood["position"][0], abs=1e-3)
        assert zero.send()
        drive(5)
        assert np.linalg.norm(drive(1)["position"]) < 1e-3
        assert power.send(True)
        assert drive(50)["position"][0] > 0.1


def test_commands_without_a_receiver(alone: belvedere.Node) -> None:
    for publisher in (alone.motor_power_publisher(), alone.reset_odometry_publisher()):
        assert not publisher.wait(0.05)
    assert not alone.motor_power_publisher().send(True)
    # No stream appears either.
    assert alone.streams() == []
    with (
        alone.control(timeout=0.05) as control,
        pytest.raises(belvedere.StreamTimeoutError, match=r"0\.05 s"),
    ):
        control.pause()


def test_a_simulation_is_paused_stepped_and_reset(still: belvedere.Node) -> None:
    with still.control(timeout=30) as control:
        paused_ns = control.pause()
        assert control.pause() == paused_ns
        step_ns = control.step() - paused_ns
        assert step_ns > 0
        assert control.step(9) == paused_ns + 10 * step_ns
        with pytest.raises(belvedere.RefusedError, match="0 steps cannot be run"):
            control.step(0)
        assert control.reset_world() == paused_ns + 10 * step_ns
        assert control.reset() == 0
        control.resume()
        with still.subscribe("clock") as clock:
            times = [
                int(frame.array[0]["now_ns"]) for frame, _ in zip(clock.frames(timeout=30), range(5), strict=False)
            ]
        assert times == sorted(set(times))


def test_models_are_spawned_moved_and_deleted(still: belvedere.Node) -> None:
    def position(name: str) -> list[float] | None:
        states = structs(still, "simulation/model_states")
        found = states[states["name"] == name.encode()]
        return found[0]["position"].tolist() if found.size else None

    with still.control(timeout=30) as control:
        control.spawn(CRATE, "second", (2.0, 0.0, 0.5))
        assert position("second") == [2.0, 0.0, 0.5]
        with pytest.raises(belvedere.RefusedError, match="'second'"):
            control.spawn(CRATE, "second")
        # A longer text than the first needs another port.
        control.spawn(CRATE + " " * 5000, position=(-2.0, 0.0, 0.5))
        assert position("crate") == [-2.0, 0.0, 0.5]
        control.move("second", (1.0, 0.0, 1.0), reference="second")
        assert position("second") == [3.0, 0.0, 1.5]
        control.delete("second")
        assert position("second") is None
        with pytest.raises(belvedere.RefusedError, match="'second'"):
            control.delete("second")
        with pytest.raises(belvedere.InvalidNameError, match="64 bytes, but at most 63 are possible"):
            control.delete("x" * 64)


def test_the_simulation_is_queried(still: belvedere.Node) -> None:
    with still.control(timeout=30) as control:
        paused_ns = control.pause()
        assert control.query() == (paused_ns, {"paused"})
        control.spawn(CRATE, "queried", (2.0, 1.0, 0.5))
        assert control.query("queried").words == {"paused", "static", "spawned"}
        assert control.query("turtlebot").words == {"paused", "robot"}
        control.delete("queried")
        with pytest.raises(belvedere.RefusedError, match="no model 'queried'"):
            control.query("queried")
        control.resume()
        assert control.query().words == {"playing"}


def test_control_goes_on_with_the_next_simulator(simulator: Simulator) -> None:
    with belvedere.Node(domain=simulator.domain) as node, node.control(timeout=30) as control:
        control.pause()
        with ThreadPoolExecutor() as threads:
            answer = threads.submit(control.step, 10**9)
            time.sleep(0.5)
            simulator.stop(signal.SIGKILL)
            with pytest.raises(belvedere.StreamTimeoutError, match="ended without an answer to step"):
                answer.result()
        simulator.start()
        assert control.pause() >= 0
        assert control.step(3) > 0


def test_sensors_are_configured(still: belvedere.Node) -> None:
    def settings(name: bytes) -> np.void:
        return next(sensor for sensor in structs(still, "simulation/sensor_settings") if sensor["name"] == name)

    camera = settings(b"camera1")
    assert [*camera["topics"][:3]] == [b"image_raw", b"camera_info", b""]
    assert camera["exposure"].item() == (1.0, 0.01, 100.0)
    assert np.isnan(settings(b"laser")["exposure"]["value"])
    with still.control() as control:
        control.configure("/scan", update_rate=8, noise_mean=-1e-3)
        laser = settings(b"laser")
        assert (laser["update_rate"]["value"], laser["noise_mean"]["value"]) == (8.0, -1e-3)
        with pytest.raises(belvedere.RefusedError, match=r"it must be a number from 0\.01 to 1000"):
            control.configure("/scan", update_rate=0)
    layers = {stream.topic: stream.layers for stream in still.streams()}
    assert (layers["scan"], layers["clock"]) == (1, None)
