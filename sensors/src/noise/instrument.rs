//! Error models of instruments: gyroscopes, accelerometers, magnetometers, barometers, satellite receivers.

use super::{Stream, fill_standard_normal};
use crate::ParameterError;
use crate::simd::best_level;

/// Errors of an instrument with `N` axes, in the unit of the measured quantity. By default there are none.
///
/// ```
/// use belvedere_sensors::noise::{Instrument, InstrumentConfig, InstrumentState, Stream};
/// let gyro = Instrument::new(InstrumentConfig::<3>::default().density([1e-4; 3]).bias_mean([0.01; 3]))?;
/// let stream = Stream { seed: 1, sensor: 0, frame: 0, channel: 100 };
/// let mut state = gyro.start(&stream);
/// let read = gyro.measure([0.0, 0.0, 0.5], 0.01, &stream, &mut state);
/// assert!((read[2].abs() - 0.5).abs() < 0.02 && read[2] != 0.5); // 1e-4/√0.01 = 1e-3 beside a bias of ±0.01
/// # Ok::<(), belvedere_sensors::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct InstrumentConfig<const N: usize> {
    /// Sensitivity matrix, row by row: what each axis reads per unit along each axis. The default is the identity.
    pub sensitivity: [[f64; N]; N],
    /// Mean of the noise. The default is 0.
    pub mean: [f64; N],
    /// Standard deviation of white noise per sample, independent of the rate. The default is 0.
    pub stddev: [f64; N],
    /// White noise density in units/√Hz. The default is 0.
    pub density: [f64; N],
    /// Mean of the bias of a run. The sign of the bias is flipped with probability ½ for each axis, as in SDF; for a
    /// bias of known sign, set `mean`. The default is 0.
    pub bias_mean: [f64; N],
    /// Standard deviation of the bias of a run. The default is 0.
    pub bias_stddev: [f64; N],
    /// Density of the white noise that drives the drifting bias, in units/s/√Hz. The default is 0.
    pub drift: [f64; N],
    /// Correlation time of the drifting bias in seconds; infinite for a random walk. The default is infinity.
    pub drift_time_s: [f64; N],
    /// Quantisation step of the output; 0 for none. A value is left unrounded if its nearest step is not a finite
    /// number. The default is 0.
    pub precision: [f64; N],
    /// Outputs are clamped to ± this value. The default is infinity.
    pub limit: f64,
}

impl<const N: usize> Default for InstrumentConfig<N> {
    fn default() -> Self {
        let mut sensitivity = [[0.0; N]; N];
        for axis in 0..N {
            sensitivity[axis][axis] = 1.0;
        }
        Self {
            sensitivity,
            mean: [0.0; N],
            stddev: [0.0; N],
            density: [0.0; N],
            bias_mean: [0.0; N],
            bias_stddev: [0.0; N],
            drift: [0.0; N],
            drift_time_s: [f64::INFINITY; N],
            precision: [0.0; N],
            limit: f64::INFINITY,
        }
    }
}

impl<const N: usize> InstrumentConfig<N> {
    setters! {
        /// Sets the sensitivity matrix, row by row.
        sensitivity: [[f64; N]; N],
        /// Sets the mean of the noise.
        mean: [f64; N],
        /// Sets the standard deviation of white noise per sample.
        stddev: [f64; N],
        /// Sets the white noise density in units/√Hz.
        density: [f64; N],
        /// Sets the mean of the bias of a run.
        bias_mean: [f64; N],
        /// Sets the standard deviation of the bias of a run.
        bias_stddev: [f64; N],
        /// Sets the density of the white noise that drives the drifting bias, in units/s/√Hz.
        drift: [f64; N],
        /// Sets the correlation time of the drifting bias in seconds.
        drift_time_s: [f64; N],
        /// Sets the quantisation step of the output.
        precision: [f64; N],
        /// Sets the limit: outputs are clamped to ± this value.
        limit: f64,
    }

    /// Sets relative scale errors: with 0.01 an axis reads 1 % too much.
    #[must_use]
    pub fn scale_errors(mut self, errors: [f64; N]) -> Self {
        for axis in 0..N {
            self.sensitivity[axis][axis] = 1.0 + errors[axis];
        }
        self
    }

    /// Returns the standard deviation of white noise for samples that are `period_s` apart.
    #[must_use]
    pub fn white_stddev(&self, period_s: f64) -> [f64; N] {
        let mut stddev = self.stddev;
        if period_s > 0.0 {
            for axis in 0..N {
                let of_density = self.density[axis] / libm::sqrt(period_s);
                stddev[axis] = libm::sqrt(stddev[axis] * stddev[axis] + of_density * of_density);
            }
        }
        stddev
    }

