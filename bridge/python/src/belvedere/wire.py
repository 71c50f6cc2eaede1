"""The wire format, version 2, as numpy sees it; ``bridge/WIRE.md`` has every offset in words."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from belvedere._errors import BadFrameError

MAGIC = int.from_bytes(b"BLVD", "little")
SCHEMA = 2
HEADER_LEN = 384
#: Flag: a plane of intensities follows the ranges.
HAS_INTENSITIES = 1
#: Name, size and alignment of the user header, which iceoryx2 compares.
HEADER_TYPE_NAME = "belvedere.FrameHeader.v2"


class Kind(IntEnum):
    """What a payload is."""

    IMAGE = 1
    DEPTH_IMAGE = 2
    CAMERA_INFO = 3
    LASER_SCAN = 4
    POINT_CLOUD = 5
    ODOMETRY = 6
    TRANSFORMS = 7
    STATIC_TRANSFORMS = 8
    JOINT_STATES = 9
    CLOCK = 10
    VELOCITY_COMMAND = 11
    IMU = 12
    ROBOT_EVENT = 13
    SIMULATION_COMMAND = 14
    SIMULATION_RESULT = 15
    MODEL_STATES = 16
    CORE_SENSORS = 17
    RESET_ODOMETRY = 18
    MOTOR_POWER = 19
    RANGE = 20
    SENSOR_SETTINGS = 21
    BOUNDING_BOXES = 22
    TAG_DETECTIONS = 23


class Encoding(IntEnum):
    """How an element of a payload is coded."""

    RGB8 = 1
    BGR8 = 2
    MONO8 = 3
    #: Metres; NaN invalid, −inf too near, +inf nothing there (REP-118).
    F32C1 = 4
    #: Millimetres; 0 invalid.
    U16C1 = 5
    XYZRGB_F32 = 6
    #: Metres (REP-117).
    RANGES_F32 = 7
    STRUCT = 8
    RGBA8 = 9
    MONO16 = 10
    BAYER_RGGB8 = 11
    BAYER_BGGR8 = 12
    BAYER_GBRG8 = 13
    BAYER_GRBG8 = 14
    BAYER_RGGB16 = 15
    BAYER_BGGR16 = 16
    BAYER_GBRG16 = 17
    BAYER_GRBG16 = 18
    #: Flow in pixels, to the right and down; NaN where there is none.
    F32C2 = 19
    #: Unit normals in the axes of the world; 0 where nothing is seen.
    F32C3 = 20
    #: Numbers of things (−1 where nothing is seen) or of classes.
    I32C1 = 21


class DistortionModel(IntEnum):
    """How a lens maps directions to pixels, and its parameters; in lower case the name in a camera_info."""

    #: k1 k2 p1 p2 k3; all 0 for a pinhole.
    PLUMB_BOB = 1
    #: k1 k2 p1 p2 k3 k4 k5 k6, then s1 s2 s3 s4, then τx τy: 8, 12 or 14.
    RATIONAL_POLYNOMIAL = 2
    #: k1 k2 k3 k4 of Kannala and Brandt, OpenCV's fisheye.
    EQUIDISTANT = 3
    #: alpha beta
    EUCM = 4
    #: xi alpha
    DOUBLE_SPHERE = 5
    #: xi k1 k2 p1 p2
    MEI = 6
    #: None.
    EQUIRECTANGULAR = 7
    #: c1 c2 c3 f fun cutoff of SDF's lens; f in pixels, fun 0 sin, 1 tan, 2 the angle itself.
    WIDE_ANGLE = 8


class Operation(IntEnum):
    """What a simulator is told to do."""

    PAUSE = 1
    RESUME = 2
    STEP = 3
    RESET_WORLD = 4
    RESET_SIMULATION = 5
    SET_MODEL_STATE = 6
    SPAWN = 7
    DELETE = 8
    CONFIGURE = 9


#: The 384 bytes before every payload.
HEADER = np.dtype(
    {
        "names": [
            *("magic", "header_len", "schema", "kind", "encoding", "flags"),
            *("seq", "session", "stamp_ns", "publish_mono_ns"),
            *("width", "height", "row_stride", "elem_stride", "payload_len"),
            *("frame_id", "position", "orientation", "block"),
        ],
        "formats": [
            *("<u4", "<u2", "<u2", "<u2", "<u2", "<u4"),
            *("<u8", "<u8", "<u8", "<u8"),
            *("<u4", "<u4", "<u4", "<u4", "<u8"),
            *("S64", ("<f8", 3), ("<f4", 4), "V208"),
        ],
        "offsets": [0, 4, 6, 8, 10, 12, 16, 24, 32, 40, 48, 52, 56, 60, 64, 72, 136, 160, 176],
        "itemsize": HEADER_LEN,
    }
)

_INTRINSICS = np.dtype(
    [
        *(("fx", "<f8"), ("fy", "<f8"), ("cx", "<f8"), ("cy", "<f8"), ("skew", "<f8"), ("distortion", "<f8", 14)),
        *(("near", "<f4"), ("far", "<f4"), ("tx", "<f4"), ("distortion_model", "<u2"), ("distortion_len", "<u2")),
        ("reserved", "<u8", 5),
    ]
)
_SCAN_GEOMETRY = np.dtype(
    [
        *(("angle_min", "<f8"), ("angle_increment", "<f8"), ("time_increment", "<f8"), ("scan_time", "<f8")),
        *(("range_min", "<f4"), ("range_max", "<f4")),
        *(("vertical_angle_min", "<f8"), ("vertical_angle_increment", "<f8"), ("reserved", "<u8", 19)),
    ]
)

#: A number that can be set; NaN where a sensor has no such setting.
_SETTING = np.dtype([("value", "<f8"), ("min", "<f8"), ("max", "<f8")])

#: The structs of payloads, by kind.
STRUCTS: dict[Kind, np.dtype[np.void]] = {
    Kind.CAMERA_INFO: np.dtype(
        [
            *(("width", "<u4"), ("height", "<u4"), ("distortion_model", "S32"), ("d", "<f8", 14)),
            *(("d_len", "<u4"), ("reserved", "<u4")),
            *(("k", "<f8", (3, 3)), ("r", "<f8", (3, 3)), ("p", "<f8", (3, 4))),
        ]
    ),
    Kind.ODOMETRY: np.dtype(
        [
            *(("child_frame_id", "S64"), ("position", "<f8", 3), ("orientation", "<f8", 4)),
            *(("linear", "<f8", 3), ("angular", "<f8", 3)),
            *(("pose_covariance", "<f8", (6, 6)), ("twist_covariance", "<f8", (6, 6))),
        ]
    ),
    Kind.TRANSFORMS: np.dtype(
        [("parent", "S64"), ("child", "S64"), ("translation", "<f8", 3), ("rotation", "<f8", 4)]
    ),
    Kind.JOINT_STATES: np.dtype([("name", "S64"), ("position", "<f8"), ("velocity", "<f8"), ("effort", "<f8")]),
    Kind.CLOCK: np.dtype([("now_ns", "<u8")]),
    Kind.VELOCITY_COMMAND: np.dtype([("linear", "<f8", 3), ("angular", "<f8", 3)]),
    Kind.IMU: np.dtype(
        [
            *(("orientation", "<f8", 4), ("angular_velocity", "<f8", 3), ("linear_acceleration", "<f8", 3)),
            *(("orientation_covariance", "<f8", (3, 3)), ("angular_velocity_covariance", "<f8", (3, 3))),
            ("linear_acceleration_covariance", "<f8", (3, 3)),
        ]
    ),
    Kind.ROBOT_EVENT: np.dtype([("source", "<u4"), ("index", "<u4"), ("state", "<u4"), ("value", "<u4")]),
    Kind.CORE_SENSORS: np.dtype(
        [
            *(("time_stamp", "<u2"), ("bumper", "u1"), ("wheel_drop", "u1"), ("cliff", "u1"), ("buttons", "u1")),
            *(("left_encoder", "<u2"), ("right_encoder", "<u2"), ("left_pwm", "i1"), ("right_pwm", "i1")),
            *(("charger", "u1"), ("battery", "u1"), ("bottom", "<u2", 3)),
        ]
    ),
    Kind.RESET_ODOMETRY: np.dtype([("reserved", "<u8")]),
    Kind.MOTOR_POWER: np.dtype([("state", "<u4")]),
    Kind.RANGE: np.dtype(
        [
            *(("radiation_type", "<u4"), ("field_of_view", "<f4")),
            *(("min_range", "<f4"), ("max_range", "<f4"), ("range", "<f4")),
        ]
    ),
    Kind.SENSOR_SETTINGS: np.dtype(
        [
            *(("name", "S64"), ("topics", "S256", 6), ("update_rate", _SETTING)),
            *(("noise_mean", _SETTING), ("noise_stddev", _SETTING), ("exposure", _SETTING)),
        ]
    ),
    Kind.SIMULATION_COMMAND: np.dtype(
        [
            *(("id", "<u8"), ("operation", "<u2"), ("reserved", "<u2"), ("text_len", "<u4"), ("steps", "<u8")),
            *(("name", "S64"), ("reference", "S64"), ("position", "<f8", 3), ("orientation", "<f8", 4)),
            *(("linear", "<f8", 3), ("angular", "<f8", 3), ("robot_namespace", "S64")),
        ]
    ),
    Kind.SIMULATION_RESULT: np.dtype(
        [
            *(("id", "<u8"), ("time_ns", "<u8"), ("done", "<u2"), ("operation", "<u2"), ("reserved", "<u4")),
            ("reason", "S488"),
        ]
    ),
    Kind.MODEL_STATES: np.dtype(
        [
            *(("name", "S128"), ("position", "<f8", 3), ("orientation", "<f8", 4)),
            *(("linear", "<f8", 3), ("angular", "<f8", 3)),
        ]
    ),
    Kind.BOUNDING_BOXES: np.dtype(
        [
            *(("instance", "<u4"), ("label", "<u4"), ("pixels", "<u4"), ("min", "<u4", 2), ("max", "<u4", 2)),
            *(("reserved", "<u4"), ("position", "<f8", 3), ("orientation", "<f8", 4), ("size", "<f8", 3)),
        ]
    ),
    Kind.TAG_DETECTIONS: np.dtype(
        [
            *(("family", "S32"), ("id", "<u4"), ("visible", "u1", 4), ("size", "<f8"), ("corners", "<f8", (4, 2))),
            *(("position", "<f8", 3), ("orientation", "<f8", 4)),
        ]
    ),
}
STRUCTS[Kind.STATIC_TRANSFORMS] = STRUCTS[Kind.TRANSFORMS]

_POINT = np.dtype(
    {
        "names": ["x", "y", "z", "rgb"],
        "formats": ["<f4", "<f4", "<f4", "<u4"],
        "offsets": [0, 4, 8, 16],
        "itemsize": 32,
    }
)
_ELEMENTS: dict[Encoding, np.dtype[np.generic]] = {
    Encoding.RGB8: np.dtype(("u1", 3)),
    Encoding.BGR8: np.dtype(("u1", 3)),
    Encoding.MONO8: np.dtype("u1"),
    Encoding.F32C1: np.dtype("<f4"),
    Encoding.U16C1: np.dtype("<u2"),
    Encoding.XYZRGB_F32: _POINT,
    Encoding.RANGES_F32: np.dtype("<f4"),
    Encoding.RGBA8: np.dtype(("u1", 4)),
    Encoding.MONO16: np.dtype("<u2"),
    Encoding.BAYER_RGGB8: np.dtype("u1"),
    Encoding.BAYER_BGGR8: np.dtype("u1"),
    Encoding.BAYER_GBRG8: np.dtype("u1"),
    Encoding.BAYER_GRBG8: np.dtype("u1"),
    Encoding.BAYER_RGGB16: np.dtype("<u2"),
    Encoding.BAYER_BGGR16: np.dtype("<u2"),
    Encoding.BAYER_GBRG16: np.dtype("<u2"),
    Encoding.BAYER_GRBG16: np.dtype("<u2"),
    Encoding.F32C2: np.dtype(("<f4", 2)),
    Encoding.F32C3: np.dtype(("<f4", 3)),
    Encoding.I32C1: np.dtype("<i4"),
}


class Intrinsics(NamedTuple):
    """How pixels map to directions. Pixel centres are integers; distances in metres."""

    fx: float
    fy: float
    cx: float
    cy: float
    #: K[1]
    skew: float
    #: As many parameters as the model has, in the order that DistortionModel says.
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
    """The block of an image, depth image or cloud."""
    block = np.frombuffer(header["block"].tobytes(), _INTRINSICS)[0]
    fx, fy, cx, cy, skew, _, near, far, tx, model, count, _ = block.item()
    return Intrinsics(fx, fy, cx, cy, skew, tuple(block["distortion"][:count].tolist()), near, far, tx, model)


def scan_geometry(header: np.void) -> ScanGeometry:
    """The block of a scan."""
    block = np.frombuffer(header["block"].tobytes(), _SCAN_GEOMETRY)[0].item()
    return ScanGeometry(*block[:8])


def element(kind: int, encoding: int) -> np.dtype[np.generic] | None:
    """What one element of a payload is; None for a kind or encoding that this version does not know."""
    try:
        if encoding == Encoding.STRUCT:
            return STRUCTS.get(Kind(kind))
        return _ELEMENTS[Encoding(encoding)]
    except ValueError:
        return None


def check(header: np.void, available: int) -> None:
    """Check everything that a reader of ``available`` payload bytes relies on.

    No header, however wrong, leads outside the payload after this.

    Raises:
        BadFrameError: naming the first thing that does not hold.

    """
    if header["magic"] != MAGIC:
        raise BadFrameError(f"magic is {header['magic']:#x} instead of {MAGIC:#x}")
    if header["schema"] != SCHEMA:
        raise BadFrameError(f"schema is {header['schema']}; this package reads {SCHEMA}")
    if header["header_len"] != HEADER_LEN:
        raise BadFrameError(f"header_len is {header['header_len']} instead of {HEADER_LEN}")
    # Python's whole numbers: no sum or product overflows.
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
