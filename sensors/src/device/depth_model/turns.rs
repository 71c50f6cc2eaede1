//! Angles in turns: sine and cosine, and the inverse.

use core::f64::consts::TAU;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16};

/// Sine and cosine of an angle of −½ to ½ turns: M. Abramowitz, I. A. Stegun, "Handbook of Mathematical Functions",
/// 1964, 4.3.97 and 4.3.99, up to a quarter turn. The error is 2e-9 plus the rounding of single precision.
#[inline(always)]
pub(super) fn sin_cos_of_turns<S: Simd>(simd: S, turns: f32x16<S>) -> [f32x16<S>; 2] {
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

/// The angle of a vector in turns, −½ to ½: the arc tangent by 4.4.49 of the same handbook, with an error of 2e-8.
#[inline(always)]
pub(super) fn turns_of<S: Simd>(simd: S, sine: f32x16<S>, cosine: f32x16<S>) -> f32x16<S> {
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
    fn angles_of_a_full_turn_are_accurate() {
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
