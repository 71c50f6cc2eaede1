"""The frames of a rendered batch."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from belvedere import _picture
from belvedere._above import above

if TYPE_CHECKING:
    from belvedere._sensors import Sensor

#: The channel that is shown: the first one that the frames have.
_SHOWN = ("rgb", "depth", "range", "distance", "true_depth", "true_range", "instance", "class", "normal")
#: The maximum number of frames shown, and of pixels across.
_MOST, _WIDTH = 8, 640
#: The least number of rows that are shown.
_ROWS = 16


class Frames(dict[str, NDArray[Any]]):
    """Arrays by channel, each with the batch's shape followed by the frame's.

    Jupyter shows them as an image: ``frames._repr_png_()`` is a PNG file of the first frames, with scans from
    above. ``frames.picture(channel)`` is one frame as an array of colours, ``frames.above(channel)`` a scan from
    above.
    """

    def __init__(
        self,
        arrays: dict[str, NDArray[Any]],
        lead: tuple[int, ...],
        frame: tuple[int, ...],
        sensor: Sensor | None = None,
        numbers: Sequence[int] = (),
    ) -> None:
        super().__init__(arrays)
        #: The batch's shape: that of the poses without their last axes; for rays, theirs without the last two.
        self.lead = lead
        self._frame = frame
        # The sensor, if the frames are from one, and the number of each.
        self._sensor, self._numbers = sensor, numbers

    def picture(self, channel: str | None = None, index: int | tuple[int, ...] = ()) -> NDArray[np.uint8]:
        """Return a frame as colours (height, width, 3), or grey (height, width).

        Rows are those of a camera, or the lines of a lidar, repeated if there are few. A scanner has no rows: its
        frame is shown as by ``above``.

        Args:
            channel: the channel; by default the first one present of rgb, depth, range and so on.
            index: the index of the frame in the batch.

        Raises:
            ValueError: there is no such channel or frame.

        """
        if self._sensor is not None and self._sensor._view == "firings":
            return self.above(channel, index)
        name, place = self._named(channel), self._place(index)
        values = self[name][place]
        rows = (1, 1, *self._frame)[-2:]
        shown = _picture.picture(name, values.reshape(*rows, *values.shape[len(self._frame) :]))
        if rows[0] == 1 or (self._sensor is not None and self._sensor._view == "lines"):
            shown = np.repeat(shown, -(-_ROWS // max(rows[0], 1)), axis=0)
        return np.repeat(shown, _ROWS, axis=1) if rows == (1, 1) else shown

    def above(self, channel: str | None = None, index: int | tuple[int, ...] = ()) -> NDArray[np.uint8]:
        """Return a frame of a lidar or scanner seen from above: (height, width, 3), forward up, rings around the sensor.

        Dots are at the positions of ``points`` or of ranges; without either, one metre away.

        Args:
            channel: the channel that gives the colours; the default is that of ``picture``.
            index: the index of the frame in the batch.

        Raises:
            ValueError: there is no such channel or frame, or the frame is not a scan.

        """
        name, place = self._named(channel), self._place(index)
        if self._sensor is None or self._sensor._view == "picture":
            raise ValueError("above: frames of a Lidar or a Scanner are expected; these have a picture")
        if "points" in self:
            places = self["points"][place]
        else:
            number = self._numbers[int(np.ravel_multi_index(place, self.lead))] if place else self._numbers[0]
            ranges = next((self[kind][place] for kind in ("range", "true_range") if kind in self), None)
            places = self._sensor._directions(number)
            with np.errstate(invalid="ignore"):
                places = np.broadcast_to(places, (*self._frame, 3)) * (1 if ranges is None else ranges[..., None])
        values = self[name][place]
        rest = values.shape[len(self._frame) :]
        if values.ndim < len(self._frame):
            # One value for each firing, which has several returns.
            values = np.broadcast_to(values[:, None], self._frame)
        places = places.reshape(-1, 3)
        there = np.isfinite(places).all(axis=1)
        colours = _picture.picture(name, values.reshape(-1, 1, *rest)[there])
        return above(places[there], colours[:, 0])

    def _repr_png_(self) -> bytes | None:
        """Return the first frames as a PNG file, for Jupyter."""
        total = min(math.prod(self.lead), _MOST)
        if not self or total == 0 or 0 in self._frame:
            return None
        is_scan = self._sensor is not None and self._sensor._view != "picture"
        indices = [tuple(int(part) for part in np.unravel_index(index, self.lead)) for index in range(total)]
        frames = [self.above(index=index) if is_scan else self.picture(index=index) for index in indices]
        sheet = _picture.side_by_side(frames) if total > 1 else frames[0]
        step = -(-sheet.shape[1] // (_WIDTH * min(total, 2)))
        # Keep the height of strips.
        down = min(step, max(sheet.shape[0] // _ROWS, 1))
        return _picture.png(np.ascontiguousarray(sheet[::down, ::step]))

    def _named(self, channel: str | None) -> str:
        if channel is None:
            channel = next((name for name in (*_SHOWN, *self) if name in self), None)
        if channel is None or channel not in self:
            raise ValueError(f"channel: one of {', '.join(self) or 'none'} is expected, not {channel!r}")
        return channel

    def _place(self, index: int | tuple[int, ...]) -> tuple[int, ...]:
        """Return the full index of a frame in the batch; missing axes are 0."""
        given = index if isinstance(index, tuple) else (index,)
        place = (*given, *(0,) * (len(self.lead) - len(given)))
        if len(place) != len(self.lead) or not all(
            -size <= part < size for part, size in zip(place, self.lead, strict=True)
        ):
            raise ValueError(f"index: {index} is not within the batch's shape {self.lead}")
        return tuple(int(part) % size for part, size in zip(place, self.lead, strict=True))

    def __repr__(self) -> str:
        """Return names, shapes and types of the arrays."""
        arrays = ", ".join(f"{name}: {values.dtype}{list(values.shape)}" for name, values in self.items())
        return f"<Frames {arrays}>"
