"""Worlds from names, files, texts and arrays."""

from __future__ import annotations

import copy
import pickle
import re
import subprocess
import sys
import time
from typing import TYPE_CHECKING

import numpy as np
import pytest

import belvedere as bv

if TYPE_CHECKING:
    from pathlib import Path

HERE = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
URDF = """<robot name="post" xmlns:xacro="http://ros.org/wiki/xacro"><xacro:arg name="height" default="1"/>
<link name="base"><visual><geometry><box size="0.2 0.2 $(arg height)"/></geometry></visual></link></robot>"""
SDF = """<sdf version="1.6"><world name="w"><model name="m"><static>true</static><pose>2 0 0 0 0 0</pose>
<link name="l"><visual name="v"><geometry><sphere><radius>0.5</radius></sphere></geometry></visual></link>
</model></world></sdf>"""


def ahead(world: bv.World, pose: object = HERE) -> float:
    return float(bv.DepthCamera(5, 5, fov=0.1).render(world, pose)["depth"][..., 2, 2])


def test_names() -> None:
    assert any(body.startswith("ground_plane") or "::" in body for body in bv.World("playground").bodies)
    robot = bv.World("kobuki_hexagons_kinect")
    assert len(robot.bodies) > 10


def test_a_body_costs_the_same_however_many_there_are() -> None:
    world = bv.World()
    # Long, similar names, so that a search through all of them takes noticeable time.
    prefix = "x" * 4000

    def add(first: int) -> float:
        start = time.process_time()
        for number in range(first, first + 1000):
            world.add_sphere(0.1, name=f"{prefix}{number:06}")
        return time.process_time() - start

    times = [add(first) for first in range(0, 10_000, 1000)]
    assert min(times[7:]) < 3 * max(times[:3])
    with pytest.raises(ValueError, match="there is a body"):
        world.add_sphere(0.1, name=f"{prefix}{4242:06}")


def test_texts_and_files(tmp_path: Path) -> None:
    world = bv.World(SDF)
    assert world.bodies == ["m::l"]
    assert ahead(world) == 1.5
    file = tmp_path / "post.urdf.xacro"
    file.write_text(URDF)
    low, high = bv.World(file), bv.World(URDF, xacro={"height": 3})
    above = [-1.0, 0, 1.0, 0, 0, 0, 1]
    assert np.isinf(ahead(low, above))
    assert ahead(high, above) == pytest.approx(0.9)
    np.testing.assert_array_equal(low.pose(0), HERE)


def test_errors_are_those_of_the_command_line(tmp_path: Path) -> None:
    file = tmp_path / "broken.sdf"
    file.write_text(SDF.replace("0.5</radius>", "wide</radius>"))
    with pytest.raises(ValueError, match=r"broken\.sdf:2: error: .*wide") as raised:
        bv.World(file)
    assert "\n" not in str(raised.value)
    with pytest.raises(ValueError, match="playground"):
        bv.World("playgroud.world")
    with pytest.raises(ValueError, match="kobuki_hexagons_kinect"):
        bv.World("kobuki_hexagons_kinekt")
    with pytest.raises(ValueError, match="text:1: error"):
        bv.World("<robot")
    for source in (b"playground", 3):
        with pytest.raises(ValueError, match="source: a name, a path or a text is expected, not "):
            bv.World(source)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="xacro: a dictionary of arguments is expected, not 3"):
        bv.World(URDF, xacro=3)  # type: ignore[arg-type]


def test_bodies_have_names_and_poses() -> None:
    world = bv.World()
    assert world.bodies == []
    assert world.add_box((1, 1, 1)) == 0
    assert world.add_sphere(1, name="ball") == 1
    assert world.bodies == ["body_0", "ball"]
    with pytest.raises(ValueError, match='name: there is a body "ball" already'):
        world.add_cone(1, 1, name="ball")
    world.set_pose("ball", np.eye(4))
    world.set_pose(1, (4, 0, 0))
    np.testing.assert_array_equal(world.pose("ball"), [4, 0, 0, 0, 0, 0, 1])
    with pytest.raises(ValueError, match="body: there is no body 'bal'"):
        world.set_pose("bal", HERE)
    assert repr(world) == "<World of 2 bodies>"
    assert world.memory > 0


@pytest.mark.parametrize(
    ("add", "front"),
    [
        (lambda world: world.add_box((1, 2, 3), (5, 0, 0)), 4.5),
        (lambda world: world.add_rectangle((2, 2), (5, 0, 0, 0, -(0.5**0.5), 0, 0.5**0.5)), 5.0),
        (lambda world: world.add_ellipsoid((0.25, 1, 1), (5, 0, 0)), 4.75),
        (lambda world: world.add_cylinder(0.5, 2, (5, 0, 0)), 4.5),
        (lambda world: world.add_capsule(0.5, 2, (5, 0, 0)), 4.5),
        (lambda world: world.add_cone(1.0, 2, (5, 0, 0)), 4.5),
        (lambda world: world.add_box((1, 1, 1), (5, 0, 0), scale=(2, 1, 1)), 4.0),
    ],
)
def test_shapes(add: object, front: float) -> None:
    world = bv.World()
    add(world)  # type: ignore[operator]
    assert ahead(world) == pytest.approx(front, abs=1e-5)


