//! Which random words belong to which sample.
//!
//! A sample is named by (seed, sensor, frame, channel, index). These are laid out in Philox's inputs as they
//! are, nothing is hashed, so two different names never share an input:
//!
//! | input | bits 0–15 | bits 16–31 |
//! |---|---|---|
//! | counter 0 | index / 4, in the order below | |
//! | counter 1 | frame 0–31 | |
//! | counter 2 | channel | seed 32–47 |
//! | counter 3 | frame 32–47 | seed 48–63 |
//! | key 0 | seed 0–31 | |
//! | key 1 | sensor | |
//!
//! Every block of 16 samples takes four counters of four words. Sample 16·b + 4·w + c is word w of counter
//! 4·b + c: the words of one kind lie side by side, as vectors want them. There are 2³⁰ blocks, of which the indices of
//! samples reach the first quarter.

use super::philox::{philox4x32, philox4x32_lanes};

/// Rounds of Philox behind every sample: the fewest that pass `BigCrush`, and a third less work than ten.
const ROUNDS: usize = 7;

/// The random numbers of one channel of one frame of one sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Stream {
    /// The seed of the simulation.
    pub seed: u64,
    /// Which sensor of the simulation.
    pub sensor: u32,
    /// Which frame of the sensor; the low 48 bits count, which are 8900 years at 1 kHz.
    pub frame: u64,
    /// Which use of random numbers within the frame: additive noise, dropout, … The sensors of this crate draw from the
    /// channels in [`Stream::TAKEN`]; all others are free, also of a sensor's own seed and number.
    pub channel: u16,
}

impl Stream {
    /// The channel of a camera's colours: a sample for each pixel, of tiles of 16 × 4.
    pub const COLOUR: u16 = 0;
    /// The channel of a depth camera's depths, as [`Stream::COLOUR`].
    pub const DEPTH: u16 = 1;
    /// The channel of a lidar's ranges.
    pub const RANGE: u16 = 2;
    /// The channel of the noise of light in a camera's device, and the two after it: one for each colour.
    pub const SHOT: u16 = 3;
    /// The channels of counts of few electrons in a camera's device, as [`Stream::SHOT`].
    pub const COUNT: u16 = 6;
    /// The channels of the noise of reading in a camera's device, where it is drawn apart, as [`Stream::SHOT`].
    pub const READ: u16 = 9;
    /// The channels of a device's fixed patterns, which are those of frame 0, as [`Stream::SHOT`].
    pub const PATTERN: u16 = 12;
    /// The channel of biases, which are drawn once per sensor, in frame 0.
    pub const BIAS: u16 = 0xFFF0;
    /// The channel of the signs of the biases.
    pub const BIAS_SIGN: u16 = 0xFFF1;
    /// The channels that this crate's sensors and noise models draw from.
    pub const TAKEN: [u16; 17] =
        [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, Self::BIAS, Self::BIAS_SIGN];

    /// The random word of sample `index`, uniform on all of `u32`.
    #[must_use]
    #[inline]
    pub fn word(&self, index: u32) -> u32 {
        let (block, word, lane) = (index / 16, index / 4 % 4, index % 4);
        philox4x32::<ROUNDS>(self.counter(4 * block + lane), self.key())[word as usize]
    }

    /// Sample `index` as a uniform number in (0, 1): the centre of one of 2²³ equal cells, so that neither end
    /// occurs and the mean is exactly ½.
    #[must_use]
    #[inline]
    pub fn uniform(&self, index: u32) -> f32 {
        ((self.word(index) >> 9) as f32 + 0.5) * (1.0 / (1_u32 << 23) as f32)
    }

    /// The words of `LANES` consecutive counters from `first_counter` on: `[w][c]` is word w of counter
    /// `first_counter` + c, where 0 follows 2³² − 1. `LANES` is a multiple of 4 and `first_counter` four times a block
    /// number.
    #[allow(clippy::inline_always, reason = "target features reach only what is inlined")]
    #[inline(always)]
    pub(crate) fn words<const LANES: usize>(&self, first_counter: u32) -> [[u32; LANES]; 4] {
        let mut c0 = [first_counter; LANES];
        for (lane, counter) in c0.iter_mut().enumerate() {
            *counter = counter.wrapping_add(lane as u32);
        }
        self.words_at(c0)
    }

    /// The words of four blocks: `[w][4·b + c]` is sample 4·w + c of `blocks[b]`.
    #[allow(clippy::inline_always, reason = "target features reach only what is inlined")]
    #[inline(always)]
    pub(super) fn words_of_blocks(&self, blocks: [u32; 4]) -> [[u32; 16]; 4] {
        let mut c0 = [0; 16];
        for (b, block) in blocks.into_iter().enumerate() {
            for c in 0..4 {
                c0[4 * b + c] = block.wrapping_mul(4).wrapping_add(c as u32);
            }
        }
        self.words_at(c0)
    }

    /// The words of the samples of four blocks, in the order of the samples.
    #[allow(clippy::inline_always, reason = "target features reach only what is inlined")]
    #[inline(always)]
    pub(crate) fn words64(&self, blocks: [u32; 4]) -> [u32; 64] {
        let words = self.words_of_blocks(blocks);
        let mut ordered = [0; 64];
        for (sample, ordered) in ordered.iter_mut().enumerate() {
            *ordered = words[sample / 4 % 4][sample / 16 * 4 + sample % 4];
        }
        ordered
    }

    #[allow(clippy::inline_always, reason = "target features reach only what is inlined")]
    #[inline(always)]
    fn words_at<const LANES: usize>(&self, c0: [u32; LANES]) -> [[u32; LANES]; 4] {
        let [_, c1, c2, c3] = self.counter(0);
        philox4x32_lanes::<ROUNDS, LANES>([c0, [c1; LANES], [c2; LANES], [c3; LANES]], self.key())
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
