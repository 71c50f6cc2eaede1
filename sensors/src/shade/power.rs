//! Powers of numbers in [0, 1], with +, −, × and ÷ only, so that the bits are the same on every machine.

use fearless_simd::{Bytes, Select, Simd, SimdBase, SimdFloat, SimdInt, f32x16, u32x16};

/// Numbers up to this count as 0: they are less than any visible power.
const LEAST: f32 = 1e-30;

/// x^y for y ≥ 0 and x in [0, 1], to which x is clamped; 0 if x is 0 or NaN, whatever y is. The relative error is below
/// 2e-7 · (3 + y·|ln x|), and results below 1e-30 may be 0.
#[inline(always)]
pub(super) fn power<S: Simd>(simd: S, x: f32x16<S>, y: f32x16<S>) -> f32x16<S> {
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    let there = x.simd_gt(LEAST);
    let x = there.select(x, one);
    let x = x.simd_lt(1.0).select(x, one);
    there.select(two_to(simd, log2(simd, x) * y), zero)
}

/// e^x for x ≤ 0; greater numbers count as 0. The error is below 1e-6.
#[inline(always)]
pub(super) fn exp<S: Simd>(simd: S, x: f32x16<S>) -> f32x16<S> {
    let x = x.simd_lt(0.0).select(x, f32x16::splat(simd, 0.0));
    two_to(simd, x * core::f32::consts::LOG2_E)
}

/// Binary logarithm of a positive number: the exponent, plus the logarithm of the mantissa between 1/√2 and √2 by the
/// series of artanh up to its eleventh power.
#[inline(always)]
fn log2<S: Simd>(simd: S, x: f32x16<S>) -> f32x16<S> {
    const TERMS: [f32; 5] = [1.0 / 11.0, 1.0 / 9.0, 1.0 / 7.0, 1.0 / 5.0, 1.0 / 3.0];
    const TWO_PER_LN_2: f32 = 2.0 / core::f32::consts::LN_2;
    let bits: u32x16<S> = x.bitcast();
    let exponent = (bits >> 23).to_float::<f32x16<S>>() - 127.0;
    let mantissa: f32x16<S> =
        ((bits & u32x16::splat(simd, 0x007f_ffff)) | u32x16::splat(simd, 0x3f80_0000)).bitcast();
    let large = mantissa.simd_gt(core::f32::consts::SQRT_2);
    let mantissa = large.select(mantissa * 0.5, mantissa);
    let exponent = large.select(exponent + 1.0, exponent);
    let ratio = (mantissa - 1.0) / (mantissa + 1.0);
    let square = ratio * ratio;
    let mut sum = f32x16::splat(simd, 0.0);
    for term in TERMS {
        sum = (sum + term) * square;
    }
    exponent + (ratio + ratio * sum) * TWO_PER_LN_2
}

/// Two to a power of 0 or less: the series of exp for the remainder after subtracting the nearest integer.
#[inline(always)]
fn two_to<S: Simd>(simd: S, power: f32x16<S>) -> f32x16<S> {
    const TERMS: [f32; 7] = [1.0 / 5040.0, 1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0];
    let least = f32x16::splat(simd, -126.0);
    let nothing = power.simd_lt(least);
    let power = nothing.select(least, power);
    let whole = (power + 0.5).floor();
    let rest = (power - whole) * core::f32::consts::LN_2;
    let mut sum = f32x16::splat(simd, 0.0);
    for term in TERMS {
        sum = (sum + term) * rest;
    }
    let scale: f32x16<S> = ((whole + 127.0).to_int::<u32x16<S>>() << 23).bitcast();
    nothing.select(f32x16::splat(simd, 0.0), (sum + 1.0) * scale)
}

#[cfg(test)]
mod tests {
    use super::power;
    use crate::simd::dispatch;
    use fearless_simd::{Level, SimdBase, f32x16};

    #[test]
    fn powers_are_those_of_libm() {
        let power = |x: [f32; 16], y: f32| {
            let mut found = [0.0_f32; 16];
            dispatch!(Level::baseline(), simd => {
                power(simd, f32x16::load_array(simd, x), f32x16::splat(simd, y)).store_array(&mut found);
            });
            found
        };
        for y in [0.0, 0.25, 1.0, 1.5, 5.0, 12.5, 128.0, 1e4_f32] {
            for first in 0..640_u32 {
                let x: [f32; 16] =
                    core::array::from_fn(|lane| 1.0 - (first * 16 + lane as u32) as f32 / 10_240.0);
                for (x, found) in x.into_iter().zip(power(x, y)) {
                    let expected = libm::pow(f64::from(x), f64::from(y));
                    let error = (f64::from(found) - expected).abs();
                    let bound = 2e-7 * expected * (3.0 - f64::from(y) * libm::log(f64::from(x)));
                    assert!(error <= bound + 1e-30, "{x}^{y} is {found}, should be {expected}");
                }
            }
        }
        let edges = [0.0, -1.0, f32::NAN, 2.0, 1.0, 1e-40, f32::INFINITY, f32::NEG_INFINITY];
        let edges: [f32; 16] = core::array::from_fn(|lane| edges[lane % 8]);
        let expected = [0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 1.0, 0.0];
        for y in [0.0, 0.5, 1e4] {
            assert_eq!(power(edges, y)[..8], expected, "to the power of {y}");
        }
    }
}
