"""The wire format as numpy types. Generated from bridge/src/wire by bridge/c/tests/bindings; do not edit."""

# fmt: off
from __future__ import annotations

from enum import IntEnum

import numpy as np

MAGIC = 1146506306
SCHEMA = 2
HEADER_LEN = 384
#: Flag: a plane of intensities follows the ranges.
HAS_INTENSITIES = 1
#: Flag: the frame comes from a recording.
REPLAYED = 2
#: Name of the user header, which iceoryx2 compares.
HEADER_TYPE_NAME = "belvedere.FrameHeader.v2"


class Kind(IntEnum):
    """The meaning of a stream's payload (kind).

    Numbers are never reused.

    """

    #: A colour or grey image; the header carries its intrinsics.
    IMAGE = 1
    #: Depth along the optical axis; the header carries its intrinsics.
    DEPTH_IMAGE = 2
    #: One CameraInfo.
    CAMERA_INFO = 3
    #: Ranges of a planar or multi-layer lidar; the header carries its angles.
    LASER_SCAN = 4
    #: Points in the sensor's frame; organised (an image of points) if the height is more than 1.
    POINT_CLOUD = 5
    #: One Odometry.
    ODOMETRY = 6
    #: An array of Transform that are valid at the stamp.
    TRANSFORMS = 7
    #: An array of Transform that never change.
    STATIC_TRANSFORMS = 8
    #: An array of JointState.
    JOINT_STATES = 9
    #: One Clock, the simulated time.
    CLOCK = 10
    #: One VelocityCommand, to the robot.
    VELOCITY_COMMAND = 11
    #: One Imu.
    IMU = 12
    #: One RobotEvent, sent when the state changes.
    ROBOT_EVENT = 13
    #: One SimulationCommand, to the simulator; a text may follow it in the
    #: payload.
    SIMULATION_COMMAND = 14
    #: One SimulationResult, the result of a command.
    SIMULATION_RESULT = 15
    #: An array of ModelState.
    MODEL_STATES = 16
    #: One CoreSensors.
    CORE_SENSORS = 17
    #: One ResetOdometry, to the robot.
    RESET_ODOMETRY = 18
    #: One MotorPower, to the robot.
    MOTOR_POWER = 19
    #: One Range.
    RANGE = 20
    #: An array of SensorSettings: the settings of every sensor that has any,
    #: valid from the stamp on.
    SENSOR_SETTINGS = 21
    #: An array of BoundingBox, one for each object in an image.
    BOUNDING_BOXES = 22
    #: An array of TagDetection, one for each tag in an image.
    TAG_DETECTIONS = 23
    #: One NavSatFix.
    NAV_SAT_FIX = 24
    #: One MagneticField.
    MAGNETIC_FIELD = 25
    #: One FluidPressure.
    FLUID_PRESSURE = 26
    #: One Altimeter.
    ALTIMETER = 27
    #: One Vector3.
    VECTOR3 = 28
    #: One Wrench.
    WRENCH = 29
    #: An array of Contact: all contacts of a sensor since its last frame.
    CONTACTS = 30
    #: An array of SeenModel, one for each model that a logical camera sees.
    SEEN_MODELS = 31
    #: One Pose.
    POSE = 32


