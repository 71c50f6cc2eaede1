"""A data set made by two workers of Ray, one of which is killed meanwhile, has the manifest of a single process."""

import os
import pathlib
import signal
import sys
import threading
import time

import dataset_ray
import ray

plan, out, expected = sys.argv[1:]
killed: list[int] = []


def parent(process: int) -> int:
    stat = pathlib.Path(f"/proc/{process}/stat").read_text()
    return int(stat.rpartition(")")[2].split()[1])


def is_ours(process: int) -> bool:
    """Whether this process is an ancestor of the given one."""
    while process > 1 and process != os.getpid():
        process = parent(process)
    return process == os.getpid()


def working() -> list[int]:
    """The workers of our cluster that are writing a shard; each has a child process."""
    processes = [int(path.name) for path in pathlib.Path("/proc").glob("[0-9]*")]
    found = []
    for process in processes:
        try:
            command = pathlib.Path(f"/proc/{process}/cmdline").read_bytes().split(b"\0")
            worker = parent(process)
            title = pathlib.Path(f"/proc/{worker}/cmdline").read_bytes()
            if b"dataset" in command and title.startswith(b"ray::make_shard") and is_ours(worker):
                found += [worker, process]
        except (FileNotFoundError, ProcessLookupError):
            continue
    return found


def kill_one() -> None:
    while not list(pathlib.Path(out).glob("shard-*.tar")):
        time.sleep(0.005)
    while not killed:
        for process in working()[:2]:
            try:
                os.kill(process, signal.SIGKILL)
                killed.append(process)
            except ProcessLookupError:
                pass


os.environ["RAY_USAGE_STATS_ENABLED"] = "0"
ray.init(num_cpus=2, object_store_memory=100 * 2**20, include_dashboard=False, log_to_driver=False)
killer = threading.Thread(target=kill_one, daemon=True)
killer.start()
print(dataset_ray.make(plan, out))
assert killed, "no worker was killed"
assert not killer.is_alive()
ray.shutdown()
ours, theirs = (pathlib.Path(folder, "manifest.json").read_bytes() for folder in (expected, out))
assert ours == theirs, "the manifest differs"
hidden = [path.name for path in pathlib.Path(out).iterdir() if path.name.startswith(".")]
assert not hidden, f"left over: {hidden}"
print(f"two workers of Ray {ray.__version__}, one killed (process {killed[0]}): the same manifest")
