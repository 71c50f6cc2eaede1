"""Frames by ray.data from two actors, one of which is killed meanwhile, equal those of one process without Ray."""

import hashlib
import os
import pathlib
import signal
import threading
import time

import frames_ray
import numpy as np
import ray

WORLD, COUNT, SEED = "playground", 448, 7
killed: list[int] = []


def hash_of(rows: dict) -> str:
    """A hash of all columns except the number."""
    columns = sorted(name for name in rows if name != "id")
    return hashlib.sha256(b"".join(np.ascontiguousarray(rows[name]).tobytes() for name in columns)).hexdigest()


def renderers() -> list[int]:
    """The actors of this process's cluster."""
    found = []
    for path in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if b"Renderer" in (path / "cmdline").read_bytes() and is_ours(int(path.name)):
                found.append(int(path.name))
        except (FileNotFoundError, ProcessLookupError):
            continue
    return found


def is_ours(process: int) -> bool:
    while process > 1 and process != os.getpid():
        stat = pathlib.Path(f"/proc/{process}/stat").read_text()
        process = int(stat.rpartition(")")[2].split()[1])
    return process == os.getpid()


begun = threading.Event()


def kill_one() -> None:
    begun.wait()
    while not killed:
        for process in renderers()[:1]:
            try:
                os.kill(process, signal.SIGKILL)
                killed.append(process)
            except ProcessLookupError:
                pass
        time.sleep(0.01)


os.environ["RAY_USAGE_STATS_ENABLED"] = "0"
ray.init(num_cpus=3, object_store_memory=200 * 2**20, include_dashboard=False, log_to_driver=False)
threading.Thread(target=kill_one, daemon=True).start()
alone = frames_ray.Renderer(WORLD, SEED)
numbers: list[int] = []
for rows in frames_ray.frames(WORLD, COUNT, seed=SEED, actors=2).iter_batches(batch_size=64):
    # The first frames have arrived, most have not.
    begun.set()
    numbers += rows["id"].tolist()
    assert hash_of(rows) == hash_of(alone(rows)), f"other bytes in frames {rows['id'][0]} to {rows['id'][-1]}"
assert killed, "no actor was killed"
assert numbers == list(range(COUNT)), "frames are missing or out of order"
ray.shutdown()
print(f"{COUNT} frames by ray.data, one of two actors killed (process {killed[0]}): the bytes of one process")
