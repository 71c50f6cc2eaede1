"""The worlds of states: the shapes of a scene, with other poses and lamps in each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from belvedere import _arrays
from belvedere._channels import prepare

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import TypeAlias

    from numpy.typing import NDArray

    from belvedere._native import _Looks
    from belvedere._sensors import Sensor
    from belvedere._world import World
    from belvedere.mujoco._lamps import Lamps
    from belvedere.mujoco._states import States

    #: Poses of the sensor, (N, 7), and of all bodies, (N, bodies, 7).
    Places: TypeAlias = tuple[NDArray[np.float64], NDArray[np.float64]]


class Worlds:
    """Renders a frame in the world of each state.

    It does what :class:`belvedere.Batch` and :meth:`belvedere.Sensor.render` do. A call costs less, since poses are
    checked already, and colours and lamps are those of the scene.
    """

    def __init__(self, world: World, lamps: Lamps) -> None:
        self._world, self._lamps = world, lamps

    def looks(self, states: States, forward: NDArray[np.float64]) -> _Looks:
        """Return the lamps of each state, for a camera that looks forward, (N, 3).

        Raises:
            ValueError: a lamp has no place, or no direction.

        """
        own = np.array([vector for vector, _, _ in self._world._native.lights()], np.float64).reshape(1, -1, 3)
        vectors = np.repeat(own, states.count, axis=0)
        self._lamps.place(vectors, states, forward)
        # All else is as in the scene.
        return None, None, vectors, None, None

    def render(
        self,
        sensor: Sensor,
        now: Places,
        after: Places | None,
        channels: Sequence[str] | None,
        numbers: tuple[list[int], list[int]],
        looks: _Looks | None,
        threads: int | None,
    ) -> dict[str, NDArray[Any]]:
        """Return the channels of the sensor, (N, …).

        Args:
            sensor: the sensor.
            now: the sensor's poses in each state, (N, 7), and those of all bodies, (N, bodies, 7).
            after: the same at the end of the frames.
            channels: the channels, by default the sensor's main one.
            numbers: the seed and the number of each frame.
            looks: the lamps.
            threads: the number of threads.

        Raises:
            ValueError: an argument is invalid.

        """
        world, lead = self._world._native.snapshot(), (len(now[0]),)
        outputs = prepare(sensor._channels, sensor.main_channels, channels, None, lead, sensor.frame_shape)
        moved = list(range(now[1].shape[1]))
        first = now[0], moved, now[1]
        last = None if after is None else (after[0], moved, after[1])
        sensor._take(world, lead, first, last, None, (*numbers, None, looks), outputs, threads)
        return outputs


def numbers_of(seeds: Any, frames: Any, lead: tuple[int, ...]) -> tuple[list[int], list[int]]:
    """Return the seed and the number of each frame.

    Raises:
        ValueError: they are not whole numbers, or not as many as frames.

    """
    return _arrays.seeds("seeds", seeds, lead), _arrays.numbers_of_frames(frames, lead)
