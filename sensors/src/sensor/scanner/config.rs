//! What a scanner is like.

use super::error::ScannerError;
use super::pattern::Pattern;
use crate::noise::GaussianNoise;
use crate::scene::visibility;
use crate::trace::Faces;

/// The longest time of a frame: an hour.
const MOST_NS: u64 = 3_600_000_000_000;

/// What a scanner is like.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ScannerConfig<'a> {
    /// Which way it fires, from where, and when.
    pub pattern: Pattern<'a>,
    /// From a frame to the next, in nanoseconds: of a head that turns, the time of a turn.
    pub frame_time_ns: u64,
    /// Smallest range in metres, at least 0. What is nearer is not measured, and hides what is behind it.
    pub range_min_m: f64,
    /// Largest range in metres, more than the smallest.
    pub range_max_m: f64,
    /// Which instances it sees: those that have a bit of it in common; see [`visibility`].
    pub visibility: u32,
    /// Which sides of their surfaces.
    pub faces: Faces,
    /// Noise of each range.
    pub noise: GaussianNoise,
    /// Seed of the simulation.
    pub seed: u64,
    /// Number of the sensor in the simulation.
    pub sensor: u32,
}

impl<'a> ScannerConfig<'a> {
    /// Ten frames a second, seen from 0 to 100 m without noise, of seed and number 0. Both sides of collision shapes are hit.
    pub const fn new(pattern: Pattern<'a>) -> Self {
        Self {
            pattern,
            frame_time_ns: 100_000_000,
            range_min_m: 0.0,
            range_max_m: 100.0,
            visibility: visibility::COLLISION,
            faces: Faces::Both,
            noise: GaussianNoise::NONE,
            seed: 0,
            sensor: 0,
        }
    }

    setters! {
        /// Sets which way it fires, from where, and when.
        pattern: Pattern<'a>,
        /// Sets the time from a frame to the next, in nanoseconds.
        frame_time_ns: u64,
        /// Sets the smallest range, in metres.
        range_min_m: f64,
        /// Sets the largest range, in metres.
        range_max_m: f64,
        /// Sets which instances it sees.
        visibility: u32,
        /// Sets which sides of surfaces it sees.
        faces: Faces,
        /// Sets the noise of each range.
        noise: GaussianNoise,
        /// Sets the seed of the simulation.
        seed: u64,
        /// Sets the number of the sensor in the simulation.
        sensor: u32,
    }

    /// Whether there can be such a scanner.
    ///
    /// # Errors
    /// Names the first parameter that is out of its range.
    pub fn check(&self) -> Result<(), ScannerError> {
        let wrong = |parameter, value, rule| Err(ScannerError { parameter, index: None, value, rule });
        if !(1..=MOST_NS).contains(&self.frame_time_ns) {
            return wrong("frame_time_ns", self.frame_time_ns as f64, "1 up to an hour");
        }
        if !(0.0..f64::INFINITY).contains(&self.range_min_m) {
            return wrong("range_min_m", self.range_min_m, "0 or more, and finite");
        }
        if self.range_max_m.is_nan() || self.range_max_m <= self.range_min_m {
            return wrong("range_max_m", self.range_max_m, "more than range_min_m");
        }
        self.pattern.check(self.frame_time_ns)
    }
}
