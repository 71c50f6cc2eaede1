"""Laser scanners by their presets."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from belvedere import _arrays, _native
from belvedere._looks import SEES
from belvedere._sensors import Sensor, _given

if TYPE_CHECKING:
    from numpy.typing import NDArray

_F32, _U32 = np.dtype(np.float32), np.dtype(np.uint32)


class Scanner(Sensor):
    """A laser scanner of a manufacturer: every firing is cast from the poses of sensor and bodies at its time.

    Channels: ``range`` float32 (firings, returns), measured metres; ``points`` float32 (firings, returns, 3) in the
    sensor's frame at the time of the firing, NaN without a return; ``intensity`` float32; ``time`` float64
    (firings), seconds after the beginning of the frame; ``laser`` uint32 (firings). If the sensor moves, pass
    ``after=``, its poses at the end of the frame. Frames are shown from above.

    Args:
        preset: the name of a preset: see ``Scanner.presets()``.
        rate: revolutions per second; the preset's default if it is None.
        columns: columns per revolution, for presets with a choice.
        returns: ``strongest``, ``first``, ``last`` or ``dual``.
        intensity: ``retro``, by the retroreflectivity in world files; ``power``; ``reflectivity``.
        visibility: visibility in fog in metres.
        rain: millimetres per hour.
        snow: millimetres of water per hour.
        sees: ``collision`` shapes, ``visual`` ones or ``all``.

    Raises:
        ValueError: there is no such preset or mode, or an argument is out of its range.

    """

    _default = ("range",)
    _view = "firings"
    _native: _native.Scanner

    def __init__(
        self,
        preset: str,
        *,
        rate: float | None = None,
        columns: int | None = None,
        returns: str = "strongest",
        intensity: str = "retro",
        visibility: float = math.inf,
        rain: float = 0.0,
        snow: float = 0.0,
        sees: str = "collision",
    ) -> None:
        self._arguments = _given(locals())
        native = _native.Scanner(
            _arrays.text("preset", preset),
            None if rate is None else _arrays.number("rate", rate),
            None if columns is None else _arrays.count("columns", columns),
            _arrays.text("returns", returns),
            _arrays.text("intensity", intensity),
            [_arrays.number(*given) for given in (("visibility", visibility), ("rain", rain), ("snow", snow))],
            _arrays.choice("sees", sees, SEES),
        )
        firings, count, period_ns = native.size
        self._native = native
        self._frame = (firings, count)
        #: Seconds from one frame to the next.
        self.period = period_ns * 1e-9
        self._channels = {
            "range": (_F32, ()),
            "points": (_F32, (3,)),
            "intensity": (_F32, ()),
            "time": (np.dtype(np.float64), ()),
            "laser": (_U32, ()),
        }

    def _directions(self, number: int) -> NDArray[np.float32]:
        return self._native.directions(number)[:, None, :]

    @staticmethod
    def presets() -> list[str]:
        """Return the names of the presets."""
        return _native.Scanner.presets()
