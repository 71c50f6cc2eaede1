"""A simulation in this process."""

from __future__ import annotations

import numpy as np
import pytest

import belvedere as bv

WALL = """<sdf version='1.6'><model name='wall'><pose>2 0 0.5 0 0 0</pose><static>true</static><link name='l'>
<collision name='c'><geometry><box><size>0.2 4 1</size></box></geometry></collision></link></model></sdf>"""


def test_a_robot_drives_at_a_wall() -> None:
    simulation = bv.Simulation("empty", robot="kobuki_nostack_rplidar")
    simulation.spawn(WALL)
    simulation.robot = "turtlebot" if "turtlebot" in simulation.models else simulation.models[-2]
    for second in range(3):
        ranges = simulation.render("scan")
        ahead = ranges[0, ranges.shape[1] // 2]
        x = simulation.pose()[0]
        assert ahead + x - 1.8 == pytest.approx(0, abs=0.03)
        assert simulation.time == pytest.approx(second)
        for _ in range(10):
            simulation.command((0.3, 0.0))
            simulation.run(0.1)


def drive(simulation: bv.Simulation) -> list[np.ndarray]:
    frames = []
    for _ in range(3):
        simulation.command((0.2, 0.5))
        simulation.run(0.1)
        frames.append(np.array(simulation.render("/camera/depth/image_raw")))
        frames.append(np.array(simulation.render("/camera/rgb/image_raw")))
    return frames


def test_the_same_commands_give_the_same_bytes() -> None:
    one = bv.Simulation("tag_ceiling", robot="kobuki_hexagons_kinect")
    first = drive(one)
    assert first[0].dtype == np.float32
    assert first[1].shape == (480, 640, 3)
    two = bv.Simulation("tag_ceiling", robot="kobuki_hexagons_kinect", threads=1)
    one.reset()
    assert one.time_ns == 0
    for again in (drive(one), drive(two)):
        for before, after in zip(first, again, strict=True):
            np.testing.assert_array_equal(before, after)


def test_any_sensor_sees_what_is_there_now() -> None:
    simulation = bv.Simulation("empty", robot="kobuki_nostack_rplidar")
    base = next(body for body in simulation.world.bodies if body.endswith("base_link"))
    before = simulation.world.pose(base)
    simulation.command((0.3, 0.0))
    simulation.run(0.5)
    after = simulation.world.pose(base)
    assert 0.05 < after[0] - before[0] < 0.2
    simulation.place((5, 0, 0))
    np.testing.assert_allclose(simulation.pose()[:2], [5, 0], atol=1e-9)
    overview = bv.Camera(64, 48, fov=1.0)
    looking_down = [5, 0, 2, 0, 0.5**0.5, 0, 0.5**0.5]
    seen = overview.render(simulation.world, looking_down, channels=("instance",))["instance"]
    assert len(np.unique(seen)) > 2


def test_errors() -> None:
    simulation = bv.Simulation("empty")
    with pytest.raises(ValueError, match="no sensor sends /scan"):
        simulation.render("scan")
    with pytest.raises(ValueError, match="robot: none was spawned"):
        simulation.command((1, 0))
    simulation.spawn(WALL)
    with pytest.raises(ValueError, match="'wall' has no base that drives"):
        simulation.command((1, 0))
    with pytest.raises(ValueError, match="there is a model 'wall' already"):
        simulation.spawn(WALL)
    with pytest.raises(ValueError, match=r"velocity: shape \(3,\); \(2,\) is expected"):
        simulation.command((1, 0, 0))
    with pytest.raises(ValueError, match=r"playground\.world is a world"):
        simulation.spawn("playground.world")
    with pytest.raises(ValueError, match="no such world"):
        bv.Simulation("no_such.world")