class Encoding(IntEnum):
    """The encoding of one element of the payload (encoding)."""

    #: Red, green, blue; 8 bits each.
    RGB8 = 1
    #: Blue, green, red; 8 bits each.
    BGR8 = 2
    #: Grey, 8 bits.
    MONO8 = 3
    #: Depth in metres, 32-bit floats: NaN invalid, −inf too near, +inf no return (REP-118).
    F32C1 = 4
    #: Depth in millimetres, 16 bits: 0 invalid (REP-118).
    U16C1 = 5
    #: A point with a colour. NaN coordinates mean no point.
    #: Its 32 bytes:
    #: - x at 0, f32: Metres.
    #: - y at 4, f32: Metres.
    #: - z at 8, f32: Metres.
    #: - rgb at 16, u8[4]: Blue, green, red, 0.
    XYZRGB_F32 = 6
    #: Ranges in metres, 32-bit floats (REP-117): height layers of width rays. With
    #: HAS_INTENSITIES a second plane of the same shape follows
    #: at height · row_stride.
    RANGES_F32 = 7
    #: height fixed structs, elem_stride bytes apart; see payload.
    STRUCT = 8
    #: Red, green, blue, and 255; 8 bits each.
    RGBA8 = 9
    #: Grey, 16 bits.
    MONO16 = 10
    #: Bayer mosaic, 8 bits: red and green in the first row, green and blue in the second.
    BAYER_RGGB8 = 11
    #: Bayer mosaic, 8 bits: blue and green in the first row, green and red in the second.
    BAYER_BGGR8 = 12
    #: Bayer mosaic, 8 bits: green and blue in the first row, red and green in the second.
    BAYER_GBRG8 = 13
    #: Bayer mosaic, 8 bits: green and red in the first row, blue and green in the second.
    BAYER_GRBG8 = 14
    #: Bayer mosaic, 16 bits: red and green in the first row, green and blue in the second.
    BAYER_RGGB16 = 15
    #: Bayer mosaic, 16 bits: blue and green in the first row, green and red in the second.
    BAYER_BGGR16 = 16
    #: Bayer mosaic, 16 bits: green and blue in the first row, red and green in the second.
    BAYER_GBRG16 = 17
    #: Bayer mosaic, 16 bits: green and red in the first row, blue and green in the second.
    BAYER_GRBG16 = 18
    #: Two 32-bit floats: optical flow in pixels, to the right and down; NaN where it is undefined.
    F32C2 = 19
    #: Three 32-bit floats: unit normals in the world's axes; 0 where no surface is seen.
    F32C3 = 20
    #: An instance or class number, 32-bit signed; in instance images, −1 where nothing is seen.
    I32C1 = 21
    #: A point in the layout of Velodyne's driver. NaN coordinates mean no point, which occurs only in clouds of
    #: several rows.
    #: Its 22 bytes:
    #: - x at 0, f32: Metres.
    #: - y at 4, f32: Metres.
    #: - z at 8, f32: Metres.
    #: - intensity at 12, f32: Intensity.
    #: - ring at 16, u16: Number of the laser, counted from the lowest.
    #: - time at 18, f32: Seconds after the stamp.
    XYZIRT_F32 = 22
    #: A point in the layout of Ouster's driver. NaN coordinates mean no point. A row is a laser, a column a
    #: direction.
    #: Its 48 bytes:
    #: - x at 0, f32: Metres.
    #: - y at 4, f32: Metres.
    #: - z at 8, f32: Metres.
    #: - intensity at 16, f32: Intensity.
    #: - t at 20, u32: Nanoseconds after the stamp.
    #: - reflectivity at 24, u16: The intensity, limited to 255.
    #: - ring at 26, u16: Number of the laser, counted from the highest.
    #: - ambient at 28, u16: 0.
    #: - range at 32, u32: Millimetres from the axis; 0 for none.
    OUSTER_POINT = 23
    #: A point in the layout of Livox's driver.
    #: Its 26 bytes:
    #: - x at 0, f32: Metres.
    #: - y at 4, f32: Metres.
    #: - z at 8, f32: Metres.
    #: - intensity at 12, f32: Intensity, 0 to 255.
    #: - tag at 16, u8: The number of the return in bits 4 and 5.
    #: - line at 17, u8: Number of the laser.
    #: - timestamp at 18, f64: Nanoseconds since time 0.
    LIVOX_POINT = 24
    #: A point in the layout of gz-sim's lidars. NaN coordinates mean no point. A row is a layer.
    #: Its 18 bytes:
    #: - x at 0, f32: Metres.
    #: - y at 4, f32: Metres.
    #: - z at 8, f32: Metres.
    #: - intensity at 12, f32: Intensity.
    #: - ring at 16, u16: Number of the layer, counted from the first vertical angle.
    XYZIR_F32 = 25


