"""Scans drawn from above, like ``belvedere snapshot`` does."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Edge length of the image in pixels.
_SIZE = 481
_PAPER, _RING, _SENSOR = (255, 255, 255), (205, 212, 220), (200, 40, 40)


def above(places: NDArray[Any], colours: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Draw places (N, 2 or more), x forward and y left in metres, as dots of these colours (N, 3).

    Forward is up, and the sensor is in the middle. Rings are 1, 2 or 5 times a power of ten metres apart. Places
    that are not finite are left out.
    """
    level = places[:, :2].astype(np.float64)
    there = np.isfinite(level).all(axis=1)
    level, colours = level[there], colours[there]
    middle = _SIZE // 2
    farthest = max(float(np.hypot(*level.T).max(initial=0.0)), 1e-3)
    scale = (middle - 4) / farthest
    sheet = np.full((_SIZE, _SIZE, 3), _PAPER, np.uint8)

    offset = np.arange(_SIZE) - middle
    radius = np.hypot(offset, offset[:, None])
    step = _ring_distance(farthest) * scale
    ring = np.round(radius / step)
    sheet[(ring >= 1) & (np.abs(radius - ring * step) < 0.6)] = _RING

    columns, rows = np.round(middle - level[:, ::-1] * scale).astype(np.int64).T
    for down in (-1, 0, 1):
        for across in (-1, 0, 1):
            sheet[np.clip(rows + down, 0, _SIZE - 1), np.clip(columns + across, 0, _SIZE - 1)] = colours
    sheet[middle - 3 : middle + 4, middle - 3 : middle + 4] = _SENSOR
    # The forward direction.
    sheet[middle - 11 : middle - 3, middle] = _SENSOR
    return sheet


def _ring_distance(farthest: float) -> float:
    """Return a ring distance, such that at most ten rings are needed."""
    decade = 10.0 ** np.floor(np.log10(farthest / 10.0))
    return float(
        next(decade * step for step in (1.0, 2.0, 5.0, 10.0) if farthest <= decade * step * 10.0 * (1 + 1e-9))
    )
