//! [`Frame`]: a frame where it lies, checked before it is believed.

use std::{fmt, sync::Arc};

use crate::{FrameError, FrameHeader, FrameView, Node, clock, domain::Ipc, own::Own, payload::Message};

/// The end of a stream that samples come through.
pub(crate) type FramePort = iceoryx2::port::subscriber::Subscriber<Ipc, [u8], FrameHeader>;
pub(crate) type Sample = iceoryx2::sample::Sample<Ipc, [u8], FrameHeader>;

/// A copy of a sample's header that a reader of its payload may believe.
pub(crate) fn checked_header(sample: &Sample) -> Result<FrameHeader, FrameError> {
    let header = *sample.user_header();
    // Whoever prints it in C reads up to a NUL.
    let header = FrameHeader { frame_id: header.frame_id.terminated(), ..header };
    header.check(sample.payload().len())?;
    Ok(header)
}

/// A received frame: shared memory that stays as it is until this is dropped.
///
/// Its header has passed [`FrameHeader::check`], so that rows and structs lie within the payload.
pub struct Frame {
    /// A copy, since what was checked must not change: the original is the publisher's to write.
    header: FrameHeader,
    // Before port and node: fields are dropped in this order.
    sample: Own<Sample>,
    /// When a port closes, iceoryx2's publisher takes back all that went through it and writes into it again, held or
    /// not. So a port stays open as long as any of its frames.
    _port: Arc<Own<FramePort>>,
    missed: u64,
    restarted: bool,
    from_history: bool,
    _node: Node,
}

impl Frame {
    /// `header` is [`checked_header`] of the sample.
    pub(crate) fn new(
        sample: Sample,
        header: &FrameHeader,
        port: Arc<Own<FramePort>>,
        missed: u64,
        restarted: bool,
        connected_mono_ns: u64,
        node: Node,
    ) -> Self {
        let from_history = header.publish_mono_ns < connected_mono_ns;
        Self {
            header: *header,
            sample: Own::new(sample),
            _port: port,
            missed,
            restarted,
            from_history,
            _node: node,
        }
    }

    /// What the payload is.
    #[must_use]
    pub fn header(&self) -> &FrameHeader {
        &self.header
    }

    /// The data, where the publisher wrote them; aligned to 64 bytes.
    #[must_use]
    pub fn payload(&self) -> &[u8] {
        let payload = self.sample.payload();
        &payload[..payload.len().min(self.header().payload_len as usize)]
    }

    /// How many frames were sent between the last one taken and this one.
    #[must_use]
    pub fn missed(&self) -> u64 {
        self.missed
    }

    /// Whether this comes from another publisher life than the frame before: the simulator was started again.
    #[must_use]
    pub fn restarted(&self) -> bool {
        self.restarted
    }

    /// Whether it was sent before this subscriber was connected, and kept for it: its age says nothing about the
    /// way that it took.
    #[must_use]
    pub fn is_from_history(&self) -> bool {
        self.from_history
    }

    /// Nanoseconds since it was sent.
    #[must_use]
    pub fn age_ns(&self) -> u64 {
        clock::mono_ns().saturating_sub(self.header().publish_mono_ns)
    }

    /// Header and payload, to look at by rows or structs.
    #[must_use]
    pub fn view(&self) -> FrameView<'_> {
        FrameView { header: self.header(), payload: self.payload() }
    }

    /// The first struct, for kinds that have one.
    ///
    /// # Errors
    /// As [`FrameView::structs`], and when there is none.
    pub fn message<T: Message>(&self) -> Result<T, FrameError> {
        self.view().message()
    }
}

impl fmt::Debug for Frame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Frame")
            .field("header", self.header())
            .field("missed", &self.missed)
            .field("restarted", &self.restarted)
            .finish_non_exhaustive()
    }
}
