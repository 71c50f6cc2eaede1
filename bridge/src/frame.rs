//! [`Frame`]: a frame where it lies, checked before it is believed.

use std::fmt;

use bytemuck::Pod;

use crate::{Encoding, FrameError, FrameHeader, Kind, Node, clock, node::Ipc, payload::Message};

pub(crate) type Sample = iceoryx2::sample::Sample<Ipc, [u8], FrameHeader>;

/// A received frame: shared memory that stays as it is until this is dropped.
///
/// Its header has passed [`FrameHeader::check`], so that rows and structs lie within the payload.
pub struct Frame {
    // Before the node: fields are dropped in this order.
    sample: Sample,
    missed: u64,
    restarted: bool,
    _node: Node,
}

impl Frame {
    pub(crate) fn new(sample: Sample, missed: u64, restarted: bool, node: Node) -> Result<Self, FrameError> {
        sample.user_header().check(sample.payload().len())?;
        Ok(Self { sample, missed, restarted, _node: node })
    }

    /// What the payload is.
    #[must_use]
    pub fn header(&self) -> &FrameHeader {
        self.sample.user_header()
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

    /// Nanoseconds since it was sent.
    #[must_use]
    pub fn age_ns(&self) -> u64 {
        clock::mono_ns().saturating_sub(self.header().publish_mono_ns)
    }

    /// Rows from top to bottom: the bytes of `width` elements each, without what pads a row.
    pub fn rows(&self) -> impl Iterator<Item = &[u8]> {
        plane_rows(self.header(), self.payload(), 0)
    }

    /// Rows of the intensities behind the ranges; none without them.
    pub fn intensity_rows(&self) -> impl Iterator<Item = &[u8]> {
        let header = self.header();
        let planes = usize::from(header.has_intensities());
        let offset = header.height as usize * header.row_stride as usize * planes;
        plane_rows(header, self.payload(), offset).take(header.height as usize * planes)
    }

    /// The structs of a stream of [`Encoding::Struct`].
    ///
    /// # Errors
    /// [`FrameError::WrongKind`] when `T` is not what the frame holds.
    pub fn structs<T: Message>(&self) -> Result<impl ExactSizeIterator<Item = T>, FrameError> {
        structs(self.header(), self.payload())
    }

    /// The first struct, for kinds that have one.
    ///
    /// # Errors
    /// As [`structs`](Self::structs), and when there is none.
    pub fn message<T: Message>(&self) -> Result<T, FrameError> {
        self.structs()?
            .next()
            .ok_or(FrameError::WrongKind { kind: self.header().kind, encoding: self.header().encoding })
    }

    /// Elements of a row as numbers: `f32` of depth and ranges, `u16` of depth in millimetres.
    ///
    /// # Errors
    /// [`FrameError::WrongKind`] when the bytes cannot be seen as `T` where they lie.
    pub fn row_as<T: Pod>(&self, row: usize) -> Result<&[T], FrameError> {
        let header = self.header();
        let wrong = FrameError::WrongKind { kind: header.kind, encoding: header.encoding };
        let bytes = self.rows().nth(row).ok_or(wrong)?;
        bytemuck::try_cast_slice(bytes).map_err(|_| wrong)
    }
}

/// Rows of one plane of a checked header and its payload.
pub(crate) fn plane_rows<'a>(
    header: &FrameHeader,
    payload: &'a [u8],
    offset: usize,
) -> impl Iterator<Item = &'a [u8]> + use<'a> {
    let height = if header.width == 0 { 0 } else { header.height as usize };
    let elem_size = elem_size(header);
    let row_len = (header.width as usize).saturating_sub(1) * header.elem_stride as usize + elem_size;
    let row_stride = header.row_stride as usize;
    (0..height).map(move |row| &payload[offset + row * row_stride..][..row_len])
}

pub(crate) fn elem_size(header: &FrameHeader) -> usize {
    match header.encoding() {
        Some(Encoding::Struct) => header.kind().and_then(Kind::struct_size),
        Some(encoding) => encoding.elem_size(),
        None => None,
    }
    .unwrap_or(1)
}

pub(crate) fn structs<'a, T: Message>(
    header: &FrameHeader,
    payload: &'a [u8],
) -> Result<impl ExactSizeIterator<Item = T> + use<'a, T>, FrameError> {
    let holds = header.encoding() == Some(Encoding::Struct)
        && header.kind().and_then(Kind::struct_size) == Some(size_of::<T>());
    if !holds {
        return Err(FrameError::WrongKind { kind: header.kind, encoding: header.encoding });
    }
    let stride = header.row_stride as usize;
    let count = if header.width == 0 { 0 } else { header.height as usize };
    Ok((0..count)
        .map(move |index| bytemuck::pod_read_unaligned(&payload[index * stride..][..size_of::<T>()])))
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
