//! The payloads of fixed shape. All are little-endian, `repr(C)` without padding, valid for any bits, in SI
//! units and radians; orientations are quaternions x y z w. The frame that values are given in is the header's
//! `frame_id`, their time its `stamp_ns`.

mod control;
mod range;
mod settings;
mod truth;

pub use control::{ModelState, SimulationCommand, SimulationResult};
pub use range::Range;
pub use settings::{SensorSettings, Setting};
pub use truth::{BoundingBox, TagDetection};

use std::mem::{offset_of, size_of};

use bytemuck::{Pod, Zeroable};

use super::{Kind, MAX_DISTORTION, Text};

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
        Some(match self {
            Self::Image | Self::DepthImage | Self::LaserScan | Self::PointCloud => return None,
            Self::CameraInfo => size_of::<CameraInfo>(),
            Self::Odometry => size_of::<Odometry>(),
            Self::Transforms | Self::StaticTransforms => size_of::<Transform>(),
            Self::JointStates => size_of::<JointState>(),
            Self::Clock => size_of::<Clock>(),
            Self::VelocityCommand => size_of::<VelocityCommand>(),
            Self::Imu => size_of::<Imu>(),
            Self::RobotEvent => size_of::<RobotEvent>(),
            Self::CoreSensors => size_of::<CoreSensors>(),
            Self::ResetOdometry => size_of::<ResetOdometry>(),
            Self::MotorPower => size_of::<MotorPower>(),
            Self::SimulationCommand => size_of::<SimulationCommand>(),
            Self::SimulationResult => size_of::<SimulationResult>(),
            Self::ModelStates => size_of::<ModelState>(),
            Self::Range => size_of::<Range>(),
            Self::SensorSettings => size_of::<SensorSettings>(),
            Self::BoundingBoxes => size_of::<BoundingBox>(),
            Self::TagDetections => size_of::<TagDetection>(),
        })
    }
}

/// How a camera maps directions to pixels, as `sensor_msgs/CameraInfo` has it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct CameraInfo {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// A [`DistortionModel`](crate::DistortionModel) by its name, or nothing without distortion.
    pub distortion_model: Text<32>,
    /// Distortion parameters in the order of the model; the first `d_len` hold.
    pub d: [f64; MAX_DISTORTION],
    /// How many of `d` hold.
    pub d_len: u32,
    /// 0.
    pub reserved: u32,
    /// Intrinsic matrix of the raw image, row by row.
    pub k: [f64; 9],
    /// Rectification rotation, row by row.
    pub r: [f64; 9],
    /// Projection matrix of the rectified image, 3 × 4, row by row.
    pub p: [f64; 12],
}

/// Pose and velocity of a body, as `nav_msgs/Odometry` has it: the pose is in the header's `frame_id`, the
/// velocity in `child_frame_id`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Odometry {
    /// The body's frame.
    pub child_frame_id: Text<64>,
    /// Metres.
    pub position: [f64; 3],
    /// x y z w.
    pub orientation: [f64; 4],
    /// Metres per second.
    pub linear: [f64; 3],
    /// Radians per second.
    pub angular: [f64; 3],
    /// 6 × 6 row by row: x y z and rotations about x y z.
    pub pose_covariance: [f64; 36],
    /// 6 × 6 row by row: linear x y z, angular x y z.
    pub twist_covariance: [f64; 36],
}

/// `point_in_parent = parent_from_child · point_in_child`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Transform {
    /// The frame that is the reference.
    pub parent: Text<64>,
    /// The frame whose pose is given.
    pub child: Text<64>,
    /// The child's origin in the parent, metres.
    pub translation: [f64; 3],
    /// x y z w.
    pub rotation: [f64; 4],
}

/// State of one joint.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct JointState {
    /// The joint's name in the robot description.
    pub name: Text<64>,
    /// Radians or metres.
    pub position: f64,
    /// Radians or metres per second.
    pub velocity: f64,
    /// Newton metres or newtons.
    pub effort: f64,
}

/// The simulation's time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Clock {
    /// Nanoseconds since the simulation started.
    pub now_ns: u64,
}

