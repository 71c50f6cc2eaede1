//! Standard normal numbers by the Box–Muller transform.
//!
//! Of two uniform words a and b, with U = (a + ½)/2³² and an angle θ that b spreads evenly over the circle,
//! r = √(−2 ln U) gives the two independent normals r·cos θ and r·sin θ (G. E. P. Box, M. E. Muller, "A note on
//! the generation of random normal deviates", 1958, doi:10.1214/aoms/1177706645).
//!
//! The logarithm and the circular functions are minimax polynomials of our own (Remez's exchange, coefficients
//! rounded to f32) evaluated with + − × and √ alone, each rounded once and never fused: the bits are the same on
//! every machine. Their relative error is below 2.5e-7. No |z| exceeds √(66 ln 2) = 6.764, which true normals
//! pass once in 7·10¹⁰ samples.

use super::Stream;
use fearless_simd::{Level, Simd, dispatch};

/// Normals in one block: what four Philox counters give.
const BLOCK: usize = 16;
/// Normals in the batch in which long runs are computed: enough independent work to hide the multiplier's
/// latency, few enough to stay in registers.
const BATCH: usize = 64;

/// Writes the samples `first_index`, `first_index + 1`, … of the stream as standard normals. A sample depends
/// on its index alone: however a run is split into calls, the values are the same. A run that goes on past index
/// 2³² − 1 takes the blocks of [`normals16`] that follow, which no index names.
///
/// This form is compiled into its caller, with whatever instructions the caller may use;
/// [`fill_standard_normal_with`] is for callers outside a `vectorize` context.
///
/// ```
/// use belvedere_sensors::noise::{Stream, fill_standard_normal};
/// let stream = Stream { seed: 7, sensor: 0, frame: 0, channel: 0 };
/// let (mut all, mut tail) = ([0.0; 100], [0.0; 33]);
/// fill_standard_normal(&stream, 0, &mut all);
/// fill_standard_normal(&stream, 67, &mut tail);
/// assert_eq!(all[67..], tail);
/// ```
#[allow(clippy::inline_always, reason = "target features reach only what is inlined")]
#[inline(always)]
pub fn fill_standard_normal(stream: &Stream, first_index: u32, out: &mut [f32]) {
    let mut block = first_index / BLOCK as u32;
    let skipped = first_index as usize % BLOCK;

    // Step 1: up to the next whole block.
    let (head, rest) = out.split_at_mut(if skipped == 0 { 0 } else { (BLOCK - skipped).min(out.len()) });
    if !head.is_empty() {
        head.copy_from_slice(&normals16(stream, block)[skipped..skipped + head.len()]);
        block = block.wrapping_add(1);
    }

    // Step 2: whole batches.
    let (batches, rest) = rest.as_chunks_mut::<BATCH>();
    for batch in batches {
        *batch = normals64(stream, block);
        block = block.wrapping_add((BATCH / BLOCK) as u32);
    }

    // Step 3: the blocks that are left, the last perhaps in part.
    for chunk in rest.chunks_mut(BLOCK) {
        chunk.copy_from_slice(&normals16(stream, block)[..chunk.len()]);
        block = block.wrapping_add(1);
    }
}

/// [`fill_standard_normal`] with the instructions of a SIMD level. The bits are the same at every level.
pub fn fill_standard_normal_with(level: Level, stream: &Stream, first_index: u32, out: &mut [f32]) {
    dispatch!(level, simd => fill_vectorized(simd, stream, first_index, out));
}

#[allow(clippy::inline_always, reason = "target features reach only what is inlined")]
#[inline(always)]
fn fill_vectorized<S: Simd>(simd: S, stream: &Stream, first_index: u32, out: &mut [f32]) {
    simd.vectorize(
        #[inline(always)]
        || fill_standard_normal(stream, first_index, out),
    );
}

/// The standard normals 16·`block` … 16·`block` + 15 of the stream, for kernels: it compiles to the vector
/// instructions of the `vectorize` context that it is called in. Block 2³⁰ is block 0 again.
#[must_use]
#[allow(clippy::inline_always, reason = "target features reach only what is inlined")]
#[inline(always)]
pub fn normals16(stream: &Stream, block: u32) -> [f32; 16] {
    normals::<4, 16>(stream, block)
}

