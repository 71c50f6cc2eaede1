//! Numbers of electrons: Poisson's distribution.
//!
//! Small means are sampled exactly, by inversion: the count is the first k whose cumulative probability reaches a
//! uniform number. From [`MANY`] on a standard normal w is bent into a number with the distribution's mean, variance
//! and, to a part in 900, third moment, as the expansion of E. A. Cornish and R. A. Fisher does (1938,
//! doi:10.2307/1400905); M. B. Giles gives it for Poisson's quantiles (Algorithm 955, 2016, doi:10.1145/2699466).
//!
//! Read noise σ is normal and added to the count, so that the two are one number there: with a variance v = m + σ² and
//! ρ = m/v, m + w·√(v − ρ²/18) + ρ·(w² − 1)/6. The cumulative distribution of Poisson's plus the normal is met within
//! 0.0008 for σ of at least half an electron, below which whole electrons would show: then the count is rounded, by
//! Giles's second order, ⌊m + w·√m + ⅓ + w²/6 − (2w + w³)/(72·√m)⌋, whose total variation from Poisson's is below 0.0003.
//! That is below 0 for two normals in 10⁸ at a mean of [`MANY`], and the count is then 0.

use crate::simd::{LANES, Lanes, WIDTH, load_row, sqrt_f32, store_row};
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16};

/// The mean from which a count is a bent normal: where hardly any normal is bent to less than no electron.
pub(crate) const MANY: f32 = 16.0;
/// Probabilities below this are left out of the sum, which in single precision they hardly change. That of no electron,
/// e⁻¹⁶ at least, is above it.
const LEAST: f32 = 1.0e-9;
/// More terms than any sum of a mean below [`MANY`] has.
const TERMS: usize = 48;

/// Counts of the means below [`MANY`]; 0 for the others.
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

/// Mean plus the noise of both light and reading, from a standard normal: for means of [`MANY`] and more.
#[inline(always)]
pub(crate) fn many_with_reading(mean: f32, read_variance: f32, normal: f32) -> f32 {
    let variance = mean + read_variance;
    let share = mean / variance;
    let spread = sqrt_f32(variance - share * share * (1.0 / 18.0));
    mean + normal * spread + share * (normal * normal - 1.0) * (1.0 / 6.0)
}

/// A whole number of electrons, 0 or more, from a standard normal: for means of [`MANY`] and more.
#[inline(always)]
pub(crate) fn many(mean: f32, normal: f32) -> f32 {
    let spread = sqrt_f32(mean);
    let square = normal * normal;
    let bend = (1.0 / 3.0) + square * (1.0 / 6.0) - normal * (2.0 + square) / (72.0 * spread);
    let count = floor(mean + normal * spread + bend);
    if count > 0.0 { count } else { 0.0 }
}

/// Adding and taking away this rounds what is smaller to a whole number, halves to even.
const WHOLE: f32 = 12_582_912.0;

/// To the nearest whole number, halves to even, for |x| < 2²².
#[inline(always)]
pub(crate) fn round(x: f32) -> f32 {
    (x + WHOLE) - WHOLE
}

/// The largest whole number not above x, for |x| < 2²²; beyond, x as f32 has it, which tells halves apart at most.
#[inline(always)]
fn floor(x: f32) -> f32 {
    let near = round(x);
    let whole = if near > x { near - 1.0 } else { near };
    if x < 4_194_304.0 { whole } else { x }
}

/// e⁻ˣ for 0 ≤ x ≤ [`MANY`] with a relative error below 4e-7: 2ⁿ·eʸ with y = −x − n·ln 2, the latter by Taylor's series,
/// whose rest is below 1.3e-7 for |y| ≤ ½·ln 2.
#[inline(always)]
fn exp_minus(x: f32) -> f32 {
    let power = -x * core::f32::consts::LOG2_E;
    let whole = round(power);
    // n·ln 2 in two parts, of which the first, 355/512, has so few digits that nothing is rounded.
    let y = (-x - whole * (355.0 / 512.0)) - whole * -2.121_944_4e-4;
    let part = 1.0
        + y * (1.0 + y * (0.5 + y * (1.0 / 6.0 + y * (1.0 / 24.0 + y * (1.0 / 120.0 + y * (1.0 / 720.0))))));
    part * f32::from_bits(((whole as i32 + 127) << 23) as u32)
}

#[cfg(test)]
mod tests {
    use super::{MANY, TERMS};

    /// The least and the greatest normal that there is.
    const EXTREMES: [f32; 2] = [-6.547, 6.547];

    #[test]
    fn no_count_is_below_none() {
        for mean in [MANY, 16.5, 20.0, 100.0, 1e6] {
            for step in 0..=10_000 {
                let normal = EXTREMES[0] + (EXTREMES[1] - EXTREMES[0]) * (step as f32 * 1e-4);
                let count = super::many(mean, normal);
                assert!(count >= 0.0 && count == count.round(), "{count} of {mean} at {normal}");
            }
        }
    }

    #[test]
    fn sums_begin_and_end() {
        // The sum of the greatest mean that is sampled by it goes on from its first term and ends before its last.
        let last = f64::from(MANY);
        let term = |k: usize| libm::exp(k as f64 * libm::log(last) - last - libm::lgamma(k as f64 + 1.0));
        assert!(term(0) > 10.0 * f64::from(super::LEAST) && term(TERMS - 1) < f64::from(super::LEAST));
    }

    #[test]
    fn the_exponential() {
        for step in 0..=16_000 {
            let x = step as f32 * 0.001;
            let expected = libm::exp(-f64::from(x));
            let relative = (f64::from(super::exp_minus(x)) / expected - 1.0).abs();
            assert!(relative < 4e-7, "{relative} at {x}");
        }
    }
}
