"""A received frame."""

from __future__ import annotations

import time
import weakref
from typing import TYPE_CHECKING, Any

import numpy as np

from belvedere import wire
from belvedere._errors import FrameInUseError, ReleasedError

if TYPE_CHECKING:
    from types import TracebackType

    from typing_extensions import Self

    from belvedere import _native


class Frame:
    """A frame where it lies in shared memory.

    Arrays taken from it are views, read-only, and unchanged as long as they or the frame are held. A stream lets
    each subscriber hold two frames at a time, if its publisher has set no other number: ``copy()`` what is needed
    for longer.

    As a context manager it is released at the end of the block: looking at it afterwards raises ``ReleasedError``,
    and an array that still points into it raises ``FrameInUseError`` at the end of the block.
    """

    def __init__(self, taken: _native.Frame) -> None:
        #: What arrays are made of, and keep alive; None after the release.
        self._owner: _native.Frame | None = taken
        # A copy: what was checked is what is believed later.
        self._header: np.void = np.frombuffer(taken.header, wire.HEADER)[0]
        #: Frames that were sent between the last one taken and this one.
        self.missed = taken.missed
        #: Whether the publisher was started again since the frame before.
        self.restarted = taken.restarted
        #: Whether it was sent before this subscriber was connected: its age says nothing then.
        self.from_history = taken.is_from_history

    @property
    def header(self) -> np.void:
        """All fields of the header, see ``belvedere.wire.HEADER``. Usable after the release, too."""
        return self._header

    @property
    def kind(self) -> wire.Kind:
        """What the payload is."""
        return wire.Kind(int(self._header["kind"]))

    @property
    def encoding(self) -> wire.Encoding:
        """How an element is coded."""
        return wire.Encoding(int(self._header["encoding"]))

    @property
    def seq(self) -> int:
        """Counts the frames of one session from 0."""
        return int(self._header["seq"])

    @property
    def session(self) -> int:
        """Random per publisher life."""
        return int(self._header["session"])

    @property
    def stamp_ns(self) -> int:
        """Moment of capture in simulation time, nanoseconds."""
        return int(self._header["stamp_ns"])

    @property
    def width(self) -> int:
        """Elements per row."""
        return int(self._header["width"])

    @property
    def height(self) -> int:
        """Rows."""
        return int(self._header["height"])

    @property
    def frame_id(self) -> str:
        """The frame that the data are given in."""
        return bytes(self._header["frame_id"]).decode(errors="replace")

    @property
    def position(self) -> tuple[float, float, float]:
        """``world_from_sensor``: the sensor's origin in the world, metres."""
        x, y, z = self._header["position"].tolist()
        return x, y, z

    @property
    def orientation(self) -> tuple[float, float, float, float]:
        """``world_from_sensor``: its orientation, x y z w."""
        x, y, z, w = self._header["orientation"].tolist()
        return x, y, z, w

    @property
    def intrinsics(self) -> wire.Intrinsics:
        """How pixels map to directions; images, depth images and clouds have it."""
        if self.kind not in (wire.Kind.IMAGE, wire.Kind.DEPTH_IMAGE, wire.Kind.POINT_CLOUD):
            raise AttributeError(f"a {self.kind.name} has no intrinsics")
        return wire.intrinsics(self._header)

    @property
    def scan_geometry(self) -> wire.ScanGeometry:
        """Angles and limits; scans have them."""
        if self.kind != wire.Kind.LASER_SCAN:
            raise AttributeError(f"a {self.kind.name} has no scan geometry")
        return wire.scan_geometry(self._header)

    @property
    def age_ns(self) -> int:
        """Nanoseconds since it was sent."""
        return max(0, time.clock_gettime_ns(time.CLOCK_MONOTONIC) - int(self._header["publish_mono_ns"]))

    @property
    def payload(self) -> np.ndarray[Any, np.dtype[np.uint8]]:
        """All bytes of the payload, where they lie."""
        if self._owner is None:
            raise ReleasedError("the frame was released: look at it within its block, or copy() what is needed")
        return np.asarray(self._owner)

    @property
    def array(self) -> np.ndarray[Any, np.dtype[Any]]:
        """The data, where they lie.

        Shape and type: colour images (height, width, 3) of uint8, grey ones (height, width); depth (height, width)
        of float32 in metres or uint16 in millimetres; scans (layers, rays) of float32 in metres; clouds (height,
        width) of x, y, z, rgb, or of x, y, z, intensity, ring, time; all else (count,) of the struct in
        ``belvedere.wire.STRUCTS``.
        """
        return self._plane(0)

    @property
    def intensities(self) -> np.ndarray[Any, np.dtype[np.float32]] | None:
        """Intensities of a scan, of the shape of its ranges; None if it has none."""
        if not int(self._header["flags"]) & wire.HAS_INTENSITIES:
            return None
        return self._plane(self.height * int(self._header["row_stride"]))

    def _plane(self, offset: int) -> np.ndarray[Any, np.dtype[Any]]:
        return wire.plane(self._header, self.payload, offset)

    def release(self) -> None:
        """Give the memory back to the publisher. Doing it twice is no error.

        Raises:
            FrameInUseError: an array still points into the frame; the memory is given back when it is gone.

        """
        if self._owner is None:
            return
        owner = weakref.ref(self._owner)
        self._owner = None
        if owner() is not None:
            raise FrameInUseError(
                "an array still points into the released frame: copy() what is needed after the block, "
                "or delete the variable before its end"
            )

    def __enter__(self) -> Self:
        """Return the frame itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Release it; an error of the block itself goes before one of the release."""
        if error is None:
            self.release()
        else:
            self._owner = None

    def __repr__(self) -> str:
        """Kind, number and size."""
        state = "" if self._owner is not None else ", released"
        return f"<Frame kind {self._header['kind']} seq {self.seq}, {self.width} x {self.height}{state}>"