class DistortionModel(IntEnum):
    """The mapping from directions to pixels by a lens, and the order of its parameters.

    Names are those of sensor_msgs/CameraInfo where ROS has one. With K = (fx, fy, cx, cy), the
    direction (x, y, z) is seen at the pixel (fx·u + cx, fy·v + cy).

    """

    #: Brown–Conrady: k1 k2 p1 p2 k3; all 0 for a pinhole. u, v are the distorted x/z, y/z.
    PLUMB_BOB = 1
    #: OpenCV's extensions of Brown–Conrady: k1 k2 p1 p2 k3 k4 k5 k6, then the thin prism s1 s2 s3 s4, then the
    #: tilts τx τy; 8, 12 or 14 parameters.
    RATIONAL_POLYNOMIAL = 2
    #: Kannala–Brandt, OpenCV's fisheye model: k1 k2 k3 k4 in θ + k1 θ³ + k2 θ⁵ + k3 θ⁷ + k4 θ⁹.
    EQUIDISTANT = 3
    #: Extended unified camera model: alpha beta. ROS has no name for this model or for the following ones.
    EUCM = 4
    #: Double sphere: xi alpha.
    DOUBLE_SPHERE = 5
    #: Mei's unified model: xi k1 k2 p1 p2.
    MEI = 6
    #: Columns are angles about the camera's y, rows are elevations: u = atan2(x, z), v = atan2(y, √(x² + z²)).
    EQUIRECTANGULAR = 7
    #: SDF's wide-angle lens: c1 c2 c3 f fun cutoff. The radius is c1·f·fun(θ/c2 + c3), f in pixels; fun is 0 for
    #: sin, 1 for tan, 2 for the identity. Directions beyond the cutoff angle are not seen. K holds the scale at
    #: the centre.
    WIDE_ANGLE = 8


class Operation(IntEnum):
    """An operation on a simulation (operation).

    Numbers are never reused; a simulator refuses one that it does not know.

    """

    #: Pause simulated time.
    PAUSE = 1
    #: Resume simulated time.
    RESUME = 2
    #: Run steps physics steps and publish everything that is due, then pause.
    STEP = 3
    #: Return every model to its initial pose, at rest; time continues.
    RESET_WORLD = 4
    #: Restart at time 0; the output is the same as after a fresh start.
    RESET_SIMULATION = 5
    #: Set the pose and velocity of the model name, in the frame reference.
    SET_MODEL_STATE = 6
    #: Add the model in the text (URDF or SDF) to the world as name, at a pose in the frame reference.
    SPAWN = 7
    #: Remove the model name from the world.
    DELETE = 8
    #: Change settings of the sensor name, or of the sensor that publishes the topic name: key=value words in
    #: the text.
    CONFIGURE = 9
    #: Change nothing. The result's reason holds words that describe the simulation and, if there is a name, that
    #: model.
    QUERY = 10


HEADER = np.dtype(
    [
        ("magic", "<u4"),
        ("header_len", "<u2"),
        ("schema", "<u2"),
        ("kind", "<u2"),
        ("encoding", "<u2"),
        ("flags", "<u4"),
        ("seq", "<u8"),
        ("session", "<u8"),
        ("stamp_ns", "<u8"),
        ("publish_mono_ns", "<u8"),
        ("width", "<u4"),
        ("height", "<u4"),
        ("row_stride", "<u4"),
        ("elem_stride", "<u4"),
        ("payload_len", "<u8"),
        ("frame_id", "S64"),
        ("position", "<f8", 3),
        ("orientation", "<f4", 4),
        ("block", "V208"),
    ]
)

INTRINSICS = np.dtype(
    [
        ("fx", "<f8"),
        ("fy", "<f8"),
        ("cx", "<f8"),
        ("cy", "<f8"),
        ("skew", "<f8"),
        ("distortion", "<f8", 14),
        ("near", "<f4"),
        ("far", "<f4"),
        ("tx", "<f4"),
        ("distortion_model", "<u2"),
        ("distortion_len", "<u2"),
        ("reserved", "<u8", 5),
    ]
)

SCAN_GEOMETRY = np.dtype(
    [
        ("angle_min", "<f8"),
        ("angle_increment", "<f8"),
        ("time_increment", "<f8"),
        ("scan_time", "<f8"),
        ("range_min", "<f4"),
        ("range_max", "<f4"),
        ("vertical_angle_min", "<f8"),
        ("vertical_angle_increment", "<f8"),
        ("reserved", "<u8", 19),
    ]
)

SETTING = np.dtype(
    [
        ("value", "<f8"),
        ("min", "<f8"),
        ("max", "<f8"),
    ]
)

