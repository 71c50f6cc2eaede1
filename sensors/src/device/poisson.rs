//! Numbers of electrons, with a Poisson distribution.
//!
//! Small means are sampled exactly, by inversion: the count is the first k whose cumulative probability reaches a
//! uniform number. From [`MANY`] on, a standard normal w is transformed to a number with the distribution's mean,
//! variance and, to one part in 900, third moment, by the expansion of E. A. Cornish and R. A. Fisher (1938,
//! doi:10.2307/1400905). M. B. Giles gives it for the quantiles of the Poisson distribution (Algorithm 955, 2016,
//! doi:10.1145/2699466).
//!
//! The read noise σ is normal and added to the count, so both are drawn as one number: with the variance v = m + σ² and
//! ρ = m/v, it is m + w·√(v − ρ²/18) + ρ·(w² − 1)/6. Its cumulative distribution differs from that of the sum of a
//! Poisson and a normal number by at most 0.0008 for a σ of at least half an electron. For a smaller σ, single
//! electrons would be visible, so the count is rounded, using Giles's second order, ⌊m + w·√m + ⅓ + w²/6 − (2w +
//! w³)/(72·√m)⌋. Its total variation distance from the Poisson distribution is below 0.0003. At a mean of [`MANY`] it
//! is negative for two normals in 10⁸, and the count is then 0.

use crate::simd::{LANES, Lanes, WIDTH, load_row, sqrt_f32, store_row};
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16};

/// The mean from which on a count is a transformed normal: here hardly any normal is transformed to a negative count.
pub(crate) const MANY: f32 = 16.0;
/// Probabilities below this are omitted from the sum, which they hardly change in single precision. The probability of
/// a count of 0, which is at least e⁻¹⁶, is greater.
const LEAST: f32 = 1.0e-9;
/// An upper bound on the number of terms of any sum for a mean below [`MANY`].
const TERMS: usize = 48;

/// Counts for the means below [`MANY`]; 0 for the others.
#[inline(always)]
pub(crate) fn few<S: Simd>(simd: S, means: &Lanes<f32>, words: &Lanes<u32>) -> Lanes<f32> {
    let mut counts = [0.0; LANES];
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    let mut first = [0.0; LANES];
    let mut uniforms = [0.0; LANES];
    for lane in 0..LANES {
        let mean = if means[lane] < MANY { means[lane] } else { 0.0 };
        first[lane] = exp_minus(mean);
        // The centre of one of 2²³ cells.
        uniforms[lane] = ((words[lane] >> 9) as i32 as f32 + 0.5) * (1.0 / (1_u32 << 23) as f32);
    }
    for row in 0..LANES / WIDTH {
        let mean = load_row(simd, means, row);
        let mean = mean.simd_lt(MANY).select(mean, zero);
        let uniform = load_row(simd, &uniforms, row);
        let mut term = load_row(simd, &first, row);
        let (mut sum, mut count) = (term, zero);
        for k in 1..TERMS {
            let beyond = uniform.simd_gt(sum) & term.simd_gt(LEAST);
            if !beyond.any_true() {
                break;
            }
            count += beyond.select(one, zero);
            term *= mean * (1.0 / k as f32);
            sum += term;
        }
        store_row(count, &mut counts, row);
    }
    counts
}

/// The mean plus shot noise and read noise, from a standard normal, for means of at least [`MANY`].
#[inline(always)]
pub(crate) fn many_with_reading(mean: f32, read_variance: f32, normal: f32) -> f32 {
    let variance = mean + read_variance;
    let share = mean / variance;
    let spread = sqrt_f32(variance - share * share * (1.0 / 18.0));
    mean + normal * spread + share * (normal * normal - 1.0) * (1.0 / 6.0)
}

/// A whole, non-negative number of electrons from a standard normal, for means of at least [`MANY`].
#[inline(always)]
pub(crate) fn many(mean: f32, normal: f32) -> f32 {
    let spread = sqrt_f32(mean);
    let square = normal * normal;
    let bend = (1.0 / 3.0) + square * (1.0 / 6.0) - normal * (2.0 + square) / (72.0 * spread);
    let count = floor(mean + normal * spread + bend);
    if count > 0.0 { count } else { 0.0 }
}

/// Adding and subtracting this number rounds smaller ones to an integer, with halves to even.
const WHOLE: f32 = 12_582_912.0;

/// Rounds to the nearest integer, with halves to even, for |x| < 2²².
#[inline(always)]
pub(crate) fn round(x: f32) -> f32 {
    (x + WHOLE) - WHOLE
}

/// The greatest integer not above x, for |x| < 2²²; larger x are returned as they are, since f32 resolves at most
/// halves there.
#[inline(always)]
fn floor(x: f32) -> f32 {
    let near = round(x);
    let whole = if near > x { near - 1.0 } else { near };
    if x < 4_194_304.0 { whole } else { x }
}

/// e⁻ˣ for 0 ≤ x ≤ [`MANY`] with a relative error below 4e-7: 2ⁿ·eʸ with y = −x − n·ln 2, where eʸ is a Taylor series
/// whose remainder is below 1.3e-7 for |y| ≤ ½·ln 2.
#[inline(always)]
fn exp_minus(x: f32) -> f32 {
    let power = -x * core::f32::consts::LOG2_E;
    let whole = round(power);
    // n·ln 2 in two parts. The first, 355/512, has so few digits that its product is exact.
    let y = (-x - whole * (355.0 / 512.0)) - whole * -2.121_944_4e-4;
    let part = 1.0
        + y * (1.0 + y * (0.5 + y * (1.0 / 6.0 + y * (1.0 / 24.0 + y * (1.0 / 120.0 + y * (1.0 / 720.0))))));
    part * f32::from_bits(((whole as i32 + 127) << 23) as u32)
}

#[cfg(test)]
mod tests {
    use super::{MANY, TERMS};

    /// The least and the greatest normal that can occur.
    const EXTREMES: [f32; 2] = [-6.547, 6.547];

    #[test]
    fn no_count_is_negative() {
        for mean in [MANY, 16.5, 20.0, 100.0, 1e6] {
            for step in 0..=10_000 {
                let normal = EXTREMES[0] + (EXTREMES[1] - EXTREMES[0]) * (step as f32 * 1e-4);
                let count = super::many(mean, normal);
                assert!(count >= 0.0 && count == count.round(), "{count} of {mean} at {normal}");
            }
        }
    }

    #[test]
    fn sums_end_within_their_number_of_terms() {
        // The sum for the greatest sampled mean continues after its first term and ends before its last.
        let last = f64::from(MANY);
        let term = |k: usize| libm::exp(k as f64 * libm::log(last) - last - libm::lgamma(k as f64 + 1.0));
        assert!(term(0) > 10.0 * f64::from(super::LEAST) && term(TERMS - 1) < f64::from(super::LEAST));
    }

    #[test]
    fn the_exponential_is_accurate() {
        for step in 0..=16_000 {
            let x = step as f32 * 0.001;
            let expected = libm::exp(-f64::from(x));
            let relative = (f64::from(super::exp_minus(x)) / expected - 1.0).abs();
            assert!(relative < 4e-7, "{relative} at {x}");
        }
    }
}
