//! ROS 1 types of images, scans and clouds, and of our own message. Fields and constants are those of the
//! packages in Noetic, so that readers compute the same MD5 sums; comments do not affect the sums.

use belvedere_bridge::Ros1Message;

/// A ROS 1 message type.
#[derive(Debug, Clone, Copy)]
pub struct MessageType {
    /// Name in the form `package/Type`.
    pub name: &'static str,
    definition: Definition,
}

#[derive(Debug, Clone, Copy)]
enum Definition {
    /// The fields of the type itself, and the names and fields of the types that it contains.
    Text(&'static str, &'static [(&'static str, &'static str)]),
    /// The definition of a payload struct.
    Struct(Ros1Message),
}

impl MessageType {
    const fn new(
        name: &'static str,
        fields: &'static str,
        parts: &'static [(&'static str, &'static str)],
    ) -> Self {
        Self { name, definition: Definition::Text(fields, parts) }
    }

    /// Returns the definition followed by those of all contained types, as `ros1msg` requires.
    pub fn definition(&self) -> String {
        match self.definition {
            Definition::Text(fields, parts) => {
                parts.iter().fold(fields.to_owned(), |text, (name, fields)| {
                    format!("{text}\n{}\nMSG: {name}\n{fields}", "=".repeat(80))
                })
            }
            Definition::Struct(message) => message.definition(),
        }
    }
}

impl From<Ros1Message> for MessageType {
    fn from(message: Ros1Message) -> Self {
        Self { name: message.ros.name, definition: Definition::Struct(message) }
    }
}

const HEADER: (&str, &str) = ("std_msgs/Header", "uint32 seq\ntime stamp\nstring frame_id");

pub(super) const IMAGE: MessageType = MessageType::new(
    "sensor_msgs/Image",
    "Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\nuint8[] data",
    &[HEADER],
);

pub(super) const LASER_SCAN: MessageType = MessageType::new(
    "sensor_msgs/LaserScan",
    "Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\nfloat32 time_increment\n\
     float32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\nfloat32[] intensities",
    &[HEADER],
);

pub(super) const POINT_CLOUD: MessageType = MessageType::new(
    "sensor_msgs/PointCloud2",
    "Header header\nuint32 height\nuint32 width\nPointField[] fields\nbool is_bigendian\nuint32 point_step\n\
     uint32 row_step\nuint8[] data\nbool is_dense",
    &[
        HEADER,
        (
            "sensor_msgs/PointField",
            "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\n\
             uint8 FLOAT32=7\nuint8 FLOAT64=8\nstring name\nuint32 offset\nuint8 datatype\nuint32 count",
        ),
    ],
);

/// Our own message: the data that ROS's messages leave out.
pub(super) const FRAME: MessageType = MessageType::new(
    "belvedere/Frame",
    "# A frame as it was in shared memory; the layout of its header and payload is Belvedere's wire format.\n\
     uint8[] header\n\
     # If payload is empty although the header states a length: the payload is part of the previous message, on\n\
     # the stream's own topic, starting at this byte.\n\
     uint64 payload_offset\n\
     uint8[] payload",
    &[],
);
