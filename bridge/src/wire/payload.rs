//! The payloads that are fixed structs. All are little-endian, `repr(C)` without padding, valid for any bits, in SI
//! units and radians; orientations are quaternions x y z w. Values are in the coordinate frame of the header's
//! `frame_id`, at the time of its `stamp_ns`.

mod base;
mod contact;
mod control;
mod instruments;
mod range;
mod settings;
mod truth;

pub use base::*;
pub use contact::*;
pub use control::*;
pub use instruments::*;
pub use range::*;
pub use settings::*;
pub use truth::*;

use bytemuck::Pod;

use super::{
    Kind, MAX_DISTORTION, Text,
    fields::{Describe, Fields, RosType, Value},
    layout::{Struct, wire_structs},
};

/// Every payload struct as data, by file.
pub(super) const ALL: &[&[Struct]] = &[
    STRUCTS,
    base::STRUCTS,
    contact::STRUCTS,
    control::STRUCTS,
    instruments::STRUCTS,
    range::STRUCTS,
    settings::STRUCTS,
    truth::STRUCTS,
];

/// A payload struct of the wire format.
pub trait Message: Pod {
    /// The kinds of streams that carry it.
    const KINDS: &'static [Kind];
}

impl Kind {
    /// Returns the struct that this kind carries, as data; `None` for images, scans and clouds.
    pub(super) const fn layout(self) -> Option<&'static Struct> {
        let mut file = 0;
        while file < ALL.len() {
            let mut at = 0;
            while at < ALL[file].len() {
                let layout = &ALL[file][at];
                let mut kind = 0;
                while kind < layout.kinds.len() {
                    if layout.kinds[kind] == self as u16 {
                        return Some(layout);
                    }
                    kind += 1;
                }
                at += 1;
            }
            file += 1;
        }
        None
    }

    /// Returns the size in bytes of the struct that this kind carries, alone or in an array; `None` for images, scans
    /// and clouds.
    #[must_use]
    pub const fn struct_size(self) -> Option<usize> {
        match self.layout() {
            Some(layout) => Some(layout.size),
            None => None,
        }
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
}

impl Describe for CameraInfo {
    const ROS: &'static [RosType] =
        &[RosType::new("sensor_msgs/CameraInfo", "c9a58c1b0b154e0e6da7578cb991d214")];

    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.header(None);
        fields.put("height", self.height);
        fields.put("width", self.width);
        fields.put("distortion_model", self.distortion_model.as_str());
        fields.put("D", &self.d[..(self.d_len as usize).min(self.d.len())]);
        fields.put("K", &self.k);
        fields.put("R", &self.r);
        fields.put("P", &self.p);
        if fields.ros().is_some() {
            // The whole image, not binned.
            fields.put("binning_x", 0_u32);
            fields.put("binning_y", 0_u32);
            fields.part("roi", "sensor_msgs/RegionOfInterest", &mut |fields| {
                for name in ["x_offset", "y_offset", "height", "width"] {
                    fields.put(name, 0_u32);
                }
                fields.put("do_rectify", false);
            });
        }
        Some(())
    }
}

impl Describe for Odometry {
    const ROS: &'static [RosType] = &[RosType::new("nav_msgs/Odometry", "cd5e73d190d741a2f92e81eda573aca7")];

    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.header(None);
        fields.value("child_frame_id", Value::Frame(self.child_frame_id.as_str()));
        fields.part("pose", "geometry_msgs/PoseWithCovariance", &mut |fields| {
            fields.pose("pose", self.position, self.orientation);
            fields.put("covariance", &self.pose_covariance);
        });
        fields.part("twist", "geometry_msgs/TwistWithCovariance", &mut |fields| {
            fields.twist("twist", self.linear, self.angular);
            fields.put("covariance", &self.twist_covariance);
        });
        Some(())
    }
}

impl Describe for Transform {
    const ROS: &'static [RosType] = &[RosType::new("tf2_msgs/TFMessage", "94810edda583a504dfda3829e70d7eec")];

    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.header(Some(self.parent.as_str()));
        fields.value("child_frame_id", Value::Frame(self.child.as_str()));
        fields.part("transform", "geometry_msgs/Transform", &mut |fields| {
            fields.vector("translation", self.translation);
            fields.quaternion("rotation", self.rotation);
        });
        Some(())
    }

    fn describe_all(messages: &[Self], fields: &mut dyn Fields) -> Option<()> {
        each("transforms", "geometry_msgs/TransformStamped", messages, fields)
    }
}

impl Describe for JointState {
    const ROS: &'static [RosType] =
        &[RosType::new("sensor_msgs/JointState", "3066dcd76a6cfaef579bd0f34173e9fd")];

    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        Self::describe_all(&[*self], fields)
    }

    fn describe_all(messages: &[Self], fields: &mut dyn Fields) -> Option<()> {
        let column = |of: fn(&Self) -> f64| messages.iter().map(of).collect::<Vec<_>>();
        let names: Vec<&str> = messages.iter().map(|joint| joint.name.as_str()).collect();
        fields.header(None);
        fields.put("name", &names[..]);
        fields.put("position", &column(|joint| joint.position)[..]);
        fields.put("velocity", &column(|joint| joint.velocity)[..]);
        fields.put("effort", &column(|joint| joint.effort)[..]);
        Some(())
    }
}

impl Describe for Clock {
    const ROS: &'static [RosType] =
        &[RosType::new("rosgraph_msgs/Clock", "a9c97c1d230cfc112e270351a944ee47")];

    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.value("clock", Value::Time(self.now_ns));
        Some(())
    }
}

impl Describe for VelocityCommand {
    const ROS: &'static [RosType] =
        &[RosType::new("geometry_msgs/Twist", "9f195f881246fdfa2798d1d3eebca84a")];

    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.vector("linear", self.linear);
        fields.vector("angular", self.angular);
        Some(())
    }
}

impl Describe for Imu {
    const ROS: &'static [RosType] = &[RosType::new("sensor_msgs/Imu", "6a62c6daae103f4ff57a132d6f95cec2")];

    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.header(None);
        fields.quaternion("orientation", self.orientation);
        fields.put("orientation_covariance", &self.orientation_covariance);
        fields.vector("angular_velocity", self.angular_velocity);
        fields.put("angular_velocity_covariance", &self.angular_velocity_covariance);
        fields.vector("linear_acceleration", self.linear_acceleration);
        fields.put("linear_acceleration_covariance", &self.linear_acceleration_covariance);
        Some(())
    }
}

/// Describes an array of structs, a message of the type `of` each.
fn each<T: Describe>(
    name: &'static str,
    of: &'static str,
    messages: &[T],
    fields: &mut dyn Fields,
) -> Option<()> {
    let mut holds = Some(());
    fields.list(name, of, messages.len(), &mut |index, fields| {
        if messages[index].describe(fields).is_none() {
            holds = None;
        }
    });
    holds
}
