//! Where the frames of streams go: shared memory, or the memory of a caller.

#[cfg(feature = "server")]
use belvedere_bridge::LoanedFrame;
use belvedere_bridge::payload::Message;
use belvedere_bridge::{Consumer, Error, FrameHeader, FrameView, StreamSpec};
use bytemuck::{Pod, Zeroable};

/// What streams are opened at.
pub trait Sink {
    /// Opens a stream.
    ///
    /// # Errors
    /// When there can be no such stream: its topic is no name, or somebody else's.
    fn open(&self, spec: &StreamSpec) -> Result<Box<dyn Port>, Error>;
}

/// The end of a stream that frames are handed to.
pub trait Port {
    /// Whether somebody wants the next frame, so that it has to be made.
    fn is_wanted(&self) -> bool;

    /// Whether messages are taken that nobody wants now: for those who come later.
    fn keeps_messages(&self) -> bool;

    /// Memory for the next frame of `len` bytes, with the stream's header before it.
    ///
    /// # Errors
    /// When there is none.
    fn loan(&self, len: usize) -> Result<Frame, Error>;

    /// Takes a frame that was loaned here.
    ///
    /// # Errors
    /// When it does not go out.
    fn send(&self, frame: Frame) -> Result<(), Error>;

    /// Gives the last frame to those who have come since.
    ///
    /// # Errors
    /// When it does not go out.
    fn update(&self) -> Result<(), Error> {
        Ok(())
    }

    /// How many follow the stream.
    fn subscribers(&self) -> usize {
        0
    }

    /// Who follows the stream.
    fn consumers(&self) -> Vec<Consumer> {
        Vec::new()
    }

    /// Frames that were taken and could not go out later.
    fn failed(&self) -> u64 {
        0
    }
}

/// A frame to be filled.
#[derive(Debug)]
pub enum Frame {
    /// In shared memory.
    #[cfg(feature = "server")]
    Shared(LoanedFrame),
    /// In a caller's memory.
    Owned(Box<FrameBuf>),
}

impl Frame {
    /// What the payload is.
    pub fn header(&self) -> &FrameHeader {
        match self {
            #[cfg(feature = "server")]
            Self::Shared(frame) => frame.header(),
            Self::Owned(frame) => &frame.header,
        }
    }

    /// The same, to be filled in.
    pub fn header_mut(&mut self) -> &mut FrameHeader {
        match self {
            #[cfg(feature = "server")]
            Self::Shared(frame) => frame.header_mut(),
            Self::Owned(frame) => &mut frame.header,
        }
    }

    /// The data.
    pub fn payload(&self) -> &[u8] {
        match self {
            #[cfg(feature = "server")]
            Self::Shared(frame) => frame.payload(),
            Self::Owned(frame) => frame.payload(),
        }
    }

    /// The same, to be written: all of it, aligned to 64 bytes.
    pub fn payload_mut(&mut self) -> &mut [u8] {
        match self {
            #[cfg(feature = "server")]
            Self::Shared(frame) => frame.payload_mut(),
            Self::Owned(frame) => frame.payload_mut(),
        }
    }

    /// Writes structs into it, one a row, and says so in the header.
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

/// A frame in memory of one's own, which is used again for the next one.
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

/// 64 bytes: payloads are read as numbers of every size, and by SIMD.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
struct Line([u8; 64]);

impl FrameBuf {
    /// What the payload is: its kind, stamp, size, and where the sensor was.
    pub fn header(&self) -> &FrameHeader {
        &self.header
    }

    /// The data.
    pub fn payload(&self) -> &[u8] {
        &bytemuck::cast_slice(&self.lines)[..self.len]
    }

    /// Header and payload, to look at by rows or structs.
    ///
    /// # Panics
    /// Never: what is rendered is as its header says.
    pub fn view(&self) -> FrameView<'_> {
        FrameView::new(&self.header, self.payload()).expect("a frame is as its header says")
    }

    /// Another frame of `len` bytes: zeros, or what was there before.
    pub(crate) fn reset(&mut self, header: &FrameHeader, len: usize) {
        self.lines.resize(len.div_ceil(size_of::<Line>()), Line::zeroed());
        (self.header, self.len) = (*header, len);
        self.header.payload_len = len as u64;
    }

    fn payload_mut(&mut self) -> &mut [u8] {
        &mut bytemuck::cast_slice_mut(&mut self.lines)[..self.len]
    }
}
