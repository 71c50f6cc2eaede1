"""A simulation in this process."""

from __future__ import annotations

import os
import signal
import threading
from typing import TYPE_CHECKING

import numpy as np
import pytest

import belvedere as bv

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

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


def test_any_sensor_sees_the_current_state() -> None:
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


def test_a_models_own_pose_counts_once(tmp_path: Path) -> None:
    expected = pytest.approx([2, 0, 0.5])
    (tmp_path / "wall.sdf").write_text(WALL)
    for source in (WALL, str(tmp_path / "wall.sdf")):
        assert bv.Simulation(source).pose("wall")[:3] == expected
        assert bv.World(source).pose("wall::l")[:3] == expected
    simulation = bv.Simulation("empty", robot=WALL)
    assert simulation.pose("wall")[:3] == expected
    # Its own pose is relative to the given one, as when Gazebo spawns a model.
    simulation.spawn(WALL, name="other", pose=(0, 3, 0, 0, 0, 0, 1))
    assert simulation.pose("other")[:3] == pytest.approx([2, 3, 0.5])


def test_an_image_and_its_ground_truth_are_of_one_frame() -> None:
    simulation = bv.Simulation("tag_ceiling", robot="kobuki_hexagons_kinect")
    picture = "/camera/rgb/image_raw"
    topics = [picture, f"{picture}/truth/flow_back", f"{picture}/truth/flow_forward"]
    for step in range(3):
        simulation.command((0.3, 0.5))
        simulation.run(0.1)
        frames = simulation.render(topics)
        assert list(frames) == topics[: 3 if step else 1]
        assert frames[picture].shape == (480, 640, 3)
        if step:
            back = np.abs(frames[topics[1]])
            assert back.shape == (480, 640, 2)
            # It turns by 0.05 rad, about 30 pixels.
            assert 10 < np.nanmax(back) < 60
    with pytest.raises(ValueError, match=r"optical flow has one from the second call on|has no frame now"):
        bv.Simulation("tag_ceiling", robot="kobuki_hexagons_kinect").render(topics[1])


def test_a_texture_that_cannot_be_read_is_noted(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "broken.png").write_bytes(b"no picture")
    pbr = "<material><pbr><metal><albedo_map>broken.png</albedo_map></metal></pbr></material>"
    file = tmp_path / "wall.sdf"
    box = f"<visual name='v'><geometry><box><size>1 1 1</size></box></geometry>{pbr}</visual>"
    file.write_text(WALL.replace("</link>", f"{box}</link>"))
    for make in (bv.World, bv.Simulation):
        made = make(file)
        assert [note for note in made.notes if "broken.png" in note], made.notes
        told = [record.getMessage() for record in caplog.records if record.name == "belvedere"]
        assert told == made.notes
        caplog.clear()


def test_notes_are_logged_once(caplog: pytest.LogCaptureFixture) -> None:
    unknown = "<plugin name='p' filename='libunknown.so'/>"
    models = [WALL.replace("'wall'", f"'{name}'").replace("<link", f"{unknown}<link") for name in "abc"]
    simulation = bv.Simulation(models[0])
    assert [record.args for record in caplog.records] == [(note,) for note in simulation.notes]
    for model in models[1:]:
        simulation.spawn(model)
    told = [record.getMessage() for record in caplog.records if record.name == "belvedere"]
    assert told == simulation.notes
    assert ["of model 'a'" in told[0], "of model 'b'" in told[1], "of model 'c'" in told[2]] == [True] * 3


def test_a_robot_in_place_of_a_world() -> None:
    simulation = bv.Simulation("kobuki_nostack_rplidar")
    assert simulation.robot in simulation.models
    simulation.command((0.3, 0.0))
    np.testing.assert_array_equal(simulation.pose(), simulation.pose(simulation.models[0]))
    assert bv.Simulation("empty").robot is None
    for given in ({"pose": (5, 5, 0)}, {"xacro": {"height": 1}}):
        with pytest.raises(ValueError, match=rf"{next(iter(given))}: it applies to robot=…, which is missing"):
            bv.Simulation("kobuki_nostack_rplidar", **given)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "run", [lambda simulation: simulation.run(20_000), lambda simulation: simulation.step(2_000_000)]
)
def test_ctrl_c_ends_a_run(run: Callable[[bv.Simulation], None]) -> None:
    simulation = bv.Simulation("empty", robot="kobuki_nostack_rplidar")
    presses = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
    with pytest.raises(KeyboardInterrupt):  # noqa: PT012
        presses.start()
        run(simulation)
    presses.join()
    reached = simulation.time
    assert reached < 19_000
    simulation.run(0.1)
    assert simulation.time == pytest.approx(reached + 0.1, abs=0.01)


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
    with pytest.raises(ValueError, match="no such file"):
        bv.Simulation("no_such.world")
