//! Streams as the messages of ROS 1 that the bridge's node publishes of them.

mod bytes;
mod encode;
mod types;

use belvedere_bridge::{FrameHeader, FrameView, Kind, Ros1Message};
use bytes::Bytes;
pub use types::MessageType;

/// What a stream is for ROS.
#[derive(Debug, Clone)]
pub struct RosStream {
    /// With a leading slash. That of transforms, of the clock and of states of models is always ROS's own, whatever
    /// namespace the stream has.
    pub topic: String,
    /// What its messages are.
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
    /// What ROS calls a stream of this kind and topic (without a leading slash); none if it has no message for it.
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

    /// Writes a frame's message over what `out` holds, and gives the place of the payload in it if the message has all
    /// of it as it is. None if ROS's message cannot hold the frame.
    pub fn write(&self, frame: &FrameView<'_>, out: &mut Vec<u8>) -> Option<Payload> {
        out.clear();
        match self.encode {
            Encode::Elements(encode) => encode(frame, &mut Bytes(out)),
            Encode::Struct(message) => message.write(frame, out).map(|()| Payload::Elsewhere),
        }
    }
}

/// What of a frame's payload its message has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Payload {
    /// All of it, from this byte on.
    Within(usize),
    /// Not byte by byte.
    Elsewhere,
}

/// The type of [`write_frame`]'s message.
pub fn frame_type() -> MessageType {
    types::FRAME
}

/// Writes a frame whole over what `out` holds, without the payload if the message before has it.
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

/// The parts of a message of [`write_frame`]: header, offset, payload. None if it is not one.
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