    /// Returns true if the instrument has no errors.
    pub fn is_exact(&self) -> bool {
        *self == Self { drift_time_s: self.drift_time_s, ..Self::default() }
    }
}

/// The biases of a running instrument, created by [`Instrument::start`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InstrumentState<const N: usize> {
    /// The bias of the run.
    pub bias: [f64; N],
    /// The drifting bias, after the last frame.
    pub drift: [f64; N],
}

/// An instrument with `N` axes.
///
/// out = quantise(M·in + mean + b₀ + b(t) + w), in the unit of the measured quantity, where
///
/// - M is the sensitivity matrix: 1 + the scale errors on its diagonal, misalignments in radians off the diagonal;
/// - b₀ is a bias that is constant for the whole run, N(bias mean, bias stddev), with its sign flipped with probability
///   ½, as in SDF;
/// - b(t) is a drifting bias: a Gauss–Markov process driven by white noise of density q with correlation time τ,
///   b ← e^(−Δt/τ)·b + N(0, q²·τ/2·(1 − e^(−2Δt/τ))), which is exact for any Δt. With infinite τ it is a random walk
///   with standard deviation q·√t. It starts at 0. SDF calls q `dynamic_bias_stddev`, Kalibr calls it "bias random
///   walk";
/// - w is white noise: one part with a noise density that does not depend on the rate, σ/√Δt per sample, and one part
///   with a fixed standard deviation per sample. Both are drawn as one number.
///
/// In an Allan deviation plot, the noise density is the value at 1 s on the slope of −½. The drifting bias appears, for
/// averaging times T, as q·τ/√T·√(1 − τ/(2T)·(3 − 4e^(−T/τ) + e^(−2T/τ))): a slope of +½ below τ, a maximum of
/// 0.4365·q·√τ at 1.89 τ, and a slope of −½ beyond.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instrument<const N: usize> {
    config: InstrumentConfig<N>,
}

impl<const N: usize> Instrument<N> {
    /// Creates an instrument with the given errors.
    ///
    /// # Errors
    /// Names the first parameter that is not finite or is out of range.
    pub fn new(config: InstrumentConfig<N>) -> Result<Self, ParameterError> {
        Self::named("instrument", config)
    }

    /// Creates an instrument under the name that its errors report.
    pub(crate) fn named(of: &'static str, config: InstrumentConfig<N>) -> Result<Self, ParameterError> {
        type Holds = fn(f64) -> bool;
        let require_all = |parameter, values: &[f64], holds: Holds, rule| {
            let wrong = values.iter().position(|value| !holds(*value));
            wrong.map_or(Ok(()), |axis| Err(ParameterError::new(of, parameter, values[axis], rule).at(axis)))
        };
        let finite = |parameter, values| require_all(parameter, values, f64::is_finite, "a finite number");
        finite("sensitivity", config.sensitivity.as_flattened())?;
        finite("mean", &config.mean)?;
        finite("bias_mean", &config.bias_mean)?;
        let is_spread: Holds = |value| value.is_finite() && value >= 0.0;
        let spread =
            |parameter, values| require_all(parameter, values, is_spread, "a finite number, 0 or more");
        spread("stddev", &config.stddev)?;
        spread("density", &config.density)?;
        spread("bias_stddev", &config.bias_stddev)?;
        spread("drift", &config.drift)?;
        spread("precision", &config.precision)?;
        require_all("drift_time_s", &config.drift_time_s, |time_s| time_s > 0.0, "more than 0")?;
        ParameterError::require(of, "limit", config.limit, config.limit > 0.0, "more than 0")?;
        Ok(Self { config })
    }

    /// The configuration of the instrument.
    pub const fn config(&self) -> &InstrumentConfig<N> {
        &self.config
    }

    /// Starts a run of the instrument and draws its biases from the stream's channel, seed and sensor.
    pub fn start(&self, stream: &Stream) -> InstrumentState<N> {
        // These indices are not used by any frame: frames use indices below 2·N.
        let of_run = Stream { frame: 0, ..*stream };
        let mut normals = [0.0; N];
        fill_standard_normal(best_level(), &of_run, RUN, &mut normals);
        let mut bias = [0.0; N];
        for axis in 0..N {
            let size = self.config.bias_mean[axis] + self.config.bias_stddev[axis] * f64::from(normals[axis]);
            let is_turned = of_run.word(RUN_SIGN + axis as u32) >> 31 == 1;
            bias[axis] = if is_turned { -size } else { size };
        }
        InstrumentState { bias, drift: [0.0; N] }
    }

