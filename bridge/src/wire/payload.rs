//! The payloads of fixed shape. All are little-endian, `repr(C)` without padding, valid for any bits, in SI
//! units and radians; orientations are quaternions x y z w. The frame that values are given in is the header's
//! `frame_id`, their time its `stamp_ns`.

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

/// Every struct of a payload as data, by files.
pub(super) const ALL: &[&[Struct]] =
    &[STRUCTS, control::STRUCTS, instruments::STRUCTS, range::STRUCTS, settings::STRUCTS, truth::STRUCTS];

/// A payload struct of the wire format.
pub trait Message: Pod {
    /// The kinds of streams that carry it.
    const KINDS: &'static [Kind];
}

impl Kind {
    /// Size in bytes of one element of a kind whose payload is a fixed struct or an array of them; `None` for
    /// pictures, scans and clouds.
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
    /// How a camera maps directions to pixels, as `sensor_msgs/CameraInfo` has it.
    pub struct CameraInfo, 400 bytes, of [Kind::CameraInfo] {
        /// Pixels per row.
        pub width: u32 = 0,
        /// Rows.
        pub height: u32 = 4,
        /// A [`DistortionModel`](crate::DistortionModel) by its name, or nothing without distortion.
        pub distortion_model: Text<32> = 8,
        /// Distortion parameters in the order of the model; the first `d_len` hold.
        pub d: [f64; MAX_DISTORTION] = 40,
        /// How many of `d` hold.
        pub d_len: u32 = 152,
        /// 0.
        pub reserved: u32 = 156,
        /// Intrinsic matrix of the raw image, row by row.
        pub k: [f64; 9] = 160 as [3, 3],
        /// Rectification rotation, row by row.
        pub r: [f64; 9] = 232 as [3, 3],
        /// Projection matrix of the rectified image, 3 × 4, row by row.
        pub p: [f64; 12] = 304 as [3, 4],
    }

    /// Pose and velocity of a body, as `nav_msgs/Odometry` has it: the pose is in the header's `frame_id`, the
    /// velocity in `child_frame_id`.
    pub struct Odometry, 744 bytes, of [Kind::Odometry] {
        /// The body's frame.
        pub child_frame_id: Text<64> = 0,
        /// Metres.
        pub position: [f64; 3] = 64,
        /// x y z w.
        pub orientation: [f64; 4] = 88,
        /// Metres per second.
        pub linear: [f64; 3] = 120,
        /// Radians per second.
        pub angular: [f64; 3] = 144,
        /// 6 × 6 row by row: x y z and rotations about x y z.
        pub pose_covariance: [f64; 36] = 168 as [6, 6],
        /// 6 × 6 row by row: linear x y z, angular x y z.
        pub twist_covariance: [f64; 36] = 456 as [6, 6],
    }

    /// `point_in_parent = parent_from_child · point_in_child`.
    pub struct Transform, 184 bytes, of [Kind::Transforms, Kind::StaticTransforms] {
        /// The frame that is the reference.
        pub parent: Text<64> = 0,
        /// The frame whose pose is given.
        pub child: Text<64> = 64,
        /// The child's origin in the parent, metres.
        pub translation: [f64; 3] = 128,
        /// x y z w.
        pub rotation: [f64; 4] = 152,
    }

    /// State of one joint.
    pub struct JointState, 88 bytes, of [Kind::JointStates] {
        /// The joint's name in the robot description.
        pub name: Text<64> = 0,
        /// Radians or metres.
        pub position: f64 = 64,
        /// Radians or metres per second.
        pub velocity: f64 = 72,
        /// Newton metres or newtons.
        pub effort: f64 = 80,
    }

    /// The simulation's time.
    with #[derive(PartialEq, Eq)]
    pub struct Clock, 8 bytes, of [Kind::Clock] {
        /// Nanoseconds since the simulation started.
        pub now_ns: u64 = 0,
    }

