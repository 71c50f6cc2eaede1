"""Trains a policy of stable-baselines3 on pictures alone: it balances the pole of gymnasium's InvertedPendulum.

Each of eight environments gives a grey picture of 64 × 64 pixels, and the policy sees the last three. There is no GPU
and no OpenGL; everything runs on one thread. Two runs with one seed end with the same weights, bit for bit: the last
line is their hash.

    pip install 'belvedere[mujoco]' 'gymnasium[mujoco]' stable-baselines3
    python vision_policy.py --steps 100000 --seed 1
"""

from __future__ import annotations

import argparse
import hashlib
import time

import gymnasium
import mujoco
import numpy as np
import torch
from gymnasium.wrappers import GrayscaleObservation
from stable_baselines3 import PPO
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import DummyVecEnv, VecEnv, VecFrameStack, VecTransposeImage

import belvedere.mujoco as bvm


def side() -> mujoco.MjvCamera:
    """Return a camera that sees the cart and its pole from the side."""
    camera = mujoco.MjvCamera()
    camera.type = mujoco.mjtCamera.mjCAMERA_FREE
    camera.lookat[:] = 0.0, 0.0, 0.3
    camera.distance, camera.azimuth, camera.elevation = 1.8, 90.0, 0.0
    return camera


def environment() -> gymnasium.Env:
    pictures = bvm.PixelObservation(gymnasium.make("InvertedPendulum-v5"), 64, 64, side(), smooth=True)
    return Monitor(GrayscaleObservation(pictures, keep_dim=True))


def environments(count: int) -> VecEnv:
    return VecTransposeImage(VecFrameStack(DummyVecEnv([environment] * count), 3))


def return_of(policy: PPO) -> float:
    """Return the mean of the returns of 20 episodes, of which the best possible is 1,000."""
    judge = environments(1)
    judge.seed(10_000)
    mean, _ = evaluate_policy(policy, judge, n_eval_episodes=20, deterministic=True)
    return float(np.mean(mean))


def hash_of(policy: PPO) -> str:
    weights = policy.policy.state_dict()
    return hashlib.sha256(b"".join(weights[name].numpy().tobytes() for name in sorted(weights))).hexdigest()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=100_000, help="steps of all environments together")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    torch.set_num_threads(1)
    torch.use_deterministic_algorithms(True)
    policy = PPO(
        "CnnPolicy",
        environments(8),
        n_steps=256,
        batch_size=256,
        n_epochs=6,
        gamma=0.98,
        learning_rate=lambda left: 3e-4 * left,
        policy_kwargs={"log_std_init": -0.5},
        seed=asked.seed,
        device="cpu",
    )
    print(f"before: return {return_of(policy):.0f}")
    start = time.monotonic()
    policy.learn(asked.steps)
    print(f"after {asked.steps} steps, {time.monotonic() - start:.0f} s: return {return_of(policy):.0f}")
    print(f"weights: {hash_of(policy)}")


if __name__ == "__main__":
    main()
