//! [`Message`]: types of messages that are received, or that are written from something other than a frame.

use super::type_hash::type_hash;
use belvedere_bridge::{Fields, Ros};

/// A type of message of ROS 2.
#[derive(Debug, Clone, Copy)]
pub(super) struct Message {
    /// Its name in ROS 1, which has the same types.
    of_ros1: &'static str,
    /// Passes the fields, with any values.
    describe: fn(&mut dyn Fields),
}

impl Message {
    pub(super) const TWIST: Self = Self {
        of_ros1: "geometry_msgs/Twist",
        describe: |fields| {
            fields.vector("linear", [0.0; 3]);
            fields.vector("angular", [0.0; 3]);
        },
    };
    pub(super) const TWIST_STAMPED: Self = Self {
        of_ros1: "geometry_msgs/TwistStamped",
        describe: |fields| {
            fields.header(None);
            fields.twist("twist", [0.0; 3], [0.0; 3]);
        },
    };

    pub(super) const COMPRESSED_IMAGE: Self = Self {
        of_ros1: "sensor_msgs/CompressedImage",
        describe: |fields| {
            fields.header(None);
            fields.put("format", "");
            fields.put("data", &[0_u8; 0][..]);
        },
    };
    pub(super) const STRING: Self =
        Self { of_ros1: "std_msgs/String", describe: |fields| fields.put("data", "") };

    /// Returns the name of the type, such as `geometry_msgs/msg/Twist`.
    pub(super) fn name(&self) -> String {
        Ros::Two.type_name(self.of_ros1)
    }

    /// Returns the hash by which nodes of ROS 2 see that they mean the same message.
    pub(super) fn hash(&self) -> String {
        let mut describe = self.describe;
        type_hash(&self.name(), &Ros::Two.definition(self.of_ros1, &mut describe))
    }
}
