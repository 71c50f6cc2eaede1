//! Converts streams to the ROS 1 messages that the ROS node publishes for them.

mod bytes;
mod encode;
mod types;

use belvedere_bridge::{FrameHeader, FrameView, Kind, Ros1Message};
use bytes::Bytes;
pub use types::MessageType;

/// The ROS topic of a stream.
#[derive(Debug, Clone)]
pub struct RosStream {
    /// With a leading slash. Transforms, the clock and states of models always have ROS's own topic, regardless of the
    /// stream's namespace.
    pub topic: String,
    /// The type of its messages.
    pub message_type: MessageType,
    encode: Encode,
}

/// How a message is written.
#[derive(Debug, Clone, Copy)]
enum Encode {
    Elements(encode::Encode),
    Struct(Ros1Message),
}

impl RosStream {
    /// Returns the ROS topic for a stream of this kind and topic (without a leading slash), or `None` if ROS has no
    /// message for it.
    pub fn new(kind: Kind, topic: &str, layers: Option<u32>) -> Option<Self> {
        let elements: Option<(MessageType, encode::Encode)> = match kind {
            Kind::Image | Kind::DepthImage => Some((types::IMAGE, encode::image)),
            Kind::LaserScan if layers.unwrap_or(1) > 1 => Some((types::POINT_CLOUD, encode::scan_cloud)),
            Kind::LaserScan => Some((types::LASER_SCAN, encode::laser_scan)),
            Kind::PointCloud => Some((types::POINT_CLOUD, encode::point_cloud)),
            _ => None,
        };
        let (message_type, encode) = if let Some((message_type, encode)) = elements {
            (message_type, Encode::Elements(encode))
        } else {
            let message = Ros1Message::of(kind, topic)?;
            (message.into(), Encode::Struct(message))
        };
        let topic = match kind {
            Kind::Transforms => "/tf".to_owned(),
            Kind::StaticTransforms => "/tf_static".to_owned(),
            Kind::Clock => "/clock".to_owned(),
            Kind::ModelStates => format!("/gazebo/{}", topic.rsplit('/').next().unwrap_or(topic)),
            _ => format!("/{topic}"),
        };
        Some(Self { topic, message_type, encode })
    }

    /// Writes a frame's message to `out`, replacing its contents, and returns the place of the payload in it if the
    /// message contains all of it unchanged. Returns `None` if the message cannot represent the frame.
    pub fn write(&self, frame: &FrameView<'_>, out: &mut Vec<u8>) -> Option<Payload> {
        out.clear();
        match self.encode {
            Encode::Elements(encode) => encode(frame, &mut Bytes(out)),
            Encode::Struct(message) => message.write(frame, out).map(|()| Payload::Elsewhere),
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

/// Writes a complete frame to `out`, replacing its contents, without the payload if the previous message contains it.
pub fn write_frame(header: &FrameHeader, payload: &[u8], within: Payload, out: &mut Vec<u8>) {
    out.clear();
    let mut bytes = Bytes(out);
    bytes.bytes(bytemuck::bytes_of(header));
    match within {
        Payload::Within(offset) => {
            bytes.u64(offset as u64);
            bytes.bytes(&[]);
        }
        Payload::Elsewhere => {
            bytes.u64(0);
            bytes.bytes(payload);
        }
    }
}

/// Returns header, offset and payload of a message written by [`write_frame`], or `None` if it is not one.
pub fn read_frame(message: &[u8]) -> Option<(FrameHeader, u64, &[u8])> {
    const HEADER: usize = size_of::<FrameHeader>();
    let (count, rest) = message.split_first_chunk::<4>()?;
    if u32::from_le_bytes(*count) as usize != HEADER || rest.len() < HEADER {
        return None;
    }
    let (header, rest) = rest.split_at(HEADER);
    let (offset, rest) = rest.split_first_chunk::<8>()?;
    let (count, payload) = rest.split_first_chunk::<4>()?;
    (u32::from_le_bytes(*count) as usize == payload.len())
        .then(|| (bytemuck::pod_read_unaligned(header), u64::from_le_bytes(*offset), payload))
}
