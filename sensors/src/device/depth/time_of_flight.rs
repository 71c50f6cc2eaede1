//! Time of flight: the phase of modulated light, mixed over what a pixel sees.

use super::check;
use crate::device::DeviceError;
use core::f64::consts::TAU;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16};

/// The speed of light in m/s.
const LIGHT: f64 = 299_792_458.0;

/// A pixel measures the phase of the light that comes back to it, and with it the range up to multiples of
/// c/(2 · `modulation_hz`). Light of several ranges adds up as waves do:
///
/// range = c/(4πf) · arg Σ aₖ · exp(i·4πf·rₖ/c)
///
/// over the pixel and its eight neighbours, which stand for its footprint by weights of a normal distribution. The
/// amplitude aₖ is that weight · cos θₖ/rₖ². So at edges pixels fly between what is before and behind, and what is beyond
/// the ambiguity range comes back near.
///
/// ```
/// use belvedere_sensors::device::depth::TimeOfFlight;
/// // 120, 80 and 16 MHz have 8 MHz in common.
/// let kinect = TimeOfFlight { modulation_hz: 8e6, footprint_px: 0.5 };
/// assert!((kinect.ambiguity_m() - 18.737).abs() < 1e-3);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeOfFlight {
    /// Of several frequencies their greatest common divisor; 1000 … 10¹¹ Hz.
    pub modulation_hz: f64,
    /// Standard deviation of the footprint in pixels, 0 … 1.
    pub footprint_px: f64,
}

impl TimeOfFlight {
    /// The range from which on ranges come again.
    #[must_use]
    pub fn ambiguity_m(&self) -> f64 {
        LIGHT / (2.0 * self.modulation_hz)
    }

    pub(super) fn check(&self) -> Result<(), DeviceError> {
        check("time_of_flight.modulation_hz", self.modulation_hz, [1e3, 1e11])?;
        check("time_of_flight.footprint_px", self.footprint_px, [0.0, 1.0])
    }
}

/// Ranges and cosines of incidence of sixteen pixels and those around them, row by row, column by column.
pub(crate) type Around<S> = [[[f32x16<S>; 2]; 3]; 3];

/// The light of a checked device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Light {
    ambiguity: f32,
    /// Of a pixel, of its four neighbours, and of those at its corners.
    weights: [f32; 3],
}

impl Light {
    pub(super) fn new(time_of_flight: &TimeOfFlight) -> Self {
        let variance = time_of_flight.footprint_px * time_of_flight.footprint_px;
        let weight =
            |squared: f64| if variance > 0.0 { libm::exp(-0.5 * squared / variance) as f32 } else { 0.0 };
        Self { ambiguity: time_of_flight.ambiguity_m() as f32, weights: [1.0, weight(1.0), weight(2.0)] }
    }

    /// The ranges that sixteen pixels measure; what is not finite stays.
    #[inline(always)]
    pub(crate) fn ranges<S: Simd>(self, simd: S, around: &Around<S>) -> f32x16<S> {
        let [own, _] = around[1][1];
        let number = |value: f32| f32x16::splat(simd, value);
        let (mut sine, mut cosine) = (number(0.0), number(0.0));
        for (y, row) in around.iter().enumerate() {
            for (x, &[range, incidence]) in row.iter().enumerate() {
                let weight = self.weights[usize::from(x != 1) + usize::from(y != 1)];
                // From the pixel's own phase: what all of a surface has in common keeps its digits.
                let turns = (range - own) * (1.0 / self.ambiguity);
                let [sin, cos] = sin_cos_of_turns(simd, turns - turns.round_ties_even());
                let amplitude = incidence * weight / (range * range);
                let counts = range.abs().simd_lt(number(f32::INFINITY)) & incidence.simd_gt(number(0.0));
                sine += counts.select(amplitude * sin, number(0.0));
                cosine += counts.select(amplitude * cos, number(0.0));
            }
        }
        let range = own + turns_of(simd, sine, cosine) * self.ambiguity;
        let range = range - (range * (1.0 / self.ambiguity)).floor() * self.ambiguity;
        own.abs().simd_lt(number(f32::INFINITY)).select(range, own)
    }
}

/// Sine and cosine of so many turns, −½ … ½: M. Abramowitz, I. A. Stegun, "Handbook of Mathematical Functions", 1964,
/// 4.3.97 and 4.3.99, up to a quarter; 2e-9 off, and what single precision adds.
#[inline(always)]
fn sin_cos_of_turns<S: Simd>(simd: S, turns: f32x16<S>) -> [f32x16<S>; 2] {
    const SIN: [f32; 6] = [1.0, -0.166_666_67, 0.008_333_331, -0.000_198_409, 2.7526e-6, -2.39e-8];
    const COS: [f32; 6] = [1.0, -0.5, 0.041_666_64, -0.001_388_839_7, 2.476_09e-5, -2.605e-7];
    let number = |value: f32| f32x16::splat(simd, value);
    let size = turns.abs();
    let is_behind = size.simd_gt(number(0.25));
    let angle = is_behind.select(number(0.5) - size, size) * TAU as f32;
    let square = angle * angle;
    let (mut sin, mut cos) = (number(SIN[5]), number(COS[5]));
    for term in (0..5).rev() {
        sin = sin * square + SIN[term];
        cos = cos * square + COS[term];
    }
    [(sin * angle).copysign(turns), is_behind.select(-cos, cos)]
}

/// The angle of a vector in turns, −½ … ½: arctan by the same handbook's 4.4.49, 2e-8 off.
#[inline(always)]
fn turns_of<S: Simd>(simd: S, sine: f32x16<S>, cosine: f32x16<S>) -> f32x16<S> {
    const ATAN: [f32; 9] = [
        1.0,
        -0.333_331_45,
        0.199_935_51,
        -0.142_089,
        0.106_562_64,
        -0.075_289_64,
        0.042_909_614,
        -0.016_165_737,
        0.002_866_225_7,
    ];
    let number = |value: f32| f32x16::splat(simd, value);
    let (up, ahead) = (sine.abs(), cosine.abs());
    let is_steep = up.simd_gt(ahead);
    let ratio = is_steep.select(ahead, up) / is_steep.select(up, ahead);
    let square = ratio * ratio;
    let mut sum = number(ATAN[8]);
    for term in (0..8).rev() {
        sum = sum * square + ATAN[term];
    }
    let turns = sum * ratio * (1.0 / TAU) as f32;
    let turns = is_steep.select(number(0.25) - turns, turns);
    let turns = cosine.simd_lt(number(0.0)).select(number(0.5) - turns, turns);
    turns.copysign(sine)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{best_level, dispatch};

    #[test]
    fn all_the_way_round() {
        for step in -5_000..=5_000 {
            let turns = f64::from(step) * 1e-4;
            let (sin, cos) = libm::sincos(turns * TAU);
            let found: [[f32; 16]; 2] = dispatch!(best_level(), simd => {
                sin_cos_of_turns(simd, f32x16::splat(simd, turns as f32)).map(Into::into)
            });
            assert!(
                (f64::from(found[0][0]) - sin).abs() < 5e-7 && (f64::from(found[1][0]) - cos).abs() < 5e-7
            );
            let back: [f32; 16] = dispatch!(best_level(), simd => {
                turns_of(simd, f32x16::splat(simd, sin as f32), f32x16::splat(simd, cos as f32)).into()
            });
            let off = f64::from(back[0]) - turns;
            assert!((off - libm::round(off)).abs() < 1e-7, "{turns}: {}", back[0]);
        }
    }
}
