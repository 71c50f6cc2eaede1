//! The configuration of a scanner.

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

/// Additional range noise that depends on the range.
///
/// It applies from [`Spread::from_m`] on, until the next spread begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// The range from which on this noise applies, in metres.
    pub from_m: f64,
    /// The coefficients a, b and c of the standard deviation in metres, σ = a + b·r + c·r², at a range of r metres.
    /// Their units are m, 1 and 1/m.
    pub stddev: [f64; 3],
}

impl Spread {
    /// Returns the standard deviation at a range in metres: that of the last spread that begins at or before it.
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

/// The configuration of a scanner.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ScannerConfig<'a> {
    /// The firing pattern: direction, origin and time of each firing.
    pub pattern: Pattern<'a>,
    /// The time from one frame to the next, in nanoseconds. For a spinning head it is the time of one turn. The default
    /// is 100,000,000 (ten frames per second).
    pub frame_time_ns: u64,
    /// The smallest range in metres, at least 0. Nearer surfaces are not measured, but hide those behind them. The
    /// default is 0.
    pub range_min_m: f64,
    /// The largest range in metres, greater than the smallest. The default is 100.
    pub range_max_m: f64,
    /// A bit mask of the instances that are visible: those whose own mask has a bit in common with this one; see
    /// [`visibility`]. The default is [`visibility::COLLISION`].
    pub visibility: u32,
    /// The sides of surfaces that are visible. The default is [`Faces::Both`].
    pub faces: Faces,
    /// Noise of each range. The default is [`GaussianNoise::NONE`].
    pub noise: GaussianNoise,
    /// Additional range noise that depends on the range, ordered by increasing distance. Its variance adds to that of
    /// `noise`. The default is an empty list.
    pub spreads: &'a [Spread],
    /// The size of the beams and the rays that sample them. The default is [`Beam::RAY`].
    pub beam: Beam,
    /// Stray light around the beams, which makes retroreflectors bloom. The default is [`Halo::NONE`].
    pub halo: Halo,
    /// Pulses received from other lidars. The default is [`Crosstalk::NONE`].
    pub crosstalk: Crosstalk,
    /// The smallest range difference at which two surfaces in a beam give separate returns, in metres: half the length
    /// of a pulse. The default is 1.
    pub pulse_m: f64,
    /// The returns that are reported for each firing. The default is [`Returns::Strongest`].
    pub returns: Returns,
    /// The quantity that is reported as the intensity of a return. The default is [`Intensity::Retro`].
    pub intensity: Intensity,
    /// The receiver, which detects returns above a threshold. With `None`, all returns are detected; only in weather, a
    /// receiver whose reach is the largest range is assumed. The default is `None`.
    pub receiver: Option<Receiver>,
    /// The weather: fog, rain and snow. The default is [`Weather::CLEAR`].
    pub weather: Weather,
    /// The seed of the simulation. The default is 0.
    pub seed: u64,
    /// The number of the sensor in the simulation. The default is 0.
    pub sensor: u32,
}

impl<'a> ScannerConfig<'a> {
    /// Creates a configuration with ten frames per second and ranges from 0 to 100 m, without noise, with seed and
    /// sensor number 0.
    ///
    /// Beams are single rays in clear air, and hit both sides of collision shapes. Surfaces 1 m apart give separate
    /// returns.
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
        /// Sets the firing pattern.
        pattern: Pattern<'a>,
        /// Sets the time from one frame to the next, in nanoseconds.
        frame_time_ns: u64,
        /// Sets the smallest range, in metres.
        range_min_m: f64,
        /// Sets the largest range, in metres.
        range_max_m: f64,
        /// Sets which instances are visible.
        visibility: u32,
        /// Sets which sides of surfaces are visible.
        faces: Faces,
        /// Sets the noise of each range.
        noise: GaussianNoise,
        /// Sets the additional range noise that depends on the range.
        spreads: &'a [Spread],
        /// Sets the size of the beams and the rays that sample them.
        beam: Beam,
        /// Sets the stray light around the beams.
        halo: Halo,
        /// Sets the pulses received from other lidars.
        crosstalk: Crosstalk,
        /// Sets the smallest range difference at which two surfaces in a beam give separate returns, in metres.
        pulse_m: f64,
        /// Sets the returns that are reported for each firing.
        returns: Returns,
        /// Sets the quantity that is reported as the intensity of a return.
        intensity: Intensity,
        /// Sets the receiver.
        receiver: Option<Receiver>,
        /// Sets the weather.
        weather: Weather,
        /// Sets the seed of the simulation.
        seed: u64,
        /// Sets the number of the sensor in the simulation.
        sensor: u32,
    }

    /// Returns the same configuration with another pattern and other spreads.
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

    /// Checks the configuration.
    ///
    /// # Errors
    /// Returns a [`ParameterError`] that names the first parameter out of range.
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
                    "finite, and not less than that of the previous spread",
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
            return wrong("range_max_m", self.range_max_m, "finite where there is weather and no receiver");
        }
        if let Some(receiver) = &self.receiver {
            receiver.check()?;
        }
        if let Some(receiver) = self.effective_receiver() {
            self.weather.check_drops(&self.beam, receiver.least())?;
        }
        self.pattern.check(self.frame_time_ns)
    }

    /// Returns the receiver that applies, or `None` if all returns are detected.
    pub(super) fn effective_receiver(&self) -> Option<Receiver> {
        self.receiver.or((self.weather != Weather::CLEAR).then_some(Receiver::new(self.range_max_m)))
    }
}
