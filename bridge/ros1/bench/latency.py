#!/usr/bin/env python3
"""Latency of an image over each transport, compared with plain ROS; fails if a ratio is exceeded three times.

640 x 480 RGB at 30 Hz from a live simulator, by the node in BELVEDERE_ROS_BRIDGE and the program of latency.cpp in
BELVEDERE_ROS_LATENCY. Needs a master at ROS_MASTER_URI. BELVEDERE_ROS_SECONDS says how long each measurement takes.
"""

import os
import re
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "test"))
from processes import Process, bridge, simulator  # noqa: E402

PROGRAM = os.environ["BELVEDERE_ROS_LATENCY"]
SECONDS = os.environ.get("BELVEDERE_ROS_SECONDS", "8")
DOMAIN = f"latency-{os.getpid()}"

#: The compared p50 values, and their largest ratio.
BUDGETS = [
    ("shared memory", "bridge over TCPROS", 1 / 5),
    ("bridge over TCPROS", "plain over TCPROS", 1.3),
    ("frames beside messages", "messages inside", 1.0),
]
#: Ratios without a limit. A sleeping nodelet does not reach 1: its frame comes from a simulator that has just rendered it,
#: through a socket (42 us with cold caches) to another process, while the idle plain publisher wakes a thread next to it.
#: With busy polling it is sometimes reached (0.8 to 1.5 on two cores, both of which render, so that polling delays).
NO_BUDGET = [("frames inside", "plain inside"), ("frames inside, looked for", "plain inside")]


def measure():
    """Return the p50 of every transport, in ms."""
    environment = {**os.environ, "BELVEDERE_DOMAIN": DOMAIN}
    said = ""
    with simulator(DOMAIN), bridge(DOMAIN):
        time.sleep(2)
        with Process(PROGRAM, "publish"):
            command = [PROGRAM, "between", SECONDS, "image_raw"]
            said += subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE, text=True).stdout
    with simulator(DOMAIN):
        time.sleep(1)
        command = [PROGRAM, "inside", SECONDS, "image_raw"]
        said += subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE, text=True).stdout
    lines = [line for line in said.splitlines() if " p50 " in line or "nothing came" in line]
    print(*lines, sep="\n", flush=True)
    return {line[:26].strip(): float(re.search(r"p50 +([\d.]+)", line)[1]) for line in lines}


def main():
    for _ in range(3):
        p50 = measure()
        kept = True
        for what, beside, budget in BUDGETS:
            ratio = p50[what] / p50[beside]
            kept &= ratio <= budget
            print(f"{what} / {beside}: {ratio:.3f} (at most {budget:.3g})", flush=True)
        for what, beside in NO_BUDGET:
            print(f"{what} / {beside}: {p50[what] / p50[beside]:.3f}", flush=True)
        if kept:
            return 0
    return 1


if __name__ == "__main__":
    sys.exit(main())
