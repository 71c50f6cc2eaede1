"""Cameras, depth cameras, lidars and scanners: batches of frames as arrays."""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING, Any, Literal, Protocol

import numpy as np

from belvedere import _arrays, _native
from belvedere._channels import Channels, prepare
from belvedere._frames import Frames
from belvedere._lens import Lens
from belvedere._looks import SEES
from belvedere._world import World

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from belvedere._arrays import ArrayLike, Bodies
    from belvedere._native import World as _NativeWorld
    from belvedere._native import _Each, _Lens, _Moves, _Places

_F32, _U32 = np.dtype(np.float32), np.dtype(np.uint32)


def _truth(depth: str, range_: str) -> dict[str, tuple[np.dtype[Any], tuple[int, ...]]]:
    """Return the channels of ground truth for each ray, with these names for distances."""
    return {
        depth: (_F32, ()),
        range_: (_F32, ()),
        "normal": (_F32, (3,)),
        "instance": (_U32, ()),
        "class": (_U32, ()),
        "incidence": (_F32, ()),
        "flow": (_F32, (2,)),
        "flow_back": (_F32, (2,)),
    }


class _Native(Protocol):
    def render(
        self,
        world: _NativeWorld,
        now: _Places,
        after: _Places | None,
        before: _Places | None,
        each: _Each,
        outputs: dict[str, Any],
        threads: int,
    ) -> None: ...


class Sensor:
    """Base of all sensors. A sensor looks along +x of its pose; y is left, z is up.

    Sensors are immutable, and can be pickled and copied.
    """

    #: The arguments of the constructor.
    _arguments: dict[str, Any]
    #: The display of its frames.
    _view: Literal["picture", "lines", "firings"] = "picture"
    _native: _Native
    _channels: Channels
    _default: tuple[str, ...]
    _frame: tuple[int, ...]

    @property
    def channels(self) -> tuple[str, ...]:
        """The names of all channels."""
        return tuple(self._channels)

    @property
    def main_channels(self) -> tuple[str, ...]:
        """The channels that ``render`` renders if none are named."""
        return self._default

    @property
    def frame_shape(self) -> tuple[int, ...]:
        """The shape of a frame: (height, width), (lines, beams) or (firings, returns)."""
        return self._frame

    def __reduce__(self) -> tuple[Any, ...]:
        """Return the constructor and its arguments."""
        return functools.partial(type(self), **self._arguments), ()

    def _directions(self, number: int) -> NDArray[np.float32]:
        """Return the directions of the rays of a frame with this number, (…, 3), for scanning sensors."""
        raise NotImplementedError

    def render(
        self,
        world: World,
        poses: ArrayLike,
        out: Mapping[str, ArrayLike] | None = None,
        *,
        channels: Sequence[str] | None = None,
        seeds: ArrayLike | int = 0,
        frames: ArrayLike | int = 0,
        bodies: Bodies | None = None,
        after: ArrayLike | None = None,
        bodies_after: Bodies | None = None,
        before: ArrayLike | None = None,
        bodies_before: Bodies | None = None,
        threads: int | None = None,
    ) -> Frames:
        """Render a frame from each pose.

        The bytes of a frame depend only on world, sensor, pose, bodies and seed: not on the batch or the position
        in it, the number of threads or the machine.

        Args:
            world: the world.
            poses: the sensor's poses: (…, 7), x y z qx qy qz qw in metres, or (…, 4, 4). The axes before the last
                ones are the batch's shape.
            out: arrays to write into, by channel, with the right shape and type, contiguous and writeable. Arrays
                of other libraries are accepted by ``__dlpack__``.
            channels: the channels to render; by default those of ``out``, or the sensor's main one.
            seeds: the seeds of the noise: one for each frame, with the batch's shape; or the first of consecutive
                ones.
            frames: the number of each frame in its stream, or one for all: noise is a function of seed and number,
                and some scanners continue to rotate from one frame to the next.
            bodies: poses of bodies that differ from the world's: a dictionary, by name or number, of poses that
                broadcast to the batch's shape, or an array (…, bodies, 7) of all.
            after: the sensor's poses at the next frame, like ``poses``, for ``flow``. For a scanner, its poses at
                the end of the frame: each ray is cast from the pose at its time. The motion in between is straight
                and turns evenly by the shorter way, so a rotation by more than π becomes a smaller one in the
                opposite direction.
            bodies_after: poses of bodies at that time; ``bodies`` by default.
            before: the sensor's poses at the previous frame, for ``flow_back``.
            bodies_before: poses of bodies at that time; ``bodies`` by default.
            threads: the number of threads; one per processor by default.

        Returns:
            The arrays, by channel, with the batch's shape followed by the frame's.

        Raises:
            ValueError: an argument is invalid; the message has its name, its shape and what was expected. Nothing
                is written then.
            KeyboardInterrupt: Ctrl-C; frames that were not begun are not written.

        """
        if not isinstance(world, World):
            raise ValueError(f"world: a World is expected, not {type(world).__name__}")
        flat, lead = _arrays.poses("poses", poses)
        outputs = prepare(self._channels, self._default, channels, out, lead, self._frame)
        # Names take time in proportion to the number of bodies.
        is_still = bodies is None and bodies_after is None and bodies_before is None
        names = () if is_still else world.bodies
        moved = _arrays.bodies("bodies", bodies, lead, names)
        later = self._moment("after", after, bodies_after, lead, names, moved)
        earlier = self._moment("before", before, bodies_before, lead, names, moved)
        numbers = _arrays.numbers_of_frames(frames, lead)
        each = (_arrays.seeds("seeds", seeds, lead), numbers, None, None)
        self._take(world._native, lead, (flat, *moved), later, earlier, each, outputs, threads)
        return Frames(outputs, lead, self._frame, self, numbers)

    def _moment(
        self,
        argument: str,
        value: ArrayLike | None,
        given: Bodies | None,
        lead: tuple[int, ...],
        names: Sequence[str],
        moved: _Moves,
    ) -> _Places | None:
        """Return the poses of sensor and bodies at another time."""
        if value is None:
            if given is not None:
                raise ValueError(f"bodies_{argument}: {argument}=poses is expected as well")
            return None
        other, shape = _arrays.poses(argument, value)
        if shape != lead:
            raise ValueError(f"{argument}: poses of shape {shape}; {lead}, as poses, is expected")
        elsewhere = moved if given is None else _arrays.bodies(f"bodies_{argument}", given, lead, names)
        return (other, *elsewhere)

    def _take(
        self,
        world: _NativeWorld,
        lead: tuple[int, ...],
        now: _Places,
        after: _Places | None,
        before: _Places | None,
        each: _Each,
        outputs: dict[str, Any],
        threads: int | None,
    ) -> None:
        """Render frames with checked arguments."""
        for flow, there, argument in (("flow", after, "after"), ("flow_back", before, "before")):
            if flow in outputs and there is None:
                raise ValueError(f"channels: {flow!r} needs the poses at another time: give {argument}=poses")
        workers = _arrays.threads(threads)
        if math.prod(lead):
            self._native.render(world, now, after, before, each, outputs, workers)


