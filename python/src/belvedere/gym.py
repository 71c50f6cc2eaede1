"""A gymnasium environment with images: follow a wall by depth. The extra ``gym`` installs the package ``gymnasium``.

Use ``gymnasium.make("belvedere/Wall-v0")`` after ``import belvedere.gym``. ``WallVectorEnv`` steps many corridors
at once, each with its own shape, in one batch; ``WallEnv`` is a single one.
"""

from __future__ import annotations

import math
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from belvedere import _arrays
from belvedere._batch import Batch
from belvedere._sensors import DepthCamera
from belvedere._world import World

__all__ = ["WallEnv", "WallVectorEnv"]

#: The desired distance from the wall in metres, the distance of a collision, and the distance at which the wall is
#: lost.
WANTED, BUMP, LOST = 1.0, 0.25, 3.0
#: Metres of one step, and the largest turn in radians.
STEP, TURN = 0.1, 0.25
#: Steps of an episode.
LENGTH = 200
#: The largest depth in observations, metres.
FARTHEST = 5.0
#: Number of panels of the wall, and their spacing in metres.
PANELS, SPACING = 24, 1.0


class _Corridors:
    """Robots that drive along walls of panels, one in each world of a batch."""

    def __init__(self, randoms: list[np.random.Generator], size: tuple[int, int]) -> None:
        n = len(randoms)
        #: One generator for each robot, for its wall and its start.
        self.randoms = randoms
        world = World()
        world.add_plane(name="floor")
        for panel in range(PANELS):
            world.add_box((SPACING * 1.2, 0.1, 1.0), (0, 0, 0.5), name=f"panel{panel}")
        self.panels = [world.bodies.index(f"panel{panel}") for panel in range(PANELS)]
        self.batch = Batch(world, n, randomize=self._bend)
        self.camera = DepthCamera(*size, fov=1.6, most=FARTHEST)
        #: x, y, heading of each robot.
        self.state = np.zeros((n, 3))
        self.steps = np.zeros(n, np.int64)

    def _bend(self, batch: Batch, index: int, _: np.random.Generator) -> None:
        """Bend the wall at random."""
        bends = self.randoms[index].uniform(-0.35, 0.35, PANELS)
        bends[:3] = 0.0
        x, y, heading = -SPACING, 0.0, 0.0
        for body, bend in zip(self.panels, bends.tolist(), strict=True):
            heading = min(max(heading + bend, -0.6), 0.6)
            x, y = x + SPACING * math.cos(heading), y + SPACING * math.sin(heading)
            batch.poses[index, body] = (x, y, 0.5, 0, 0, math.sin(heading / 2), math.cos(heading / 2))

    def reset(self, mask: NDArray[np.bool_]) -> None:
        self.batch.reset(mask)
        for index in np.flatnonzero(mask).tolist():
            random = self.randoms[index]
            self.state[index] = 0.0, random.uniform(-1.3, -0.7), random.uniform(-0.2, 0.2)
        self.steps[mask] = 0

    def look(self) -> NDArray[np.uint8]:
        """Return depths, 255 for near and 0 for far: (n, height, width, 1)."""
        poses = np.zeros((len(self.state), 7))
        poses[:, :2], poses[:, 2] = self.state[:, :2], 0.4
        # The camera looks to the left, towards the wall.
        half = (self.state[:, 2] + 0.5) / 2
        poses[:, 5], poses[:, 6] = np.sin(half), np.cos(half)
        depth = self.batch.render(self.camera, poses)["depth"]
        return np.asarray(np.clip(1.0 - depth / FARTHEST, 0, 1) * 255, np.uint8)[..., None]

    def step(
        self, turns: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], NDArray[np.float64]]:
        """Drive one step; return rewards, terminations, truncations and distances from the wall."""
        self.state[:, 2] += np.clip(turns, -1, 1) * TURN
        self.state[:, 0] += STEP * np.cos(self.state[:, 2])
        self.state[:, 1] += STEP * np.sin(self.state[:, 2])
        self.steps += 1
        distance = self.distances()
        ended = (distance < BUMP) | (distance > LOST) | (np.cos(self.state[:, 2]) < 0)
        rewards = np.where(ended, -1.0, 1.0 - np.minimum(np.abs(distance - WANTED), 1.0))
        return rewards, ended, ~ended & (self.steps >= LENGTH), distance

    def distances(self) -> NDArray[np.float64]:
        """Return the distance in metres from the nearest panel's middle line."""
        panels = self.batch.poses[:, self.panels]
        along = 2 * np.arctan2(panels[..., 5], panels[..., 6])
        offset = self.state[:, None, :2] - panels[..., :2]
        axis = np.stack([np.cos(along), np.sin(along)], axis=-1)
        reach = np.clip((offset * axis).sum(-1), -SPACING / 2, SPACING / 2)
        nearest: NDArray[np.float64] = np.linalg.norm(offset - reach[..., None] * axis, axis=-1).min(axis=1)
        return nearest