/// A wanted velocity of the robot in its own frame, as `geometry_msgs/Twist` has it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct VelocityCommand {
    /// x forward, y left, z up; metres per second.
    pub linear: [f64; 3],
    /// About x, y, z; radians per second.
    pub angular: [f64; 3],
}

/// What an inertial measurement unit measures, as `sensor_msgs/Imu` has it, in the header's `frame_id`. Covariances
/// are 3 × 3 row by row; one of zeros is not known, one that begins with −1 says that there is no measurement
/// (REP-145).
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Imu {
    /// x y z w.
    pub orientation: [f64; 4],
    /// Radians per second.
    pub angular_velocity: [f64; 3],
    /// Metres per second²; +g upwards at rest.
    pub linear_acceleration: [f64; 3],
    /// About x, y, z.
    pub orientation_covariance: [f64; 9],
    /// About x, y, z.
    pub angular_velocity_covariance: [f64; 9],
    /// Along x, y, z.
    pub linear_acceleration_covariance: [f64; 9],
}

/// A sensor of a base that has changed its state (`kobuki_msgs/BumperEvent`, `CliffEvent`, `WheelDropEvent`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct RobotEvent {
    /// [`RobotEvent::BUMPER`], [`RobotEvent::CLIFF`] or [`RobotEvent::WHEEL_DROP`].
    pub source: u32,
    /// [`RobotEvent::LEFT`], [`RobotEvent::CENTRE`] or [`RobotEvent::RIGHT`]. (`kobuki_msgs` numbers the right wheel 1.)
    pub index: u32,
    /// 0 released, floor, raised; 1 pressed, cliff, dropped.
    pub state: u32,
    /// A cliff sensor's reading, as [`CoreSensors::bottom`]; else 0.
    pub value: u32,
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

/// What a base says of itself 50 times a second (`kobuki_msgs/SensorState`). In the bits of bumper and cliff 1 is
/// right, 2 is centre, 4 is left; in those of the wheels 1 is right, 2 is left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct CoreSensors {
    /// Milliseconds; wraps.
    pub time_stamp: u16,
    /// Bits of what is pressed.
    pub bumper: u8,
    /// Bits of the wheels that hang.
    pub wheel_drop: u8,
    /// Bits of where there is no floor.
    pub cliff: u8,
    /// Bits of what is pressed: 1, 2, 4.
    pub buttons: u8,
    /// Ticks of the left wheel; wraps.
    pub left_encoder: u16,
    /// Ticks of the right wheel; wraps.
    pub right_encoder: u16,
    /// Duty of the left motor; 0, not simulated.
    pub left_pwm: i8,
    /// Duty of the right motor; 0, not simulated.
    pub right_pwm: i8,
    /// 0 discharging, 2 charged, 6 charging; 16 is added at an adapter.
    pub charger: u8,
    /// Tenths of a volt.
    pub battery: u8,
    /// Converted readings of the cliff sensors right, centre, left, of 12 bits; smaller is farther.
    pub bottom: [u16; 3],
}

/// Odometry is to begin at zero here and now.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct ResetOdometry {
    /// 0.
    pub reserved: u64,
}

/// Whether the motors follow commands (`kobuki_msgs/MotorPower`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct MotorPower {
    /// 0 off, else on.
    pub state: u32,
}

impl Message for CameraInfo {
    const KINDS: &'static [Kind] = &[Kind::CameraInfo];
}
impl Message for Odometry {
    const KINDS: &'static [Kind] = &[Kind::Odometry];
}
impl Message for Transform {
    const KINDS: &'static [Kind] = &[Kind::Transforms, Kind::StaticTransforms];
}
impl Message for JointState {
    const KINDS: &'static [Kind] = &[Kind::JointStates];
}
impl Message for Clock {
    const KINDS: &'static [Kind] = &[Kind::Clock];
}
impl Message for VelocityCommand {
    const KINDS: &'static [Kind] = &[Kind::VelocityCommand];
}
impl Message for Imu {
    const KINDS: &'static [Kind] = &[Kind::Imu];
}
impl Message for RobotEvent {
    const KINDS: &'static [Kind] = &[Kind::RobotEvent];
}
impl Message for CoreSensors {
    const KINDS: &'static [Kind] = &[Kind::CoreSensors];
}
impl Message for ResetOdometry {
    const KINDS: &'static [Kind] = &[Kind::ResetOdometry];
}
impl Message for MotorPower {
    const KINDS: &'static [Kind] = &[Kind::MotorPower];
}

