//! [`SendOrder`]: sorts frames from different threads by the order in which they were sent.

use belvedere_bridge::{FrameHeader, clock};
use std::collections::BTreeMap;

/// A frame with the number of its stream.
type Taken = (usize, Box<FrameHeader>, Vec<u8>);

/// Frames that wait until all frames sent before them have arrived.
#[derive(Default)]
pub(super) struct SendOrder {
    /// Ordered by send time, then by arrival.
    frames: BTreeMap<(u64, u64), Taken>,
    arrived: u64,
}

impl SendOrder {
    /// Adds a frame of a stream.
    pub(super) fn add(&mut self, number: usize, header: Box<FrameHeader>, payload: Vec<u8>) {
        self.arrived += 1;
        // A send time in the future would hold the frame, and its memory, for ever.
        let sent = header.publish_mono_ns.min(clock::mono_ns());
        self.frames.insert((sent, self.arrived), (number, header, payload));
    }

    /// Takes the first of the frames that were sent before this time.
    pub(super) fn next_sent_before(&mut self, mono_ns: u64) -> Option<Taken> {
        let first = self.frames.first_entry()?;
        (first.key().0 < mono_ns).then(|| first.remove())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_bridge::{Encoding, Kind};

    #[test]
    fn frames_come_in_send_order_and_a_wrong_time_holds_none_back() {
        let mut order = SendOrder::default();
        let now = clock::mono_ns();
        for (number, sent) in
            [(0, now - 10), (1, now - 30), (2, u64::MAX), (3, now - 20), (4, now - 20), (5, 0)]
        {
            let mut header = Box::new(FrameHeader::new(Kind::Clock, Encoding::Struct));
            header.publish_mono_ns = sent;
            order.add(number, header, Vec::new());
        }
        let mut take = |before| {
            std::iter::from_fn(|| order.next_sent_before(before)).map(|frame| frame.0).collect::<Vec<_>>()
        };
        assert_eq!(take(now - 15), [5, 1, 3, 4]);
        assert_eq!(take(clock::mono_ns() + 1), [0, 2]);
    }
}
