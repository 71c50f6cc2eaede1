//! Encoding of colours into bytes, with the noise of a camera.

use crate::noise::GaussianNoise;
use crate::scene::tree::WIDTH;
use crate::shade::Colours;
use crate::simd::{LANES, Lanes};
use crate::trace::tile::{TILE_HEIGHT, TILE_WIDTH};
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16, u32x16};

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

/// Light times a factor; clamped, where it is too much, when it becomes a byte.
#[inline(always)]
pub(crate) fn expose(colours: &mut Colours, exposure: f32) {
    for channel in colours {
        for value in channel {
            *value *= exposure;
        }
    }
}

/// Adds to each lane's colour its noise, the same to all three channels. What leaves [0, 1] is clamped when it
/// becomes a byte, as Gazebo does.
#[inline(always)]
pub(crate) fn add_noise(colours: &mut Colours, noise: &GaussianNoise, bias: f32, normals: &Lanes<f32>) {
    for channel in colours {
        noise.apply_all(channel, bias, normals);
    }
}

/// Value in [0, 1] to the nearest byte; what lies outside is clamped.
#[inline(always)]
pub(crate) fn to_byte(value: f32) -> u8 {
    // `as` saturates and makes NaN 0.
    (value * 255.0 + 0.5) as u8
}

/// [`to_byte`] of sixteen values.
#[inline(always)]
fn to_byte_each<S: Simd>(simd: S, values: f32x16<S>) -> u32x16<S> {
    let scaled = values * 255.0 + 0.5;
    // NaN is not greater than 0 and becomes it.
    let zero = f32x16::splat(simd, 0.0);
    let scaled = scaled.simd_gt(zero).select(scaled, zero);
    let most = f32x16::splat(simd, 255.0);
    scaled.simd_lt(most).select(scaled, most).to_int()
}

/// Three channels, the first in the lowest byte.
#[inline(always)]
pub(crate) fn to_bytes<S: Simd>(simd: S, first: f32x16<S>, second: f32x16<S>, third: f32x16<S>) -> u32x16<S> {
    let [first, second, third] =
        [to_byte_each(simd, first), to_byte_each(simd, second), to_byte_each(simd, third)];
    first | (second << 8) | (third << 16)
}

/// Bytes of the largest pixel.
const MOST_BYTES: usize = 3;

/// Writes some lanes of a tile's colours, a bit each, as [`write_tile`] writes all.
#[inline(always)]
pub(crate) fn write_lanes<S: Simd>(
    simd: S,
    (colours, lanes): (&Colours, u64),
    format: PixelFormat,
    column: usize,
    rows: &mut [u8],
    row_stride: usize,
) {
    let (bytes, mut tile) = (format.bytes(), [0; LANES * MOST_BYTES]);
    write_tile(simd, colours, format, 0, &mut tile[..LANES * bytes], TILE_WIDTH * bytes);
    let mut rest = lanes;
    while rest != 0 {
        let lane = rest.trailing_zeros() as usize % LANES;
        rest &= rest - 1;
        let place = lane / TILE_WIDTH * row_stride + (column + lane % TILE_WIDTH) * bytes;
        rows[place..place + bytes].copy_from_slice(&tile[lane * bytes..(lane + 1) * bytes]);
    }
}

/// Writes a tile's colours into the rows of a picture, from pixel column `column` on.
#[inline(always)]
pub(crate) fn write_tile<S: Simd>(
    simd: S,
    colours: &Colours,
    format: PixelFormat,
    column: usize,
    rows: &mut [u8],
    row_stride: usize,
) {
    let [red, green, blue] = colours;
    // Each pixel's bytes, the first lowest.
    let mut packed = [0_u32; LANES];
    for first in (0..LANES).step_by(WIDTH) {
        let sixteen = |channel: &Lanes<f32>| {
            let mut values = [0.0; WIDTH];
            values.copy_from_slice(&channel[first..first + WIDTH]);
            f32x16::load_array(simd, values)
        };
        let (red, green, blue) = (sixteen(red), sixteen(green), sixteen(blue));
        let bytes = match format {
            PixelFormat::Rgb8 => to_bytes(simd, red, green, blue),
            PixelFormat::Bgr8 => to_bytes(simd, blue, green, red),
            PixelFormat::Mono8 => to_byte_each(simd, red * 0.299 + green * 0.587 + blue * 0.114),
        };
        let mut values = [0; WIDTH];
        bytes.store_array(&mut values);
        packed[first..first + WIDTH].copy_from_slice(&values);
    }
    for (y, row) in rows.chunks_mut(row_stride).take(TILE_HEIGHT).enumerate() {
        let row = &mut row[column * format.bytes()..];
        let lanes = y * TILE_WIDTH..(y + 1) * TILE_WIDTH;
        if format == PixelFormat::Mono8 {
            for (pixel, packed) in row.iter_mut().zip(&packed[lanes]) {
                *pixel = *packed as u8;
            }
        } else {
            write_pixels(&packed[lanes], row);
        }
    }
}

/// Pixels of three bytes, four at a time in three words.
#[inline(always)]
fn write_pixels(packed: &[u32], row: &mut [u8]) {
    let (fours, rest) = row.as_chunks_mut::<12>();
    let written = fours.len().min(packed.len() / 4);
    for (bytes, [a, b, c, d]) in fours.iter_mut().zip(packed.as_chunks::<4>().0) {
        let words = [a | b << 24, b >> 8 | c << 16, c >> 16 | d << 8];
        for (bytes, word) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(words) {
            *bytes = word.to_le_bytes();
        }
    }
    // The last ones of a row whose length is no multiple of four.
    for (pixel, packed) in rest.as_chunks_mut::<3>().0.iter_mut().zip(&packed[4 * written..]) {
        let [first, second, third, _] = packed.to_le_bytes();
        *pixel = [first, second, third];
    }
}
