"""Batches: the same bytes in any batch, and rendering into the caller's memory."""

from __future__ import annotations

import contextlib
import os
import signal
import threading
import time

import numpy as np
import pytest

import belvedere as bv

CHANNELS = ("depth", "rgb", "instance", "normal", "points")


@pytest.fixture(scope="module")
def world() -> bv.World:
    return bv.World("playground")


def somewhere(count: int) -> np.ndarray:
    """Return reproducible random poses."""
    random = np.random.default_rng(5)
    poses = np.zeros((count, 7))
    poses[:, :2] = random.uniform(-3, 3, (count, 2))
    poses[:, 2] = random.uniform(0.1, 1.5, count)
    turns = random.normal(size=(count, 4))
    poses[:, 3:] = turns / np.linalg.norm(turns, axis=1, keepdims=True)
    return poses


def test_an_element_is_the_same_in_every_batch(world: bv.World) -> None:
    camera = bv.DepthCamera(96, 64, fov=1.2, model="kinect_v1")
    poses, seeds = somewhere(12), np.arange(100, 112)
    whole = camera.render(world, poses, channels=CHANNELS, seeds=seeds)
    for threads in (1, 2, 5):
        again = camera.render(world, poses, channels=CHANNELS, seeds=seeds, threads=threads)
        for name in CHANNELS:
            np.testing.assert_array_equal(whole[name], again[name])
    order = np.random.default_rng(1).permutation(12)
    shuffled = camera.render(world, poses[order], channels=CHANNELS, seeds=seeds[order])
    grid = camera.render(world, poses.reshape(3, 4, 7), channels=CHANNELS, seeds=seeds.reshape(3, 4))
    one = camera.render(world, poses[7], channels=CHANNELS, seeds=int(seeds[7]))
    for name in CHANNELS:
        np.testing.assert_array_equal(whole[name][order], shuffled[name])
        np.testing.assert_array_equal(whole[name].reshape(grid[name].shape), grid[name])
        np.testing.assert_array_equal(whole[name][7], one[name])


def test_few_large_frames_are_the_same_on_many_threads(world: bv.World) -> None:
    camera = bv.Camera(640, 480, fov=1.0)
    one = camera.render(world, somewhere(1), threads=1)["rgb"]
    several = camera.render(world, somewhere(1), threads=4)["rgb"]
    np.testing.assert_array_equal(one, several)


def test_frames_go_into_the_callers_memory(world: bv.World) -> None:
    camera = bv.DepthCamera(32, 24, fov=1.0)
    memory = np.full((6, 24, 32), -1.0, np.float32)
    part = memory[1:4]
    frames = camera.render(world, somewhere(3), out={"depth": part}, channels=("depth", "instance"))
    assert frames["depth"] is part
    assert frames["instance"].shape == (3, 24, 32)
    assert (memory[[0, 4, 5]] == -1).all()
    assert (memory[1:4] > 0).all()
    np.testing.assert_array_equal(camera.render(world, somewhere(3))["depth"], part)


class Foreign:
    """An array of another library, such as PyTorch: not an ndarray, but with DLPack and a view for numpy."""

    def __init__(self, array: np.ndarray) -> None:
        self.array = array

    def __dlpack__(self, **arguments: object) -> object:
        return self.array.__dlpack__(**arguments)

    def __dlpack_device__(self) -> tuple[int, int]:
        return self.array.__dlpack_device__()

    def __array__(self, *_: object, **__: object) -> np.ndarray:
        return self.array


class Copied(Foreign):
    """An array that gives numpy a copy."""

    def __array__(self, *_: object, **__: object) -> np.ndarray:
        return self.array.copy()


def test_arrays_of_other_libraries_by_dlpack(world: bv.World) -> None:
    camera = bv.DepthCamera(32, 24, fov=1.0)
    poses, memory = somewhere(3), np.zeros((3, 24, 32), np.float32)
    frames = camera.render(world, Foreign(poses), out={"depth": Foreign(memory)})
    np.testing.assert_array_equal(frames["depth"], memory)
    np.testing.assert_array_equal(camera.render(world, poses)["depth"], memory)
    np.testing.assert_array_equal(np.from_dlpack(frames["depth"]), memory)
    # The result is written to the given memory, or refused: numpy before 2.2 does not write through DLPack.
    is_refused = np.lib.NumpyVersion(np.__version__) < "2.2.0"
    memory[:] = 0
    with pytest.raises(ValueError, match="it is read-only") if is_refused else contextlib.nullcontext():
        camera.render(world, poses, out={"depth": Copied(memory)})
    assert memory.any() != is_refused
    memory.flags.writeable = False
    with pytest.raises(ValueError, match=r"out\['depth'\]: .*read-?only"):
        camera.render(world, poses, out={"depth": Foreign(memory)})


