"""Compares Belvedere with the libraries that a user might choose instead, on the same scenes, poses and outputs.

    python benches/python/compare.py [--seconds 1.0] [--rounds 5] [--threads 1,2] [--scene WORD]

Peers that are not installed are reported and left out: open3d (or open3d-cpu), embreex with trimesh, mujoco, pybullet,
pyrender. Scenes whose shapes are in a missing package are left out too: mjlab has the Unitree G1, dm_control a humanoid of
capsules; MuJoCo reads both.

All libraries are measured alternately in each round. A rate is the median of the rounds, a ratio the median of their
ratios, with the least and the greatest. With one thread, processor time is measured, with more, wall time.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib
import os
import statistics
import time
from collections import defaultdict
from collections.abc import Callable

# Set before any library starts threads.
os.environ.setdefault("MUJOCO_GL", "egl")
os.environ.setdefault("PYOPENGL_PLATFORM", "egl")
os.environ.setdefault("LP_NUM_THREADS", "1")

import numpy as np
from costs import memory, overhead
from peers import PEERS, WITH_SHAPES, Peer
from scenes import SCENES, Scene

#: The number of frames whose depths are compared.
LOOKS = (0, 9, 18, 27)
#: Sizes and channels of the frames.
FRAMES = (
    ((64, 64), ("depth",)),
    ((128, 128), ("depth",)),
    ((640, 480), ("depth",)),
    ((64, 64), ("depth", "rgb")),
    ((128, 128), ("depth", "rgb")),
)


def rate(peer: Peer, first: int, seconds: float, clock: Callable[[], float]) -> tuple[float, int]:
    """Return frames per second, and the number of the next frame."""
    index, start = first, clock()
    while (past := clock() - start) < seconds:
        peer.take(index)
        index += peer.batch
    return (index - first) / past, index


def agreement(ours: Peer, theirs: Peer) -> float:
    """Return the share of pixels whose depths differ by less than 2 cm."""
    shares = []
    for index in LOOKS:
        one, other = (np.asarray(peer.depth(index), np.float64) for peer in (ours, theirs))
        shares.append(
            np.isclose(np.where(one > 30, 99, one), np.where(other > 30, 99, other), rtol=1e-5, atol=0.02)
        )
    return float(np.mean(shares))


def compare(
    scene: Scene,
    size: tuple[int, int],
    channels: tuple[str, ...],
    threads: int,
    arguments: argparse.Namespace,
    missing: dict[str, str],
) -> str:
    """Print a row for each peer. Return a row with Belvedere's rate, and how many times as fast as each peer it is."""
    peers: dict[str, Peer] = {}
    for name, make in PEERS.items():
        if "rgb" in channels and name in ("open3d", "embreex", "mj_multiRay"):
            continue
        try:
            peer = make(scene, *size, threads, channels)
            peer.take(0)
            peers[name] = peer
        except NotImplementedError:
            pass
        except Exception as error:  # anything that is missing in a peer's installation
            missing[name if isinstance(error, ImportError) else f"{name}, {scene.name}"] = why(error)
    clock = time.process_time if threads == 1 else time.perf_counter
    rates: dict[str, list[float]] = {name: [] for name in peers}
    turns = dict.fromkeys(peers, 0)
    for _ in range(arguments.rounds):
        for name, peer in peers.items():
            each, turns[name] = rate(peer, turns[name], arguments.seconds / arguments.rounds, clock)
            rates[name].append(each)
    what = "RGB-D" if "rgb" in channels else "depth"
    summary = dict.fromkeys(PEERS, "")
    for name, peer in peers.items():
        row = [scene.name, f"{what} {size[0]}x{size[1]}", str(threads), name]
        row.append(f"{statistics.median(rates[name]):,.{0 if rates[name][0] >= 100 else 1}f}")
        summary[name] = row[-1]
        if name == "belvedere":
            row += ["", ""]
        else:
            ratios = sorted(ours / theirs for ours, theirs in zip(rates["belvedere"], rates[name], strict=True))
            row += [f"{statistics.median(ratios):.1f} ({ratios[0]:.1f} to {ratios[-1]:.1f})"]
            if name != "belvedere, meshes":
                middle = statistics.median(ratios)
                summary[name] = f"{middle:.{1 if middle < 10 else 0}f}×"
            same = "belvedere" if name in WITH_SHAPES else "belvedere, meshes"
            row += [f"{agreement(peers.get(same, peers['belvedere']), peer):.1%}"]
        print(f"| {' | '.join(row)} |", flush=True)
    for peer in peers.values():
        peer.close()
    return f"| {scene.name} | {what} {size[0]} × {size[1]} | {' | '.join(summary.values())} |"


def why(error: Exception) -> str:
    return f"{type(error).__name__}: {str(error).splitlines()[0][:100] if str(error) else ''}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=1.0, help="time for each figure, over all rounds")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--threads", default="1,2")
    parser.add_argument("--scene", default="", help="part of a scene's name")
    arguments = parser.parse_args()
    missing: dict[str, str] = {}
    with contextlib.suppress(ImportError):
        importlib.import_module("pybullet")  # it prints a line
    scenes = []
    for make in SCENES:
        try:
            scenes.append(make())
        except ImportError as error:
            missing[f"scene {make.__name__}"] = why(error)
    print(
        "| scene | frame | threads | who | frames/s | belvedere is faster, times | same depth |\n"
        "|---|---|---|---|---:|---:|---:|"
    )
    summaries: dict[int, list[str]] = defaultdict(list)
    for scene in scenes:
        if arguments.scene not in scene.name:
            continue
        for threads in (int(number) for number in arguments.threads.split(",")):
            for size, channels in FRAMES:
                summaries[threads] += [compare(scene, size, channels, threads, arguments, missing)]
    for threads, rows in summaries.items():
        print(f"\nthreads={threads}: Belvedere's frames per second, and how many times as fast as the others it is\n")
        print(f"| scene | frame | {' | '.join(PEERS)} |\n|---|---|{'---:|' * len(PEERS)}")
        print("\n".join(rows))
    overhead(scenes[0], arguments)
    memory()
    print()
    for scene in scenes:
        print(f"{scene.name}: {len(scene.parts)} bodies, {scene.triangles:,} triangles")
    for name, reason in missing.items():
        print(f"left out: {name} ({reason})")


if __name__ == "__main__":
    main()