class Camera(Sensor):
    """A colour camera. It sees the outside of surfaces, where triangles appear counter-clockwise.

    Channels: ``rgb`` uint8 (height, width, 3), or ``(height, width)`` if it is grey; and ground truth for each
    pixel: ``depth`` float32, metres along the optical axis, ∞ without a hit; ``range``, metres along the ray;
    ``normal`` float32 (…, 3), outwards, in the world's axes; ``instance`` uint32, 2**32 − 1 without a hit (see
    ``World.instance_bodies``); ``class`` uint32, 0 without a hit; ``incidence`` float32, radians between ray
    and normal; ``flow`` and ``flow_back`` float32 (…, 2), pixels to the position of the point in the next and
    in the previous frame.

    Args:
        width: pixels across.
        height: pixels down.
        fov: horizontal field of view in radians, for a pinhole with square pixels.
        lens: another lens, instead of ``fov``.
        near: metres; nearer surfaces are not seen.
        far: metres; farther surfaces are not seen.
        grey: one byte per pixel instead of three.
        smooth: anti-aliased edges.
        exposure: a factor of the light.
        noise: standard deviation of a colour value, from 0 to 1.
        device: a preset of the sensor chip and processing: ``webcam``, ``machine_vision`` or ``raspberry_pi_hq``.

    Raises:
        ValueError: an argument is out of its range.

    """

    _default = ("rgb",)

    def __init__(
        self,
        width: int,
        height: int,
        fov: float | None = None,
        *,
        lens: Lens | None = None,
        near: float = 0.02,
        far: float = 300.0,
        grey: bool = False,
        smooth: bool = False,
        exposure: float = 1.0,
        noise: float = 0.0,
        device: str | None = None,
    ) -> None:
        self._arguments = _given(locals())
        size = _size(width, height)
        self._native = _native.Camera(
            size,
            _lens(fov, lens),
            [_arrays.number("near", near), _arrays.number("far", far)],
            _arrays.number("exposure", exposure),
            bool(grey),
            bool(smooth),
            [0.0, _arrays.number("noise", noise)],
            None if device is None else _arrays.text("device", device),
        )
        self._frame = (size[1], size[0])
        self._channels = {"rgb": (np.dtype(np.uint8), () if grey else (3,)), **_truth("depth", "range")}


