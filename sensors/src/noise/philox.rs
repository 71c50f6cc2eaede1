//! Philox4x32: a keyed bijection on 128 bits whose outputs for the counters 0, 1, 2, … are random numbers.
//!
//! J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011,
//! doi:10.1145/2063384.2063405. Seven rounds are the fewest that passed `BigCrush`, and what this crate's noise uses;
//! ten are the authors' recommendation for those who want a margin. The number of rounds is a parameter of the
//! functions here.

/// The multipliers of words 0 and 2 (Salmon 2011, table 2).
const MULTIPLIERS: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
/// What is added to the key after each round: the golden ratio and √3 − 1 in 32 bits.
const KEY_STEPS: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];

/// One block: four random words of `counter` under `key`.
///
/// ```
/// use belvedere_sensors::noise::philox4x32;
/// // The authors' known answers for seven rounds and for ten.
/// assert_eq!(philox4x32::<7>([0; 4], [0; 2]), [0x5f6f_b709, 0x0d89_3f64, 0x4f12_1f81, 0x4f73_0a48]);
/// assert_eq!(philox4x32::<10>([0; 4], [0; 2]), [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);
/// ```
#[must_use]
#[inline]
pub fn philox4x32<const ROUNDS: usize>(counter: [u32; 4], key: [u32; 2]) -> [u32; 4] {
    philox4x32_lanes::<ROUNDS, 1>(counter.map(|word| [word]), key).map(|[word]| word)
}

/// `LANES` blocks at once under one key: lane i of the four results is the block of lane i of the four
/// counter words. Called inside a `vectorize` context it compiles to that context's vector instructions.
#[must_use]
#[allow(clippy::inline_always, reason = "target features reach only what is inlined")]
#[inline(always)]
pub fn philox4x32_lanes<const ROUNDS: usize, const LANES: usize>(
    counter: [[u32; LANES]; 4],
    key: [u32; 2],
) -> [[u32; LANES]; 4] {
    // Each 32-bit word lives in a 64-bit lane and only its low half counts: the low half is what a widening
    // multiplication reads, so products need neither packing nor masking between rounds.
    // Plain loops, not `map`, which is a function that may stay outside the caller's target features.
    let [mut c0, mut c1, mut c2, mut c3] = [[0; LANES]; 4];
    for lane in 0..LANES {
        c0[lane] = u64::from(counter[0][lane]);
        c1[lane] = u64::from(counter[1][lane]);
        c2[lane] = u64::from(counter[2][lane]);
        c3[lane] = u64::from(counter[3][lane]);
    }
    let [mut key0, mut key1] = key;
    for _ in 0..ROUNDS {
        for lane in 0..LANES {
            let product0 = low(c0[lane]) * u64::from(MULTIPLIERS[0]);
            let product1 = low(c2[lane]) * u64::from(MULTIPLIERS[1]);
            c0[lane] = (product1 >> 32) ^ c1[lane] ^ u64::from(key0);
            c1[lane] = product1;
            c2[lane] = (product0 >> 32) ^ c3[lane] ^ u64::from(key1);
            c3[lane] = product0;
        }
        key0 = key0.wrapping_add(KEY_STEPS[0]);
        key1 = key1.wrapping_add(KEY_STEPS[1]);
    }
    let mut words = [[0; LANES]; 4];
    for lane in 0..LANES {
        words[0][lane] = c0[lane] as u32;
        words[1][lane] = c1[lane] as u32;
        words[2][lane] = c2[lane] as u32;
        words[3][lane] = c3[lane] as u32;
    }
    words
}

#[allow(clippy::inline_always, reason = "target features reach only what is inlined")]
#[inline(always)]
const fn low(word: u64) -> u64 {
    word & 0xFFFF_FFFF
}
