"""The worlds of states: the shapes of a scene, with other poses and lamps in each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from belvedere import _arrays
from belvedere._channels import prepare

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from belvedere import _native
    from belvedere._native import _Looks
    from belvedere._sensors import Sensor
    from belvedere._world import World
    from belvedere.mujoco._lamps import Lamps
    from belvedere.mujoco._states import States


class Worlds:
    """Renders a frame in the world of each state.

    It does what :class:`belvedere.Batch` and :meth:`belvedere.Sensor.render` do. A call costs less, since poses are
    checked already, and colours and lamps are those of the scene.
    """

    def __init__(self, world: World, lamps: Lamps) -> None:
        self._world, self._lamps = world, lamps

    def looks(self, states: States, matrices: NDArray[np.float64], camera: int) -> _Looks:
        """Return the lamps of each state, for a camera among those with these matrices, (N, cameras, 9).

        Raises:
            ValueError: a lamp has no place, or no direction.

        """
        # All else is as in the scene.
        vectors, spots = self._lamps.place(self._world._native, states, matrices, camera)
        return None, None, vectors, None, None, spots

    def render(
        self,
        sensor: Sensor,
        lead: tuple[int, ...],
        now: _native.States,
        after: _native.States | None,
        channels: Sequence[str] | None,
        numbers: tuple[list[int], list[int]],
        looks: _Looks | None,
        threads: int | None,
    ) -> dict[str, NDArray[Any]]:
        """Return the channels of the sensor, with the shape of the states followed by the frame's.

        Args:
            sensor: the sensor.
            lead: the shape of the states.
            now: the poses of the sensor and of all bodies in each state.
            after: the same at the end of the frames.
            channels: the channels, by default the sensor's main one.
            numbers: the seed and the number of each frame.
            looks: the lamps.
            threads: the number of threads.

        Raises:
            ValueError: an argument is invalid.

        """
        outputs = prepare(sensor._channels, sensor.main_channels, channels, None, lead, sensor.frame_shape)
        each = (*numbers, None, looks)
        sensor._take(self._world._native, lead, now, after, None, each, outputs, threads)
        return outputs


def numbers_of(seeds: Any, frames: Any, lead: tuple[int, ...]) -> tuple[list[int], list[int]]:
    """Return the seed and the number of each frame.

    Raises:
        ValueError: they are not whole numbers, or not as many as frames.

    """
    return _arrays.seeds("seeds", seeds, lead), _arrays.numbers_of_frames(frames, lead)
