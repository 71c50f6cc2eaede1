"""Train a policy that drives along a wall by depth images, on the CPU, in about a minute.

    pip install './python[gym]' cma
    python examples/python/follow_wall.py

CMA-ES searches for a linear policy with 33 parameters. Each candidate drives in eight corridors. All candidates drive at
the same time, in one vector environment.
"""

from __future__ import annotations

import argparse

import cma
import numpy as np

from belvedere.gym import WallVectorEnv

CORRIDORS = 8


def features(pictures: np.ndarray) -> np.ndarray:
    """Pictures of 24 x 32 pixels as 4 x 8 means, from 0 to 1."""
    n = len(pictures)
    return pictures.reshape(n, 4, 6, 8, 4).mean(axis=(2, 4)).reshape(n, 32) / 255


def drive(env: WallVectorEnv, policies: np.ndarray, seed: int, steps: int = 150) -> np.ndarray:
    """Return the mean reward per step of each policy."""
    weights = np.repeat(policies, CORRIDORS, axis=0)
    pictures, _ = env.reset(seed=seed)
    gained = np.zeros(len(weights))
    for _ in range(steps):
        turns = np.tanh((features(pictures) * weights[:, :32]).sum(axis=1) + weights[:, 32])
        pictures, rewards, *_ = env.step(turns[:, None].astype(np.float32))
        gained += rewards
    return gained.reshape(len(policies), CORRIDORS).mean(axis=1) / steps


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--generations", type=int, default=30)
    arguments = parser.parse_args()
    search = cma.CMAEvolutionStrategy(np.zeros(33), 0.5, {"seed": 1, "verbose": -9})
    env = WallVectorEnv(search.popsize * CORRIDORS)
    test = WallVectorEnv(CORRIDORS)
    before = drive(test, np.zeros((1, 33)), seed=10_000)[0]
    for generation in range(arguments.generations):
        candidates = search.ask()
        rewards = drive(env, np.array(candidates), seed=generation)
        search.tell(candidates, (-rewards).tolist())
        print(f"generation {generation}: best {rewards.max():.3f}, mean {rewards.mean():.3f}", flush=True)
    after = drive(test, search.mean[None], seed=10_000)[0]
    print(f"reward per step in new corridors: {before:.3f} before the training, {after:.3f} after it")


if __name__ == "__main__":
    main()
