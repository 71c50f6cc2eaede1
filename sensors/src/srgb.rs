//! The sRGB transfer curve, IEC 61966-2-1, from linear light to image values and back.
//!
//! The powers are polynomials in roots, computed with +, −, × and √ only, so the bits are the same on every machine.
//! Errors are below 3e-6 of full scale, a fifth of a step of 16 bits.

use crate::simd::sqrt_f32;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16};

/// 1.055·t^(5/3) − 0.055 for t = x^¼, with x from 0.0031308 to 1.
const ENCODE: [f32; 7] =
    [-0.059_641_75, 0.140_776_78, 1.360_225_6, -0.838_965_36, 0.638_769_45, -0.306_036_98, 0.064_873_32];
/// t^4.8 for t² from 0.0905 to 1.
const DECODE: [f32; 8] = [
    0.000_116_756_295,
    -0.001_873_118_1,
    0.013_471_924,
    -0.060_099_173,
    0.226_822_56,
    0.891_081_3,
    -0.079_172_93,
    0.009_652_698,
];

/// Returns the image value, 0 to 1, for linear light, which is clamped to [0, 1].
///
/// ```
/// use belvedere_sensors::srgb;
/// assert_eq!((srgb::encode(0.18) * 255.0).round(), 118.0); // a fifth of the light is half of the scale
/// assert_eq!([srgb::encode(-1.0), srgb::encode(2.0) * 255.0].map(f32::round), [0.0, 255.0]);
/// ```
#[must_use]
#[allow(clippy::inline_always, reason = "called per sample inside vectorised kernels")]
#[inline(always)]
pub fn encode(linear: f32) -> f32 {
    // NaN is not greater than 0, so it becomes 0.
    let linear = if linear > 0.0 { linear } else { 0.0 };
    let linear = if linear < 1.0 { linear } else { 1.0 };
    let root = sqrt_f32(sqrt_f32(linear));
    let curve = polynomial(&ENCODE, root);
    if linear < 0.003_130_8 { 12.92 * linear } else { curve }
}

/// Returns the linear light for an image value, which is clamped to [0, 1].
///
/// ```
/// use belvedere_sensors::srgb;
/// assert!((srgb::decode(128.0 / 255.0) - 0.215_861).abs() < 2e-6);
/// ```
#[must_use]
#[allow(clippy::inline_always, reason = "called per sample inside vectorised kernels")]
#[inline(always)]
pub fn decode(value: f32) -> f32 {
    let value = if value > 0.0 { value } else { 0.0 };
    let value = if value < 1.0 { value } else { 1.0 };
    let curve = polynomial(&DECODE, sqrt_f32((value + 0.055) * (1.0 / 1.055)));
    if value < 0.040_45 { value * (1.0 / 12.92) } else { curve }
}

/// Vector form of [`decode`] for sixteen values.
#[inline(always)]
pub(crate) fn decode_row<S: Simd>(simd: S, value: f32x16<S>) -> f32x16<S> {
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    let value = value.simd_gt(zero).select(value, zero);
    let value = value.simd_lt(one).select(value, one);
    let root = ((value + 0.055) * (1.0 / 1.055)).sqrt();
    let mut curve = f32x16::splat(simd, DECODE[DECODE.len() - 1]);
    for term in (0..DECODE.len() - 1).rev() {
        curve = curve * root + DECODE[term];
    }
    value.simd_lt(0.040_45).select(value * (1.0 / 12.92), curve)
}

#[inline(always)]
fn polynomial<const N: usize>(coefficients: &[f32; N], x: f32) -> f32 {
    let mut sum = coefficients[N - 1];
    for term in (0..N - 1).rev() {
        sum = sum * x + coefficients[term];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::{decode, encode};

    #[test]
    fn the_curve_is_the_standard_s() {
        for step in 0..=65_535_u32 {
            let x = f64::from(step) / 65_535.0;
            let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * libm::pow(x, 1.0 / 2.4) - 0.055 };
            let decoded = if x <= 0.040_45 { x / 12.92 } else { libm::pow((x + 0.055) / 1.055, 2.4) };
            assert!((f64::from(encode(x as f32)) - encoded).abs() < 3e-6, "{x}");
            assert!((f64::from(decode(x as f32)) - decoded).abs() < 1.5e-6, "{x}");
        }
        // Every byte survives a round trip, and both ends are exact.
        for byte in 0..=255_u8 {
            assert_eq!((encode(decode(f32::from(byte) / 255.0)) * 255.0 + 0.5) as u8, byte);
        }
        assert_eq!((encode(1.0) * 65_535.0 + 0.5) as u32, 65_535);
        assert_eq!([encode(0.0), decode(0.0), encode(f32::NAN)], [0.0; 3]);
    }
}