// The wire format: every offset is pinned here, in the C and C++ headers and in WIRE.md.
const _: () = {
    assert!(size_of::<CameraInfo>() == 400);
    assert!(offset_of!(CameraInfo, width) == 0);
    assert!(offset_of!(CameraInfo, height) == 4);
    assert!(offset_of!(CameraInfo, distortion_model) == 8);
    assert!(offset_of!(CameraInfo, d) == 40);
    assert!(offset_of!(CameraInfo, d_len) == 152);
    assert!(offset_of!(CameraInfo, reserved) == 156);
    assert!(offset_of!(CameraInfo, k) == 160);
    assert!(offset_of!(CameraInfo, r) == 232);
    assert!(offset_of!(CameraInfo, p) == 304);

    assert!(size_of::<Odometry>() == 744);
    assert!(offset_of!(Odometry, child_frame_id) == 0);
    assert!(offset_of!(Odometry, position) == 64);
    assert!(offset_of!(Odometry, orientation) == 88);
    assert!(offset_of!(Odometry, linear) == 120);
    assert!(offset_of!(Odometry, angular) == 144);
    assert!(offset_of!(Odometry, pose_covariance) == 168);
    assert!(offset_of!(Odometry, twist_covariance) == 456);

    assert!(size_of::<Transform>() == 184);
    assert!(offset_of!(Transform, parent) == 0);
    assert!(offset_of!(Transform, child) == 64);
    assert!(offset_of!(Transform, translation) == 128);
    assert!(offset_of!(Transform, rotation) == 152);

    assert!(size_of::<JointState>() == 88);
    assert!(offset_of!(JointState, name) == 0);
    assert!(offset_of!(JointState, position) == 64);
    assert!(offset_of!(JointState, velocity) == 72);
    assert!(offset_of!(JointState, effort) == 80);

    assert!(size_of::<Clock>() == 8);
    assert!(size_of::<VelocityCommand>() == 48);
    assert!(offset_of!(VelocityCommand, linear) == 0);
    assert!(offset_of!(VelocityCommand, angular) == 24);

    assert!(size_of::<Imu>() == 296);
    assert!(offset_of!(Imu, orientation) == 0);
    assert!(offset_of!(Imu, angular_velocity) == 32);
    assert!(offset_of!(Imu, linear_acceleration) == 56);
    assert!(offset_of!(Imu, orientation_covariance) == 80);
    assert!(offset_of!(Imu, angular_velocity_covariance) == 152);
    assert!(offset_of!(Imu, linear_acceleration_covariance) == 224);

    assert!(size_of::<RobotEvent>() == 16);
    assert!(offset_of!(RobotEvent, source) == 0);
    assert!(offset_of!(RobotEvent, index) == 4);
    assert!(offset_of!(RobotEvent, state) == 8);
    assert!(offset_of!(RobotEvent, value) == 12);

    assert!(size_of::<CoreSensors>() == 20);
    assert!(offset_of!(CoreSensors, time_stamp) == 0);
    assert!(offset_of!(CoreSensors, bumper) == 2);
    assert!(offset_of!(CoreSensors, wheel_drop) == 3);
    assert!(offset_of!(CoreSensors, cliff) == 4);
    assert!(offset_of!(CoreSensors, buttons) == 5);
    assert!(offset_of!(CoreSensors, left_encoder) == 6);
    assert!(offset_of!(CoreSensors, right_encoder) == 8);
    assert!(offset_of!(CoreSensors, left_pwm) == 10);
    assert!(offset_of!(CoreSensors, right_pwm) == 11);
    assert!(offset_of!(CoreSensors, charger) == 12);
    assert!(offset_of!(CoreSensors, battery) == 13);
    assert!(offset_of!(CoreSensors, bottom) == 14);

    assert!(size_of::<ResetOdometry>() == 8);
    assert!(size_of::<MotorPower>() == 4);
};
