"""Meshes whose corners or faces have colours of their own, as meshes with a texture."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

#: The length of the square of texels of a face. With more of them, less is seen of the other half of the square.
_SQUARE = 4


def coloured(
    vertices: NDArray[Any], faces: NDArray[Any], corners: NDArray[np.uint8]
) -> tuple[NDArray[Any], NDArray[Any], NDArray[np.float32] | None, dict[str, Any]]:
    """Return vertices, faces, texture coordinates and look of a mesh with these colours.

    Args:
        vertices: (V, 3).
        faces: (F, 3).
        corners: the colours of the three corners of each face, (F, 3, 3). A face shows them linearly interpolated.

    """
    if (corners == corners[:1, :1]).all():
        return vertices, faces, None, {"color": (corners[0, 0] / 255.0).tolist()}
    is_flat = bool((corners == corners[:, :1]).all())
    if is_flat:
        texture, uvs = _one_texel_each(corners[:, 0])
    else:
        turned = _turned(corners)
        faces = np.take_along_axis(np.asarray(faces), turned, axis=1)
        texture, uvs = _texels_each(np.take_along_axis(corners, turned[..., None], axis=1))
    own = np.asarray(vertices)[np.asarray(faces).reshape(-1)]
    look = {"color": [1.0, 1.0, 1.0], "texture": texture}
    return own, np.arange(len(own)).reshape(-1, 3), uvs.reshape(-1, 2).astype(np.float32), look


def coloured_with_normals(
    vertices: NDArray[Any], normals: NDArray[Any] | None, faces: NDArray[Any], corners: NDArray[np.uint8]
) -> tuple[NDArray[Any], NDArray[Any] | None, NDArray[Any], NDArray[np.float32] | None, dict[str, Any]]:
    """Return the same as ``coloured``, with the normals of the vertices, (V, 3), if there are any."""
    if normals is None:
        vertices, faces, uvs, look = coloured(vertices, faces, corners)
        return vertices, None, faces, uvs, look
    rows = np.concatenate([np.asarray(vertices, np.float64), np.asarray(normals, np.float64)], axis=1)
    rows, faces, uvs, look = coloured(rows, faces, corners)
    return rows[:, :3], rows[:, 3:], faces, uvs, look


def _one_texel_each(colours: NDArray[np.uint8]) -> tuple[NDArray[np.uint8], NDArray[np.float64]]:
    """Return a texture with a texel for each colour, and the coordinates of the corners (F, 3, 2)."""
    packed = colours.astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], np.uint32)
    unique, numbers = np.unique(packed, return_inverse=True)
    width, height = _layout(len(unique))
    texels = np.zeros((height * width, 3), np.uint8)
    texels[: len(unique)] = (unique[:, None] >> np.array([16, 8, 0], np.uint32)) & 255
    uvs = _centres(numbers, width, width, height)
    return texels.reshape(height, width, 3), np.repeat(uvs[:, None], 3, axis=1)


def _turned(corners: NDArray[np.uint8]) -> NDArray[np.int64]:
    """Return the order of the corners of each face in which the fourth corner is nearest to a colour, (F, 3)."""
    orders = np.array([[0, 1, 2], [1, 2, 0], [2, 0, 1]])
    first, right, below = (corners[:, orders[:, corner]].astype(np.int64) for corner in range(3))
    fourth = right + below - first
    excess = np.abs(fourth - np.clip(fourth, 0, 255)).sum(axis=-1)
    chosen: NDArray[np.int64] = orders[excess.argmin(axis=1)]
    return chosen


def _texels_each(corners: NDArray[np.uint8]) -> tuple[NDArray[np.uint8], NDArray[np.float64]]:
    """Return a texture with a square of texels for each face, and the coordinates of the corners (F, 3, 2).

    The corners of a face are three corners of its square. Colours in between are linear; texels of the other half are
    seen at its edge, and continue them as far as there are such colours.
    """
    first, right, below = (corners[:, corner, None, None].astype(np.float64) for corner in range(3))
    steps = np.linspace(0.0, 1.0, _SQUARE)[:, None]
    colours = first + (right - first) * steps + (below - first) * steps[:, None]
    width, height = _layout(len(corners))
    squares = np.zeros((height * width, _SQUARE, _SQUARE, 3), np.uint8)
    squares[: len(corners)] = np.rint(np.clip(colours, 0.0, 255.0))
    across, down = _SQUARE * width, _SQUARE * height
    texels = squares.reshape(height, width, _SQUARE, _SQUARE, 3).swapaxes(1, 2).reshape(down, across, 3)
    start = _centres(np.arange(len(corners)), width, across, down, _SQUARE)
    last = _SQUARE - 1
    return np.ascontiguousarray(texels), start[:, None] + [[0.0, 0.0], [last / across, 0.0], [0.0, -last / down]]


def _layout(count: int) -> tuple[int, int]:
    width = int(np.ceil(np.sqrt(count)))
    return width, -(-count // width)


def _centres(numbers: NDArray[Any], width: int, across: int, down: int, size: int = 1) -> NDArray[np.float64]:
    """Return the coordinates of the middle of the first texel of these squares, v upwards, (N, 2).

    Args:
        numbers: (N,).
        width: the number of squares in a row.
        across: texels in a row of the texture.
        down: rows of the texture.
        size: the length of a square in texels.

    """
    column, row = numbers % width * size + 0.5, numbers // width * size + 0.5
    return np.stack([column / across, 1.0 - row / down], axis=-1)
