"""Render frames for training on a Ray cluster with `ray.data`: each actor loads the world and renders batches of frames.

    pip install belvedere 'ray[data]'
    python frames_ray.py playground 10000 -o /shared/frames                 (on this machine)
    python frames_ray.py playground 10000 -o /shared/frames --address auto  (on the cluster that this node belongs to)

A frame depends only on the seed and its number. So its bytes do not depend on the actor or the batch in which it is
rendered, even if the actor replaces one that died. A training loop need not write files: it can iterate over the data set
that `frames` returns.
"""

from __future__ import annotations

import argparse
import pathlib

import numpy as np
import ray
from numpy.typing import NDArray

import belvedere as bv


def poses(seed: int, numbers: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return random poses of a sensor, (n, 7): in a square of 4 m, 0.3 to 1.5 m high, with any heading."""
    draws = np.stack([np.random.default_rng([seed, number]).random(4) for number in numbers.tolist()])
    half = np.pi * draws[:, 3]
    level = np.zeros(len(draws))
    x, y, z = 4 * draws[:, 0] - 2, 4 * draws[:, 1] - 2, 0.3 + 1.2 * draws[:, 2]
    return np.stack([x, y, z, level, level, np.sin(half), np.cos(half)], axis=1)


class Renderer:
    """The state of an actor, which loads the world once."""

    def __init__(self, source: str, seed: int) -> None:
        self.world = bv.World(source)
        self.camera = bv.DepthCamera(160, 120, fov=1.05, model="kinect_v1")
        self.seed = seed

    def __call__(self, rows: dict[str, NDArray[np.int64]]) -> dict[str, NDArray[np.generic]]:
        """Render the frames with these numbers."""
        numbers = rows["id"]
        pose = poses(self.seed, numbers)
        frames = self.camera.render(
            self.world, pose, channels=("rgb", "depth", "instance"), seeds=self.seed, frames=numbers, threads=1
        )
        return {"id": numbers, "pose": pose, **frames}


def frames(source: str, count: int, *, seed: int = 0, actors: int = 1, batch: int = 64) -> ray.data.Dataset:
    """Return `id`, `pose` (7), `rgb` (120, 160, 3), `depth` (120, 160) in metres and `instance` (120, 160), in order."""
    # By default the rows are in the order in which the actors finish.
    ray.data.DataContext.get_current().execution_options.preserve_order = True
    # An actor requests less than one CPU, because the task that counts the rows needs some as well.
    return ray.data.range(count, override_num_blocks=-(-count // batch)).map_batches(
        Renderer,
        fn_constructor_args=(source, seed),
        batch_size=batch,
        num_cpus=0.75,
        compute=ray.data.ActorPoolStrategy(size=actors),
    )


def main() -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(description="Take frames at random poses on a Ray cluster, as Parquet.")
    parser.add_argument("world", help="a name or a file, as for belvedere.World")
    parser.add_argument("count", type=int, help="number of frames")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True, help="a folder that all nodes share")
    parser.add_argument("--seed", type=int, default=0, help="seed of poses and noise")
    parser.add_argument("--actors", type=int, default=1, help="number of actors")
    parser.add_argument("--address", help="address of the cluster; auto for the cluster of this node")
    arguments = parser.parse_args()
    ray.init(address=arguments.address)
    made = frames(arguments.world, arguments.count, seed=arguments.seed, actors=arguments.actors)
    made.write_parquet(str(arguments.output.resolve()), mode="overwrite")


if __name__ == "__main__":
    main()
