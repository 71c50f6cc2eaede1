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
    """A received frame in shared memory.

    Arrays of a frame are read-only views, which do not change as long as they or the frame are held. A stream lets
    each subscriber hold two frames at a time, unless its publisher set another number: ``copy()`` data that you
    need for longer.

    As a context manager the frame is released at the end of the block. Accessing it afterwards raises
    ``ReleasedError``. If an array still points into it, the end of the block raises ``FrameInUseError``.
    """

    def __init__(self, taken: _native.Frame) -> None:
        #: The memory that arrays point into and keep alive; None after the release.
        self._owner: _native.Frame | None = taken
        # A copy, since the original could change after the check.
        self._header: np.void = np.frombuffer(taken.header, wire.HEADER)[0]
        #: Frames that were sent between the previously taken frame and this one.
        self.missed = taken.missed
        #: True if the publisher was restarted since the previous frame.
        self.restarted = taken.restarted
        #: True if the frame was sent before this subscriber connected: its age then does not show the latency.
        self.from_history = taken.is_from_history

    @property
    def header(self) -> np.void:
        """All fields of the header, see ``belvedere.wire.HEADER``. Usable after the release, too."""
        return self._header

    @property
    def kind(self) -> wire.Kind:
        """The kind of the payload."""
        return wire.Kind(int(self._header["kind"]))

    @property
    def encoding(self) -> wire.Encoding:
        """The encoding of an element."""
        return wire.Encoding(int(self._header["encoding"]))

    @property
    def seq(self) -> int:
        """The sequence number of the frame in its session, from 0."""
        return int(self._header["seq"])

    @property
    def session(self) -> int:
        """The random number of the publisher's life."""
        return int(self._header["session"])

    @property
    def stamp_ns(self) -> int:
        """Time of capture in simulated time, nanoseconds."""
        return int(self._header["stamp_ns"])

    @property
    def width(self) -> int:
        """Elements per row."""
        return int(self._header["width"])

    @property
    def height(self) -> int:
        """Number of rows."""
        return int(self._header["height"])

    @property
    def frame_id(self) -> str:
        """The coordinate frame of the data."""
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
        """The mapping from pixels to directions, for images, depth images and clouds."""
        if self.kind not in (wire.Kind.IMAGE, wire.Kind.DEPTH_IMAGE, wire.Kind.POINT_CLOUD):
            raise AttributeError(f"a {self.kind.name} has no intrinsics")
        return wire.intrinsics(self._header)

    @property
    def scan_geometry(self) -> wire.ScanGeometry:
        """Angles and limits, for scans."""
        if self.kind != wire.Kind.LASER_SCAN:
            raise AttributeError(f"a {self.kind.name} has no scan geometry")
        return wire.scan_geometry(self._header)

    @property
    def age_ns(self) -> int:
        """Nanoseconds since the frame was sent."""
        return max(0, time.clock_gettime_ns(time.CLOCK_MONOTONIC) - int(self._header["publish_mono_ns"]))

    @property
    def payload(self) -> np.ndarray[Any, np.dtype[np.uint8]]:
        """All bytes of the payload, in place."""
        if self._owner is None:
            raise ReleasedError("the frame was released: use it within its block, or copy() what is needed")
        return np.asarray(self._owner)

    @property
    def array(self) -> np.ndarray[Any, np.dtype[Any]]:
        """The data, in place.

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
        """Return the memory to the publisher. Releasing it twice is not an error.

        Raises:
            FrameInUseError: an array still points into the frame; the memory is returned when the array is gone.

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
        """Release the frame; an error of the block takes precedence over one of the release."""
        if error is None:
            self.release()
        else:
            self._owner = None

    def __repr__(self) -> str:
        """Return kind, number and size."""
        state = "" if self._owner is not None else ", released"
        return f"<Frame kind {self._header['kind']} seq {self.seq}, {self.width} x {self.height}{state}>"
