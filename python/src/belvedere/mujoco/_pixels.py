"""Pictures as observations of gymnasium's environments of MuJoCo."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import gymnasium
import mujoco
import numpy as np
from gymnasium import spaces

from belvedere.mujoco._scene import Scene

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

#: The limits of each channel, its last axes, and its type.
_LIMITS: dict[str, tuple[float, float, tuple[int, ...], type[np.generic]]] = {
    "rgb": (0, 255, (3,), np.uint8),
    "depth": (0.0, np.inf, (), np.float32),
    "normal": (-1.0, 1.0, (3,), np.float32),
    "geom": (-1, np.iinfo(np.int32).max, (), np.int32),
}


class PixelObservation(gymnasium.ObservationWrapper[Any, Any, Any]):
    """Replaces the observations of an environment of MuJoCo by pictures, without OpenGL.

    Args:
        env: an environment with ``model`` and ``data`` of MuJoCo, such as ``gymnasium.make("Humanoid-v5")``.
        width: pixels across.
        height: pixels down.
        camera: name or number of a camera of the model; −1 is the free camera as it starts; or an ``MjvCamera``.
        channels: some of ``rgb``, ``depth`` (∞ where nothing is), ``normal`` and ``geom``. With one channel the
            observation is its array, otherwise a dictionary of arrays.
        state: True if the dictionary also has the environment's own observation as ``state``.
        **options: other keywords of :class:`belvedere.Camera`: ``noise``, ``smooth``, …

    Raises:
        ValueError: the environment has no model of MuJoCo, or an argument is invalid.

    """

    def __init__(
        self,
        env: gymnasium.Env[Any, Any],
        width: int = 64,
        height: int = 64,
        camera: str | int | mujoco.MjvCamera = -1,
        *,
        channels: Sequence[str] = ("rgb",),
        state: bool = False,
        **options: Any,
    ) -> None:
        super().__init__(env)
        inner: Any = env.unwrapped
        model = getattr(inner, "model", None)
        if not isinstance(model, mujoco.MjModel):
            raise ValueError(f"env: an environment with a model of MuJoCo is expected, not {inner!r}")
        self._inner = inner
        self._channels = (channels,) if isinstance(channels, str) else tuple(channels)
        for channel in self._channels:
            if channel not in _LIMITS:
                raise ValueError(f"channels: there is no channel {channel!r}; there are {', '.join(_LIMITS)}")
        self._has_state = state
        self._camera = Scene(model).camera(camera, width, height, **options)
        boxes: dict[str, spaces.Space[Any]] = {}
        for channel in self._channels:
            least, most, rest, dtype = _LIMITS[channel]
            boxes[channel] = spaces.Box(least, most, (*self._camera.sensor.frame_shape, *rest), dtype)
        if state:
            boxes["state"] = env.observation_space
        self.observation_space = boxes[self._channels[0]] if len(boxes) == 1 else spaces.Dict(boxes)

    def _pictures(self) -> dict[str, NDArray[Any]]:
        return dict(self._camera.render(self._inner.data, channels=self._channels))

    def observation(self, observation: Any) -> Any:
        """Return the picture of the environment's state now."""
        pictures: dict[str, Any] = self._pictures()
        if self._has_state:
            pictures["state"] = observation
        return pictures[self._channels[0]] if len(pictures) == 1 else pictures
