//! Converts streams to messages of ROS 1, as the node for ROS 1 publishes them, and of ROS 2.

mod detections;
mod encode;
mod frame;
mod qos;
mod types;

use belvedere_bridge::{FrameView, Kind, Ros, RosBytes, RosMessage};
pub use frame::{read_frame, write_frame};
pub(super) use qos::{OLD_METADATA, offered_qos_profiles};
pub use types::MessageType;

/// The ROS topic of a stream.
#[derive(Debug, Clone)]
pub struct RosStream {
    /// With a leading slash. Transforms, the clock and states of models always have ROS's own topic, regardless of the
    /// stream's namespace.
    pub topic: String,
    /// The type of its messages.
    pub message_type: MessageType,
    ros: Ros,
    encode: Encode,
}

/// How a message is written.
#[derive(Debug, Clone, Copy)]
enum Encode {
    Elements(encode::Encode),
    Struct(RosMessage),
}

impl RosStream {
    /// Returns the topic of ROS 1 or ROS 2 for a stream of this kind and topic (without a leading slash), or `None` if
    /// ROS has no message for it.
    pub fn new(ros: Ros, kind: Kind, topic: &str, layers: Option<u32>) -> Option<Self> {
        let elements: Option<(MessageType, encode::Encode)> = match kind {
            Kind::Image | Kind::DepthImage => Some((types::IMAGE, encode::image)),
            Kind::LaserScan if layers.unwrap_or(1) > 1 => Some((types::POINT_CLOUD, encode::scan_cloud)),
            Kind::LaserScan => Some((types::LASER_SCAN, encode::laser_scan)),
            Kind::PointCloud => Some((types::POINT_CLOUD, encode::point_cloud)),
            Kind::BoundingBoxes if ros == Ros::Two => Some((detections::DETECTIONS, detections::detections)),
            _ => None,
        };
        let (message_type, encode) = if let Some((message_type, encode)) = elements {
            (message_type, Encode::Elements(encode))
        } else {
            let message = RosMessage::of(kind, topic)?;
            (message.into(), Encode::Struct(message))
        };
        let topic = match kind {
            Kind::Transforms => "/tf".to_owned(),
            Kind::StaticTransforms => "/tf_static".to_owned(),
            Kind::Clock => "/clock".to_owned(),
            Kind::ModelStates => format!("/gazebo/{}", topic.rsplit('/').next().unwrap_or(topic)),
            _ => format!("/{topic}"),
        };
        Some(Self { topic, message_type, ros, encode })
    }

    /// Writes a frame's message to `out`, replacing its contents, and returns the place of the payload in it if the
    /// message contains all of it unchanged. Returns `None` if the message cannot represent the frame.
    pub fn write(&self, frame: &FrameView<'_>, out: &mut Vec<u8>) -> Option<Payload> {
        out.clear();
        match self.encode {
            Encode::Elements(encode) => {
                let mut bytes = RosBytes::begin(self.ros, out);
                let payload = encode(frame, &mut bytes)?;
                bytes.end().map(|()| payload)
            }
            Encode::Struct(message) => message.write(self.ros, frame, out).map(|()| Payload::Elsewhere),
        }
    }
}

/// The place of a frame's payload relative to its message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Payload {
    /// The message contains all of it, starting at this byte.
    Within(usize),
    /// The message does not contain it byte by byte.
    Elsewhere,
}

/// Returns the type of the message that [`write_frame`] writes.
pub fn frame_type() -> MessageType {
    types::FRAME
}
