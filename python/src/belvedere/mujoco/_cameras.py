"""Cameras of a model."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from belvedere import _arrays
from belvedere._channels import names_of
from belvedere._frames import Frames
from belvedere._lens import Lens
from belvedere._sensors import Camera, DepthCamera, Sensor
from belvedere.mujoco._names import number_of
from belvedere.mujoco._states import States, states_of
from belvedere.mujoco._worlds import numbers_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from belvedere._arrays import ArrayLike
    from belvedere.mujoco._scene import Scene
    from belvedere.mujoco._states import Frames as FramesOfStates


class SceneCamera:
    """A camera of a model; :meth:`belvedere.mujoco.Scene.camera` makes it.

    Its channels are those of its sensor, and ``geom`` int32: the geom of each pixel, −1 without a hit.
    """

    def __init__(
        self,
        scene: Scene,
        camera: str | int | mujoco.MjvCamera,
        width: int | None,
        height: int | None,
        sensor: Sensor | None,
        options: dict[str, Any],
    ) -> None:
        self._scene = scene
        self._camera = _camera_of(scene.model, camera)
        if sensor is not None:
            if not isinstance(sensor, (Camera, DepthCamera)):
                raise ValueError(f"sensor: a Camera or DepthCamera is expected, not {sensor!r}")
            if width is not None or height is not None or options:
                raise ValueError("sensor: it has its own size and options; leave the others out")
            #: The sensor in this place.
            self.sensor: Sensor = sensor
            return
        size = _size(scene.model, self._camera, width, height)
        lens, near, far = _optics(scene.model, self._camera, size)
        self.sensor = Camera(*size, lens=lens, **({"near": near, "far": far} | options))

    def render(
        self,
        states: Any,
        channels: Sequence[str] | None = None,
        *,
        seeds: ArrayLike | int = 0,
        frames: ArrayLike | int = 0,
        threads: int | None = None,
    ) -> Frames:
        """Render a frame of each state.

        Args:
            states: an ``MjData``, a list of them, ``qpos`` (…, nq), or a dictionary of arrays with names and shapes
                of ``MjData``, a state for each of their first axes: ``geom_xpos`` (…, ngeom, 3) and ``geom_xmat``
                (…, ngeom, 9), ``cam_xpos`` and ``cam_xmat`` for a camera of the model, ``light_xpos`` and
                ``light_xdir`` if lamps move.
            channels: the channels to render; by default the sensor's main one.
            seeds: the seeds of the noise: one for each frame, or the first of consecutive ones.
            frames: the number of each frame, or one for all.
            threads: the number of threads; one per processor by default.

        Returns:
            The arrays, by channel, with the shape of the states followed by the frame's.

        Raises:
            ValueError: an argument is invalid.

        """
        scene, sensor = self._scene, self.sensor
        wanted = names_of(channels, sensor.main_channels)
        rendered = list(dict.fromkeys("instance" if name == "geom" else name for name in wanted))
        read = states_of(scene.model, states)
        own, number = self._frames(read)
        places = scene.places(read, own, number, is_camera=True)
        numbers = numbers_of(seeds, frames, read.lead)
        looks = scene.worlds.looks(read, own[1], number)
        arrays = scene.worlds.render(sensor, read.lead, places, None, rendered, numbers, looks, threads)
        if "geom" in wanted:
            arrays["geom"] = scene.geom_of(arrays["instance"])
        shown = {name: arrays[name] for name in wanted}
        return Frames(shown, read.lead, sensor.frame_shape, sensor, numbers[1])

    def _frames(self, states: States) -> tuple[FramesOfStates, int]:
        """Return places and matrices of the model's cameras in each state, and which is this one."""
        if self._camera.type == mujoco.mjtCamera.mjCAMERA_FIXED:
            return states.frames("cam_"), int(self._camera.fixedcamid)
        place, matrix = _frame_of(self._scene.model, self._scene.still, self._camera)
        # One camera, in the same place in all states.
        places, matrices = (np.repeat(part[None, None], states.count, axis=0) for part in (place, matrix))
        return (places, matrices), 0


def _camera_of(model: mujoco.MjModel, camera: str | int | mujoco.MjvCamera) -> mujoco.MjvCamera:
    if isinstance(camera, mujoco.MjvCamera):
        if camera.type not in (mujoco.mjtCamera.mjCAMERA_FIXED, mujoco.mjtCamera.mjCAMERA_FREE):
            raise ValueError(
                "camera: a fixed or a free MjvCamera is expected; one that tracks a body is not supported"
            )
        chosen = camera
    else:
        chosen = mujoco.MjvCamera()
        if isinstance(camera, (int, np.integer)) and not isinstance(camera, bool) and camera == -1:
            mujoco.mjv_defaultFreeCamera(model, chosen)
        else:
            chosen.type = mujoco.mjtCamera.mjCAMERA_FIXED
            chosen.fixedcamid = number_of(model, mujoco.mjtObj.mjOBJ_CAMERA, "camera", camera, model.ncam)
    if chosen.type == mujoco.mjtCamera.mjCAMERA_FIXED:
        _arrays.count("camera: its fixedcamid", int(chosen.fixedcamid), 0, model.ncam - 1)
        is_flat = bool(model.cam_projection[chosen.fixedcamid])
    else:
        is_flat = bool(chosen.orthographic)
    if is_flat:
        raise ValueError("camera: it is orthographic; a camera with a perspective is expected")
    return chosen


def _size(
    model: mujoco.MjModel, camera: mujoco.MjvCamera, width: int | None, height: int | None
) -> tuple[int, int]:
    own = [int(model.vis.global_.offwidth), int(model.vis.global_.offheight)]
    if camera.type == mujoco.mjtCamera.mjCAMERA_FIXED:
        resolution = model.cam_resolution[camera.fixedcamid]
        if min(resolution) > 1:
            own = [int(pixels) for pixels in resolution]
    return (
        _arrays.count("width", own[0] if width is None else width, 1, 16384),
        _arrays.count("height", own[1] if height is None else height, 1, 16384),
    )


def _optics(model: mujoco.MjModel, camera: mujoco.MjvCamera, size: tuple[int, int]) -> tuple[Lens, float, float]:
    """Return the lens, the nearest and the farthest distance, from the frustum of MuJoCo's renderer."""
    vertical, horizontal, clip = (np.zeros(2, np.float32) for _ in range(3))
    mujoco.mjv_cameraFrustum(vertical, horizontal, clip, model, camera)
    (below, above), (left, right), (near, far) = vertical.tolist(), horizontal.tolist(), clip.tolist()
    width, height = size
    # Pixels are square, unless the model has the sensor's size: its whole picture is then stretched to these pixels.
    down = (below + above) / height
    across = (left + right) / width if left + right > 0.0 else down
    middle = (right - left) / 2.0 / across
    lens = Lens.pinhole(near / across, near / down, (width - 1) / 2.0 - middle, above / down - 0.5)
    return lens, near, far


def _frame_of(
    model: mujoco.MjModel, still: mujoco.MjData, camera: mujoco.MjvCamera
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return place (3,) and matrix (9,) of a free camera, which is in no state, in the axes of MuJoCo's cameras."""
    place, forward, up, right = (np.zeros(3) for _ in range(4))
    mujoco.mjv_cameraFrame(place, forward, up, right, still, camera)
    return place, np.array([right, up, -forward]).T.ravel()
