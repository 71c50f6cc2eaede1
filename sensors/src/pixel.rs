//! Encoding of colours into bytes, with the noise of a camera.

use crate::lens::TILE_WIDTH;
use crate::noise::GaussianNoise;
use crate::simd::Lanes;

/// Layout of a colour pixel in memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PixelFormat {
    /// Red, green, blue.
    Rgb8,
    /// Blue, green, red.
    Bgr8,
    /// Brightness: 0.299 R + 0.587 G + 0.114 B (ITU-R BT.601).
    Mono8,
}

impl PixelFormat {
    /// Bytes of a pixel.
    pub const fn bytes(self) -> usize {
        match self {
            Self::Rgb8 | Self::Bgr8 => 3,
            Self::Mono8 => 1,
        }
    }
}

/// Adds to each lane's colour its noise, the same to all three channels, and clamps to [0, 1], as Gazebo does.
#[inline(always)]
pub(crate) fn add_noise(
    colours: &mut Lanes<[f32; 3]>,
    noise: &GaussianNoise,
    bias: f32,
    normals: &Lanes<f32>,
) {
    for (colour, z) in colours.iter_mut().zip(normals) {
        for channel in colour {
            *channel = noise.apply(*channel, bias, *z);
        }
    }
}

/// Value in [0, 1] to the nearest byte; what lies outside is clamped.
#[inline(always)]
pub(crate) fn to_byte(value: f32) -> u8 {
    // `as` saturates and makes NaN 0.
    (value * 255.0 + 0.5) as u8
}

/// Writes a tile's colours into the rows of a picture, from pixel column `column` on.
#[inline(always)]
pub(crate) fn write_tile(
    colours: &Lanes<[f32; 3]>,
    format: PixelFormat,
    column: usize,
    rows: &mut [u8],
    row_stride: usize,
) {
    for (row, colours) in rows.chunks_mut(row_stride).zip(colours.as_chunks::<TILE_WIDTH>().0) {
        let pixels = row[column * format.bytes()..].chunks_exact_mut(format.bytes());
        for (pixel, &[red, green, blue]) in pixels.zip(colours) {
            match format {
                PixelFormat::Rgb8 => pixel.copy_from_slice(&[to_byte(red), to_byte(green), to_byte(blue)]),
                PixelFormat::Bgr8 => pixel.copy_from_slice(&[to_byte(blue), to_byte(green), to_byte(red)]),
                PixelFormat::Mono8 => pixel[0] = to_byte(0.299 * red + 0.587 * green + 0.114 * blue),
            }
        }
    }
}
