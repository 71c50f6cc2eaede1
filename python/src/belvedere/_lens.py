"""Lens models, which map directions to pixels."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from belvedere import _arrays


@dataclass(frozen=True)
class Lens:
    """A lens model with its intrinsic parameters in pixels; pixel centres are whole numbers.

    Create one by its model: ``Lens.kannala_brandt(fx=300, fy=300, cx=319.5, cy=239.5, k=(0.1, 0, 0, 0))``. Pixels
    that the lens does not map are black in images and +∞ in depth. A sensor with the lens checks the parameters.
    """

    #: The name of the model.
    model: str
    #: fx, fy, cx, cy, skew, followed by the model's own parameters.
    parameters: tuple[float, ...] = field(repr=True)

    @staticmethod
    def _of(
        model: str, fx: float, fy: float, cx: float, cy: float, skew: float, own: tuple[float, ...] = ()
    ) -> Lens:
        given = (fx, fy, cx, cy, skew, *own)
        return Lens(model, tuple(_arrays.number(f"lens ({model})", value) for value in given))

    @staticmethod
    def pinhole(fx: float, fy: float, cx: float, cy: float, skew: float = 0.0) -> Lens:
        """A camera without distortion."""
        return Lens._of("pinhole", fx, fy, cx, cy, skew)

    @staticmethod
    def brown_conrady(
        fx: float, fy: float, cx: float, cy: float, coefficients: tuple[float, ...], skew: float = 0.0
    ) -> Lens:
        """OpenCV's model, ROS's plumb_bob and rational_polynomial: k1 k2 p1 p2 k3 …, 4, 5, 8, 12 or 14 of them."""
        row = _arrays.array("coefficients", coefficients, np.float64)
        if row.ndim != 1:
            raise ValueError(f"coefficients: shape {row.shape}; a row of numbers is expected")
        return Lens._of("brown_conrady", fx, fy, cx, cy, skew, tuple(row.tolist()))

    @staticmethod
    def kannala_brandt(
        fx: float,
        fy: float,
        cx: float,
        cy: float,
        k: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0),
        skew: float = 0.0,
    ) -> Lens:
        """OpenCV's fisheye, ROS's equidistant: k1 k2 k3 k4."""
        return Lens._of("kannala_brandt", fx, fy, cx, cy, skew, tuple(_arrays.numbers("k", k, 4)))

    @staticmethod
    def eucm(fx: float, fy: float, cx: float, cy: float, alpha: float, beta: float) -> Lens:
        """The extended unified camera model, as in Kalibr."""
        return Lens._of("eucm", fx, fy, cx, cy, 0.0, (alpha, beta))

    @staticmethod
    def double_sphere(fx: float, fy: float, cx: float, cy: float, xi: float, alpha: float) -> Lens:
        """The double sphere model, as in Kalibr and Basalt."""
        return Lens._of("double_sphere", fx, fy, cx, cy, 0.0, (xi, alpha))

    @staticmethod
    def mei(
        fx: float,
        fy: float,
        cx: float,
        cy: float,
        xi: float,
        coefficients: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0),
    ) -> Lens:
        """The unified model of Mei, as in OpenCV's omnidir: ξ, then k1 k2 p1 p2."""
        return Lens._of("mei", fx, fy, cx, cy, 0.0, (xi, *_arrays.numbers("coefficients", coefficients, 4)))

    @staticmethod
    def equirectangular(width: int, height: int) -> Lens:
        """All directions in one image: columns are longitudes, rows latitudes."""
        across, down = _arrays.count("width", width), _arrays.count("height", height)
        per_radian = across / (2.0 * 3.141592653589793)
        down_per_radian = down / 3.141592653589793
        return Lens._of("equirectangular", per_radian, down_per_radian, (across - 1) / 2, (down - 1) / 2, 0.0)
