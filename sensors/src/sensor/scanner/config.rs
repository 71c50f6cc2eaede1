//! What a scanner is like.

use super::beam::{Beam, Halo};
use super::crosstalk::Crosstalk;
use super::intensity::{Intensity, Receiver};
use super::pattern::Pattern;
use super::returns::Returns;
use super::weather::Weather;
use crate::ParameterError;
use crate::noise::GaussianNoise;
use crate::scene::visibility;
use crate::trace::Faces;

/// The longest time of a frame: an hour.
const MOST_NS: u64 = 3_600_000_000_000;

/// How much ranges from some distance on vary besides their noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// From this range on, in metres.
    pub from_m: f64,
    /// Standard deviation of a range r in metres: the first is of it as a whole, the second a metre, the third a metre
    /// squared; σ = a + b·r + c·r².
    pub stddev: [f64; 3],
}

impl Spread {
    /// That of the last of some that begins before a range, in metres.
    #[inline(always)]
    pub(super) fn stddev_at(spreads: &[Self], range_m: f64) -> f64 {
        let mut stddev = 0.0;
        for spread in spreads {
            if spread.from_m <= range_m {
                let [a, b, c] = spread.stddev;
                stddev = a + (b + c * range_m) * range_m;
            }
        }
        stddev
    }
}

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
    /// What depends on the range of it, nearest first: variances add.
    pub spreads: &'a [Spread],
    /// How wide its beams are.
    pub beam: Beam,
    /// What light there is beside them.
    pub halo: Halo,
    /// What is heard of other lidars.
    pub crosstalk: Crosstalk,
    /// How far apart in range what a beam meets is told apart, in metres: half the length of a pulse.
    pub pulse_m: f64,
    /// Which returns of a firing are reported.
    pub returns: Returns,
    /// What is reported as their intensity.
    pub intensity: Intensity,
    /// How little is noticed of what comes back; without one, all is, but for weather, in which it reaches as far as ranges
    /// go.
    pub receiver: Option<Receiver>,
    /// What stands in the air.
    pub weather: Weather,
    /// Seed of the simulation.
    pub seed: u64,
    /// Number of the sensor in the simulation.
    pub sensor: u32,
}

impl<'a> ScannerConfig<'a> {
    /// Ten frames a second, seen from 0 to 100 m without noise, of seed and number 0. Both sides of collision shapes are hit,
    /// by single rays, in clear air; returns are told apart by a metre.
    pub const fn new(pattern: Pattern<'a>) -> Self {
        Self {
            pattern,
            frame_time_ns: 100_000_000,
            range_min_m: 0.0,
            range_max_m: 100.0,
            visibility: visibility::COLLISION,
            faces: Faces::Both,
            noise: GaussianNoise::NONE,
            spreads: &[],
            beam: Beam::RAY,
            halo: Halo::NONE,
            crosstalk: Crosstalk::NONE,
            pulse_m: 1.0,
            returns: Returns::Strongest,
            intensity: Intensity::Retro,
            receiver: None,
            weather: Weather::CLEAR,
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
        /// Sets what depends on the range of it.
        spreads: &'a [Spread],
        /// Sets how wide its beams are.
        beam: Beam,
        /// Sets what light there is beside them.
        halo: Halo,
        /// Sets what is heard of other lidars.
        crosstalk: Crosstalk,
        /// Sets how far apart in range what a beam meets is told apart, in metres.
        pulse_m: f64,
        /// Sets which returns of a firing are reported.
        returns: Returns,
        /// Sets what is reported as their intensity.
        intensity: Intensity,
        /// Sets how little is noticed of what comes back.
        receiver: Option<Receiver>,
        /// Sets what stands in the air.
        weather: Weather,
        /// Sets the seed of the simulation.
        seed: u64,
        /// Sets the number of the sensor in the simulation.
        sensor: u32,
    }

    /// The same with another pattern and other spreads.
    #[cfg(feature = "alloc")]
    pub(crate) fn with_tables<'b>(&self, pattern: Pattern<'b>, spreads: &'b [Spread]) -> ScannerConfig<'b> {
        let Self {
            pattern: _,
            spreads: _,
            frame_time_ns,
            range_min_m,
            range_max_m,
            visibility,
            faces,
            noise,
            beam,
            halo,
            crosstalk,
            pulse_m,
            returns,
            intensity,
            receiver,
            weather,
            seed,
            sensor,
        } = *self;
        ScannerConfig {
            pattern,
            frame_time_ns,
            range_min_m,
            range_max_m,
            visibility,
            faces,
            noise,
            spreads,
            beam,
            halo,
            crosstalk,
            pulse_m,
            returns,
            intensity,
            receiver,
            weather,
            seed,
            sensor,
        }
    }

    /// Whether there can be such a scanner.
    ///
    /// # Errors
    /// Names the first parameter that is out of its range.
    pub fn check(&self) -> Result<(), ParameterError> {
        let wrong = |parameter, value, rule| Err(ParameterError::new("scanner", parameter, value, rule));
        if !(1..=MOST_NS).contains(&self.frame_time_ns) {
            return wrong("frame_time_ns", self.frame_time_ns as f64, "1 up to an hour");
        }
        if !(0.0..f64::INFINITY).contains(&self.range_min_m) {
            return wrong("range_min_m", self.range_min_m, "0 or more, and finite");
        }
        if self.range_max_m.is_nan() || self.range_max_m <= self.range_min_m {
            return wrong("range_max_m", self.range_max_m, "more than range_min_m");
        }
        let mut before = 0.0;
        for (index, spread) in self.spreads.iter().enumerate() {
            let wrong = |parameter, value, rule| {
                Err(ParameterError::new("scanner", parameter, value, rule).at(index))
            };
            if !(before..f64::INFINITY).contains(&spread.from_m) {
                return wrong(
                    "from_m of spread",
                    spread.from_m,
                    "not before that of the one before, and finite",
                );
            }
            if let Some(value) = spread.stddev.into_iter().find(|value| !(0.0..f64::INFINITY).contains(value))
            {
                return wrong("stddev of spread", value, "0 or more, and finite");
            }
            before = spread.from_m;
        }
        self.beam.check()?;
        self.halo.check()?;
        self.crosstalk.check(self.range_max_m)?;
        if !(0.0..f64::INFINITY).contains(&self.pulse_m) {
            return wrong("pulse_m", self.pulse_m, "0 or more, and finite");
        }
        self.returns.check()?;
        self.weather.check()?;
        if self.weather != Weather::CLEAR && self.receiver.is_none() && self.range_max_m == f64::INFINITY {
            return wrong("range_max_m", self.range_max_m, "finite in weather, or there must be a receiver");
        }
        if let Some(receiver) = &self.receiver {
            receiver.check()?;
        }
        if let Some(receiver) = self.effective_receiver() {
            self.weather.check_drops(&self.beam, receiver.least())?;
        }
        self.pattern.check(self.frame_time_ns)
    }

    /// The receiver that there is, if not all is noticed.
    pub(super) fn effective_receiver(&self) -> Option<Receiver> {
        self.receiver.or((self.weather != Weather::CLEAR).then_some(Receiver::new(self.range_max_m)))
    }
}
