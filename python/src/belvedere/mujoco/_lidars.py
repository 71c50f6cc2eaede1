"""Lidars in a model."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import mujoco

from belvedere._frames import Frames
from belvedere._scanner import Scanner
from belvedere._sensors import Lidar, Sensor
from belvedere.mujoco._names import number_of
from belvedere.mujoco._states import States, states_of
from belvedere.mujoco._worlds import numbers_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from belvedere import _native
    from belvedere._arrays import ArrayLike
    from belvedere.mujoco._scene import Scene


class SceneLidar:
    """A lidar on a site or body of a model; :meth:`belvedere.mujoco.Scene.lidar` makes it."""

    def __init__(
        self,
        scene: Scene,
        site: str | int | None,
        body: str | int | None,
        preset: str | None,
        sensor: Sensor | None,
        options: dict[str, Any],
    ) -> None:
        self._scene = scene
        model = scene.model
        if (site is None) == (body is None):
            raise ValueError("site, body: one of the two is expected")
        if site is not None:
            self._kind = "site_"
            self._number = number_of(model, mujoco.mjtObj.mjOBJ_SITE, "site", site, model.nsite)
        elif body is not None:
            self._kind = ""
            self._number = number_of(model, mujoco.mjtObj.mjOBJ_BODY, "body", body, model.nbody)
        if sensor is not None:
            if not isinstance(sensor, (Lidar, Scanner)):
                raise ValueError(f"sensor: a Lidar or Scanner is expected, not {sensor!r}")
            if preset is not None or options:
                raise ValueError("sensor: it has its own preset and options; leave the others out")
        elif preset is not None:
            sensor = Scanner(preset, **options)
        else:
            sensor = Lidar(**options)
        #: The sensor in this place.
        self.sensor: Sensor = sensor

    def render(
        self,
        states: Any,
        after: Any = None,
        *,
        channels: Sequence[str] | None = None,
        seeds: ArrayLike | int = 0,
        frames: ArrayLike | int = 0,
        threads: int | None = None,
    ) -> Frames:
        """Render a frame of each state.

        Args:
            states: as for :meth:`SceneCamera.render`; a dictionary of arrays needs the poses of the lidar, too:
                ``site_xpos`` and ``site_xmat``, or ``xpos`` and ``xmat`` for one on a body.
            after: the states at the end of the frame, as many. A scanner then casts each ray from the poses at its
                time: the motion in between is straight, and turns evenly.
            channels: the channels to render; by default the sensor's main one.
            seeds: the seeds of the noise.
            frames: the number of each frame; some scanners continue to rotate from one frame to the next.
            threads: the number of threads; one per processor by default.

        Raises:
            ValueError: an argument is invalid.

        """
        scene = self._scene
        now = states_of(scene.model, states)
        later = None if after is None else states_of(scene.model, after)
        if later is not None and later.lead != now.lead:
            raise ValueError(f"after: {later.lead or 'one'} states; {now.lead or 'one'}, as states, are expected")
        sensor, places = self.sensor, self._places(now)
        last = None if later is None else self._places(later)
        numbers = numbers_of(seeds, frames, now.lead)
        arrays = scene.worlds.render(sensor, now.lead, places, last, channels, numbers, None, threads)
        return Frames(arrays, now.lead, sensor.frame_shape, sensor, numbers[1])

    def _places(self, states: States) -> _native.States:
        return self._scene.places(states, states.frames(self._kind), self._number)
