//! [`FrameError`]: the reasons to reject a frame.

/// The reason why a frame must not be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FrameError {
    /// It does not begin with the magic number.
    #[error("not a Belvedere frame (magic {0:#010x})")]
    Magic(u32),
    /// It has the layout of another version.
    #[error("frame schema {0}, this build reads {schema}; use the same version of Belvedere on both sides", schema = super::SCHEMA)]
    Schema(u16),
    /// Its header has another size.
    #[error("frame header of {0} bytes, expected 384")]
    HeaderLen(u16),
    /// It claims more payload than there is.
    #[error("frame claims {claimed} bytes of payload, but only {available} are available")]
    PayloadLen {
        /// Bytes claimed.
        claimed: u64,
        /// Bytes available.
        available: u64,
    },
    /// Its elements or rows overlap.
    #[error("strides do not fit: width {width}, {elem_stride} bytes per element, {row_stride} per row")]
    Stride {
        /// Elements per row.
        width: u32,
        /// Bytes per element.
        elem_stride: u32,
        /// Bytes per row.
        row_stride: u32,
    },
    /// Its rows reach beyond the payload.
    #[error("geometry needs {needed} bytes, the payload has {payload_len}")]
    Extent {
        /// Bytes that the geometry spans.
        needed: u128,
        /// Bytes of payload.
        payload_len: u64,
    },
    /// It was read as a type that it does not hold.
    #[error("the frame does not hold this type: it is of kind {kind} with encoding {encoding}")]
    WrongKind {
        /// Its kind's number.
        kind: u16,
        /// Its encoding's number.
        encoding: u16,
    },
}