class DepthCamera(Sensor):
    """A depth camera, with a colour camera in the same place.

    Channels: ``depth`` float32, measured metres along the optical axis: −∞ too near, +∞ too far or no hit, NaN
    where the device cannot measure; ``depth_mm`` uint16, 0 without a measurement; ``points`` float32 (…, 3) in
    the optical frame (x right, y down, z forward), NaN without a measurement; ``rgb`` as for ``Camera``; and
    ground truth: ``true_depth`` and the other channels of ``Camera``.

    Args:
        width: pixels across; the model's by default.
        height: pixels down; the model's by default.
        fov: horizontal field of view in radians; the model's by default, unless ``lens`` is given.
        model: a preset of the device, with its noise, quantisation, shadows and range: see
            ``DepthCamera.models()``. Without a model, depths are exact.
        projector: for a stereo ``model``, False disables its projector, so that it measures only textured surfaces.
        lens: another lens, in place of ``fov``.
        least: metres; depths up to this are too near. The default is the model's, or 0.
        most: metres; depths from this on are too far. The default is the model's, or ∞.
        noise: standard deviation of depths in metres, for a camera without ``model``.
        near: metres; nearer surfaces are not seen.
        far: metres; farther surfaces are not seen.
        grey: the option ``grey`` of the colour camera, see ``Camera``.
        smooth: the option ``smooth`` of the colour camera.
        exposure: the option ``exposure`` of the colour camera.
        color_noise: the option ``noise`` of the colour camera.
        device: the option ``device`` of the colour camera.
        faces: ``both`` sides of surfaces, or ``front``: only the outside, where triangles appear counter-clockwise,
            so that a camera inside its own housing sees out. All channels show the same surfaces.

    Raises:
        ValueError: an argument is out of its range, or there is no such model.

    """

    _default = ("depth",)

    def __init__(
        self,
        width: int | None = None,
        height: int | None = None,
        fov: float | None = None,
        *,
        model: str | None = None,
        projector: bool = True,
        lens: Lens | None = None,
        least: float | None = None,
        most: float | None = None,
        noise: float = 0.0,
        near: float = 0.02,
        far: float = 300.0,
        grey: bool = False,
        smooth: bool = False,
        exposure: float = 1.0,
        color_noise: float = 0.0,
        device: str | None = None,
        faces: str = "both",
    ) -> None:
        self._arguments = _given(locals())
        if model is not None:
            _arrays.text("model", model)
        preset = next((known for known in _native.DepthCamera.presets() if known[0] == model), None)
        if model is not None and preset is None:
            raise ValueError(f"model: one of {', '.join(self.models())} is expected, not {model!r}")
        if preset is not None:
            width = preset[1][0] if width is None else width
            height = preset[1][1] if height is None else height
            fov = math.radians(preset[2]) if fov is None and lens is None else fov
            if noise != 0.0:
                raise ValueError("noise: the model has its own; leave one of the two out")
        elif not projector:
            raise ValueError("projector: a depth camera without a model has none")
        if width is None or height is None:
            raise ValueError("width, height: two whole numbers are expected, or a model")
        size = _size(width, height)
        self._native = _native.DepthCamera(
            size,
            _lens(fov, lens),
            [_arrays.number("near", near), _arrays.number("far", far)],
            _arrays.number("exposure", exposure),
            bool(grey),
            bool(smooth),
            [0.0, _arrays.number("color_noise", color_noise)],
            None if device is None else _arrays.text("device", device),
            [
                None if least is None else _arrays.number("least", least),
                None if most is None else _arrays.number("most", most),
            ],
            [0.0, _arrays.number("noise", noise)],
            model,
            bool(projector),
            _arrays.choice("faces", faces, {"front": 0, "both": 1}),
        )
        self._frame = (size[1], size[0])
        self._channels = {
            "depth": (_F32, ()),
            "depth_mm": (np.dtype(np.uint16), ()),
            "points": (_F32, (3,)),
            "rgb": (np.dtype(np.uint8), () if grey else (3,)),
            **_truth("true_depth", "range"),
        }

    @staticmethod
    def models() -> list[str]:
        """Return the names of the presets."""
        return [name for name, *_ in _native.DepthCamera.presets()]


