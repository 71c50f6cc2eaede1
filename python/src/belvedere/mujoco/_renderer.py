"""The interface of ``mujoco.Renderer`` without OpenGL."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from belvedere import _arrays
from belvedere._closing import Closing
from belvedere.mujoco._scene import Scene
from belvedere.mujoco._states import States, states_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from belvedere.mujoco._cameras import SceneCamera

#: What is rendered: the channel, and the array's type and last axes.
_MODES: dict[str, tuple[str, type[np.generic], tuple[int, ...]]] = {
    "rgb": ("rgb", np.uint8, (3,)),
    "depth": ("depth", np.float32, ()),
    "segmentation": ("geom", np.int32, (2,)),
}


class Renderer(Closing):
    """Renders as ``mujoco.Renderer`` does: change one import, and no OpenGL is needed.

    ``render()`` returns colours uint8 (height, width, 3); depths float32 (height, width) in metres, the far clip
    distance where nothing is; or segmentation int32 (height, width, 2): geom and ``mjOBJ_GEOM``, −1 where nothing is.
    Of ``scene_option`` only ``geomgroup`` has an effect: sites, contacts and other decoration are not shown.

    Args:
        model: the model.
        height: pixels down.
        width: pixels across.
        max_geom: has no effect.
        smooth: anti-aliased edges of colours, as MuJoCo's.

    """

    def __init__(
        self,
        model: mujoco.MjModel,
        height: int = 240,
        width: int = 320,
        max_geom: int = 10000,
        *,
        smooth: bool = True,
    ) -> None:
        self._model = model
        self._size = _arrays.count("width", width, 1, 16384), _arrays.count("height", height, 1, 16384)
        self._smooth = smooth
        self._mode = "rgb"
        self._scenes: dict[tuple[int, ...], Scene] = {}
        self._cameras: dict[Any, SceneCamera] = {}
        self._state: States | None = None
        self._camera: SceneCamera | None = None
        self._is_closed = False

    @property
    def model(self) -> mujoco.MjModel:
        """The model."""
        return self._model

    @property
    def height(self) -> int:
        """Pixels down."""
        return self._size[1]

    @property
    def width(self) -> int:
        """Pixels across."""
        return self._size[0]

    def enable_depth_rendering(self) -> None:
        """Let ``render`` return depths."""
        self._mode = "depth"

    def disable_depth_rendering(self) -> None:
        """Let ``render`` return colours."""
        self._mode = "rgb"

    def enable_segmentation_rendering(self) -> None:
        """Let ``render`` return segmentation."""
        self._mode = "segmentation"

    def disable_segmentation_rendering(self) -> None:
        """Let ``render`` return colours."""
        self._mode = "rgb"

    def update_scene(
        self,
        data: mujoco.MjData,
        camera: int | str | mujoco.MjvCamera = -1,
        scene_option: mujoco.MjvOption | None = None,
    ) -> None:
        """Take the state and the camera of the next picture.

        Raises:
            ValueError: the state belongs to another model, or there is no such camera.

        """
        if self._is_closed:
            raise RuntimeError("update_scene cannot be called after close.")
        option = mujoco.MjvOption() if scene_option is None else scene_option
        if not isinstance(option, mujoco.MjvOption):
            raise ValueError(f"scene_option: an MjvOption is expected, not {option!r}")
        groups = tuple(int(group) for group in np.flatnonzero(option.geomgroup))
        if groups not in self._scenes:
            self._scenes[groups] = Scene(self._model, groups=groups)
        if not isinstance(camera, (str, int)) or isinstance(camera, bool):
            # The caller may change it from picture to picture.
            self._camera = self._scenes[groups].camera(camera, *self._size, smooth=self._smooth)
        else:
            if (groups, camera) not in self._cameras:
                chosen = self._scenes[groups].camera(camera, *self._size, smooth=self._smooth)
                self._cameras[groups, camera] = chosen
            self._camera = self._cameras[groups, camera]
        read = states_of(self._model, data)
        # The caller's next step changes the state.
        self._state = States(read.lead, read.count, {name: field.copy() for name, field in read.fields.items()})

    def render(self, *, out: NDArray[Any] | None = None) -> NDArray[Any]:
        """Render the picture.

        Args:
            out: an array to write into, which is returned then; its type may differ.

        Raises:
            RuntimeError: ``update_scene`` was not called, or ``close`` was.
            ValueError: ``out`` has another shape.

        """
        if self._is_closed:
            raise RuntimeError("render cannot be called after close.")
        if self._camera is None or self._state is None:
            raise RuntimeError("render cannot be called before update_scene.")
        channel, dtype, rest = _MODES[self._mode]
        shape = (self._size[1], self._size[0], *rest)
        if out is not None and not isinstance(out, np.ndarray):
            raise ValueError(f"out: an array of numpy is expected, not {type(out).__name__}")
        if out is not None and out.shape != shape:
            raise ValueError(f"out: shape {out.shape}; {shape} is expected")
        if out is not None and (out.dtype.kind not in "biufc" or not out.flags.writeable):
            raise ValueError(f"out: {out.dtype}; numbers that can be written to are expected")
        picture = self._camera.render(self._state, channels=(channel,))[channel]
        if self._mode == "depth":
            picture[np.isinf(picture)] = self._model.vis.map.zfar * self._model.stat.extent
        elif self._mode == "segmentation":
            kinds = np.where(picture < 0, -1, int(mujoco.mjtObj.mjOBJ_GEOM))
            picture = np.stack([picture, kinds], axis=-1).astype(dtype)
        if out is None:
            return picture
        out[...] = picture
        return out

    def close(self) -> None:
        """Release the memory."""
        self._is_closed = True
        self._scenes, self._cameras, self._camera, self._state = {}, {}, None, None
