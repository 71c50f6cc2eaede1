//! Pixel formats.

use super::{Mosaic, Planes};

/// The layout of a colour pixel in memory. 16-bit values are little-endian; their full scale is 65535, or the greatest
/// number of the converter if there is a [device](crate::device).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PixelFormat {
    /// Red, green, blue.
    Rgb8,
    /// Blue, green, red.
    Bgr8,
    /// Brightness: 0.299 R + 0.587 G + 0.114 B (ITU-R BT.601).
    Mono8,
    /// Red, green, blue, and an alpha of 255 (opaque).
    Rgba8,
    /// Brightness in 16 bits, little-endian.
    Mono16,
    /// One colour per pixel, in a Bayer mosaic.
    Bayer8(Mosaic),
    /// One colour per pixel, in a Bayer mosaic, in 16 bits.
    Bayer16(Mosaic),
}

impl PixelFormat {
    /// Number of bytes of a pixel.
    pub const fn bytes(self) -> usize {
        match self {
            Self::Rgba8 => 4,
            Self::Rgb8 | Self::Bgr8 => 3,
            Self::Mono16 | Self::Bayer16(_) => 2,
            Self::Mono8 | Self::Bayer8(_) => 1,
        }
    }

    /// The sensor pixels behind each pixel of the image.
    pub(crate) const fn planes(self) -> Planes {
        match self {
            Self::Rgb8 | Self::Bgr8 | Self::Rgba8 => Planes::Colours,
            Self::Mono8 | Self::Mono16 => Planes::Brightness,
            Self::Bayer8(mosaic) | Self::Bayer16(mosaic) => Planes::Mosaic(mosaic),
        }
    }
}
