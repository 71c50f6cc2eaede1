//! Encoding of colours into bytes, with the noise of a camera.

use crate::noise::GaussianNoise;
use crate::shade::Colours;
use crate::simd::{LANES, Lanes};
use crate::trace::tile::{TILE_HEIGHT, TILE_WIDTH};

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

/// Adds to each lane's colour its noise, the same to all three channels. What leaves [0, 1] is clamped when it
/// becomes a byte, as Gazebo does.
#[inline(always)]
pub(crate) fn add_noise(colours: &mut Colours, noise: &GaussianNoise, bias: f32, normals: &Lanes<f32>) {
    for channel in colours {
        for lane in 0..LANES {
            channel[lane] = noise.apply(channel[lane], bias, normals[lane]);
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
    colours: &Colours,
    format: PixelFormat,
    column: usize,
    rows: &mut [u8],
    row_stride: usize,
) {
    let mut bytes = [[0; LANES]; 3];
    let [red, green, blue] = colours;
    for lane in 0..LANES {
        let grey = 0.299 * red[lane] + 0.587 * green[lane] + 0.114 * blue[lane];
        let (first, last) = match format {
            PixelFormat::Rgb8 => (red[lane], blue[lane]),
            PixelFormat::Bgr8 => (blue[lane], red[lane]),
            PixelFormat::Mono8 => (grey, grey),
        };
        bytes[0][lane] = to_byte(first);
        bytes[1][lane] = to_byte(green[lane]);
        bytes[2][lane] = to_byte(last);
    }
    for (y, row) in rows.chunks_mut(row_stride).take(TILE_HEIGHT).enumerate() {
        let row = &mut row[column * format.bytes()..];
        let lanes = y * TILE_WIDTH..(y + 1) * TILE_WIDTH;
        if format == PixelFormat::Mono8 {
            for (pixel, byte) in row.iter_mut().zip(&bytes[0][lanes]) {
                *pixel = *byte;
            }
        } else {
            for (pixel, lane) in row.as_chunks_mut::<3>().0.iter_mut().zip(lanes) {
                *pixel = [bytes[0][lane], bytes[1][lane], bytes[2][lane]];
            }
        }
    }
}
