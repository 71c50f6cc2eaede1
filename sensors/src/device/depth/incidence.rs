//! How flat a ray meets a surface, in the measure that depth cameras' noise grows by.

use fearless_simd::{Simd, SimdBase, SimdFloat, f32x16};

/// Cosines below this, 0.006° from a ray along the surface, count as this.
const LEAST_COSINE: f32 = 1e-4;

/// θ/√(1 − cos θ) in cos θ: M. Abramowitz, I. A. Stegun, "Handbook of Mathematical Functions", 1964, 4.4.46; θ is
/// off by 2e-8 at most.
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

/// The same of an angle.
pub(super) fn slant_of(incidence_rad: f64) -> f64 {
    incidence_rad / (core::f64::consts::FRAC_PI_2 - incidence_rad)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{best_level, dispatch};

    #[test]
    fn of_all_angles() {
        for step in 0..8_990 {
            let angle = f64::from(step) * 0.01_f64.to_radians();
            let cosine = libm::cos(angle) as f32;
            let found: [f32; 16] =
                dispatch!(best_level(), simd => slant(simd, f32x16::splat(simd, cosine)).into());
            // In single precision a cosine tells little of small angles; root, sum and product round the angle six times,
            // by 6e-8 of it each at most, and what is left of a right angle is off by as much.
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
