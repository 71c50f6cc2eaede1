"""Frames as images for display, and PNG files without another package."""

from __future__ import annotations

import struct
import zlib
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Turbo: red, green, blue as polynomials of a value from 0 to 1 (A. Mikhailov, 2019).
_TURBO = np.array(
    [
        [0.13572138, 4.61539260, -42.66032258, 132.13108234, -152.94239396, 59.28637943],
        [0.09140261, 2.19418839, 4.84296658, -14.18503333, 4.27729857, 2.82956604],
        [0.10667330, 12.64194608, -60.58204836, 110.36276771, -89.90310912, 27.34824973],
    ]
)
#: Channels of distances in metres.
_DISTANCES = ("depth", "range", "distance", "true_depth", "true_range")
#: The start of the colour map for distances.
_FARTHEST = 0.08
#: The golden section, which scatters consecutive numbers.
_GOLDEN = 0.618033988749895


def png(pixels: NDArray[np.uint8]) -> bytes:
    """Return an image (height, width, 3) or (height, width) as a PNG file."""
    height, width = pixels.shape[:2]
    colour = 2 if pixels.ndim == 3 else 0
    rows = np.ascontiguousarray(pixels).reshape(height, -1)
    lines = np.concatenate([np.zeros((height, 1), np.uint8), rows], axis=1).tobytes()

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, colour, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(lines, 6))
        + chunk(b"IEND", b"")
    )


def picture(channel: str, values: NDArray[Any]) -> NDArray[np.uint8]:
    """Return a channel's frame (height, width, …) as colours (height, width, 3), or grey (height, width)."""
    if values.dtype == np.uint8:
        return values
    if values.ndim == 3 and values.shape[2] == 3 and channel == "normal":
        return np.asarray(np.clip(values * 127.5 + 127.5, 0, 255), np.uint8)
    if channel in ("instance", "class", "laser", "primitive"):
        missing = values == (0 if channel == "class" else np.iinfo(values.dtype).max)
        colours = turbo(((values.astype(np.float64) + 1) * _GOLDEN) % 1.0)
        colours[missing] = 0
        return colours
    if values.ndim == 3:
        with np.errstate(invalid="ignore"):
            values = np.linalg.norm(values, axis=2)
    shown = values.astype(np.float64)
    valid = np.isfinite(shown)
    least, most = (shown[valid].min(), shown[valid].max()) if valid.any() else (0.0, 1.0)
    share = np.where(valid, shown - least, 0.0) / (most - least if most > least else 1.0)
    if channel in _DISTANCES:
        # As in the viewer and in `belvedere snapshot`: near is red, and far differs from black, which means
        # missing.
        share = 1.0 - (1.0 - _FARTHEST) * share
    colours = turbo(share)
    colours[~valid] = 0
    return colours


def turbo(share: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return colours from blue for 0 to red for 1."""
    powers = np.stack([np.clip(share, 0.0, 1.0) ** power for power in range(6)], axis=-1)
    return np.asarray(np.clip(powers @ _TURBO.T * 255.0 + 0.5, 0, 255), np.uint8)


def side_by_side(frames: list[NDArray[np.uint8]]) -> NDArray[np.uint8]:
    """Return images of equal size in rows of four."""
    coloured = [frame if frame.ndim == 3 else np.repeat(frame[..., None], 3, axis=2) for frame in frames]
    across = min(4, len(coloured))
    while len(coloured) % across:
        coloured.append(np.zeros_like(coloured[0]))
    rows = [np.concatenate(coloured[first : first + across], axis=1) for first in range(0, len(coloured), across)]
    return np.concatenate(rows, axis=0)
