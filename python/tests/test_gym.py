"""The gymnasium environments: gymnasium's own checker, and that the task can be solved."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")
from gymnasium.utils.env_checker import check_env  # noqa: E402

from belvedere import gym  # noqa: E402


def test_gymnasiums_checker() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make("belvedere/Wall-v0", render_mode="rgb_array").unwrapped)
    vector = gymnasium.make_vec("belvedere/Wall-v0", num_envs=3, vectorization_mode="vector_entry_point")
    assert vector.reset(seed=1)[0].shape == (3, 24, 32, 1)


def test_the_vector_environment_is_repeatable() -> None:
    def run() -> tuple[np.ndarray, np.ndarray]:
        env = gym.WallVectorEnv(5)
        observation, _ = env.reset(seed=3)
        assert env.observation_space.contains(observation)
        rewards = np.zeros(5)
        random = np.random.default_rng(0)
        for _ in range(60):
            action = random.uniform(-1, 1, (5, 1)).astype(np.float32)
            observation, reward, *_ = env.step(action)
            rewards += reward
        return observation, rewards

    (first, gained), (second, again) = run(), run()
    np.testing.assert_array_equal(first, second)
    np.testing.assert_array_equal(gained, again)


def test_each_environment_has_a_seed() -> None:
    env = gym.WallVectorEnv(3)
    first, _ = env.reset(seed=[1, 2, 3])
    second, _ = env.reset(seed=[1, 9, 3])
    np.testing.assert_array_equal(first[[0, 2]], second[[0, 2]])
    assert (first[1] != second[1]).any()
    # A single number is the seed of the first environment.
    np.testing.assert_array_equal(env.reset(seed=1)[0], first)
    # None continues: the walls differ from the first ones of the seed.
    on, _ = env.reset(seed=[1, None, 3])
    np.testing.assert_array_equal(on[[0, 2]], first[[0, 2]])
    assert (on[1] != first[1]).any()
    with pytest.raises(ValueError, match="seed: 2 of them; 3, one for each environment"):
        env.reset(seed=[1, 2])


def test_an_invalid_action_changes_nothing() -> None:
    env, other = gym.WallVectorEnv(3), gym.WallVectorEnv(3)
    for one in (env, other):
        one.reset(seed=1)
    actions = np.zeros((3, 1), np.float32)
    actions[1] = np.nan
    with pytest.raises(ValueError, match="actions: of environment 1, a finite number is expected, not nan"):
        env.step(actions)
    with pytest.raises(ValueError, match=r"actions: shape \(2, 1\); \(3, 1\) is expected"):
        env.step(actions[:2])
    for ours, theirs in zip(env.step(np.ones((3, 1))), other.step(np.ones((3, 1))), strict=True):
        if isinstance(ours, np.ndarray):
            np.testing.assert_array_equal(ours, theirs)


def gain(steer: object) -> float:
    """Return the mean reward of a step."""
    env = gym.WallVectorEnv(8)
    observation, _ = env.reset(seed=1)
    total = 0.0
    for _ in range(150):
        observation, reward, *_ = env.step(steer(observation)[:, None].astype(np.float32))  # type: ignore[operator]
        total += float(reward.mean())
    return total / 150


def test_steering_by_depth_beats_driving_straight() -> None:
    def by_depth(picture: np.ndarray) -> np.ndarray:
        # The wall is to the left: the nearer it appears, the more to the right.
        near = picture[:, 8:14, :12, 0].mean(axis=(1, 2)) / 255
        return np.clip(8 * (0.8 - near), -1, 1)

    blind = gain(lambda picture: np.zeros(len(picture)))
    seeing = gain(by_depth)
    assert seeing > max(blind + 0.2, 0.9), (seeing, blind)
