"""Bodies that share the triangles and the texture of another."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import belvedere as bv

LOOK = [0, 0, 0, 0, 0, 0, 1]


def sheet(world: bv.World, x: float, **look: Any) -> int:
    """Add a square of two metres that faces a camera at the origin."""
    vertices = [[x, -1, -1], [x, 1, -1], [x, 1, 1], [x, -1, 1]]
    return world.add_mesh(vertices, [[0, 2, 1], [0, 3, 2]], uvs=[[1, 0], [0, 0], [0, 1], [1, 1]], **look)


def seen(world: bv.World, channel: str = "rgb") -> Any:
    world.set_environment(ambient=(1, 1, 1), background=(0, 0, 0))
    return bv.Camera(8, 8, fov=0.5).render(world, LOOK, channels=(channel,))[channel]


def large(world: bv.World, **look: Any) -> int:
    random = np.random.default_rng(0)
    return world.add_mesh(random.random((3000, 3)), np.arange(3000).reshape(-1, 3), **look)


def test_a_copy_shares_triangles_and_texture() -> None:
    texture = np.random.default_rng(1).integers(0, 255, (256, 256, 3), np.uint8)
    world = bv.World()
    first = large(world, texture=texture, name="first")
    before = world.memory
    for _ in range(20):
        world.add_copy(first)
    assert before > 400_000
    assert world.memory < before + 20 * 1000
    again = world.memory
    large(world, texture=first)
    assert world.memory - again < before - 300_000, "the texture is shared, the triangles are not"
    assert len(world.bodies) == 22


def test_a_copy_looks_like_its_original_but_for_what_is_given() -> None:
    texture = np.zeros((128, 128, 3), np.uint8)
    texture[:64] = 200
    world = bv.World()
    sheet(world, 30.0, texture=texture, name="far", class_id=7, seen_by="visual", laser_retro=3.0)
    alone = seen(world)
    nearer = world.add_copy("far", (-10, 0, 0), name="near", scale=(1, 2.0 / 3, 2.0 / 3))
    assert world.bodies == ["far", "near"]
    assert world.pose(nearer)[:3].tolist() == [-10, 0, 0]
    world.set_pose("far", (0, 100, 0))
    assert (seen(world) == alone).all()
    assert set(np.unique(seen(world, "class"))) <= {0, 7}
    assert np.isinf(bv.Lidar(1).render(world, LOOK)["range"]).all(), "lidars do not see the copy either"
    world.add_copy("near", (-25, 0, 0), color=(1, 0.5, 0), class_id=9)
    picture = seen(world)
    # A pixel is as wide as a quarter of the texture, so a little of the other half is in its mean.
    np.testing.assert_allclose(picture[3, 4], [200, 100, 0], atol=6)
    np.testing.assert_allclose(picture[4, 4], [0, 0, 0], atol=6)
    assert seen(world, "class")[3, 4] == 9


def test_a_batch_colours_each_copy_alone() -> None:
    world = bv.World()
    sheet(world, 5.0, name="one", color=(1, 1, 1))
    world.add_copy("one", (0, 100, 0), name="two")
    world.set_environment(ambient=(1, 1, 1))
    batch = bv.Batch(world, n=1)
    batch.colors[0, batch.number("two")] = (1, 0, 0)
    assert batch.render(bv.Camera(8, 8, fov=0.2), LOOK)["rgb"][0, 4, 4].tolist() == [255, 255, 255]


def test_solids_and_mirrored_copies() -> None:
    world = bv.World()
    world.add_sphere(0.5, (3, 0, 0))
    world.add_copy(0, (3, 0, 3), scale=2.0 * np.ones(3))
    hit = world.cast([0, 0, 3], [[1.0, 0.0, 0.0]])
    assert hit["distance"][0] == pytest.approx(2.0)
    wedge = bv.World()
    wedge.add_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    wedge.add_copy(0, scale=(-1, 1, 1))
    both = wedge.cast([[0.3, 0.3, 5], [-0.3, 0.3, 5]], [[0.0, 0.0, -1.0]] * 2, faces="front")
    assert both["distance"].tolist() == [5.0, 5.0], "the outside stays the outside"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"body": "three"}, "body: there is no body 'three'; there are ball, other"),
        ({"body": 2}, "body: there is no body 2; the world has 2"),
        ({"name": "other"}, 'name: there is a body "other" already'),
        ({"scale": (1, 0, 1)}, "scale: a scale is not between"),
        ({"color": (1, 2, 0)}, "color: numbers from 0 to 1"),
        ({"class_id": -1}, "class_id: a whole number from 0"),
        ({"pose": (1, 2)}, "pose: shape"),
    ],
)
def test_bad_input_adds_nothing(arguments: dict[str, Any], words: str) -> None:
    world = bv.World()
    world.add_sphere(1, name="ball")
    world.add_sphere(1, name="other")
    memory = []
    for _ in range(3):
        with pytest.raises(ValueError, match=words):
            world.add_copy(**{"body": "ball", **arguments})
        memory.append(world.memory)
    assert world.bodies == ["ball", "other"]
    assert memory[2] == memory[0]


def test_what_has_no_shape_or_texture_to_share() -> None:
    room = bv.World("playground")
    with pytest.raises(ValueError, match=r"body: .* was read from a file; one that was added is expected"):
        room.add_copy(0)
    world = bv.World()
    world.add_box((1, 1, 1))
    for body in (0, 5):
        with pytest.raises(ValueError, match=f"texture: body {body} was not added with a texture"):
            world.add_box((1, 1, 1), texture=body)
    with pytest.raises(ValueError, match="texture: a whole number from 0"):
        world.add_box((1, 1, 1), texture=-1)
    assert len(world.bodies) == 1
