//! Philox4x32: a keyed bijection on 128 bits whose outputs for the counters 0, 1, 2, … are random numbers.

use fearless_simd::{Bytes, Simd, SimdBase, u32x16, u64x8};

/// The multipliers of words 0 and 2 (Salmon 2011, table 2).
const MULTIPLIERS: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
/// Added to the key after each round: the golden ratio and √3 − 1 in 32 bits.
const KEY_STEPS: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];

/// Returns one block: the four random words for `counter` under `key`.
///
/// J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011,
/// doi:10.1145/2063384.2063405. Seven rounds are the fewest that passed `BigCrush`, and this crate's noise uses seven;
/// the authors recommend ten for a safety margin. The number of rounds is a parameter of the functions here.
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
    let ([mut c0, mut c1, mut c2, mut c3], [mut key0, mut key1]) = (counter, key);
    for _ in 0..ROUNDS {
        let product0 = u64::from(c0) * u64::from(MULTIPLIERS[0]);
        let product1 = u64::from(c2) * u64::from(MULTIPLIERS[1]);
        c0 = (product1 >> 32) as u32 ^ c1 ^ key0;
        c1 = product1 as u32;
        c2 = (product0 >> 32) as u32 ^ c3 ^ key1;
        c3 = product0 as u32;
        key0 = key0.wrapping_add(KEY_STEPS[0]);
        key1 = key1.wrapping_add(KEY_STEPS[1]);
    }
    [c0, c1, c2, c3]
}

/// Computes the blocks of eight counters that differ only in their first words, all under the same key. For the block
/// of counter i, words 1 and 0 are lanes 2i and 2i + 1 of the first result, words 3 and 2 those of the second.
///
/// Each word has a 64-bit lane of which only the low half is used: a widening multiplication reads only the low half,
/// so products need neither packing nor masking between rounds. The last round leaves words in both halves.
#[inline(always)]
pub(super) fn philox4x32_of_eight<S: Simd, const ROUNDS: usize>(
    simd: S,
    first_words: u64x8<S>,
    [c1, c2, c3]: [u32; 3],
    [mut key0, mut key1]: [u32; 2],
) -> [u32x16<S>; 2] {
    let mut c0 = first_words;
    let [mut c1, mut c2, mut c3] = [word(simd, c1), word(simd, c2), word(simd, c3)];
    for _ in 1..ROUNDS {
        let (product0, product1) = (times(simd, c0, MULTIPLIERS[0]), times(simd, c2, MULTIPLIERS[1]));
        c0 = (product1 >> 32) ^ (c1 ^ word(simd, key0));
        c1 = product1;
        c2 = (product0 >> 32) ^ (c3 ^ word(simd, key1));
        c3 = product0;
        key0 = key0.wrapping_add(KEY_STEPS[0]);
        key1 = key1.wrapping_add(KEY_STEPS[1]);
    }
    let (product0, product1) = (times(simd, c0, MULTIPLIERS[0]), times(simd, c2, MULTIPLIERS[1]));
    let (upper1, upper3) = (c1 ^ word(simd, key0), c3 ^ word(simd, key1));
    [(product1 ^ (upper1 << 32)).bitcast(), (product0 ^ (upper3 << 32)).bitcast()]
}

/// Broadcasts a word to all lanes.
#[inline(always)]
fn word<S: Simd>(simd: S, word: u32) -> u64x8<S> {
    u64x8::splat(simd, u64::from(word))
}

/// The products of the low halves with the multiplier.
#[inline(always)]
fn times<S: Simd>(simd: S, words: u64x8<S>, multiplier: u32) -> u64x8<S> {
    (words & word(simd, u32::MAX)) * word(simd, multiplier)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{best_level, dispatch};

    #[test]
    fn eight_at_once() {
        let (firsts, rest, key) =
            ([0, 1, 2, 77, u32::MAX, 1 << 31, 12345, 4], [6, 7, u32::MAX], [8, u32::MAX]);
        let words: [[u32; 16]; 2] = dispatch!(best_level(), simd => {
            let firsts = u64x8::load_array(simd, firsts.map(u64::from));
            philox4x32_of_eight::<_, 7>(simd, firsts, rest, key).map(<[u32; 16]>::from)
        });
        for (i, first) in firsts.into_iter().enumerate() {
            let block = philox4x32::<7>([first, rest[0], rest[1], rest[2]], key);
            let lanes = 2 * i..2 * i + 2;
            assert_eq!(
                [&words[0][lanes.clone()], &words[1][lanes]],
                [[block[1], block[0]], [block[3], block[2]]]
            );
        }
    }
}
