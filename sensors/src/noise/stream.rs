//! The mapping from samples to random words.

use super::philox::{philox4x32, philox4x32_of_eight};
use fearless_simd::{Simd, SimdBase, u32x16, u64x8};

/// The bit of counter 0 that is set for uniform words and clear for normals.
const UNIFORM: u32 = 1 << 31;

/// Rounds of Philox for every sample: the fewest that pass `BigCrush`, and a third less work than ten.
const ROUNDS: usize = 7;

/// The random numbers of one channel of one frame of one sensor: uniform numbers, and normals
/// ([`standard_normal`](super::standard_normal)) that are independent of them and of each other.
///
/// A sample is named by (seed, sensor, frame, channel, index). These numbers are laid out unhashed in Philox's inputs,
/// so two different names never share an input:
///
/// | input | bits 0–15 | bits 16–31 |
/// |---|---|---|
/// | counter 0 | bits 0–30: number of a block of four words, see below; bit 31: 1 for uniform, 0 for normal | |
/// | counter 1 | frame 0–31 | |
/// | counter 2 | channel | seed 32–47 |
/// | counter 3 | frame 32–47 | seed 48–63 |
/// | key 0 | seed 0–31 | |
/// | key 1 | sensor | |
///
/// Uniform words: sample 16·b + 4·w + c is word w of counter 2³¹ + 4·b + c, so a block of 16 samples takes four
/// counters. Bit 31 separates uniform words from normals, so the uniform numbers and the normals of one stream have no
/// word in common.
///
/// Normals: each word makes two, z⁰ and z¹. A block of 16 samples takes the two counters 2·b and 2·b + 1. Their words 1
/// and 0 are lanes 0 and 1 (counter 2·b) and 2 and 3 (counter 2·b + 1) of a first vector; their words 3 and 2 are those
/// of a second. Sample 16·b + c is z⁰ of lane c of the first vector, sample 16·b + 4 + c its z¹; the last eight samples
/// come from the second vector in the same way. Normals of one kind are therefore contiguous, which suits vector
/// stores.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Stream {
    /// The seed of the simulation.
    pub seed: u64,
    /// Number of the sensor in the simulation.
    pub sensor: u32,
    /// Number of the sensor's frame. Only the low 48 bits are used, which last 8900 years at 1 kHz.
    pub frame: u64,
    /// Purpose of the random numbers within the frame: additive noise, dropout, … The sensors of this crate draw
    /// from the channels in [`Stream::TAKEN`]; all others are free, even with the seed and number of one of these
    /// sensors.
    pub channel: u16,
}

impl Stream {
    /// The channel of a camera's colour noise: one sample per pixel, in tiles of 16 × 4 pixels.
    pub const COLOUR: u16 = 0;
    /// The channel of a depth camera's depth noise, in the layout of [`Stream::COLOUR`].
    pub const DEPTH: u16 = 1;
    /// The channel of a lidar's range noise.
    pub const RANGE: u16 = 2;
    /// The first of three channels of photon shot noise in a camera's device, one for each colour.
    pub const SHOT: u16 = 3;
    /// The first of three channels of small electron counts in a camera's device, one for each colour.
    pub const COUNT: u16 = 6;
    /// The first of three channels of read noise in a camera's device, where it is drawn separately, one for each
    /// colour.
    pub const READ: u16 = 9;
    /// The first of three channels of the fixed pattern of a device's response, one for each colour. The pattern is
    /// drawn in frame 0.
    pub const RESPONSE: u16 = 12;
    /// The first of three channels of the fixed pattern of a device's dark signal, one for each colour. The pattern is
    /// drawn in frame 0.
    pub const DARK: u16 = 15;
    /// The first of the channels of a sensor with several instruments, such as gyroscope and accelerometer:
    /// consecutive, one for each instrument.
    pub const INSTRUMENT: u16 = 18;
    /// The first of two channels of the lateral noise of a depth camera, the offsets of a pixel's ray to the right and
    /// down, in the layout of [`Stream::COLOUR`].
    pub const SHIFT: u16 = 64;
    /// The channel of the dot pattern that structured light projects, which is drawn in frame 0.
    pub const DOTS: u16 = 66;
    /// The first channel of the phase noise of a time-of-flight camera, one for each modulation frequency, in the
    /// layout of [`Stream::COLOUR`].
    pub const PHASE: u16 = 67;
    /// The first channel of the drops in the beams of a scanner's firings: their number, sizes and positions.
    pub const DROPS: u16 = 70;
    /// The channel of the pixels that stereo matching finds, in the layout of [`Stream::COLOUR`].
    pub const MATCH: u16 = 72;
    /// The channel of crosstalk from other lidars in a scanner's firings.
    pub const CROSSTALK: u16 = 73;
    /// The channel of biases, which are drawn once per sensor, in frame 0.
    pub const BIAS: u16 = 0xFFF0;
    /// The channel of the signs of the biases.
    pub const BIAS_SIGN: u16 = 0xFFF1;
    /// The channels from which this crate's sensors and noise models draw.
    #[rustfmt::skip]
    pub const TAKEN: [u16; 32] = [
        0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 64, 65, 66, 67, 68, 69, 70, 71, 72, 73, Self::BIAS, Self::BIAS_SIGN,
    ];

