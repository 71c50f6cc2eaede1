//! Encoding of colours into bytes, with the pixel noise of a camera.

use crate::device::{LUMA, PixelFormat, Planes};
use crate::noise::GaussianNoise;
use crate::shade::Colours;
use crate::simd::{LANES, Lanes, WIDTH};
use crate::srgb;
use crate::trace::grid::tiling::Tiling;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16, u32x16};

/// Applies the sRGB transfer curve to linear light.
#[inline(always)]
pub(crate) fn encode(colours: &mut Colours) {
    for channel in colours {
        for value in channel {
            *value = srgb::encode(*value);
        }
    }
}

/// Multiplies light by a factor. Values above 1 are clamped when they are converted to bytes.
#[inline(always)]
pub(crate) fn expose(colours: &mut Colours, exposure: f32) {
    for channel in colours {
        for value in channel {
            *value *= exposure;
        }
    }
}

/// Adds noise to the colours, the same in all three channels of a lane. Values outside [0, 1] are clamped when they are
/// converted to bytes, as in Gazebo.
#[inline(always)]
pub(crate) fn add_noise(colours: &mut Colours, noise: &GaussianNoise, bias: f32, normals: &Lanes<f32>) {
    for channel in colours {
        noise.apply_all(channel, bias, normals);
    }
}

/// Rounds a value in [0, 1] to the nearest byte; values outside are clamped.
#[inline(always)]
pub(crate) fn to_byte(value: f32) -> u8 {
    // `as` saturates and converts NaN to 0.
    (value * 255.0 + 0.5) as u8
}

/// Scales values in [0, 1] to `full_scale` and rounds to the nearest integers; values outside are clamped.
#[inline(always)]
fn to_levels<S: Simd>(simd: S, values: f32x16<S>, full_scale: f32) -> u32x16<S> {
    let scaled = values * full_scale + 0.5;
    // NaN is not greater than 0 and so becomes 0.
    let zero = f32x16::splat(simd, 0.0);
    let scaled = scaled.simd_gt(zero).select(scaled, zero);
    let most = f32x16::splat(simd, full_scale);
    scaled.simd_lt(most).select(scaled, most).to_int()
}

/// Packs three channels into bytes, the first in the lowest.
#[inline(always)]
pub(super) fn to_bytes<S: Simd>(simd: S, channels: [f32x16<S>; 3]) -> u32x16<S> {
    let [first, second, third] = channels;
    let [first, second, third] =
        [to_levels(simd, first, 255.0), to_levels(simd, second, 255.0), to_levels(simd, third, 255.0)];
    first | (second << 8) | (third << 16)
}

/// Bytes of the largest pixel.
const MOST_BYTES: usize = 4;

/// Writes the lanes of a 16 × 4 tile that are set in the mask `lanes`, as [`write_tile`] writes all of them. `rows`
/// begins with the first row of the tile.
#[inline(always)]
pub(crate) fn write_lanes<S: Simd>(
    simd: S,
    (colours, lanes): (&Colours, u64),
    format: (PixelFormat, f32),
    column: usize,
    rows: &mut [u8],
    row_stride: usize,
) {
    let bytes = format.0.bytes();
    let mut tile = [0; LANES * MOST_BYTES];
    // All tiles begin in even columns and rows, so a mosaic pattern has the same phase in each of them.
    write_tile(simd, colours, format, (Tiling::Square, [0; 2]), &mut tile[..LANES * bytes], WIDTH * bytes);
    let mut rest = lanes;
    while rest != 0 {
        let lane = rest.trailing_zeros() as usize % LANES;
        rest &= rest - 1;
        let place = lane / WIDTH * row_stride + (column * WIDTH + lane % WIDTH) * bytes;
        rows[place..place + bytes].copy_from_slice(&tile[lane * bytes..(lane + 1) * bytes]);
    }
}

/// Writes the colours of a tile into the rows of a picture.
///
/// `tile` is its column and row, `rows` begins with its first row, and `full_scale` applies to the 16-bit formats.
/// Compiled once per SIMD level, for all sensors.
#[inline(never)]
pub(crate) fn write_tile<S: Simd>(
    simd: S,
    colours: &Colours,
    format: (PixelFormat, f32),
    tile: (Tiling, [usize; 2]),
    rows: &mut [u8],
    row_stride: usize,
) {
    simd.vectorize(
        #[inline(always)]
        || write_formatted(simd, colours, format, tile, rows, row_stride),
    );
}

#[inline(always)]
fn write_formatted<S: Simd>(
    simd: S,
    colours: &Colours,
    (format, full_scale): (PixelFormat, f32),
    (tiling, tile): (Tiling, [usize; 2]),
    rows: &mut [u8],
    row_stride: usize,
) {
    let mosaic;
    let [red, green, blue] = match format.planes() {
        Planes::Mosaic(pattern) => {
            mosaic = pattern.pick(colours, &tiling.lines(tile));
            [&mosaic; 3]
        }
        _ => colours.each_ref(),
    };
    // The bytes of each pixel, the first in the lowest.
    let mut packed = [0_u32; LANES];
    for first in (0..LANES).step_by(WIDTH) {
        let sixteen = |channel: &Lanes<f32>| {
            let mut values = [0.0; WIDTH];
            values.copy_from_slice(&channel[first..first + WIDTH]);
            f32x16::load_array(simd, values)
        };
        let (red, green, blue) = (sixteen(red), sixteen(green), sixteen(blue));
        let bytes = match format {
            PixelFormat::Rgb8 => to_bytes(simd, [red, green, blue]),
            PixelFormat::Bgr8 => to_bytes(simd, [blue, green, red]),
            PixelFormat::Rgba8 => to_bytes(simd, [red, green, blue]) | 0xFF00_0000,
            PixelFormat::Mono8 | PixelFormat::Mono16 => {
                let full_scale = if format == PixelFormat::Mono8 { 255.0 } else { full_scale };
                to_levels(simd, red * LUMA[0] + green * LUMA[1] + blue * LUMA[2], full_scale)
            }
            PixelFormat::Bayer8(_) => to_levels(simd, red, 255.0),
            PixelFormat::Bayer16(_) => to_levels(simd, red, full_scale),
        };
        let mut values = [0; WIDTH];
        bytes.store_array(&mut values);
        packed[first..first + WIDTH].copy_from_slice(&values);
    }
    for (line, packed) in packed.as_chunks::<WIDTH>().0.iter().enumerate() {
        let [x, y] = tiling.line(line);
        let start = (tile[0] * tiling.size()[0] + x) * format.bytes();
        let Some(row) =
            rows.get_mut(y * row_stride..(y + 1) * row_stride).and_then(|row| row.get_mut(start..))
        else {
            return;
        };
        match format.bytes() {
            1 => {
                for (pixel, packed) in row.iter_mut().zip(packed) {
                    *pixel = *packed as u8;
                }
            }
            2 => {
                for (pixel, packed) in row.as_chunks_mut::<2>().0.iter_mut().zip(packed) {
                    *pixel = (*packed as u16).to_le_bytes();
                }
            }
            3 => write_pixels(packed, row),
            _ => {
                for (pixel, packed) in row.as_chunks_mut::<4>().0.iter_mut().zip(packed) {
                    *pixel = packed.to_le_bytes();
                }
            }
        }
    }
}

/// Writes pixels of three bytes, four at a time as three words.
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
    // The remaining pixels of a row whose length is not a multiple of four.
    for (pixel, packed) in rest.as_chunks_mut::<3>().0.iter_mut().zip(&packed[4 * written..]) {
        let [first, second, third, _] = packed.to_le_bytes();
        *pixel = [first, second, third];
    }
}
