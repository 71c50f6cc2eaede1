"""Measures the overhead of Belvedere apart from its frames: of a call from Python, and of a world in a batch."""

from __future__ import annotations

import argparse
import multiprocessing
import os
import pathlib
import statistics
import time

import numpy as np
from scenes import Scene, balls

import belvedere as bv


class Unwanted:
    """Belvedere's native sensor with all frames skipped, so that only the overhead of a call remains."""

    def __init__(self, native: object) -> None:
        self.native = native

    def render(self, world, now, after, before, each, *rest) -> None:
        self.native.render(world, now, after, before, (*each[:2], [False] * len(each[0]), None), *rest)


def overhead(scene: Scene, arguments: argparse.Namespace) -> None:
    """Measure the overhead of a call without its frames, one thread, 64x64.

    There are two ways. First, calls whose frames are skipped do everything except rendering. Second, a + b·N is fitted
    to the times of calls with N frames: a is the overhead of a call, and b includes Python's overhead for each frame.
    """
    counts = (1, 16, 256, 8192)
    out = {"depth": np.empty((max(counts), 64, 64), np.float32)}
    full, empty = bv.DepthCamera(64, 64, fov=scene.fov), bv.DepthCamera(64, 64, fov=scene.fov)
    empty._native = Unwanted(empty._native)
    poses = np.resize(scene.poses, (max(counts), 7))

    def cost(camera: bv.DepthCamera, count: int) -> float:
        """Return the time of a call in microseconds. Together the calls render all poses, even if each has few."""
        calls = 0
        arrays = {"depth": out["depth"][:count]}
        start = time.process_time()
        while (past := time.process_time() - start) < arguments.seconds / arguments.rounds:
            for first in range(0, max(count, len(scene.poses)), count):
                camera.render(scene.world, poses[first : first + count], out=arrays, threads=1)
                calls += 1
        return past / calls * 1e6

    rounds: list[tuple[np.ndarray, np.ndarray]] = []
    for _ in range(max(5, arguments.rounds)):
        both = np.array([[cost(camera, count) for camera in (full, empty)] for count in counts])
        rounds.append((both[:, 0], both[:, 1]))
    fits = np.array([fit(np.array(counts, float), costs) for costs, _ in rounds])
    print(
        "\n| frames of a call | call, µs | without its frames, µs | share | a / (a + b·N) |\n|---|---|---|---|---|"
    )
    for row, count in enumerate(counts):
        shares = [besides[row] / costs[row] for costs, besides in rounds]
        fitted = fits[:, 0] / (fits[:, 0] + fits[:, 1] * count)
        costs, besides = np.median([[one[row] for one in both] for both in rounds], axis=0)
        print(f"| {count:,} | {costs:,.1f} | {besides:,.1f} | {spread(shares, '.2%')} | {spread(fitted, '.2%')} |")
    a, b = (spread(values, ".1f") for values in fits.T)
    print(f"a = {a} µs per call, b = {b} µs per frame; medians, least to greatest")


def fit(counts: np.ndarray, costs: np.ndarray) -> np.ndarray:
    """Fit a and b of a + b·N by least squares of relative errors, so that small calls count as well."""
    return np.linalg.lstsq(np.stack([1 / costs, counts / costs], axis=1), np.ones(len(costs)), rcond=None)[0]


def spread(values: list[float] | np.ndarray, form: str) -> str:
    return f"{statistics.median(values):{form}} ({min(values):{form}} to {max(values):{form}})"


def resident() -> int:
    """Return the resident memory of this process in bytes."""
    return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def growth(count: int, answer: multiprocessing.Queue) -> None:
    """Return the growth of this process by a batch of worlds, and the growth after a frame of each world."""
    scene, camera = balls(), bv.DepthCamera(8, 8, fov=1.2)
    bv.Batch(scene.world, 1).render(camera, scene.poses[0], threads=1)
    out = {"depth": np.ones((count, 8, 8), np.float32)}
    before = resident()
    batch = bv.Batch(scene.world, count)
    made = resident() - before
    batch.render(camera, scene.poses[0], out, threads=1)
    answer.put((made, resident() - before))


def memory() -> None:
    """Measure the memory of a world in a batch, apart from shared data: of its arrays, and of a new process."""
    start, counts = multiprocessing.get_context("spawn"), (1_000, 11_000)
    grown = []
    for count in counts:
        answer = start.Queue()
        process = start.Process(target=growth, args=(count, answer))
        process.start()
        grown.append(answer.get(timeout=60))
        process.join()
    made, after = ((more - less) / (counts[1] - counts[0]) / 1024 for less, more in zip(*grown, strict=True))
    one = bv.Batch(balls().world, 1)
    print(
        f"\na world of {len(one.bodies)} bodies in a batch: its arrays {one.memory / 1024:.2f} KB; resident, between "
        f"{counts[0]:,} and {counts[1]:,} worlds, {made:.2f} KB each, {after:.2f} KB when a frame of each was taken"
    )
