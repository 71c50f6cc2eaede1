//! The payloads of fixed shape. All are little-endian, `repr(C)` without padding, valid for any bits, in SI
//! units and radians; orientations are quaternions x y z w. The frame that values are given in is the header's
//! `frame_id`, their time its `stamp_ns`.

mod control;

pub use control::{ModelState, SimulationCommand, SimulationResult};

use std::mem::{offset_of, size_of};

use bytemuck::{Pod, Zeroable};

use crate::{Kind, Text};

/// A payload struct of the wire format.
pub trait Message: Pod {
    /// The kinds of streams that carry it.
    const KINDS: &'static [Kind];
}

/// How a camera maps directions to pixels, as `sensor_msgs/CameraInfo` has it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct CameraInfo {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `plumb_bob`, `rational_polynomial`, `equidistant`, or nothing without distortion.
    pub distortion_model: Text<32>,
    /// Distortion parameters in the order of the model; the first `d_len` hold.
    pub d: [f64; 8],
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

// The wire format: every offset is pinned here, in the C and C++ headers and in WIRE.md.
const _: () = {
    assert!(size_of::<CameraInfo>() == 352);
    assert!(offset_of!(CameraInfo, width) == 0);
    assert!(offset_of!(CameraInfo, height) == 4);
    assert!(offset_of!(CameraInfo, distortion_model) == 8);
    assert!(offset_of!(CameraInfo, d) == 40);
    assert!(offset_of!(CameraInfo, d_len) == 104);
    assert!(offset_of!(CameraInfo, reserved) == 108);
    assert!(offset_of!(CameraInfo, k) == 112);
    assert!(offset_of!(CameraInfo, r) == 184);
    assert!(offset_of!(CameraInfo, p) == 256);

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
};
