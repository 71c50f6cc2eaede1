//! The payloads that are fixed structs. All are little-endian, `repr(C)` without padding, valid for any bits, in SI
//! units and radians; orientations are quaternions x y z w. Values are in the coordinate frame of the header's
//! `frame_id`, at the time of its `stamp_ns`.

mod control;
mod instruments;
mod range;
mod settings;
mod truth;

pub use control::{ModelState, SimulationCommand, SimulationResult};
pub use instruments::{Altimeter, FluidPressure, MagneticField, NavSatFix, Vector3};
pub use range::Range;
pub use settings::{SensorSettings, Setting};
pub use truth::{BoundingBox, TagDetection};

use bytemuck::Pod;

use super::{
    Kind, MAX_DISTORTION, Text,
    layout::{Struct, wire_structs},
};

/// Every payload struct as data, by file.
pub(super) const ALL: &[&[Struct]] =
    &[STRUCTS, control::STRUCTS, instruments::STRUCTS, range::STRUCTS, settings::STRUCTS, truth::STRUCTS];

/// A payload struct of the wire format.
pub trait Message: Pod {
    /// The kinds of streams that carry it.
    const KINDS: &'static [Kind];
}

impl Kind {
    /// Returns the size in bytes of the struct that this kind carries, alone or in an array; `None` for images, scans
    /// and clouds.
    #[must_use]
    pub const fn struct_size(self) -> Option<usize> {
        let mut file = 0;
        while file < ALL.len() {
            let mut at = 0;
            while at < ALL[file].len() {
                let Struct { kinds, size, .. } = ALL[file][at];
                let mut kind = 0;
                while kind < kinds.len() {
                    if kinds[kind] == self as u16 {
                        return Some(size);
                    }
                    kind += 1;
                }
                at += 1;
            }
            file += 1;
        }
        None
    }
}

