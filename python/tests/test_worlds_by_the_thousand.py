"""Batches of worlds: shared shapes with individual poses, colours, lamps and noise."""

from __future__ import annotations

import numpy as np
import pytest

import belvedere as bv

HERE = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]


def world() -> bv.World:
    world = bv.World()
    world.set_environment(ambient=(0.5, 0.5, 0.5))
    world.add_box((0.2, 10, 10), (3.1, 0, 0), name="wall", color=(0.5, 0.5, 0.5))
    world.add_sphere(0.5, (2, 0, 0), name="ball", color=(0.5, 0.5, 0.5))
    world.add_light("directional", direction=(1, 0, 0), color=(0.5, 0.5, 0.5))
    return world


def scatter(batch: bv.Batch, index: int, random: np.random.Generator) -> None:
    batch.poses[index, batch.number("ball"), :3] = random.uniform((1.5, -0.5, -0.5), (2.4, 0.5, 0.5))
    batch.colors[index, batch.number("ball")] = random.uniform(0.1, 1.0, 3)
    batch.light_colors[index] = random.uniform(0.2, 0.6)


def test_each_world_is_seen_as_if_it_were_alone() -> None:
    batch = bv.Batch(world(), 9, randomize=scatter, seed=3)
    camera = bv.DepthCamera(48, 36, fov=1.0, noise=0.01)
    frames = batch.render(camera, HERE, channels=("depth", "rgb"))
    assert len(np.unique(frames["depth"].reshape(9, -1), axis=0)) == 9
    for index in (0, 4, 8):
        alone = bv.World()
        ambient, lamp = (0.5, 0.5, 0.5), float(batch.light_colors[index, 0, 0])
        alone.set_environment(ambient=ambient)
        alone.add_box((0.2, 10, 10), (3.1, 0, 0), color=(0.5, 0.5, 0.5))
        alone.add_sphere(0.5, batch.poses[index, 1], color=batch.colors[index, 1])
        alone.add_light("directional", direction=(1, 0, 0), color=(lamp, lamp, lamp))
        own = camera.render(alone, HERE, channels=("depth", "rgb"), seeds=3 + index)
        np.testing.assert_array_equal(own["depth"], frames["depth"][index])
        np.testing.assert_array_equal(own["rgb"], frames["rgb"][index])


def test_results_depend_neither_on_size_nor_threads() -> None:
    camera = bv.Camera(48, 36, fov=1.0, noise=0.02)
    large = bv.Batch(world(), 40, randomize=scatter).render(camera, HERE, threads=3)["rgb"]
    small = bv.Batch(world(), 7, randomize=scatter).render(camera, HERE, threads=1)["rgb"]
    np.testing.assert_array_equal(large[:7], small)


def test_a_mask_leaves_the_others_alone() -> None:
    batch = bv.Batch(world(), 4, randomize=scatter)
    camera = bv.DepthCamera(16, 12, fov=1.0)
    memory = np.full((4, 12, 16), -5.0, np.float32)
    mask = np.array([True, False, True, False])
    frames = batch.render(camera, np.tile(HERE, (4, 1)), {"depth": memory}, mask=mask)
    assert frames["depth"] is memory
    assert (memory[~mask] == -5).all()
    assert (memory[mask] > 0).all()
    assert batch.frames.tolist() == [1, 0, 1, 0]
    assert (batch.render(camera, HERE, mask=mask)["depth"][~mask] == 0).all()


def test_worlds_are_reset() -> None:
    batch = bv.Batch(world(), 3, randomize=scatter, seed=8)
    first = batch.poses.copy()
    batch.reset(np.array([False, True, False]))
    assert batch.episodes.tolist() == [0, 1, 0]
    assert (batch.poses[[0, 2]] == first[[0, 2]]).all()
    assert (batch.poses[1] != first[1]).any()
    again = bv.Batch(world(), 3, randomize=scatter, seed=8)
    np.testing.assert_array_equal(again.poses, first)
    plain = bv.Batch(world(), 2)
    assert np.isnan(plain.colors).all()
    np.testing.assert_array_equal(plain.poses[:, 1], [[2, 0, 0, 0, 0, 0, 1]] * 2)


def test_noise_differs_in_each_frame() -> None:
    batch = bv.Batch(world(), 2)
    camera = bv.DepthCamera(16, 12, fov=1.0, noise=0.01)
    first, second = (batch.render(camera, HERE)["depth"] for _ in range(2))
    assert (first != second).any()
    batch.reset()
    np.testing.assert_array_equal(batch.render(camera, HERE)["depth"], first)


def test_later_changes_of_the_world_are_not_seen() -> None:
    shared = world()
    batch = bv.Batch(shared, 2)
    camera = bv.DepthCamera(5, 5, fov=0.1)
    before = batch.render(camera, HERE)["depth"]
    shared.set_pose("ball", (1, 0, 0))
    shared.add_box((1, 1, 1), (1, 0, 0))
    np.testing.assert_array_equal(batch.render(camera, HERE)["depth"], before)


def test_lamps_move() -> None:
    batch = bv.Batch(world(), 2)
    batch.light_vectors[1, 0] = (-1, 0, 0)
    pictures = batch.render(bv.Camera(16, 12, fov=1.0), HERE)["rgb"]
    assert pictures[0].mean() > pictures[1].mean() + 20