class WallVectorEnv(VectorEnv[NDArray[np.uint8], NDArray[np.float32], Any]):
    """Robots that learn to drive along a wall at a distance of one metre, from depth images.

    Observations: (n, height, width, 1) of uint8, 255 near, 0 at 5 m. Actions: (n, 1) from −1, right, to 1, left.
    Reward: 1 at the desired distance, 0 a metre off, −1 for a collision, for losing the wall or for turning
    round, which end an episode. Episodes are truncated after 200 steps. Worlds are reset in the following step
    (``NEXT_STEP``).

    Args:
        num_envs: the number of environments.
        width: pixels of an image across.
        height: pixels down.

    """

    metadata: dict[str, Any] = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}  # noqa: RUF012

    def __init__(self, num_envs: int = 16, width: int = 32, height: int = 24) -> None:
        self.num_envs = num_envs
        self._size = (width, height)
        self.single_observation_space = spaces.Box(0, 255, (height, width, 1), np.uint8)
        self.single_action_space = spaces.Box(-1.0, 1.0, (1,), np.float32)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._corridors: _Corridors | None = None
        self._ended = np.zeros(num_envs, bool)

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.uint8], dict[str, Any]]:
        """Reset all environments; the same seed gives the same episodes.

        Args:
            seed: one for each environment, None to continue with its random numbers; or the first of consecutive
                ones.
            options: ignored.

        Raises:
            ValueError: the number of seeds differs from the number of environments.

        """
        seeds: list[int | None]
        if seed is None:
            seeds = [None] * self.num_envs
        elif isinstance(seed, list):
            seeds = [None if own is None else _arrays.count("seed", own, 0, 2**63 - 1) for own in seed]
        else:
            first = _arrays.count("seed", seed, 0, 2**63 - 1)
            seeds = list(range(first, first + self.num_envs))
            super().reset(seed=first)
        if len(seeds) != self.num_envs:
            raise ValueError(f"seed: {len(seeds)} of them; {self.num_envs}, one for each environment, are expected")
        if self._corridors is None:
            randoms = [np.random.default_rng(self.np_random.integers(2**63)) for _ in seeds]
            self._corridors = _Corridors(randoms, self._size)
        for index, own in enumerate(seeds):
            if own is not None:
                self._corridors.randoms[index] = np.random.default_rng(own)
        self._corridors.reset(np.ones(self.num_envs, bool))
        self._ended[:] = False
        return self._corridors.look(), {"distance": self._corridors.distances()}

    def step(
        self, actions: NDArray[np.float32]
    ) -> tuple[NDArray[np.uint8], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Drive one step in each world; those that have ended are reset instead.

        Raises:
            ValueError: an environment has no finite action. Nothing is changed then.

        """
        if self._corridors is None:
            raise gymnasium.error.ResetNeeded("reset the environment first")
        turns = _arrays.array("actions", actions, np.float64)
        if turns.shape not in ((self.num_envs, 1), (self.num_envs,)):
            raise ValueError(f"actions: shape {turns.shape}; {(self.num_envs, 1)} is expected")
        turns = turns.reshape(self.num_envs)
        if not np.isfinite(turns).all():
            which = int(np.argmin(np.isfinite(turns)))
            raise ValueError(f"actions: of environment {which}, a finite number is expected, not {turns[which]}")
        began = self._ended.copy()
        rewards, terminated, truncated, distance = self._corridors.step(turns)
        if began.any():
            self._corridors.reset(began)
            rewards[began], terminated[began], truncated[began] = 0.0, False, False
            distance = self._corridors.distances()
        self._ended = terminated | truncated
        return self._corridors.look(), rewards, terminated, truncated, {"distance": distance}


class WallEnv(gymnasium.Env[NDArray[np.uint8], NDArray[np.float32]]):
    """A single environment of ``WallVectorEnv``."""

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012

    def __init__(self, width: int = 32, height: int = 24, render_mode: str | None = None) -> None:
        self.render_mode = render_mode
        self._many = WallVectorEnv(1, width, height)
        self.observation_space = self._many.single_observation_space
        self.action_space = self._many.single_action_space
        self._seen = np.zeros((height, width, 1), np.uint8)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.uint8], dict[str, Any]]:
        """Reset the environment; the same seed gives the same episode."""
        super().reset(seed=seed)
        observations, info = self._many.reset(seed=seed)
        self._seen = observations[0]
        return self._seen, {"distance": float(info["distance"][0])}

    def step(self, action: NDArray[np.float32]) -> tuple[NDArray[np.uint8], float, bool, bool, dict[str, Any]]:
        """Drive one step."""
        observations, rewards, terminated, truncated, info = self._many.step(np.asarray(action)[None])
        self._seen = observations[0]
        distance = float(info["distance"][0])
        return self._seen, float(rewards[0]), bool(terminated[0]), bool(truncated[0]), {"distance": distance}

    def render(self) -> Any:
        """Return the last observation in grey: (height, width, 3)."""
        return np.repeat(self._seen, 3, axis=2) if self.render_mode == "rgb_array" else None


gymnasium.register(
    "belvedere/Wall-v0",
    entry_point="belvedere.gym:WallEnv",
    vector_entry_point="belvedere.gym:WallVectorEnv",
)
