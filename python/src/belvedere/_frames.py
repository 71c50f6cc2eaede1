"""What a batch is rendered into."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from belvedere import _picture

#: What is shown of frames with several channels, the first that is there.
_SHOWN = ("rgb", "depth", "range", "true_depth", "true_range", "instance", "class", "normal", "distance")
#: So many frames are shown at the most, reduced to so many pixels across.
_MOST, _WIDTH = 8, 640


class Frames(dict[str, NDArray[Any]]):
    """Arrays by channel, each of the batch's shape and then the frame's.

    Jupyter shows it as a picture: ``frames._repr_png_()`` is a PNG file of the first frames. ``frames.picture(channel)``
    is one frame as an array of colours.
    """

    def __init__(self, arrays: dict[str, NDArray[Any]], lead: tuple[int, ...]) -> None:
        super().__init__(arrays)
        #: The batch's shape: that of the poses without their last axes.
        self.lead = lead

    def picture(self, channel: str | None = None, index: int | tuple[int, ...] = ()) -> NDArray[np.uint8]:
        """Return a frame as colours (height, width, 3), or (height, width) of grey.

        Args:
            channel: which one; without it, the first of rgb, depth, range and so on that is there.
            index: which frame of the batch.

        Raises:
            ValueError: there is no such channel or frame.

        """
        if channel is None:
            channel = next((name for name in (*_SHOWN, *self) if name in self), None)
        if channel is None or channel not in self:
            raise ValueError(f"channel: one of {', '.join(self) or 'none'} is expected, not {channel!r}")
        try:
            frame = self[channel][index] if index != () else self[channel]
        except IndexError as error:
            raise ValueError(f"index: {index} is not within the batch's shape {self.lead}") from error
        rest = len(self.lead) - (len(index) if isinstance(index, tuple) else 1)
        frame = frame[(0,) * rest]
        if frame.ndim == 1:
            frame = frame[None]
        shown = _picture.picture(channel, frame)
        # A single line is hard to see.
        return np.repeat(shown, 16, axis=0) if shown.shape[0] == 1 else shown

    def _repr_png_(self) -> bytes | None:
        """Return the first frames as a PNG file, for Jupyter."""
        total = min(math.prod(self.lead), _MOST)
        if not self or total == 0:
            return None
        indices = [tuple(int(part) for part in np.unravel_index(index, self.lead)) for index in range(total)]
        frames = [self.picture(index=index if self.lead else ()) for index in indices]
        sheet = _picture.side_by_side(frames) if total > 1 else frames[0]
        step = -(-sheet.shape[1] // (_WIDTH * min(total, 2)))
        return _picture.png(np.ascontiguousarray(sheet[::step, ::step]))

    def __repr__(self) -> str:
        """Names, shapes and types of the arrays."""
        arrays = ", ".join(f"{name}: {values.dtype}{list(values.shape)}" for name, values in self.items())
        return f"<Frames {arrays}>"
