"""The wire format, version 2, as numpy types; ``bridge/WIRE.md`` documents every offset."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from belvedere._errors import BadFrameError
from belvedere._layout import (
    ELEMENTS,
    HAS_INTENSITIES,
    HEADER,
    HEADER_LEN,
    HEADER_TYPE_NAME,
    INTRINSICS,
    MAGIC,
    REPLAYED,
    SCAN_GEOMETRY,
    SCHEMA,
    STRUCTS,
    DistortionModel,
    Encoding,
    Kind,
    Operation,
)

__all__ = [
    "HAS_INTENSITIES",
    "HEADER",
    "HEADER_LEN",
    "HEADER_TYPE_NAME",
    "MAGIC",
    "REPLAYED",
    "SCHEMA",
    "STRUCTS",
    "DistortionModel",
    "Encoding",
    "Intrinsics",
    "Kind",
    "Operation",
    "ScanGeometry",
    "check",
    "element",
    "intrinsics",
    "plane",
    "scan_geometry",
]


class Intrinsics(NamedTuple):
    """The mapping from pixels to directions. Pixel centres are integers; distances in metres."""

    fx: float
    fy: float
    cx: float
    cy: float
    #: K[1]
    skew: float
    #: The parameters of the model, in the order of DistortionModel.
    distortion: tuple[float, ...]
    near: float
    far: float
    #: P[3] = −fx · baseline
    tx: float
    #: A DistortionModel; 0 for none.
    distortion_model: int


class ScanGeometry(NamedTuple):
    """Angles (radians) and limits (metres) of a lidar."""

    angle_min: float
    angle_increment: float
    time_increment: float
    scan_time: float
    range_min: float
    range_max: float
    vertical_angle_min: float
    vertical_angle_increment: float


def intrinsics(header: np.void) -> Intrinsics:
    """Return the block of an image, depth image or cloud."""
    block = np.frombuffer(header["block"].tobytes(), INTRINSICS)[0]
    fx, fy, cx, cy, skew, _, near, far, tx, model, count, _ = block.item()
    return Intrinsics(fx, fy, cx, cy, skew, tuple(block["distortion"][:count].tolist()), near, far, tx, model)


def scan_geometry(header: np.void) -> ScanGeometry:
    """Return the block of a scan."""
    block = np.frombuffer(header["block"].tobytes(), SCAN_GEOMETRY)[0].item()
    return ScanGeometry(*block[:8])


def element(kind: int, encoding: int) -> np.dtype[np.generic] | None:
    """Return the type of one element of a payload; None for an unknown kind or encoding."""
    try:
        if encoding == Encoding.STRUCT:
            return STRUCTS.get(Kind(kind))
        return ELEMENTS[Encoding(encoding)]
    except ValueError:
        return None


def plane(
    header: np.void, payload: np.ndarray[Any, np.dtype[np.uint8]], offset: int = 0
) -> np.ndarray[Any, np.dtype[Any]]:
    """Return the elements of a payload with a checked header as a view: ``Frame.array`` has shapes and types.

    Raises:
        BadFrameError: its kind or encoding is that of a later version.

    """
    known = element(int(header["kind"]), int(header["encoding"]))
    if known is None:
        raise BadFrameError(
            f"kind {header['kind']} in encoding {header['encoding']} is of a later version: "
            "read frame.payload, or update this package"
        )
    row_stride, elem_stride = int(header["row_stride"]), int(header["elem_stride"])
    width, height = int(header["width"]), int(header["height"])
    shape: tuple[int, ...] = (height, width)
    strides: tuple[int, ...] = (row_stride, elem_stride)
    if known.names is not None and int(header["encoding"]) == Encoding.STRUCT:
        # Without elements, the row stride is meaningless and unchecked.
        shape, strides = (height if width > 0 else 0,), (row_stride,)
    if 0 in shape:
        return np.empty(shape + known.shape, known.base)
    base = known.base
    shape += known.shape
    strides += (base.itemsize,) * len(known.shape)
    return np.ndarray(shape, base, payload, offset, strides)


def check(header: np.void, available: int) -> None:
    """Check everything that a reader of ``available`` payload bytes relies on.

    No header that passes, however wrong, leads outside the payload.

    Raises:
        BadFrameError: the first fault found.

    """
    if header["magic"] != MAGIC:
        raise BadFrameError(f"magic is {header['magic']:#x} instead of {MAGIC:#x}")
    if header["schema"] != SCHEMA:
        raise BadFrameError(f"schema is {header['schema']}; this package reads {SCHEMA}")
    if header["header_len"] != HEADER_LEN:
        raise BadFrameError(f"header_len is {header['header_len']} instead of {HEADER_LEN}")
    # Python integers: no sum or product overflows.
    payload_len = int(header["payload_len"])
    if payload_len > available:
        raise BadFrameError(f"payload_len is {payload_len}, but {available} bytes came")
    width, height = int(header["width"]), int(header["height"])
    if width == 0 or height == 0:
        return
    known = element(int(header["kind"]), int(header["encoding"]))
    size = known.itemsize if known is not None else 1
    elem_stride, row_stride = int(header["elem_stride"]), int(header["row_stride"])
    row_end = (width - 1) * elem_stride + size
    if elem_stride < size or (height > 1 and row_stride < row_end):
        raise BadFrameError(f"width {width}, elem_stride {elem_stride}, row_stride {row_stride} do not fit")
    planes = 2 if int(header["flags"]) & HAS_INTENSITIES else 1
    end = (planes - 1) * height * row_stride + (height - 1) * row_stride + row_end
    if end > payload_len:
        raise BadFrameError(f"rows and strides reach to byte {end} of a payload of {payload_len}")
