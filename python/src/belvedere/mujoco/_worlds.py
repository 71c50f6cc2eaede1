"""The worlds of states: the shapes of a scene, with other poses and lamps in each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from belvedere import _arrays
from belvedere._channels import prepare

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from belvedere._sensors import Sensor
    from belvedere._world import World
    from belvedere.mujoco._lamps import Lamps
    from belvedere.mujoco._states import States


class Worlds:
    """Renders a frame in the world of each state.

    It does what :class:`belvedere.Batch` does. A call costs less, since colours and lamps are those of the scene.
    """

    def __init__(self, world: World, lamps: Lamps) -> None:
        self._world, self._lamps = world, lamps

    def render(
        self,
        sensor: Sensor,
        poses: NDArray[np.float64],
        bodies: NDArray[np.float64] | None,
        forward: NDArray[np.float64],
        states: States,
        channels: Sequence[str],
        numbers: tuple[list[int], list[int]],
        threads: int | None,
    ) -> dict[str, NDArray[Any]]:
        """Return the channels of the sensor, (N, …).

        Args:
            sensor: the sensor.
            poses: where it is in each state, (N, 7).
            bodies: the poses of all bodies, (N, bodies, 7); None without bodies.
            forward: where it looks, (N, 3).
            states: the states.
            channels: the channels.
            numbers: the seed and the number of each frame.
            threads: the number of threads.

        Raises:
            ValueError: an argument is invalid.

        """
        world, lead = self._world._native.snapshot(), (states.count,)
        own = np.array([vector for vector, _, _ in world.lights()], np.float64).reshape(1, -1, 3)
        vectors = np.repeat(own, states.count, axis=0)
        self._lamps.place(vectors, states, forward)
        outputs = prepare(sensor._channels, sensor._default, channels, None, lead, sensor._frame)
        moved = [] if bodies is None else list(range(bodies.shape[1]))
        # All else is as in the scene.
        looks = None, None, vectors, None, None
        sensor._take(world, lead, (poses, moved, bodies), None, None, (*numbers, None, looks), outputs, threads)
        return outputs


def numbers_of(seeds: Any, frames: Any, lead: tuple[int, ...]) -> tuple[list[int], list[int]]:
    """Return the seed and the number of each frame.

    Raises:
        ValueError: they are not whole numbers, or not as many as frames.

    """
    return _arrays.seeds("seeds", seeds, lead), _arrays.numbers_of_frames(frames, lead)
