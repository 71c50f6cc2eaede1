"""Make a data set on a Ray cluster: each task makes one shard, in a folder that all nodes share.

    python dataset_ray.py plan.toml -o /shared/out                 (on this machine)
    python dataset_ray.py plan.toml -o /shared/out --address auto  (on the cluster that this node belongs to)

`belvedere` must be on the PATH of every node. The bytes of a shard depend only on the plan, and a shard is either complete
or does not exist. So Ray can simply restart a task whose worker or node died, and the manifest is the same as from a single
process.
"""

from __future__ import annotations

import argparse
import pathlib
import subprocess

import ray


def belvedere(*arguments: object) -> str:
    """Run `belvedere dataset` and return its output; raise an error with its message if it fails."""
    done = subprocess.run(
        ["belvedere", "dataset", *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise RuntimeError(done.stderr.strip() or f"belvedere exited with code {done.returncode}")
    return done.stdout.strip()


@ray.remote(max_retries=-1)
def make_shard(plan: str, out: str, shard: int) -> int:
    """Make a shard unless it exists. If the worker dies, Ray restarts the task on any worker."""
    belvedere(plan, "-o", out, "--shards", f"{shard}..{shard + 1}", "--workers", 1)
    return shard


def make(plan: str, out: str, cpus: float = 1) -> str:
    """Make all shards of a plan on the connected Ray cluster, then the manifest; return the last output of belvedere."""
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
    """Run the command."""
    parser = argparse.ArgumentParser(description="Make a data set on a Ray cluster.")
    parser.add_argument("plan", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    parser.add_argument("--address", help="address of the cluster; auto for the cluster of this node")
    parser.add_argument("--cpus", type=float, default=1, help="number of CPUs per task")
    arguments = parser.parse_args()
    ray.init(address=arguments.address)
    print(make(str(arguments.plan.resolve()), str(arguments.output.resolve()), arguments.cpus))


if __name__ == "__main__":
    main()