def test_a_terrain() -> None:
    world = bv.World()
    heights = np.zeros((3, 3))
    heights[1, 1] = 1.0
    world.add_height_field(heights, (4, 4))
    down = np.array([[0, 0, 5], [2, 2, 5], [1, 0, 5.0]])
    hits = world.cast(down, np.tile([0, 0, -1.0], (3, 1)), channels="distance")
    np.testing.assert_allclose(hits["distance"], [4, 5, 4.5], atol=1e-5)


def test_looks() -> None:
    world = bv.World()
    world.set_environment(ambient=(1, 1, 1), background=(0, 0, 1))
    texture = np.zeros((2, 2, 3), np.uint8)
    texture[:, 0] = 255
    world.add_rectangle((2, 2), (2, 0, 0, -0.5, -0.5, 0.5, 0.5), color=(1, 1, 1), texture=texture)
    picture = bv.Camera(64, 64, fov=1.8).render(world, HERE)["rgb"]
    np.testing.assert_array_equal(picture[0, 0], [0, 0, 255])
    # One column of the texture is white, the other black; in between there is every shade of grey.
    row = picture[32].astype(int).sum(axis=1)
    seen = row[(picture[32] != [0, 0, 255]).any(axis=1)]
    assert seen.min() < 100
    assert seen.max() > 665


def test_visibility() -> None:
    world = bv.World()
    world.add_box((1, 1, 1), (3, 0, 0), seen_by="collision")
    assert np.isinf(ahead(world))
    assert bv.Lidar(1, angles=(0, 0)).render(world, HERE)["range"] == 2.5
    assert bv.Lidar(1, angles=(0, 0), sees="visual").render(world, HERE)["range"] == np.inf


def test_metal_is_black_beside_its_highlight() -> None:
    def brightness(**look: float) -> float:
        world = bv.World()
        world.set_environment(ambient=(0, 0, 0), background=(0, 0, 0))
        world.add_light("directional", direction=(1, 0, -1))
        world.add_box((1, 4, 4), (3, 0, 0), color=(1, 1, 1), **look)
        return float(bv.Camera(8, 8, fov=1.0).render(world, HERE)["rgb"].mean())

    assert brightness(metalness=1) == 0
    assert 50 < brightness(roughness=1) < brightness()


def test_refused_calls_change_nothing() -> None:
    world = bv.World()
    before = world.memory
    for add in (
        lambda: world.add_mesh(np.zeros((3, 3)), [[0, 1, 5]]),
        lambda: world.add_mesh(np.full((3, 3), np.nan), [[0, 1, 2]]),
        lambda: world.add_mesh(np.zeros((3, 3)), np.zeros((0, 3), int)),
        lambda: world.add_box((0, 1, 1)),
        lambda: world.add_sphere(-1),
        lambda: world.add_box((1, 1, 1), (np.inf, 0, 0)),
        lambda: world.add_box((1, 1, 1), color=(1, 1)),
        lambda: world.add_box((1, 1, 1), color=(1, 1, 1, 2)),
        lambda: world.add_box((1, 1, 1), texture=np.zeros((2, 2))),
        lambda: world.add_height_field(np.zeros((1, 5)), (1, 1)),
        lambda: world.add_light("bulb"),
        lambda: world.add_box((1, 1, 1), color=(255, 0, 0)),
        lambda: world.add_box((1, 1, 1), color=(0.5, 0.5, -0.5)),
        lambda: world.add_box((1, 1, 1), emissive=(-1, 0, 0)),
        lambda: world.add_box((1, 1, 1), roughness=1.5),
        lambda: world.add_box((1, 1, 1), metalness=np.nan),
        lambda: world.add_box((1, 1, 1), laser_retro=-1),
        lambda: world.add_box((1, 1, 1), laser_retro=np.inf),
        lambda: world.add_box((1, 1, 1), texture_repeat=(0, 0)),
        lambda: world.add_box((1, 1, 1), texture=np.zeros((6, 2, 3, 3), np.uint8)),
        lambda: world.add_box((1, 1, 1), texture=np.zeros((5, 2, 2, 3), np.uint8)),
        lambda: world.add_box((1, 1, 1), texture_stretch=(1, 1)),
        lambda: world.add_box((1, 1, 1), texture_stretch=(1, np.nan, 1)),
        lambda: world.set_sky(np.zeros((6, 0, 0, 3), np.uint8)),
        lambda: world.set_sky(np.zeros((6, 2, 2, 3))),
        lambda: world.set_sky([np.zeros((size, size, 3), np.uint8) for size in (2, 2, 2, 2, 2, 3)]),
        lambda: world.add_box((1, 1, 1), texture_mode="modulate"),
        lambda: world.add_box((1, 1, 1), texture_mode="light", roughness=0.3),
        lambda: world.add_box((1, 1, 1), texture_mode="light", metalness=0.0),
        lambda: world.add_box((1, 1, 1), name=3),
        lambda: world.add_light(color=(np.inf, 0, 0)),
        lambda: world.add_light(color=(-1, 0, 0)),
        lambda: world.add_light("point", attenuation=(1, -1, 0)),
        lambda: world.add_light(direction=(0, 0, 0)),
        lambda: world.set_environment(ambient=(-1, 0, 0)),
        lambda: world.set_environment(background=(np.nan, 0, 0)),
    ):
        with pytest.raises(ValueError, match=r"^\w+: "):
            add()
    for name in ("roughness", "metalness", "shininess"):
        for given, said in (
            (np.zeros((4, 6, 3), np.uint8), "a number is expected: it is an array of shape (4, 6, 3)"),
            ([0.1, 0.2], "a number is expected: it is an array of shape (2,)"),
            ("map.png", "a number is expected: it is the text 'map.png'"),
            ("0.5", "a number is expected: it is the text '0.5'"),
            ({}, "a number is expected: "),
        ):
            with pytest.raises(ValueError, match=f"^{name}: {re.escape(said)}"):
                world.add_box((1, 1, 1), **{name: given})
    assert world.bodies == []
    assert world.memory <= before + 4096
    with pytest.raises(TypeError, match="colour"):
        world.add_box((1, 1, 1), colour=(1, 0, 0))
    world.add_light(color=(5, 5, 5))


