//! How pixels lie in memory.

use super::{Mosaic, Planes};

/// Layout of a colour pixel in memory. Of 16 bits the low byte comes first; their full scale is 65535, or the largest
/// number of the converter where there is a [device](crate::device).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PixelFormat {
    /// Red, green, blue.
    Rgb8,
    /// Blue, green, red.
    Bgr8,
    /// Brightness: 0.299 R + 0.587 G + 0.114 B (ITU-R BT.601).
    Mono8,
    /// Red, green, blue, and 255: opaque.
    Rgba8,
    /// Brightness in 16 bits.
    Mono16,
    /// The one colour that each pixel sees.
    Bayer8(Mosaic),
    /// The same in 16 bits.
    Bayer16(Mosaic),
}

impl PixelFormat {
    /// Bytes of a pixel.
    pub const fn bytes(self) -> usize {
        match self {
            Self::Rgba8 => 4,
            Self::Rgb8 | Self::Bgr8 => 3,
            Self::Mono16 | Self::Bayer16(_) => 2,
            Self::Mono8 | Self::Bayer8(_) => 1,
        }
    }

    /// The pixels of the sensor behind one of the picture.
    pub(crate) const fn planes(self) -> Planes {
        match self {
            Self::Rgb8 | Self::Bgr8 | Self::Rgba8 => Planes::Colours,
            Self::Mono8 | Self::Mono16 => Planes::Brightness,
            Self::Bayer8(mosaic) | Self::Bayer16(mosaic) => Planes::Mosaic(mosaic),
        }
    }
}