    /// Returns the random word of sample `index`, uniform on all of `u32`.
    #[must_use]
    #[inline]
    pub fn word(&self, index: u32) -> u32 {
        let (block, word, lane) = (index / 16, index / 4 % 4, index % 4);
        philox4x32::<ROUNDS>(self.counter(UNIFORM | (4 * block + lane)), self.key())[word as usize]
    }

    /// Returns sample `index` as a uniform number in (0, 1): the centre of one of 2²³ equal cells, so that neither end
    /// occurs and the mean is exactly ½.
    #[must_use]
    #[inline]
    pub fn uniform(&self, index: u32) -> f32 {
        ((self.word(index) >> 9) as f32 + 0.5) * (1.0 / (1_u32 << 23) as f32)
    }

    /// The words for the normals of four blocks: lane 4·b + c is lane c of `blocks[b]`. Block numbers wrap at 2³⁰.
    #[inline(always)]
    pub(super) fn words_of_blocks<S: Simd>(&self, simd: S, blocks: [u32; 4]) -> [u32x16<S>; 2] {
        let mut counters = [0; 8];
        for (b, block) in blocks.into_iter().enumerate() {
            let first = (block << 1) & !UNIFORM;
            counters[2 * b] = u64::from(first);
            counters[2 * b + 1] = u64::from(first | 1);
        }
        self.words_at(simd, counters)
    }

    /// The uniform words of the samples of four blocks, in the order of the samples.
    #[inline(always)]
    pub(crate) fn words64<S: Simd>(&self, simd: S, blocks: [u32; 4]) -> [u32; 64] {
        let mut ordered = [0; 64];
        for (half, blocks) in blocks.as_chunks::<2>().0.iter().enumerate() {
            let mut counters = [0; 8];
            for (i, counter) in counters.iter_mut().enumerate() {
                *counter = u64::from(UNIFORM | ((blocks[i / 4] << 2) + i as u32 % 4));
            }
            let [first, second] = self.words_at(simd, counters);
            let words: [[u32; 16]; 2] = [first.into(), second.into()];
            for i in 0..8 {
                for w in 0..4 {
                    ordered[32 * half + 16 * (i / 4) + 4 * w + i % 4] = words[w / 2][2 * i + 1 - w % 2];
                }
            }
        }
        ordered
    }

    #[inline(always)]
    fn words_at<S: Simd>(&self, simd: S, counters: [u64; 8]) -> [u32x16<S>; 2] {
        let [_, c1, c2, c3] = self.counter(0);
        let counters = u64x8::load_array(simd, counters);
        philox4x32_of_eight::<S, ROUNDS>(simd, counters, [c1, c2, c3], self.key())
    }

    #[inline]
    const fn counter(&self, counter: u32) -> [u32; 4] {
        let seed_high = (self.seed >> 32) as u32;
        [
            counter,
            self.frame as u32,
            (seed_high << 16) | self.channel as u32,
            (seed_high & 0xFFFF_0000) | ((self.frame >> 32) as u32 & 0xFFFF),
        ]
    }

    #[inline]
    const fn key(&self) -> [u32; 2] {
        [self.seed as u32, self.sensor]
    }
}