class Lidar(Sensor):
    """A lidar with a regular grid of beams, all measured at the same time, like Gazebo's.

    Channels: ``range`` float32 (lines, beams), measured metres: −∞ too near, +∞ nothing in range; ``intensity``
    float32; and ground truth: ``true_range``, ``depth`` and the other channels of ``Camera``. Lines are ordered
    from the lowest up, beams counter-clockwise.

    Args:
        beams: the number of beams per line.
        lines: the number of lines.
        angles: the angles of the first and the last beam, radians, counter-clockwise from +x.
        elevations: the elevations of the first and the last line, radians, upwards.
        least: metres; nearer surfaces are too near.
        most: metres; farther surfaces are out of range.
        noise: standard deviation of ranges in metres.
        sees: ``collision`` shapes, like lidars in robot files; ``visual`` ones; or ``all``.
        faces: ``both`` sides of surfaces, or ``front``.

    Raises:
        ValueError: an argument is out of its range.

    """

    _default = ("range",)
    _view = "lines"

    def __init__(
        self,
        beams: int = 360,
        lines: int = 1,
        *,
        angles: tuple[float, float] = (-math.pi, math.pi),
        elevations: tuple[float, float] = (0.0, 0.0),
        least: float = 0.0,
        most: float = 30.0,
        noise: float = 0.0,
        sees: str = "collision",
        faces: str = "both",
    ) -> None:
        self._arguments = _given(locals())
        across, down = _arrays.count("beams", beams, 1, 32767), _arrays.count("lines", lines, 1, 32767)
        first, last = _arrays.numbers("angles", angles, 2)
        lowest, highest = _arrays.numbers("elevations", elevations, 2)
        self._native = _native.Lidar(
            (across, first, last),
            (down, lowest, highest),
            [_arrays.number("least", least), _arrays.number("most", most)],
            [0.0, _arrays.number("noise", noise)],
            _arrays.choice("sees", sees, SEES),
            _arrays.choice("faces", faces, {"front": 0, "both": 1}) == 1,
        )
        self._frame = (down, across)
        self._angles = np.linspace(first, last, across), np.linspace(lowest, highest, down)[:, None]
        self._channels = {"range": (_F32, ()), "intensity": (_F32, ()), **_truth("depth", "true_range")}

    def _directions(self, number: int) -> NDArray[np.float32]:
        azimuth, elevation = self._angles
        level = np.cos(elevation)
        parts = level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)
        return np.stack(np.broadcast_arrays(*parts), axis=-1).astype(np.float32)


def _given(names: dict[str, Any]) -> dict[str, Any]:
    """Return the arguments from the ``locals()`` at the start of a method."""
    return {name: value for name, value in names.items() if name != "self"}


def _size(width: int, height: int) -> list[int]:
    return [_arrays.count("width", width, 1, 16384), _arrays.count("height", height, 1, 16384)]


def _lens(fov: float | None, lens: Lens | None) -> _Lens:
    if (fov is None) == (lens is None):
        raise ValueError("fov, lens: one of the two is expected")
    if lens is not None:
        if not isinstance(lens, Lens):
            raise ValueError(f"lens: a Lens is expected, such as Lens.pinhole(…), not {lens!r}")
        parameters = _arrays.array("lens", lens.parameters, np.float64)
        if parameters.ndim != 1:
            raise ValueError(f"lens: parameters of shape {parameters.shape}; a row of numbers is expected")
        return (_arrays.text("lens", lens.model), parameters.tolist()), None
    angle = _arrays.number("fov", fov if fov is not None else 0.0)
    if not 0.0 < angle < math.pi:
        raise ValueError(f"fov: an angle in radians between 0 and π is expected, not {angle:g}")
    return None, angle