/// The standard normals 16·`block` … 16·`block` + 63 of the stream: four times [`normals16`], in less than four
/// times its time.
#[must_use]
#[allow(clippy::inline_always, reason = "target features reach only what is inlined")]
#[inline(always)]
pub fn normals64(stream: &Stream, block: u32) -> [f32; 64] {
    normals::<16, 64>(stream, block)
}

/// `LEN` normals from `COUNTERS` = `LEN` / 4 Philox counters.
#[allow(clippy::inline_always, reason = "target features reach only what is inlined")]
#[inline(always)]
fn normals<const COUNTERS: usize, const LEN: usize>(stream: &Stream, block: u32) -> [f32; LEN] {
    const { assert!(LEN == 4 * COUNTERS && COUNTERS.is_multiple_of(4)) }
    normals_of(stream.words::<COUNTERS>(block.wrapping_mul(4)))
}

/// The standard normals of four blocks, as [`normals64`] has those of four that follow each other.
#[allow(clippy::inline_always, reason = "target features reach only what is inlined")]
#[inline(always)]
pub(crate) fn normals64_at(stream: &Stream, blocks: [u32; 4]) -> [f32; 64] {
    normals_of(stream.words_of_blocks(blocks))
}

/// The same normals by columns: those of the first four samples of each block, of the second four, and so on.
#[allow(clippy::inline_always, reason = "target features reach only what is inlined")]
#[inline(always)]
pub(crate) fn normal_columns64_at(stream: &Stream, blocks: [u32; 4]) -> [[f32; 16]; 4] {
    // That is how the words come.
    let [w0, w1, w2, w3] = stream.words_of_blocks(blocks);
    let (z0, z1) = box_muller(w0, w1);
    let (z2, z3) = box_muller(w2, w3);
    [z0, z1, z2, z3]
}

/// The normals of so many words, in the order of the samples.
#[allow(clippy::inline_always, reason = "target features reach only what is inlined")]
#[inline(always)]
fn normals_of<const COUNTERS: usize, const LEN: usize>([w0, w1, w2, w3]: [[u32; COUNTERS]; 4]) -> [f32; LEN] {
    let (z0, z1) = box_muller(w0, w1);
    let (z2, z3) = box_muller(w2, w3);
    let mut out = [0.0; LEN];
    for (b, block) in out.as_chunks_mut::<BLOCK>().0.iter_mut().enumerate() {
        for (w, z) in [&z0, &z1, &z2, &z3].into_iter().enumerate() {
            block[4 * w..4 * w + 4].copy_from_slice(&z[4 * b..4 * b + 4]);
        }
    }
    out
}

/// Two independent normals for each sample of four blocks of 16, from one word each. A word's upper half is the radius and
/// its lower half the angle, so that none exceeds 4.9: enough for what is drawn once and stays.
#[allow(clippy::inline_always, reason = "target features reach only what is inlined")]
#[inline(always)]
pub(crate) fn normal_pairs64(stream: &Stream, blocks: [u32; 4]) -> ([f32; 64], [f32; 64]) {
    let words = stream.words_of_blocks(blocks);
    let (mut radii, mut angles) = ([0; 64], [0; 64]);
    for (i, word) in words.as_flattened().iter().enumerate() {
        radii[i] = word & 0xFFFF_0000 | 0x8000;
        angles[i] = word << 16 | 0x8000;
    }
    let (first, second) = box_muller(radii, angles);
    // Four at a time to where they belong.
    let (mut out, mut other) = ([0.0; 64], [0.0; 64]);
    for block in 0..4 {
        for w in 0..4 {
            let (to, from) = (BLOCK * block + 4 * w, BLOCK * w + 4 * block);
            out[to..to + 4].copy_from_slice(&first[from..from + 4]);
            other[to..to + 4].copy_from_slice(&second[from..from + 4]);
        }
    }
    (out, other)
}