def test_refused_calls_take_no_memory() -> None:
    world = bv.World()
    world.add_sphere(1)
    triangle, texture = np.eye(3), np.zeros((64, 64, 3), np.uint8)
    adds = (
        lambda: world.add_sphere(-1, texture=texture),
        lambda: world.add_sphere(1, shininess=-1, texture=texture),
        lambda: world.add_mesh(triangle, [[0, 1, 2]], scale=(0, 0, 0), texture=texture),
        lambda: world.add_height_field(np.zeros((9, 9)), (1, 1), scale=(0, 0, 0), texture=texture),
    )

    def try_all() -> int:
        for add in adds:
            with pytest.raises(ValueError, match=r"^(size|shininess|scale): "):
                add()
        return world.memory

    first = try_all()
    for _ in range(20):
        assert try_all() == first
    world.add_sphere(1, texture=texture)
    assert world.memory > first + texture.nbytes


def test_bodies_without_a_name_get_a_free_one() -> None:
    world = bv.World()
    world.add_sphere(1, name="body_1")
    world.add_sphere(1, name="body_3")
    for _ in range(3):
        world.add_sphere(1)
    assert world.bodies == ["body_1", "body_3", "body_2", "body_4", "body_5"]
    # Each name that is taken is skipped only once.
    many = bv.World()
    for number in range(4000):
        many.add_sphere(1, name=f"body_{number + 4000}")
    start = time.process_time()
    for _ in range(4000):
        many.add_sphere(1)
    assert time.process_time() - start < 20
    assert many.bodies[-1] == "body_11999"


def test_worlds_are_copied_and_not_pickled() -> None:
    world = bv.World(SDF)
    for other in (copy.copy(world), copy.deepcopy({"world": world})["world"]):
        other.set_pose("m::l", (3, 0, 0))
        assert ahead(other) == 2.5
        assert ahead(world) == 1.5
    for thing in (world, bv.Batch(world, 1), bv.Simulation("empty")):
        with pytest.raises(TypeError, match=f"a {type(thing).__name__} cannot be pickled: .*create it "):
            pickle.dumps(thing)


#: faulthandler's watchdog needs no lock of the interpreter.
READERS_AND_WRITERS = """
import faulthandler, threading
import numpy as np
import belvedere as bv

faulthandler.dump_traceback_later(60, exit=True)
side = 300
corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).reshape(-1, 1)
faces = np.concatenate([corner + [0, 1, side], corner + [1, side + 1, side]])
place = np.divmod(np.arange(side * side), side)
vertices = np.stack([*place, np.zeros(side * side)], axis=1)
world = bv.World()
world.add_sphere(0.1)
camera = bv.DepthCamera(8, 6, fov=1.0)

def build():
    for number in range(4):
        world.add_mesh(vertices, faces, name=f"mesh_{number}")

def use():
    while builder.is_alive():
        world.set_pose(0, world.pose(0))
        world.bodies, world.instance_bodies
        camera.render(world, [0, 0, 1, 0, 0, 0, 1])

builder = threading.Thread(target=build)
users = [threading.Thread(target=use) for _ in range(2)]
for thread in (builder, *users):
    thread.start()
for thread in (builder, *users):
    thread.join()
print(sum(name.startswith("mesh_") for name in world.bodies))
"""


