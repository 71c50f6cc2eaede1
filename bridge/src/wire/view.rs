//! [`FrameView`]: access to a payload by its header.

use bytemuck::Pod;

use super::{Encoding, FrameError, FrameHeader, Kind, fields::Fields, payload::Message};

/// A checked header and its payload, for access to rows and structs in place.
#[derive(Clone, Copy, Debug)]
pub struct FrameView<'a> {
    pub(crate) header: &'a FrameHeader,
    pub(crate) payload: &'a [u8],
}

impl<'a> FrameView<'a> {
    /// Creates a view of `payload`, after checking `header`.
    ///
    /// # Errors
    /// The errors of [`FrameHeader::check`].
    pub fn new(header: &'a FrameHeader, payload: &'a [u8]) -> Result<Self, FrameError> {
        header.check(payload.len())?;
        Ok(Self { header, payload: &payload[..header.payload_len as usize] })
    }

    /// Returns the header.
    #[must_use]
    pub fn header(&self) -> &'a FrameHeader {
        self.header
    }

    /// Returns the payload.
    #[must_use]
    pub fn payload(&self) -> &'a [u8] {
        self.payload
    }

    /// Returns the rows from top to bottom: the bytes of `width` elements each, without row padding.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &'a [u8]> + use<'a> {
        self.plane(0, self.height())
    }

    /// Returns the rows of the intensities that follow the ranges; none if there are no intensities.
    pub fn intensity_rows(&self) -> impl ExactSizeIterator<Item = &'a [u8]> + use<'a> {
        let offset = self.header.height as usize * self.header.row_stride as usize;
        self.plane(offset, if self.header.has_intensities() { self.height() } else { 0 })
    }

    /// Returns a copy of the `T` that each element of `rows` begins with: `f32` for ranges and depth in metres, `u16`
    /// for depth in millimetres.
    pub fn numbers<T: Pod>(&self, rows: impl Iterator<Item = &'a [u8]>) -> impl Iterator<Item = T> {
        let elem_stride = (self.header.elem_stride as usize).max(1);
        rows.flat_map(move |row| row.chunks(elem_stride))
            .filter_map(|element| element.get(..size_of::<T>()).map(bytemuck::pod_read_unaligned))
    }

    /// Returns the structs of a frame of [`Encoding::Struct`].
    ///
    /// # Errors
    /// [`FrameError::WrongKind`] if the frame does not hold `T`.
    pub fn structs<T: Message>(&self) -> Result<impl ExactSizeIterator<Item = T> + use<'a, T>, FrameError> {
        let holds = self.header.encoding() == Some(Encoding::Struct)
            && self.header.kind().is_some_and(|kind| T::KINDS.contains(&kind));
        if !holds {
            return Err(self.wrong_kind());
        }
        Ok(self.rows().map(|row| bytemuck::pod_read_unaligned(&row[..size_of::<T>()])))
    }

    /// Returns the first struct, for kinds that have one.
    ///
    /// # Errors
    /// The errors of [`structs`](Self::structs), and [`FrameError::WrongKind`] if there is none.
    pub fn message<T: Message>(&self) -> Result<T, FrameError> {
        self.structs()?.next().ok_or(self.wrong_kind())
    }

    /// Passes the values of a frame of [`Encoding::Struct`] to `fields`.
    ///
    /// `None` if the frame is of another encoding or of an unknown kind, lacks the struct of its kind, or if the type
    /// of ROS that `fields` writes cannot hold it.
    pub fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        if self.header.encoding() != Some(Encoding::Struct) {
            return None;
        }
        let describe = self.header.kind()?.layout()?.describe?;
        describe(&mut self.rows(), fields)
    }

    fn wrong_kind(&self) -> FrameError {
        FrameError::WrongKind { kind: self.header.kind, encoding: self.header.encoding }
    }

    fn height(&self) -> usize {
        if self.header.width == 0 { 0 } else { self.header.height as usize }
    }

    fn plane(&self, offset: usize, rows: usize) -> impl ExactSizeIterator<Item = &'a [u8]> + use<'a> {
        let Self { header, payload } = *self;
        let elem_size = match header.encoding() {
            Some(Encoding::Struct) => header.kind().and_then(Kind::struct_size),
            Some(encoding) => encoding.elem_size(),
            None => None,
        }
        .unwrap_or(1);
        let row_len = (header.width as usize).saturating_sub(1) * header.elem_stride as usize + elem_size;
        let row_stride = header.row_stride as usize;
        (0..rows).map(move |row| &payload[offset + row * row_stride..][..row_len])
    }
}
