"""Compares the speed of `belvedere.mujoco` with other libraries that see models of MuJoCo, on one core.

The libraries take turns in one process, and the least processor time of a frame counts, so that other programs on the
machine hardly matter. Libraries and packages of robots that are not installed are left out.

    MUJOCO_GL=egl LP_NUM_THREADS=1 python benches/mujoco/compare.py
"""

from __future__ import annotations

import argparse
import importlib.metadata
import logging
import platform
import sys
import time
import traceback
from collections.abc import Callable

import mujoco
import numpy as np
from peers import CASES, PEERS, Case, Peer
from scenes import SCENES

#: A measurement takes at least this many seconds.
LEAST = 0.02
PACKAGES = (
    "belvedere",
    "mujoco",
    "mujoco-warp",
    "warp-lang",
    "newton",
    "open3d",
    "open3d-cpu",
    "dm_control",
    "mjlab",
    "robosuite",
)


def seconds(take: Callable[[], object], least: float) -> float:
    """Return the processor time of one call."""
    calls, start = 0, time.process_time()
    while True:
        take()
        calls += 1
        passed = time.process_time() - start
        if passed >= least:
            return passed / calls


def prepare(case: Case, model: mujoco.MjModel, data: mujoco.MjData, names: list[str]) -> dict[str, Peer]:
    ready = {}
    for name in names:
        try:
            peer = PEERS[name](case, model, data)
            peer.take()
            ready[name] = peer
        except (ImportError, NotImplementedError) as why:
            print(f"  {name}: left out: {why}", file=sys.stderr)
        except Exception:
            print(f"  {name}: failed\n{traceback.format_exc(limit=-2)}", file=sys.stderr)
    return ready


def agreement(ours: np.ndarray, theirs: np.ndarray) -> float:
    """Return the fraction of the distances that are within 2 cm, or infinite in both."""
    with np.errstate(invalid="ignore"):
        return float(((np.abs(ours - theirs) < 0.02) | ((ours > 100.0) & (theirs > 100.0))).mean())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--scenes", default="", help="parts of the names of scenes, with commas between them")
    parser.add_argument("--cases", default="", help="likewise of cases")
    parser.add_argument("--peers", default="", help="likewise of libraries; belvedere is always there")
    asked = parser.parse_args()
    logging.getLogger("belvedere").setLevel(logging.ERROR)

    def wanted(name: str, parts: str) -> bool:
        return any(part in name for part in parts.split(","))

    names = [name for name in PEERS if name == "belvedere" or wanted(name, asked.peers)]
    with open("/proc/cpuinfo") as file:
        cpu = next(
            (line.split(":")[1].strip() for line in file if line.startswith("model name")), platform.machine()
        )
    versions = []
    for package in PACKAGES:
        try:
            versions.append(f"{package} {importlib.metadata.version(package)}")
        except importlib.metadata.PackageNotFoundError:
            continue
    print(f"{cpu}; {', '.join(versions)}\n")
    print("| scene | frame | " + " | ".join(["frames a second", *names[1:]]) + " |")
    print("|---|---|" + "---:|" * len(names))
    for title, make in SCENES.items():
        if not wanted(title, asked.scenes):
            continue
        try:
            model = make()
        except ModuleNotFoundError as why:
            print(f"  {title}: left out: {why}", file=sys.stderr)
            continue
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        for case in CASES:
            if not wanted(case.name, asked.cases):
                continue
            ready = prepare(case, model, data, names)
            least = dict.fromkeys(ready, float("inf"))
            for _ in range(asked.rounds):
                for name, peer in ready.items():
                    least[name] = min(least[name], seconds(peer.take, LEAST) / case.frames)
            distances = {name: peer.distances() for name, peer in ready.items()}
            for name, found in distances.items():
                same = agreement(distances["belvedere"], found)
                if same < 0.98:
                    print(f"  {title}, {case.name}: {name} agrees in {same:.1%} of the pixels", file=sys.stderr)
            for peer in ready.values():
                peer.close()
            cells = [f"{1.0 / least['belvedere']:,.0f}"]
            for name in names[1:]:
                ratio = least[name] / least["belvedere"] if name in least else 0.0
                cells.append(f"{ratio:.{0 if ratio >= 10.0 else 1}f}×" if ratio else "")
            print(f"| {title} | {case.name} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