/// Two independent normals a lane from two independent words a lane.
#[allow(clippy::inline_always, reason = "target features reach only what is inlined")]
#[inline(always)]
fn box_muller<const N: usize>(radius_word: [u32; N], angle_word: [u32; N]) -> ([f32; N], [f32; N]) {
    let (mut first, mut second) = ([0.0; N], [0.0; N]);
    for lane in 0..N {
        let radius = square_root(-2.0 * ln_uniform(radius_word[lane]));

        // The angle: bits 0–29, signed, are a part of a quarter turn in [−½, ½]; bit 31 mirrors it at the diagonal
        // and bit 30 turns it by half, which together cover the circle once.
        let (sin, cos) = sin_cos_quarter((angle_word[lane] << 2) as i32);
        let mirrored = (angle_word[lane] as i32) < 0;
        let signed_radius = f32::from_bits(radius.to_bits() ^ (angle_word[lane] << 1 & SIGN));
        first[lane] = signed_radius * if mirrored { sin } else { cos };
        second[lane] = signed_radius * if mirrored { cos } else { sin };
    }
    (first, second)
}

/// The sign bit of an f32.
const SIGN: u32 = 0x8000_0000;

/// ln((word + ½) / 2³²), at most 0, with a relative error below 2.5e-7 of the logarithm of the uniform number as f32
/// holds it.
#[allow(clippy::inline_always, reason = "target features reach only what is inlined")]
#[inline(always)]
fn ln_uniform(word: u32) -> f32 {
    /// √½ in f32: the least mantissa.
    const SQRT_HALF: u32 = 0x3F35_04F3;
    /// (ln(1 + f) − f + f²/2)/f³ on √½ ≤ 1 + f < √2, minimax in the relative error of ln: 3.2e-8.
    const P: [f32; 7] =
        [0.333_339_1, -0.250_013_38, 0.199_630_63, -0.165_775_9, 0.149_147_7, -0.142_674_54, 0.087_003_83];

    let scaled = word as f32 + 0.5;
    // scaled = 2^exponent · mantissa with √½ ≤ mantissa < √2.
    let shifted = scaled.to_bits().wrapping_sub(SQRT_HALF);
    let exponent = ((shifted as i32) >> 23) - 32;
    let f = f32::from_bits((shifted & 0x007F_FFFF) + SQRT_HALF) - 1.0;

    let f2 = f * f;
    // Estrin's scheme: half the depth of Horner's.
    let p01 = P[0] + P[1] * f;
    let p23 = P[2] + P[3] * f;
    let p45 = P[4] + P[5] * f;
    let p456 = p45 + P[6] * f2;
    let p = p01 + (p23 + p456 * f2) * f2;
    let tail = p * (f2 * f) - 0.5 * f2;
    exponent as f32 * core::f32::consts::LN_2 + (f + tail)
}

/// Sine and cosine of π/2 · `quarter` / 2³², an angle in [−π/4, π/4], with errors below 1.3e-7 of the value.
#[allow(clippy::inline_always, reason = "target features reach only what is inlined")]
#[inline(always)]
fn sin_cos_quarter(quarter: i32) -> (f32, f32) {
    /// sin(π/2·x)/x in x² on |x| ≤ ½, minimax in the relative error: 3.3e-9.
    const S: [f32; 4] = [1.570_796_4, -0.645_963_5, 0.079_680_03, -0.004_601_658];
    /// (cos(π/2·x) − 1)/x² in x² on |x| ≤ ½, minimax in the relative error of cos: 3.9e-8.
    const C: [f32; 3] = [-1.233_697_7, 0.253_603_22, -0.020_417_282];

    let x = quarter as f32 * (1.0 / 4_294_967_296.0);
    let x2 = x * x;
    let sin = x * (S[0] + x2 * (S[1] + x2 * (S[2] + x2 * S[3])));
    let cos = 1.0 + x2 * (C[0] + x2 * (C[1] + x2 * C[2]));
    (sin, cos)
}

/// √x, correctly rounded, as IEEE 754 asks: the same bits with and without `std`, with which it is one
/// instruction.
#[allow(clippy::inline_always, reason = "target features reach only what is inlined")]
#[inline(always)]
fn square_root(x: f32) -> f32 {
    #[cfg(feature = "std")]
    return x.sqrt();
    #[cfg(not(feature = "std"))]
    return libm::sqrtf(x);
}
