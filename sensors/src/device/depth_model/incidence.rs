//! The angle of incidence, in the measure by which the noise of depth cameras grows.

use fearless_simd::{Simd, SimdBase, SimdFloat, f32x16};

/// Lower limit of the cosine, 0.006° from grazing incidence.
const LEAST_COSINE: f32 = 1e-4;

/// θ/√(1 − cos θ) as a polynomial in cos θ: M. Abramowitz, I. A. Stegun, "Handbook of Mathematical Functions", 1964,
/// 4.4.46; the error of θ is at most 2e-8.
const ACOS: [f32; 8] = [
    core::f32::consts::FRAC_PI_2,
    -0.214_598_8,
    0.088_978_99,
    -0.050_174_305,
    0.030_891_88,
    -0.017_088_126,
    0.006_670_09,
    -0.001_262_491_1,
];

/// θ/(π/2 − θ) from the cosines of angles of incidence.
#[inline(always)]
pub(super) fn slant<S: Simd>(simd: S, cosines: f32x16<S>) -> f32x16<S> {
    let (least, one) = (f32x16::splat(simd, LEAST_COSINE), f32x16::splat(simd, 1.0));
    let cosine = cosines.max(least).min(one);
    let mut sum = f32x16::splat(simd, ACOS[7]);
    for term in (0..7).rev() {
        sum = sum * cosine + ACOS[term];
    }
    let angle = (one - cosine).sqrt() * sum;
    angle / (f32x16::splat(simd, core::f32::consts::FRAC_PI_2) - angle)
}

/// θ/(π/2 − θ) from the angle of incidence.
pub(super) fn slant_of(incidence_rad: f64) -> f64 {
    incidence_rad / (core::f64::consts::FRAC_PI_2 - incidence_rad)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{best_level, dispatch};

    #[test]
    fn slants_of_all_angles_are_accurate() {
        for step in 0..8_990 {
            let angle = f64::from(step) * 0.01_f64.to_radians();
            let cosine = libm::cos(angle) as f32;
            let found: [f32; 16] =
                dispatch!(best_level(), simd => slant(simd, f32x16::splat(simd, cosine)).into());
            // In single precision, a cosine does not resolve small angles. Root, sum and product round the angle six
            // times, by a relative error of at most 6e-8 each, and the difference from a right angle has the same
            // absolute error.
            let doubt = 1.2e-7 / (libm::sin(angle) + 3e-4) + 3.6e-7 * angle;
            let doubt = doubt / (core::f64::consts::FRAC_PI_2 - angle);
            let (found, expected) = (f64::from(found[0]), slant_of(angle));
            assert!(
                (found - expected).abs() < (1.0 + expected) * (doubt + 1e-6),
                "{step}: {found}, not {expected}"
            );
        }
    }
}
