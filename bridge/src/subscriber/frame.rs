//! [`Frame`]: a received frame in shared memory, with a checked header.

use std::{fmt, sync::Arc};

use crate::{FrameError, FrameHeader, FrameView, Node, clock, domain::Ipc, own::Own, payload::Message};

/// The port that receives samples.
pub(crate) type FramePort = iceoryx2::port::subscriber::Subscriber<Ipc, [u8], FrameHeader>;
pub(crate) type Sample = iceoryx2::sample::Sample<Ipc, [u8], FrameHeader>;

/// Returns a checked copy of a sample's header.
pub(crate) fn checked_header(sample: &Sample) -> Result<FrameHeader, FrameError> {
    let header = *sample.user_header();
    // C programs print the text up to a NUL.
    let header = FrameHeader { frame_id: header.frame_id.terminated(), ..header };
    header.check(sample.payload().len())?;
    Ok(header)
}

/// A received frame: shared memory that does not change until this is dropped.
///
/// Its header has passed [`FrameHeader::check`], so that rows and structs lie within the payload.
pub struct Frame {
    /// A copy, since the publisher could still change the original after the check.
    header: FrameHeader,
    // Dropped before port and node: fields are dropped in this order.
    sample: Own<Sample>,
    /// When a port closes, iceoryx2's publisher reuses all samples that were sent through it, even those still held. So
    /// a port stays open as long as any of its frames.
    _port: Arc<Own<FramePort>>,
    missed: u64,
    restarted: bool,
    from_history: bool,
    _node: Node,
}

impl Frame {
    /// Creates a frame; `header` is the [`checked_header`] of `sample`.
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

    /// Returns the header.
    #[must_use]
    pub fn header(&self) -> &FrameHeader {
        &self.header
    }

    /// Returns the data in place, aligned to 64 bytes.
    #[must_use]
    pub fn payload(&self) -> &[u8] {
        let payload = self.sample.payload();
        &payload[..payload.len().min(self.header().payload_len as usize)]
    }

    /// Returns the number of frames that were sent between the previously taken frame and this one.
    #[must_use]
    pub fn missed(&self) -> u64 {
        self.missed
    }

    /// Returns true if this frame comes from another life of the publisher than the previous one: the simulator was
    /// restarted.
    #[must_use]
    pub fn restarted(&self) -> bool {
        self.restarted
    }

    /// Returns true if this frame was sent before this subscriber connected, and was kept for it. Its age then does not
    /// show the latency.
    #[must_use]
    pub fn is_from_history(&self) -> bool {
        self.from_history
    }

    /// Returns the nanoseconds since the frame was sent.
    #[must_use]
    pub fn age_ns(&self) -> u64 {
        clock::mono_ns().saturating_sub(self.header().publish_mono_ns)
    }

    /// Returns a view of header and payload, with access to rows and structs.
    #[must_use]
    pub fn view(&self) -> FrameView<'_> {
        FrameView { header: self.header(), payload: self.payload() }
    }

    /// Returns the first struct, for kinds that have one.
    ///
    /// # Errors
    /// The errors of [`FrameView::message`].
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