def test_threads_read_a_world_while_another_adds_a_large_mesh() -> None:
    ran = subprocess.run(
        [sys.executable, "-c", READERS_AND_WRITERS], capture_output=True, text=True, timeout=120, check=False
    )
    assert (ran.returncode, ran.stdout) == (0, "4\n"), ran.stderr


#: The colours of the faces +x, −x, +y, −y, +z and −z.
FACES = np.array([[200, 0, 0], [100, 0, 0], [0, 200, 0], [0, 100, 0], [0, 0, 200], [0, 0, 100]], np.uint8)
#: Directions in which a camera looks, and the quaternion with which it does.
WAYS = {
    "+x": (0, 0, 0, 1),
    "-x": (0, 0, 1, 0),
    "+y": (0, 0, 0.5**0.5, 0.5**0.5),
    "-y": (0, 0, -(0.5**0.5), 0.5**0.5),
    "+z": (0, -(0.5**0.5), 0, 0.5**0.5),
    "-z": (0, 0.5**0.5, 0, 0.5**0.5),
}


def cube(size: int = 2) -> np.ndarray:
    return np.broadcast_to(FACES[:, None, None], (6, size, size, 3))


def middle(world: bv.World, pose: object) -> list[int]:
    """The colour in the middle of a picture."""
    return bv.Camera(9, 9, fov=0.3).render(world, pose)["rgb"][4, 4].tolist()


def test_a_sky_shows_the_faces_of_a_cube_whose_y_axis_is_up() -> None:
    world = bv.World()
    world.set_environment(ambient=(1, 1, 1), background=(1, 0, 1))
    world.set_sky(cube())
    seen = {way: middle(world, (0, 0, 0, *turn)) for way, turn in WAYS.items()}
    faces = dict(zip(("+x", "-x", "+z", "-z", "-y", "+y"), FACES.tolist(), strict=True))
    assert seen == faces
    world.set_sky(np.concatenate([cube(5), np.zeros((6, 5, 5, 1), np.uint8)], axis=-1)[::-1])
    assert middle(world, HERE) == FACES[5].tolist()
    world.set_sky(None)
    assert middle(world, HERE) == [255, 0, 255]


def test_a_sky_that_is_replaced_takes_no_memory() -> None:
    world = bv.World()
    sizes = []
    for _ in range(6):
        world.set_sky(cube(64))
        sizes.append(world.memory)
    # The new one is there before the old one is removed.
    assert max(sizes) < 2.2 * sizes[0]
    assert sizes[2:4] == sizes[4:]
    world.set_sky(None)
    assert world.memory < sizes[0] / 10


def test_a_body_shows_the_faces_of_a_cube() -> None:
    world = bv.World()
    world.set_environment(ambient=(1, 1, 1))
    first = world.add_box((0.5, 1, 2), color=(1, 1, 1), texture=cube())
    for way, turn in WAYS.items():
        axis, sign = "xyz".index(way[1]), 1.0 if way[0] == "+" else -1.0
        place = [0.0, 0.0, 0.0]
        place[axis] = -3.0 * sign
        face = 2 * axis + (sign > 0.0)
        assert middle(world, (*place, *turn)) == FACES[face].tolist(), way
    # A ball with its texture, stretched so far along x that only the faces across it are seen.
    world.add_sphere(0.4, (5, 0, 0), color=(1, 1, 1), texture=first, texture_stretch=(1e3, 1, 1))
    turn = WAYS["-z"]
    assert middle(world, (5.1, 0, 3, *turn)) == FACES[0].tolist()
    assert middle(world, (4.9, 0, 3, *turn)) == FACES[1].tolist()
    copy = world.add_copy(first, (0, 5, 0))
    assert middle(world, (-3, 5, 0, 0, 0, 0, 1)) == FACES[1].tolist()
    assert copy == 2


def test_a_cube_of_faces_of_several_sizes_is_refused() -> None:
    world = bv.World()
    faces = [np.zeros((size, size, 3), np.uint8) for size in (2, 2, 2, 2, 2, 3)]
    with pytest.raises(ValueError, match=r"faces: arrays of several shapes; \(6, size, size, 3 or 4\) of uint8"):
        world.set_sky(faces)
    with pytest.raises(ValueError, match=r"texture: shape \(6, 2, 3, 3\) of uint8; \(6, size, size, 3 or 4\)"):
        world.add_sphere(1, texture=np.zeros((6, 2, 3, 3), np.uint8))