#: The structs of payloads, by kind.
STRUCTS: dict[Kind, np.dtype[np.void]] = {
    Kind.CAMERA_INFO: np.dtype(
        [
            ("width", "<u4"),
            ("height", "<u4"),
            ("distortion_model", "S32"),
            ("d", "<f8", 14),
            ("d_len", "<u4"),
            ("reserved", "<u4"),
            ("k", "<f8", (3, 3)),
            ("r", "<f8", (3, 3)),
            ("p", "<f8", (3, 4)),
        ]
    ),
    Kind.ODOMETRY: np.dtype(
        [
            ("child_frame_id", "S64"),
            ("position", "<f8", 3),
            ("orientation", "<f8", 4),
            ("linear", "<f8", 3),
            ("angular", "<f8", 3),
            ("pose_covariance", "<f8", (6, 6)),
            ("twist_covariance", "<f8", (6, 6)),
        ]
    ),
    Kind.TRANSFORMS: np.dtype(
        [
            ("parent", "S64"),
            ("child", "S64"),
            ("translation", "<f8", 3),
            ("rotation", "<f8", 4),
        ]
    ),
    Kind.JOINT_STATES: np.dtype(
        [
            ("name", "S64"),
            ("position", "<f8"),
            ("velocity", "<f8"),
            ("effort", "<f8"),
        ]
    ),
    Kind.CLOCK: np.dtype(
        [
            ("now_ns", "<u8"),
        ]
    ),
    Kind.VELOCITY_COMMAND: np.dtype(
        [
            ("linear", "<f8", 3),
            ("angular", "<f8", 3),
        ]
    ),
    Kind.IMU: np.dtype(
        [
            ("orientation", "<f8", 4),
            ("angular_velocity", "<f8", 3),
            ("linear_acceleration", "<f8", 3),
            ("orientation_covariance", "<f8", (3, 3)),
            ("angular_velocity_covariance", "<f8", (3, 3)),
            ("linear_acceleration_covariance", "<f8", (3, 3)),
        ]
    ),
    Kind.ROBOT_EVENT: np.dtype(
        [
            ("source", "<u4"),
            ("index", "<u4"),
            ("state", "<u4"),
            ("value", "<u4"),
        ]
    ),
    Kind.CORE_SENSORS: np.dtype(
        [
            ("time_stamp", "<u2"),
            ("bumper", "u1"),
            ("wheel_drop", "u1"),
            ("cliff", "u1"),
            ("buttons", "u1"),
            ("left_encoder", "<u2"),
            ("right_encoder", "<u2"),
            ("left_pwm", "i1"),
            ("right_pwm", "i1"),
            ("charger", "u1"),
            ("battery", "u1"),
            ("bottom", "<u2", 3),
        ]
    ),
    Kind.RESET_ODOMETRY: np.dtype(
        [
            ("reserved", "<u8"),
        ]
    ),
    Kind.MOTOR_POWER: np.dtype(
        [
            ("state", "<u4"),
        ]
    ),
    Kind.CONTACTS: np.dtype(
        [
            ("collision1", "S128"),
            ("collision2", "S128"),
            ("position", "<f8", 3),
            ("normal", "<f8", 3),
            ("depth", "<f8"),
            ("force", "<f8", 3),
            ("torque", "<f8", 3),
        ]
    ),
    Kind.SIMULATION_COMMAND: np.dtype(
        [
            ("id", "<u8"),
            ("operation", "<u2"),
            ("reserved", "<u2"),
            ("text_len", "<u4"),
            ("steps", "<u8"),
            ("name", "S64"),
            ("reference", "S64"),
            ("position", "<f8", 3),
            ("orientation", "<f8", 4),
            ("linear", "<f8", 3),
            ("angular", "<f8", 3),
            ("robot_namespace", "S64"),
        ]
    ),
    Kind.SIMULATION_RESULT: np.dtype(
        [
            ("id", "<u8"),
            ("time_ns", "<u8"),
            ("done", "<u2"),
            ("operation", "<u2"),
            ("reserved", "<u4"),
            ("reason", "S488"),
        ]
    ),
    Kind.MODEL_STATES: np.dtype(
        [
            ("name", "S128"),
            ("position", "<f8", 3),
            ("orientation", "<f8", 4),
            ("linear", "<f8", 3),
            ("angular", "<f8", 3),
        ]
    ),
    Kind.NAV_SAT_FIX: np.dtype(
        [
            ("latitude", "<f8"),
            ("longitude", "<f8"),
            ("altitude", "<f8"),
            ("velocity", "<f8", 3),
            ("position_covariance", "<f8", (3, 3)),
        ]
    ),
    Kind.MAGNETIC_FIELD: np.dtype(
        [
            ("magnetic_field", "<f8", 3),
            ("covariance", "<f8", (3, 3)),
        ]
    ),
    Kind.FLUID_PRESSURE: np.dtype(
        [
            ("fluid_pressure", "<f8"),
            ("variance", "<f8"),
        ]
    ),
    Kind.ALTIMETER: np.dtype(
        [
            ("vertical_position", "<f8"),
            ("vertical_velocity", "<f8"),
            ("vertical_reference", "<f8"),
            ("variance", "<f8"),
        ]
    ),
    Kind.VECTOR3: np.dtype(
        [
            ("vector", "<f8", 3),
        ]
    ),
    Kind.WRENCH: np.dtype(
        [
            ("force", "<f8", 3),
            ("torque", "<f8", 3),
        ]
    ),
    Kind.RANGE: np.dtype(
        [
            ("radiation_type", "<u4"),
            ("field_of_view", "<f4"),
            ("min_range", "<f4"),
            ("max_range", "<f4"),
            ("range", "<f4"),
        ]
    ),
    Kind.SENSOR_SETTINGS: np.dtype(
        [
            ("name", "S64"),
            ("topics", "S256", 6),
            ("update_rate", SETTING),
            ("noise_mean", SETTING),
            ("noise_stddev", SETTING),
            ("exposure", SETTING),
        ]
    ),
    Kind.BOUNDING_BOXES: np.dtype(
        [
            ("instance", "<u4"),
            ("label", "<u4"),
            ("pixels", "<u4"),
            ("min", "<u4", 2),
            ("max", "<u4", 2),
            ("reserved", "<u4"),
            ("position", "<f8", 3),
            ("orientation", "<f8", 4),
            ("size", "<f8", 3),
        ]
    ),
    Kind.TAG_DETECTIONS: np.dtype(
        [
            ("family", "S32"),
            ("id", "<u4"),
            ("visible", "u1", 4),
            ("size", "<f8"),
            ("corners", "<f8", (4, 2)),
            ("position", "<f8", 3),
            ("orientation", "<f8", 4),
        ]
    ),
    Kind.SEEN_MODELS: np.dtype(
        [
            ("name", "S128"),
            ("position", "<f8", 3),
            ("orientation", "<f8", 4),
        ]
    ),
    Kind.POSE: np.dtype(
        [
            ("position", "<f8", 3),
            ("orientation", "<f8", 4),
        ]
    ),
}
STRUCTS[Kind.STATIC_TRANSFORMS] = STRUCTS[Kind.TRANSFORMS]

