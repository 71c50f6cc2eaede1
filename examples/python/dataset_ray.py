"""Make a data set on a Ray cluster: each task makes one shard at a time, in a folder that all nodes see.

    python dataset_ray.py plan.toml -o /shared/out                 (on this machine)
    python dataset_ray.py plan.toml -o /shared/out --address auto  (on the cluster that this node belongs to)

`belvedere` has to be on the PATH of every node. A shard's bytes depend on the plan alone, and it is there as a whole or not
at all. So a task that dies with its worker or node is simply started again, and the manifest is that of a single process.
"""

from __future__ import annotations

import argparse
import pathlib
import subprocess

import ray


def belvedere(*arguments: object) -> str:
    """What `belvedere dataset` prints; its own words when it fails."""
    done = subprocess.run(
        ["belvedere", "dataset", *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise RuntimeError(done.stderr.strip() or f"belvedere ended with {done.returncode}")
    return done.stdout.strip()


@ray.remote(max_retries=-1)
def make_shard(plan: str, out: str, shard: int) -> int:
    """Makes a shard unless it is there. Ray starts it again, anywhere, when its worker dies."""
    belvedere(plan, "-o", out, "--shards", f"{shard}..{shard + 1}", "--workers", 1)
    return shard


def make(plan: str, out: str, cpus: float = 1) -> str:
    """Makes all shards of a plan on the cluster that Ray is connected to, then the manifest; gives what was said of it."""
    shards = int(belvedere(plan, "-o", out, "--count").split()[2])
    task = make_shard.options(num_cpus=cpus)
    waiting = [task.remote(plan, out, shard) for shard in range(shards)]
    done = 0
    while waiting:
        ready, waiting = ray.wait(waiting)
        done += len(ray.get(ready))
        print(f"{done} of {shards} shards", flush=True)
    return belvedere(plan, "-o", out)


def main() -> None:
    """Runs the command."""
    parser = argparse.ArgumentParser(description="Make a data set on a Ray cluster.")
    parser.add_argument("plan", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    parser.add_argument("--address", help="of the cluster; auto for the one of this node")
    parser.add_argument("--cpus", type=float, default=1, help="of a task")
    arguments = parser.parse_args()
    ray.init(address=arguments.address)
    print(make(str(arguments.plan.resolve()), str(arguments.output.resolve()), arguments.cpus))


if __name__ == "__main__":
    main()
