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

#[cfg(test)]
mod tests {
    use super::*;

    /// The hashes are those of Jazzy's packages.
    #[test]
    fn messages_have_the_names_and_hashes_of_ros2() {
        for (message, name, hash) in [
            (
                Message::TWIST,
                "geometry_msgs/msg/Twist",
                "9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a",
            ),
            (
                Message::TWIST_STAMPED,
                "geometry_msgs/msg/TwistStamped",
                "5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64",
            ),
            (
                Message::COMPRESSED_IMAGE,
                "sensor_msgs/msg/CompressedImage",
                "15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a",
            ),
            (
                Message::STRING,
                "std_msgs/msg/String",
                "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
            ),
        ] {
            assert_eq!((message.name(), message.hash()), (name.to_owned(), format!("RIHS01_{hash}")));
        }
    }
}