wire_structs! {
    /// The calibration of a camera, as in `sensor_msgs/CameraInfo`.
    pub struct CameraInfo, 400 bytes, of [Kind::CameraInfo] {
        /// Pixels per row.
        pub width: u32 = 0,
        /// Rows.
        pub height: u32 = 4,
        /// The name of a [`DistortionModel`](crate::DistortionModel); empty without distortion.
        pub distortion_model: Text<32> = 8,
        /// Distortion parameters in the order of the model; the first `d_len` are valid.
        pub d: [f64; MAX_DISTORTION] = 40,
        /// Number of valid values in `d`.
        pub d_len: u32 = 152,
        /// Reserved; 0.
        pub reserved: u32 = 156,
        /// Intrinsic matrix of the raw image, row by row.
        pub k: [f64; 9] = 160 as [3, 3],
        /// Rectification rotation, row by row.
        pub r: [f64; 9] = 232 as [3, 3],
        /// Projection matrix of the rectified image, 3 × 4, row by row.
        pub p: [f64; 12] = 304 as [3, 4],
    }

    /// Pose and velocity of a body, as in `nav_msgs/Odometry`: the pose is in the header's `frame_id`, the velocity in
    /// `child_frame_id`.
    pub struct Odometry, 744 bytes, of [Kind::Odometry] {
        /// The body's frame.
        pub child_frame_id: Text<64> = 0,
        /// Position, metres.
        pub position: [f64; 3] = 64,
        /// Orientation, x y z w.
        pub orientation: [f64; 4] = 88,
        /// Linear velocity, metres per second.
        pub linear: [f64; 3] = 120,
        /// Angular velocity, radians per second.
        pub angular: [f64; 3] = 144,
        /// Covariance of the pose, 6 × 6 row by row: x y z, then rotations about x y z.
        pub pose_covariance: [f64; 36] = 168 as [6, 6],
        /// Covariance of the velocity, 6 × 6 row by row: linear x y z, then angular x y z.
        pub twist_covariance: [f64; 36] = 456 as [6, 6],
    }

    /// A transform between two frames: `point_in_parent = parent_from_child · point_in_child`.
    pub struct Transform, 184 bytes, of [Kind::Transforms, Kind::StaticTransforms] {
        /// The reference frame.
        pub parent: Text<64> = 0,
        /// The frame whose pose is given.
        pub child: Text<64> = 64,
        /// The child's origin in the parent, metres.
        pub translation: [f64; 3] = 128,
        /// The child's orientation in the parent, x y z w.
        pub rotation: [f64; 4] = 152,
    }

    /// The state of one joint.
    pub struct JointState, 88 bytes, of [Kind::JointStates] {
        /// The joint's name in the robot description.
        pub name: Text<64> = 0,
        /// Position, radians or metres.
        pub position: f64 = 64,
        /// Velocity, radians or metres per second.
        pub velocity: f64 = 72,
        /// Effort, newton metres or newtons.
        pub effort: f64 = 80,
    }

    /// The simulated time.
    with #[derive(PartialEq, Eq)]
    pub struct Clock, 8 bytes, of [Kind::Clock] {
        /// Nanoseconds since the simulation started.
        pub now_ns: u64 = 0,
    }

    /// A commanded velocity of the robot in its own frame, as in `geometry_msgs/Twist`.
    with #[derive(Default, PartialEq)]
    pub struct VelocityCommand, 48 bytes, of [Kind::VelocityCommand] {
        /// Linear velocity: x forward, y left, z up; metres per second.
        pub linear: [f64; 3] = 0,
        /// Angular velocity about x, y, z; radians per second.
        pub angular: [f64; 3] = 24,
    }

    /// The measurement of an inertial measurement unit, as in `sensor_msgs/Imu`, in the header's `frame_id`.
    /// Covariances are 3 × 3 row by row. All zeros mean an unknown covariance; −1 as the first element means that there
    /// is no measurement (REP-145).
    with #[derive(PartialEq)]
    pub struct Imu, 296 bytes, of [Kind::Imu] {
        /// Orientation, x y z w.
        pub orientation: [f64; 4] = 0,
        /// Angular velocity, radians per second.
        pub angular_velocity: [f64; 3] = 32,
        /// Linear acceleration, metres per second²; +g upwards at rest.
        pub linear_acceleration: [f64; 3] = 56,
        /// Covariance of the orientation about x, y, z.
        pub orientation_covariance: [f64; 9] = 80 as [3, 3],
        /// Covariance of the angular velocity about x, y, z.
        pub angular_velocity_covariance: [f64; 9] = 152 as [3, 3],
        /// Covariance of the linear acceleration along x, y, z.
        pub linear_acceleration_covariance: [f64; 9] = 224 as [3, 3],
    }

    /// A change of state of a base's bumper, cliff sensor or wheel (`kobuki_msgs/BumperEvent`, `CliffEvent`,
    /// `WheelDropEvent`).
    with #[derive(PartialEq, Eq)]
    pub struct RobotEvent, 16 bytes, of [Kind::RobotEvent] {
        /// [`RobotEvent::BUMPER`], [`RobotEvent::CLIFF`] or [`RobotEvent::WHEEL_DROP`].
        pub source: u32 = 0,
        /// [`RobotEvent::LEFT`], [`RobotEvent::CENTRE`] or [`RobotEvent::RIGHT`]. (`kobuki_msgs` numbers the right wheel 1.)
        pub index: u32 = 4,
        /// The new state: 0 released, floor, raised; 1 pressed, cliff, dropped.
        pub state: u32 = 8,
        /// The reading of a cliff sensor, as in [`CoreSensors::bottom`]; 0 for other sources.
        pub value: u32 = 12,
    }

    /// The state of a base's own sensors, 50 times a second (`kobuki_msgs/SensorState`). In the bits of bumper and
    /// cliff, 1 is right, 2 is centre, 4 is left; in those of the wheels, 1 is right, 2 is left.
    with #[derive(PartialEq, Eq)]
    pub struct CoreSensors, 20 bytes, of [Kind::CoreSensors] {
        /// Time in milliseconds; wraps around.
        pub time_stamp: u16 = 0,
        /// Bits of the pressed bumpers.
        pub bumper: u8 = 2,
        /// Bits of the dropped wheels.
        pub wheel_drop: u8 = 3,
        /// Bits of the cliff sensors that see no floor.
        pub cliff: u8 = 4,
        /// Bits of the pressed buttons: 1, 2, 4.
        pub buttons: u8 = 5,
        /// Ticks of the left wheel; wraps around.
        pub left_encoder: u16 = 6,
        /// Ticks of the right wheel; wraps around.
        pub right_encoder: u16 = 8,
        /// Duty cycle of the left motor; always 0, since it is not simulated.
        pub left_pwm: i8 = 10,
        /// Duty cycle of the right motor; always 0, since it is not simulated.
        pub right_pwm: i8 = 11,
        /// State of charge control: 0 discharging, 2 charged, 6 charging; plus 16 if an adapter is connected.
        pub charger: u8 = 12,
        /// Battery voltage in tenths of a volt.
        pub battery: u8 = 13,
        /// Readings of the cliff sensors' 12-bit converters: right, centre, left; smaller is farther.
        pub bottom: [u16; 3] = 14,
    }

    /// A command to restart odometry at zero from the current pose.
    with #[derive(Default, PartialEq, Eq)]
    pub struct ResetOdometry, 8 bytes, of [Kind::ResetOdometry] {
        /// Reserved; 0.
        pub reserved: u64 = 0,
    }

    /// A command to enable or disable the motors (`kobuki_msgs/MotorPower`).
    with #[derive(Default, PartialEq, Eq)]
    pub struct MotorPower, 4 bytes, of [Kind::MotorPower] {
        /// 0 off, else on.
        pub state: u32 = 0,
    }
}

impl RobotEvent {
    /// Source: a bumper.
    pub const BUMPER: u32 = 0;
    /// Source: a cliff sensor.
    pub const CLIFF: u32 = 1;
    /// Source: a wheel.
    pub const WHEEL_DROP: u32 = 2;
    /// Index: on the left.
    pub const LEFT: u32 = 0;
    /// Index: in front.
    pub const CENTRE: u32 = 1;
    /// Index: on the right.
    pub const RIGHT: u32 = 2;
}