#: The type of one element.
ELEMENTS: dict[Encoding, np.dtype[np.generic]] = {
    Encoding.RGB8: np.dtype(("u1", 3)),
    Encoding.BGR8: np.dtype(("u1", 3)),
    Encoding.MONO8: np.dtype("u1"),
    Encoding.F32C1: np.dtype("<f4"),
    Encoding.U16C1: np.dtype("<u2"),
    Encoding.XYZRGB_F32: np.dtype({
        "names": ["x", "y", "z", "rgb"],
        "formats": ["<f4", "<f4", "<f4", "<u4"],
        "offsets": [0, 4, 8, 16],
        "itemsize": 32,
    }),
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
    Encoding.XYZIRT_F32: np.dtype({
        "names": ["x", "y", "z", "intensity", "ring", "time"],
        "formats": ["<f4", "<f4", "<f4", "<f4", "<u2", "<f4"],
        "offsets": [0, 4, 8, 12, 16, 18],
        "itemsize": 22,
    }),
    Encoding.OUSTER_POINT: np.dtype({
        "names": ["x", "y", "z", "intensity", "t", "reflectivity", "ring", "ambient", "range"],
        "formats": ["<f4", "<f4", "<f4", "<f4", "<u4", "<u2", "<u2", "<u2", "<u4"],
        "offsets": [0, 4, 8, 16, 20, 24, 26, 28, 32],
        "itemsize": 48,
    }),
    Encoding.LIVOX_POINT: np.dtype({
        "names": ["x", "y", "z", "intensity", "tag", "line", "timestamp"],
        "formats": ["<f4", "<f4", "<f4", "<f4", "u1", "u1", "<f8"],
        "offsets": [0, 4, 8, 12, 16, 17, 18],
        "itemsize": 26,
    }),
    Encoding.XYZIR_F32: np.dtype({
        "names": ["x", "y", "z", "intensity", "ring"],
        "formats": ["<f4", "<f4", "<f4", "<f4", "<u2"],
        "offsets": [0, 4, 8, 12, 16],
        "itemsize": 18,
    }),
}
