//! The SIMD level, and the packets of values that kernels process.
//!
//! Kernels are plain loops over fixed-size arrays of [`LANES`] values, using only +, −, ×, ÷, √ and comparisons.
//! [`Simd::vectorize`] compiles each of them for every instruction set, and the level is chosen once per frame. Since
//! no operation is fused or approximated, every level gives the same bits.

pub use fearless_simd::Level;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x4, f32x16, f64x8};

/// Evaluates an expression compiled for the instruction set of a [`Level`], with the token of that level.
///
/// This is [`fearless_simd::dispatch!`] without a separate version for SSE4.2, which is the best level of few machines:
/// on these, SSE2 takes up to a seventh longer, and each level accounts for a quarter of the compilation time of this
/// crate. For the same reason, builds with debug assertions (the dev profile) omit AVX-512 and use AVX2 instead, and
/// the unit tests, which test individual parts, only have the baseline. The integration tests compare the levels, in a
/// release build all of them.
macro_rules! dispatch {
    (@with $token:expr, $simd:pat => $op:expr) => {{
        let token = $token;
        let $simd = token;
        $crate::simd::apart(
            #[inline(always)]
            || fearless_simd::Simd::vectorize(token, #[inline(always)] || $op),
        )
    }};
    ($level:expr, $simd:pat => $op:expr) => {{
        let level: $crate::simd::Level = $level;
        #[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(test)))]
        let result = $crate::simd::avx512_or!(level, $simd => $op, {
            if let Some(token) = level.as_avx2() {
                $crate::simd::dispatch!(@with token, $simd => $op)
            } else if let Some(token) = level.as_sse2().or_else(|| $crate::simd::Level::baseline().as_sse2()) {
                $crate::simd::dispatch!(@with token, $simd => $op)
            } else {
                unreachable!("the target has SSE2")
            }
        });
        #[cfg(all(target_arch = "x86_64", target_feature = "sse2", test))]
        let result = {
            let _ = level;
            match $crate::simd::Level::baseline().as_sse2() {
                Some(token) => $crate::simd::dispatch!(@with token, $simd => $op),
                None => unreachable!("the target has SSE2"),
            }
        };
        #[cfg(not(all(target_arch = "x86_64", target_feature = "sse2")))]
        let result = fearless_simd::dispatch!(level, $simd => $op);
        result
    }};
}
pub(crate) use dispatch;

/// Calls a level's version of [`dispatch!`]. If the version of SSE2 were inlined, its stack would be allocated for
/// every level.
#[inline(never)]
pub(crate) fn apart<R>(version: impl FnOnce() -> R) -> R {
    version()
}

/// Calls a part of a kernel, which is a function of its own at AVX-512 and inlined at other levels. With registers of
/// sixteen values, a large kernel keeps many of them on the stack, and a change of any part moves those of all others.
#[inline(always)]
pub(crate) fn part<S: Simd, R>(simd: S, part: impl FnOnce() -> R) -> R {
    if const { <S::f32s as SimdBase<S>>::LEN == WIDTH } {
        apart(
            #[inline(always)]
            || simd.vectorize(part),
        )
    } else {
        part()
    }
}

/// The branch of [`dispatch!`] for AVX-512, and the expression that replaces it in builds without AVX-512.
#[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(test), not(debug_assertions)))]
macro_rules! avx512_or {
    ($level:ident, $simd:pat => $op:expr, $otherwise:expr) => {
        if let Some(token) = $level.as_avx512() {
            $crate::simd::dispatch!(@with token, $simd => $op)
        } else {
            $otherwise
        }
    };
}
#[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(test), debug_assertions))]
macro_rules! avx512_or {
    ($level:ident, $simd:pat => $op:expr, $otherwise:expr) => {
        $otherwise
    };
}
#[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(test)))]
pub(crate) use avx512_or;

/// Number of rays in a packet: a tile of 16 × 4 pixels, or 64 consecutive beams.
pub const LANES: usize = 64;

/// Number of values in a vector of the kernels, at every SIMD level: the children of a node, the triangles of a leaf,
/// the rays of a block.
pub const WIDTH: usize = 16;

/// One value per lane.
pub(crate) type Lanes<T> = [T; LANES];

/// Returns the best SIMD level of this machine with the feature `std`, otherwise the level of the compilation target.
pub fn best_level() -> Level {
    #[cfg(feature = "std")]
    return Level::new();
    #[cfg(not(feature = "std"))]
    return Level::baseline();
}

/// Loads sixteen of the lanes, starting at lane 16·`row`.
#[inline(always)]
pub(crate) fn load_row<S: Simd>(simd: S, lanes: &Lanes<f32>, row: usize) -> f32x16<S> {
    f32x16::load_array_ref(simd, &lanes.as_chunks().0[row])
}

/// Stores sixteen values, in the position from which [`load_row`] loads them.
#[inline(always)]
pub(crate) fn store_row<S: Simd>(values: f32x16<S>, lanes: &mut Lanes<f32>, row: usize) {
    values.store_array(&mut lanes.as_chunks_mut().0[row]);
}

/// Splits a vector into four quarters of four lanes.
#[inline(always)]
pub(crate) fn quarters<S: Simd>(simd: S, values: f32x16<S>) -> [f32x4<S>; 4] {
    let (upper, lower) = simd.split_f32x16(values);
    let ((a, b), (c, d)) = (simd.split_f32x8(upper), simd.split_f32x8(lower));
    [a, b, c, d]
}

/// The minimum of a power-of-two number of values, by halving, since a chain of dependent comparisons would take
/// longer.
#[inline(always)]
pub(crate) fn least<const N: usize>(mut values: [f32; N]) -> f32 {
    let mut half = N / 2;
    while half > 0 {
        for lane in 0..half {
            let other = values[lane + half];
            values[lane] = if other < values[lane] { other } else { values[lane] };
        }
        half /= 2;
    }
    values[0]
}

/// The square root, correctly rounded on every machine.
#[inline(always)]
pub(crate) fn sqrt(x: f64) -> f64 {
    #[cfg(feature = "std")]
    return x.sqrt();
    #[cfg(not(feature = "std"))]
    return libm::sqrt(x);
}

/// The square root in single precision, correctly rounded on every machine.
#[inline(always)]
pub(crate) fn sqrt_f32(x: f32) -> f32 {
    #[cfg(feature = "std")]
    return x.sqrt();
    #[cfg(not(feature = "std"))]
    return libm::sqrtf(x);
}

/// The greatest integer not above x, for |x| < 2⁶³, in one to three instructions instead of a call of the library
/// function.
#[inline(always)]
pub(crate) fn floor(x: f64) -> f64 {
    let whole = x as i64 as f64;
    if whole > x { whole - 1.0 } else { whole }
}

/// π/2 to 33 bits, so that its product with a quadrant is exact.
const HIGH: f64 = f64::from_bits(0x3ff9_21fb_5440_0000);
/// The remainder of π/2.
const LOW: f64 = 6.077_100_506_506_192e-11;

/// Sine and cosine to the last bits of f64, for |x| < 1e5: reduced by multiples of π/2 in two parts, then a Taylor
/// series whose remainder is below 1e-17 up to π/4. Uses only +, −, × and ÷, so that tables of angles can be filled
/// lane by lane.
#[inline(always)]
pub(crate) fn sin_cos(x: f64) -> (f64, f64) {
    let quadrant = floor(x * core::f64::consts::FRAC_2_PI + 0.5);
    let rest = (x - quadrant * HIGH) - quadrant * LOW;
    let square = rest * rest;
    let (mut sin, mut cos) = (SINE[8], COSINE[8]);
    for term in (0..8).rev() {
        sin = sin * square + SINE[term];
        cos = cos * square + COSINE[term];
    }
    sin *= rest;
    match (quadrant as i64) & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// [`sin_cos`] of eight values, with the same bits.
#[inline(always)]
pub(crate) fn sin_cos_of<S: Simd>(simd: S, x: f64x8<S>) -> [f64x8<S>; 2] {
    let quadrant = (x * core::f64::consts::FRAC_2_PI + 0.5).floor();
    let rest = (x - quadrant * HIGH) - quadrant * LOW;
    let square = rest * rest;
    let (mut sin, mut cos) = (f64x8::splat(simd, SINE[8]), f64x8::splat(simd, COSINE[8]));
    for term in (0..8).rev() {
        sin = sin * square + SINE[term];
        cos = cos * square + COSINE[term];
    }
    sin *= rest;
    let quadrant = quadrant - (quadrant * 0.25).floor() * 4.0;
    let is = |number: f64| quadrant.simd_eq(f64x8::splat(simd, number));
    let odd = is(1.0) | is(3.0);
    let (opposite, [mut s, mut c]) = (is(2.0) | is(3.0), [odd.select(cos, sin), odd.select(sin, cos)]);
    s = opposite.select(-s, s);
    c = (is(1.0) | is(2.0)).select(-c, c);
    [s, c]
}

/// Taylor coefficients of sin x / x in x².
const SINE: [f64; 9] = alternating_factorials(1);
/// Taylor coefficients of cos x in x².
const COSINE: [f64; 9] = alternating_factorials(0);

/// ±1/(first + 2k)! for k = 0, 1, …
const fn alternating_factorials(first: u32) -> [f64; 9] {
    let mut terms = [0.0; 9];
    let (mut term, mut number, mut k) = (1.0, first as f64, 0);
    while k < 9 {
        terms[k] = 1.0 / term;
        term *= -(number + 1.0) * (number + 2.0);
        number += 2.0;
        k += 1;
    }
    terms
}

#[cfg(test)]
mod tests {
    use fearless_simd::{SimdBase as _, f64x8};

    #[test]
    fn sine_and_cosine_to_the_last_bits() {
        for step in -20_000..20_000 {
            let x = f64::from(step) * 0.011;
            let (sin, cos) = super::sin_cos(x);
            let (true_sin, true_cos) = libm::sincos(x);
            assert!((sin - true_sin).abs() < 3e-16 && (cos - true_cos).abs() < 3e-16, "{x}");
        }
    }

    #[test]
    fn eight_values_have_the_bits_of_one() {
        let simd = super::best_level();
        for step in -5_000..5_000 {
            let x: [f64; 8] = core::array::from_fn(|lane| f64::from(8 * step + lane as i32) * 0.011);
            let mut eight = [[0.0_f64; 8]; 2];
            super::dispatch!(simd, simd => {
                let both = super::sin_cos_of(simd, f64x8::load_array(simd, x));
                both[0].store_array(&mut eight[0]);
                both[1].store_array(&mut eight[1]);
            });
            for lane in 0..8 {
                let (sin, cos) = super::sin_cos(x[lane]);
                let bits = [eight[0][lane].to_bits(), eight[1][lane].to_bits()];
                assert_eq!(bits, [sin.to_bits(), cos.to_bits()], "{}", x[lane]);
            }
        }
    }
}