    /// A wanted velocity of the robot in its own frame, as `geometry_msgs/Twist` has it.
    with #[derive(Default, PartialEq)]
    pub struct VelocityCommand, 48 bytes, of [Kind::VelocityCommand] {
        /// x forward, y left, z up; metres per second.
        pub linear: [f64; 3] = 0,
        /// About x, y, z; radians per second.
        pub angular: [f64; 3] = 24,
    }

    /// What an inertial measurement unit measures, as `sensor_msgs/Imu` has it, in the header's `frame_id`. Covariances
    /// are 3 × 3 row by row; one of zeros is not known, one that begins with −1 says that there is no measurement
    /// (REP-145).
    with #[derive(PartialEq)]
    pub struct Imu, 296 bytes, of [Kind::Imu] {
        /// x y z w.
        pub orientation: [f64; 4] = 0,
        /// Radians per second.
        pub angular_velocity: [f64; 3] = 32,
        /// Metres per second²; +g upwards at rest.
        pub linear_acceleration: [f64; 3] = 56,
        /// About x, y, z.
        pub orientation_covariance: [f64; 9] = 80 as [3, 3],
        /// About x, y, z.
        pub angular_velocity_covariance: [f64; 9] = 152 as [3, 3],
        /// Along x, y, z.
        pub linear_acceleration_covariance: [f64; 9] = 224 as [3, 3],
    }

    /// A sensor of a base that has changed its state (`kobuki_msgs/BumperEvent`, `CliffEvent`, `WheelDropEvent`).
    with #[derive(PartialEq, Eq)]
    pub struct RobotEvent, 16 bytes, of [Kind::RobotEvent] {
        /// [`RobotEvent::BUMPER`], [`RobotEvent::CLIFF`] or [`RobotEvent::WHEEL_DROP`].
        pub source: u32 = 0,
        /// [`RobotEvent::LEFT`], [`RobotEvent::CENTRE`] or [`RobotEvent::RIGHT`]. (`kobuki_msgs` numbers the right wheel 1.)
        pub index: u32 = 4,
        /// 0 released, floor, raised; 1 pressed, cliff, dropped.
        pub state: u32 = 8,
        /// A cliff sensor's reading, as [`CoreSensors::bottom`]; else 0.
        pub value: u32 = 12,
    }

    /// What a base says of itself 50 times a second (`kobuki_msgs/SensorState`). In the bits of bumper and cliff 1 is
    /// right, 2 is centre, 4 is left; in those of the wheels 1 is right, 2 is left.
    with #[derive(PartialEq, Eq)]
    pub struct CoreSensors, 20 bytes, of [Kind::CoreSensors] {
        /// Milliseconds; wraps.
        pub time_stamp: u16 = 0,
        /// Bits of what is pressed.
        pub bumper: u8 = 2,
        /// Bits of the wheels that hang.
        pub wheel_drop: u8 = 3,
        /// Bits of where there is no floor.
        pub cliff: u8 = 4,
        /// Bits of what is pressed: 1, 2, 4.
        pub buttons: u8 = 5,
        /// Ticks of the left wheel; wraps.
        pub left_encoder: u16 = 6,
        /// Ticks of the right wheel; wraps.
        pub right_encoder: u16 = 8,
        /// Duty of the left motor; 0, not simulated.
        pub left_pwm: i8 = 10,
        /// Duty of the right motor; 0, not simulated.
        pub right_pwm: i8 = 11,
        /// 0 discharging, 2 charged, 6 charging; 16 is added at an adapter.
        pub charger: u8 = 12,
        /// Tenths of a volt.
        pub battery: u8 = 13,
        /// Converted readings of the cliff sensors right, centre, left, of 12 bits; smaller is farther.
        pub bottom: [u16; 3] = 14,
    }

    /// Odometry is to begin at zero here and now.
    with #[derive(Default, PartialEq, Eq)]
    pub struct ResetOdometry, 8 bytes, of [Kind::ResetOdometry] {
        /// 0.
        pub reserved: u64 = 0,
    }

    /// Whether the motors follow commands (`kobuki_msgs/MotorPower`).
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
