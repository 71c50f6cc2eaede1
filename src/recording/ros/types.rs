//! The types of images, scans and clouds, and of our own message. In ROS 1, fields and constants are those of the
//! packages in Noetic, so that readers compute the same MD5 sums; comments do not affect the sums.

use belvedere_bridge::point::Number;
use belvedere_bridge::{Fields, Ros, RosMessage};

/// A type of message of ROS.
#[derive(Debug, Clone, Copy)]
pub struct MessageType {
    /// Name in ROS 1, in the form `package/Type`.
    pub name: &'static str,
    pub(super) definition: Definition,
}

/// Where the definition of a type comes from.
#[derive(Debug, Clone, Copy)]
pub(super) enum Definition {
    /// A function that passes the fields, with any values.
    Fields(fn(&mut dyn Fields)),
    /// The definition of a payload struct.
    Struct(RosMessage),
    /// A text, which is the same in ROS 1 and ROS 2.
    Text(&'static str),
}

impl MessageType {
    /// Returns the definition followed by those of all contained types, as `ros1msg` or `ros2msg` requires.
    pub fn definition(&self, ros: Ros) -> String {
        match self.definition {
            Definition::Fields(mut describe) => ros.definition(self.name, &mut describe),
            Definition::Struct(message) => message.definition(ros),
            Definition::Text(text) => text.to_owned(),
        }
    }
}

impl From<RosMessage> for MessageType {
    fn from(message: RosMessage) -> Self {
        Self { name: message.ros.name, definition: Definition::Struct(message) }
    }
}

pub(super) const IMAGE: MessageType =
    MessageType { name: "sensor_msgs/Image", definition: Definition::Fields(image) };

fn image(fields: &mut dyn Fields) {
    fields.header(None);
    fields.put("height", 0_u32);
    fields.put("width", 0_u32);
    fields.put("encoding", "");
    fields.put("is_bigendian", 0_u8);
    fields.put("step", 0_u32);
    fields.put("data", &[0_u8; 0][..]);
}

pub(super) const LASER_SCAN: MessageType =
    MessageType { name: "sensor_msgs/LaserScan", definition: Definition::Fields(laser_scan) };

fn laser_scan(fields: &mut dyn Fields) {
    fields.header(None);
    for name in
        ["angle_min", "angle_max", "angle_increment", "time_increment", "scan_time", "range_min", "range_max"]
    {
        fields.put(name, 0.0_f32);
    }
    fields.put("ranges", &[0.0_f32; 0][..]);
    fields.put("intensities", &[0.0_f32; 0][..]);
}

pub(super) const POINT_CLOUD: MessageType =
    MessageType { name: "sensor_msgs/PointCloud2", definition: Definition::Fields(point_cloud) };

/// The types of the fields of points, `datatype` in a `sensor_msgs/PointField`.
const DATATYPES: [(&str, u8); 8] = [
    ("INT8", 1),
    ("UINT8", 2),
    ("INT16", 3),
    ("UINT16", 4),
    ("INT32", 5),
    ("UINT32", 6),
    ("FLOAT32", 7),
    ("FLOAT64", 8),
];

/// Returns the `datatype` of a field.
pub(super) fn datatype(number: Number) -> u8 {
    DATATYPES.iter().find(|(name, _)| *name == number.ros_constant()).map_or(0, |(_, datatype)| *datatype)
}

fn point_cloud(fields: &mut dyn Fields) {
    fields.header(None);
    fields.put("height", 0_u32);
    fields.put("width", 0_u32);
    fields.list("fields", "sensor_msgs/PointField", 1, &mut |_, fields| {
        for (name, value) in DATATYPES {
            fields.constant("uint8", name, value.into());
        }
        fields.put("name", "");
        fields.put("offset", 0_u32);
        fields.put("datatype", 0_u8);
        fields.put("count", 0_u32);
    });
    fields.put("is_bigendian", false);
    fields.put("point_step", 0_u32);
    fields.put("row_step", 0_u32);
    fields.put("data", &[0_u8; 0][..]);
    fields.put("is_dense", false);
}

/// Our own message: the data that ROS's messages leave out.
pub(super) const FRAME: MessageType = MessageType {
    name: "belvedere/Frame",
    definition: Definition::Text(
        "# A frame as it was in shared memory; the layout of its header and payload is Belvedere's wire format.\n\
         uint8[] header\n\
         # If payload is empty although the header states a length: the payload is part of the previous message, on\n\
         # the stream's own topic, starting at this byte.\n\
         uint64 payload_offset\n\
         uint8[] payload",
    ),
};