def test_threads_share_a_world(world: bv.World) -> None:
    camera = bv.Camera(64, 48, fov=1.0)
    poses = somewhere(16)
    expected = camera.render(world, poses)["rgb"]
    frames: list[np.ndarray] = []
    workers = [threading.Thread(target=lambda: frames.append(camera.render(world, poses)["rgb"])) for _ in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert len(frames) == 4
    for frame in frames:
        np.testing.assert_array_equal(frame, expected)


def test_a_world_changes_beside_a_batch() -> None:
    world = bv.World()
    world.add_box((1, 1, 1), (3, 0, 0))
    camera = bv.DepthCamera(64, 48, fov=1.0)
    stop = threading.Event()

    def add() -> None:
        count = 0
        while not stop.is_set() and count < 200:
            world.add_sphere(0.1, (0, count, 50))
            count += 1

    worker = threading.Thread(target=add)
    worker.start()
    for _ in range(20):
        depth = camera.render(world, np.tile([0, 0, 0, 0, 0, 0, 1], (64, 1)))["depth"]
        assert (depth[:, 24, 32] == 2.5).all()
    stop.set()
    worker.join()


@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_forked_child_has_threads_of_its_own(world: bv.World) -> None:
    camera = bv.Camera(160, 120, fov=1.0)
    expected = camera.render(world, somewhere(8), threads=2)["rgb"]
    child = os.fork()
    if child == 0:
        same = (camera.render(world, somewhere(8), threads=2)["rgb"] == expected).all()
        os._exit(0 if same else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def test_threads_of_few_sizes_are_kept(world: bv.World) -> None:
    def count() -> int:
        return len(os.listdir("/proc/self/task"))

    most = count() + 14 + 15
    camera = bv.Camera(200, 200, fov=1.0)
    for threads in range(2, 16):
        camera.render(world, somewhere(1), threads=threads)
    # The threads end a moment later.
    deadline = time.monotonic() + 30
    while count() > most and time.monotonic() < deadline:
        time.sleep(0.05)
    assert count() <= most


@pytest.mark.parametrize("threads", [1, 2])
def test_frames_end_at_ctrl_c(world: bv.World, threads: int) -> None:
    # Frames that are never reached use no memory.
    memory = np.zeros((20_000, 120, 160), np.uint8)
    camera = bv.Camera(160, 120, fov=1.0, grey=True, smooth=True)
    poses = np.tile([-2, 0, 0.4, 0, 0, 0, 1.0], (20_000, 1))

    def press() -> None:
        while memory[0, 100, 80] == 0:
            time.sleep(0.01)
        os.kill(os.getpid(), signal.SIGINT)

    worker = threading.Thread(target=press)
    with pytest.raises(KeyboardInterrupt):  # noqa: PT012
        worker.start()
        camera.render(world, poses, {"rgb": memory}, threads=threads)
    worker.join()
    written = memory[:, 100, 80] != 0
    assert 0 < written.sum() < 20_000
    # The frames that were written are complete.
    np.testing.assert_array_equal(memory[written][-1], camera.render(world, poses[0])["rgb"])


def test_arbitrary_rays() -> None:
    world = bv.World()
    vertices = np.array([[2, -1, -1], [2, 1, -1], [2, 1, 1], [2, -1, 1]], float)
    world.add_mesh(vertices, [[0, 2, 1], [0, 3, 2]], name="square")
    world.add_sphere(1.0, (0, 0, 10))
    origins = np.array([[0, 0.5, -0.5], [0, -0.5, 0.5], [0, 0, 5], [0, 0, -5]])
    directions = np.array([[1, 0, 0], [2, 0, 0], [0, 0, 1], [0, 0, -1]], float)
    hits = world.cast(origins, directions)
    np.testing.assert_allclose(hits["distance"], [2, 1, 4, np.inf])
    np.testing.assert_array_equal(hits["instance"], [0, 0, 1, 2**32 - 1])
    np.testing.assert_array_equal(hits["primitive"][:2], [0, 1])
    np.testing.assert_allclose(hits["normal"], [[-1, 0, 0], [-1, 0, 0], [0, 0, -1], [0, 0, 0]], atol=1e-6)
    # The weights reproduce the point.
    corners = vertices[[0, 2, 1]]
    first, second = hits["barycentrics"][0]
    point = (1 - first - second) * corners[0] + first * corners[1] + second * corners[2]
    np.testing.assert_allclose(point, [2, 0.5, -0.5], atol=1e-6)
    moved = world.cast((0, 0, 0), directions, bodies={"square": (1, 0, 0, 0, 0, 0, 1)}, channels=("distance",))
    np.testing.assert_allclose(moved["distance"], [3, 1.5, 9, np.inf])
    near = world.cast((0, 0, 0), directions, ranges=np.tile([0.0, 1.2], (4, 1)), channels="distance")
    np.testing.assert_allclose(near["distance"], [np.inf, 1, np.inf, np.inf])


def test_casts_are_the_same_on_any_threads(world: bv.World) -> None:
    random = np.random.default_rng(2)
    origins, directions = random.uniform(-3, 3, (50_000, 3)), random.normal(size=(50_000, 3))
    one = world.cast(origins, directions, threads=1, sees="all")
    two = world.cast(origins, directions, threads=3, sees="all")
    half = world.cast(origins[::2], directions[::2], sees="all")
    for name, values in one.items():
        np.testing.assert_array_equal(values, two[name])
        np.testing.assert_array_equal(values[::2], half[name])


def test_more_rays_than_are_cast_at_a_time(world: bv.World) -> None:
    random = np.random.default_rng(2)
    origins, directions = random.uniform(-1, 1, (1_100_000, 3)), random.normal(size=(1_100_000, 3))
    ranges = np.tile([0.1, 3.0], (1_100_000, 1))
    all_ = world.cast(origins, directions, ranges=ranges)
    last = world.cast(origins[-100_000:], directions[-100_000:], ranges=ranges[-100_000:])
    from_one = world.cast(origins[0], directions, channels="distance")["distance"]
    for name, values in last.items():
        np.testing.assert_array_equal(values, all_[name][-100_000:])
    np.testing.assert_array_equal(
        from_one[-100_000:], world.cast(origins[0], directions[-100_000:], channels="distance")["distance"]
    )
