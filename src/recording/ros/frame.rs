//! Our own message, `belvedere/Frame`: the data of a frame that ROS's messages leave out.

use super::Payload;
use belvedere_bridge::{FrameHeader, Ros, RosBytes};

/// Writes a complete frame to `out`, replacing its contents, without the payload if the previous message contains it.
pub fn write_frame(ros: Ros, header: &FrameHeader, payload: &[u8], within: Payload, out: &mut Vec<u8>) {
    out.clear();
    let mut bytes = RosBytes::begin(ros, out);
    bytes.bytes(bytemuck::bytes_of(header));
    let (offset, payload) = match within {
        Payload::Within(offset) => (offset, &[][..]),
        Payload::Elsewhere => (0, payload),
    };
    bytes.u64(offset as u64);
    bytes.bytes(payload);
}

/// Returns header, offset and payload of a message written by [`write_frame`], or `None` if it is not one.
pub fn read_frame(ros: Ros, message: &[u8]) -> Option<(FrameHeader, u64, &[u8])> {
    const HEADER: usize = size_of::<FrameHeader>();
    // Little-endian CDR, and the bytes that align the offset.
    let (message, gap) = match ros {
        Ros::One => (message, 0),
        Ros::Two => (message.strip_prefix(&[0, 1])?.get(2..)?, 4),
    };
    let (count, rest) = message.split_first_chunk::<4>()?;
    if u32::from_le_bytes(*count) as usize != HEADER || rest.len() < HEADER {
        return None;
    }
    let (header, rest) = rest.split_at(HEADER);
    let (offset, rest) = rest.get(gap..)?.split_first_chunk::<8>()?;
    let (count, payload) = rest.split_first_chunk::<4>()?;
    (u32::from_le_bytes(*count) as usize == payload.len())
        .then(|| (bytemuck::pod_read_unaligned(header), u64::from_le_bytes(*offset), payload))
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_bridge::{Encoding, Kind};

    #[test]
    fn a_frame_is_read_back_in_both_encodings() {
        let header = FrameHeader::new(Kind::Image, Encoding::Mono8);
        let mut out = Vec::new();
        for ros in [Ros::One, Ros::Two] {
            for (within, offset, payload) in
                [(Payload::Elsewhere, 0, &[1, 2, 3][..]), (Payload::Within(70), 70, &[])]
            {
                write_frame(ros, &header, &[1, 2, 3], within, &mut out);
                let (read, at, rest) = read_frame(ros, &out).unwrap();
                assert_eq!(bytemuck::bytes_of(&read), bytemuck::bytes_of(&header));
                assert_eq!((at, rest), (offset, payload));
                for len in 0..out.len() {
                    assert!(read_frame(ros, &out[..len]).is_none(), "{ros:?}, {len} bytes");
                }
            }
        }
        assert!(read_frame(Ros::One, &out).is_none());
    }
}