    /// Returns the reading for `truth` in a frame that comes `period_s` seconds after the previous one.
    ///
    /// `stream` gives the seed, the sensor, the frame and the channel of the instrument. Frames have to be measured in
    /// order, since the drifting bias continues from the last one. If the period is not positive, or if the bias would
    /// not stay finite, the bias does not change.
    pub fn measure(
        &self,
        truth: [f64; N],
        period_s: f64,
        stream: &Stream,
        state: &mut InstrumentState<N>,
    ) -> [f64; N] {
        let config = &self.config;
        let mut normals = [[0.0; N]; 2];
        fill_standard_normal(best_level(), stream, 0, normals.as_flattened_mut());
        let white = config.white_stddev(period_s);
        let mut read = [0.0; N];
        for axis in 0..N {
            state.drift[axis] = self.drifted(axis, state.drift[axis], period_s, normals[1][axis]);
            let mut value = 0.0;
            for part in 0..N {
                value += config.sensitivity[axis][part] * truth[part];
            }
            value += config.mean[axis] + state.bias[axis] + state.drift[axis];
            value += white[axis] * f64::from(normals[0][axis]);
            let precision = config.precision[axis];
            if precision > 0.0 {
                let stepped = libm::round(value / precision) * precision;
                value = if stepped.is_finite() { stepped } else { value };
            }
            read[axis] = value.clamp(-config.limit, config.limit);
        }
        read
    }

    /// The bias of an axis `period_s` after it was `bias`.
    fn drifted(&self, axis: usize, bias: f64, period_s: f64, normal: f32) -> f64 {
        let (drift, time_s) = (self.config.drift[axis], self.config.drift_time_s[axis]);
        if drift == 0.0 || period_s.is_nan() || period_s <= 0.0 {
            return bias;
        }
        let kept = libm::exp(-period_s / time_s);
        let variance =
            if time_s.is_finite() { -0.5 * time_s * libm::expm1(-2.0 * period_s / time_s) } else { period_s };
        let drifted = kept * bias + drift * libm::sqrt(variance) * f64::from(normal);
        if drifted.is_finite() { drifted } else { bias }
    }
}

/// Indices in frame 0 of the first sample of the run's biases, and of their signs.
const RUN: u32 = 1 << 16;
const RUN_SIGN: u32 = 1 << 17;

#[cfg(test)]
mod tests {
    use super::{Instrument, InstrumentConfig, InstrumentState};
    use crate::noise::Stream;

    const STREAM: Stream = Stream { seed: 1, sensor: 0, frame: 0, channel: 100 };

    #[test]
    fn values_stay_unrounded_if_their_steps_cannot_be_counted() {
        for (precision, value) in [(1e-310, 1.0), (5e-324, -3.0), (1e-3, 1e306), (1.5e308, 1.6e308)] {
            let config = InstrumentConfig::default().precision([precision]);
            let instrument = Instrument::new(config).unwrap();
            let mut state = instrument.start(&STREAM);
            let [read] = instrument.measure([value], 0.01, &STREAM, &mut state);
            assert!(
                read.is_finite() && (read / value - 1.0).abs() < 0.07,
                "{read} of {value} by {precision}"
            );
        }
        let config = InstrumentConfig::default().precision([0.25]);
        let instrument = Instrument::new(config).unwrap();
        let mut state = instrument.start(&STREAM);
        assert_eq!(instrument.measure([1.1], 0.01, &STREAM, &mut state), [1.0]);
    }

    #[test]
    fn the_drift_stays_finite_after_any_period() {
        for drift_time_s in [10.0, f64::INFINITY] {
            let config = InstrumentConfig::default().drift([0.1]).drift_time_s([drift_time_s]);
            let instrument = Instrument::new(config).unwrap();
            let mut state = InstrumentState { bias: [0.0], drift: [0.5] };
            for period_s in [f64::NAN, -1.0, 0.0, f64::NEG_INFINITY] {
                let read = instrument.measure([2.0], period_s, &STREAM, &mut state);
                assert_eq!((read, state.drift), ([2.5], [0.5]), "a period of {period_s}");
            }
            let of_period = |period_s, mut state| {
                instrument.measure([2.0], period_s, &STREAM, &mut state);
                state.drift[0]
            };
            for period_s in [f64::INFINITY, f64::MAX, 5e-324] {
                let drift = of_period(period_s, state);
                assert!(drift.is_finite(), "{drift} after a period of {period_s}");
            }
            let drift = of_period(0.1, state);
            assert!(drift.is_finite() && drift != 0.5, "the drift continues to {drift}");
        }
    }
}
