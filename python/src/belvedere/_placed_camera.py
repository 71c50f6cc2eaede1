"""Cameras of scenes of other packages."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from belvedere import _arrays
from belvedere._lens import Lens
from belvedere._sensors import Camera

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: The axes of a sensor (x forward, y left, z up) in those of most scenes' cameras (x right, y up, z backward).
_AXES = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]])


@dataclass(frozen=True)
class PlacedCamera:
    """A camera of a scene of another package: its pose and its frustum. :attr:`belvedere.World.cameras` has them."""

    #: The pose of the sensor: x forward, y left, z up; (7,).
    pose: NDArray[np.float64]
    #: Tangents of the angles to the left, right, lower and upper edge of the picture, left and below negative.
    frustum: tuple[float, float, float, float]
    #: Metres; nearer surfaces are not seen.
    near: float
    #: Metres; farther surfaces are not seen.
    far: float
    #: Width and height in pixels, if the scene says them.
    size: tuple[int, int] | None = None

    def camera(self, width: int | None = None, height: int | None = None, **options: Any) -> Camera:
        """Return a camera of the horizontal angle of the scene's, with square pixels.

        Args:
            width: pixels across; by default those of the scene, or 640.
            height: pixels down; by default as many as the scene's camera sees.
            **options: keywords of :class:`belvedere.Camera` other than size and lens.

        Raises:
            ValueError: an argument is invalid.

        """
        left, right, below, above = self.frustum
        across = _arrays.count("width", (self.size or (640, 0))[0] if width is None else width, 1, 16384)
        focal = across / (right - left)
        own = max(round(focal * (above - below)), 1)
        if self.size and width is None:
            own = self.size[1]
        down = _arrays.count("height", own if height is None else height, 1, 16384)
        middle = (down - 1) / 2.0 + focal * (above + below) / 2.0
        lens = Lens.pinhole(focal, focal, -left * focal - 0.5, middle)
        return Camera(across, down, lens=lens, **({"near": self.near, "far": self.far} | options))


def pose_of(world_from_camera: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the pose (7,) of a sensor in the place of a camera that looks along −z with y up; scale is ignored."""
    left, _, right = np.linalg.svd(world_from_camera[:3, :3])
    matrix = np.eye(4)
    turned = left @ right
    matrix[:3, :3] = (turned if np.linalg.det(turned) > 0.0 else -turned) @ _AXES
    matrix[:3, 3] = world_from_camera[:3, 3]
    return _arrays.one_pose("camera", matrix)