def test_textures_can_be_removed() -> None:
    pictured = bv.World()
    pictured.set_environment(ambient=(1, 1, 1))
    picture = np.full((4, 4, 3), (255, 0, 102), np.uint8)
    pictured.add_box((0.2, 10, 10), (3.1, 0, 0), name="wall", color=(0.4, 0.4, 0.4), texture=picture)
    batch = bv.Batch(pictured, 3)
    batch.textured[1:] = False
    batch.colors[2] = (0, 0.2, 0.6)
    frames = batch.render(bv.Camera(8, 6, fov=0.5), HERE)["rgb"].reshape(3, -1, 3)
    # Ambient light is 1, so a pixel is 255 times colour and texture.
    for seen, expected in zip(frames, [(102, 0, 41), (102, 102, 102), (0, 51, 153)], strict=True):
        np.testing.assert_array_equal(seen, np.broadcast_to(expected, seen.shape))
    batch.reset()
    assert batch.textured.all()


def test_memory_of_a_world_of_forty_bodies() -> None:
    many = bv.World()
    for index in range(40):
        many.add_sphere(0.1, (index, 0, 0))
    assert bv.Batch(many, 16).memory < 64 * 1024


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"mask": np.ones(3, bool)}, r"mask: shape \(3,\) of bool; \(2,\) of bool is expected"),
        ({"mask": [1, 0]}, r"mask: shape \(2,\) of int64; .*: np\.array\(mask, bool\)"),
        ({"sensor": None}, "sensor: a Camera, Lidar or other Sensor is expected, not NoneType"),
        ({"poses": [HERE] * 3}, r"poses: poses of shape \(3,\); \(2,\), one for each world"),
        ({"after": [HERE] * 3}, r"after: poses of shape \(3,\)"),
        ({"channels": "flow"}, r"channels: 'flow' needs the poses"),
    ],
)
def test_arguments(arguments: dict[str, object], words: str) -> None:
    batch = bv.Batch(world(), 2)
    with pytest.raises(ValueError, match=words):
        batch.render(**{"sensor": bv.Camera(8, 6, 1.0), "poses": HERE, **arguments})  # type: ignore[arg-type]
    assert batch.frames.tolist() == [0, 0]


@pytest.mark.parametrize(
    ("name", "place", "value", "words"),
    [
        ("poses", (2, 1, 0), np.nan, r"batch\.poses: pose \[2, 1\], of body 'ball', is not finite"),
        (
            "colors",
            (2, 1, 0),
            0.5,
            r"batch\.colors: of world 2, body 'ball', numbers from 0 to 1 .*\[0\.5, nan, nan\]",
        ),
        ("colors", (2, 1), np.inf, r"batch\.colors: of world 2, body 'ball', .*\[inf, inf, inf\]"),
        ("colors", (2, 1), 1.5, r"batch\.colors: of world 2, body 'ball', "),
        ("light_colors", (2, 0, 1), -0.5, r"batch\.light_colors: of world 2, lamp 0, finite numbers of 0 or more"),
        ("light_vectors", (2, 0), np.nan, r"batch\.light_vectors: of world 2, lamp 0, "),
        ("light_vectors", (2, 0), 0, r"batch\.light_vectors: of world 2, lamp 0, a direction of any length but 0"),
        ("ambient", (2, 2), np.nan, r"batch\.ambient: of world 2, finite numbers of 0 or more"),
    ],
)
def test_nothing_is_written_when_one_world_is_wrong(
    name: str, place: tuple[int, ...], value: float, words: str
) -> None:
    batch = bv.Batch(world(), 3)
    getattr(batch, name)[place] = value
    memory = np.full((3, 6, 8, 3), 77, np.uint8)
    with pytest.raises(ValueError, match=words):
        batch.render(bv.Camera(8, 6, 1.0), HERE, {"rgb": memory}, threads=1)
    assert (memory == 77).all()
    assert batch.frames.tolist() == [0, 0, 0]
    batch.reset()
    batch.render(bv.Camera(8, 6, 1.0), HERE)


def test_lists_instead_of_arrays() -> None:
    batch, other = bv.Batch(world(), 2), bv.Batch(world(), 2)
    camera = bv.Camera(8, 6, 1.0, noise=0.01)
    batch.frames, batch.seeds, batch.ambient = [4, 6], [3, 5], [[0.1] * 3, [0.2] * 3]  # type: ignore[assignment]
    other.frames[:], other.seeds[:], other.ambient[:] = (4, 6), (3, 5), ((0.1,), (0.2,))
    np.testing.assert_array_equal(batch.render(camera, HERE)["rgb"], other.render(camera, HERE)["rgb"])
    assert batch.frames.tolist() == [5, 7]
    batch.frames = np.array([1, 2])
    batch.render(camera, HERE)
    assert batch.frames.tolist() == [2, 3]
    batch.frames = [-1, 0]  # type: ignore[assignment]
    with pytest.raises(ValueError, match=r"batch\.frames: shape \(2,\) of int64; .* 0 or more"):
        batch.render(camera, HERE)
    batch.frames = [8, 9]  # type: ignore[assignment]
    batch.reset()
    assert batch.frames.tolist() == [0, 0]
    np.testing.assert_array_equal(batch.ambient, np.full((2, 3), 0.5, np.float32))


def test_a_sensor_with_the_same_motion_in_all_worlds() -> None:
    batch = bv.Batch(world(), 2)
    flow = batch.render(bv.Camera(8, 6, 1.0), HERE, after=[0.1, *HERE[1:]], channels="flow")["flow"]
    assert (flow[0] != 0).any()
    np.testing.assert_array_equal(flow[0], flow[1])


def test_replaced_arrays_are_checked() -> None:
    batch = bv.Batch(world(), 2)
    batch.poses = np.zeros((2, 1, 7))
    with pytest.raises(ValueError, match=r"batch\.poses: shape \(2, 1, 7\); \(2, 2, 7\) is expected"):
        batch.render(bv.Camera(8, 6, 1.0), HERE)
    with pytest.raises(ValueError, match="n: a whole number"):
        bv.Batch(world(), 0)
