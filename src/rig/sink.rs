//! [`Sink`]: the destination of streams, which is shared memory or a caller's memory.

#[cfg(feature = "server")]
use belvedere_bridge::LoanedFrame;
use belvedere_bridge::payload::Message;
use belvedere_bridge::{Consumer, Error, FrameHeader, FrameView, StreamSpec};
use bytemuck::{Pod, Zeroable};

/// The destination at which streams are opened.
pub trait Sink {
    /// Opens a stream.
    ///
    /// # Errors
    /// If the stream is not possible, because its topic is invalid or taken.
    fn open(&self, spec: &StreamSpec) -> Result<Box<dyn Port>, Error>;
}

/// The end of a stream that accepts frames.
pub trait Port {
    /// Returns true if the next frame has to be made.
    fn is_wanted(&self) -> bool;

    /// Returns true if messages are accepted without subscribers, for later subscribers.
    fn keeps_messages(&self) -> bool;

    /// Returns memory for the next frame of `len` bytes, with the stream's header.
    ///
    /// # Errors
    /// If there is none.
    fn loan(&self, len: usize) -> Result<Frame, Error>;

    /// Sends a frame that was loaned here.
    ///
    /// # Errors
    /// If it cannot be sent.
    fn send(&self, frame: Frame) -> Result<(), Error>;

    /// Sends the last frame to new subscribers.
    ///
    /// # Errors
    /// If it cannot be sent.
    fn update(&self) -> Result<(), Error> {
        Ok(())
    }

    /// Returns the number of subscribers.
    fn subscribers(&self) -> usize {
        0
    }

    /// Returns the consumers of the stream.
    fn consumers(&self) -> Vec<Consumer> {
        Vec::new()
    }

    /// Returns the number of frames that were accepted but could not be sent later.
    fn failed(&self) -> u64 {
        0
    }
}

/// A frame that is to be filled.
#[derive(Debug)]
pub enum Frame {
    /// A frame in shared memory.
    #[cfg(feature = "server")]
    Shared(LoanedFrame),
    /// A frame in the caller's memory.
    Owned(Box<FrameBuf>),
}

impl Frame {
    /// Returns the header, which describes the payload.
    pub fn header(&self) -> &FrameHeader {
        match self {
            #[cfg(feature = "server")]
            Self::Shared(frame) => frame.header(),
            Self::Owned(frame) => &frame.header,
        }
    }

    /// Returns the header, to be filled in.
    pub fn header_mut(&mut self) -> &mut FrameHeader {
        match self {
            #[cfg(feature = "server")]
            Self::Shared(frame) => frame.header_mut(),
            Self::Owned(frame) => &mut frame.header,
        }
    }

    /// Returns the data.
    pub fn payload(&self) -> &[u8] {
        match self {
            #[cfg(feature = "server")]
            Self::Shared(frame) => frame.payload(),
            Self::Owned(frame) => frame.payload(),
        }
    }

    /// Returns the data, all of which must be written, aligned to 64 bytes.
    pub fn payload_mut(&mut self) -> &mut [u8] {
        match self {
            #[cfg(feature = "server")]
            Self::Shared(frame) => frame.payload_mut(),
            Self::Owned(frame) => frame.payload_mut(),
        }
    }

    /// Writes structs, one per row, and describes them in the header.
    pub(super) fn fill<T: Message>(&mut self, stamp_ns: u64, structs: &[T]) {
        self.payload_mut().copy_from_slice(bytemuck::cast_slice(structs));
        let header = self.header_mut();
        header.stamp_ns = stamp_ns;
        header.width = 1;
        header.height = structs.len() as u32;
        header.elem_stride = size_of::<T>() as u32;
        header.row_stride = header.elem_stride;
    }
}

/// A frame in the caller's memory, which is used again for the next frame.
///
/// ```
/// use belvedere::rig::FrameBuf;
/// let frame = FrameBuf::default();
/// assert_eq!((frame.payload().len(), frame.header().height), (0, 0));
/// ```
#[derive(Debug, Clone, Default)]
pub struct FrameBuf {
    header: FrameHeader,
    lines: Vec<Line>,
    len: usize,
}

/// 64 bytes with their alignment, because payloads are read as numbers of every size and by SIMD.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
struct Line([u8; 64]);

impl FrameBuf {
    /// Returns the header, which describes the payload: kind, timestamp, size, and the sensor's pose.
    pub fn header(&self) -> &FrameHeader {
        &self.header
    }

    /// Returns the data.
    pub fn payload(&self) -> &[u8] {
        &bytemuck::cast_slice(&self.lines)[..self.len]
    }

    /// Returns a view of header and payload, by rows or structs.
    ///
    /// # Panics
    /// Never, because rendered frames match their headers.
    pub fn view(&self) -> FrameView<'_> {
        FrameView::new(&self.header, self.payload()).expect("a frame is as its header says")
    }

    /// Prepares the memory for a frame of `len` bytes, which contains zeros or earlier data.
    pub(crate) fn reset(&mut self, header: &FrameHeader, len: usize) {
        self.lines.resize(len.div_ceil(size_of::<Line>()), Line::zeroed());
        (self.header, self.len) = (*header, len);
        self.header.payload_len = len as u64;
    }

    fn payload_mut(&mut self) -> &mut [u8] {
        &mut bytemuck::cast_slice_mut(&mut self.lines)[..self.len]
    }
}
