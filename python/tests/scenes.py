"""What the tests of scenes of other packages share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

import belvedere as bv

if TYPE_CHECKING:
    from numpy.typing import NDArray


def rays_through(world_size: float, count: int, seed: int = 0) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return origins and directions of unit length: from around a scene to places in it."""
    random = np.random.default_rng(seed)
    origins = random.uniform(-1.5 * world_size, 1.5 * world_size, (count, 3))
    directions = random.uniform(-0.8 * world_size, 0.8 * world_size, (count, 3)) - origins
    return origins, directions / np.linalg.norm(directions, axis=1, keepdims=True)


def transform(seed: int, scale: Any = (1.0, 1.0, 1.0), size: float = 3.0) -> NDArray[np.float64]:
    """Return a random turn and place of something that is scaled first."""
    random = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    matrix = np.eye(4)
    matrix[:3, :3] = turn * np.sign(np.linalg.det(turn)) * np.asarray(scale)
    matrix[:3, 3] = random.uniform(-size, size, 3)
    return matrix


def colour_seen(world: bv.World, eye: Any, sharp: bool = True) -> NDArray[np.uint8]:
    """Return the picture of a camera that looks down from a place with +x up in the picture, under ambient light only."""
    world.set_environment(ambient=(1, 1, 1), background=(0, 0, 0))
    down = [*eye, 0.0, 0.7071067811865476, 0.0, 0.7071067811865476]
    return bv.Camera(64, 64, fov=0.9).render(world, down)["rgb"]
