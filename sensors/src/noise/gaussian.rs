//! SDF's Gaussian noise, as Gazebo's `GaussianNoiseModel` applies it.

use super::{Stream, standard_normal};
use crate::ParameterError;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16};

/// The parameters of [`GaussianNoise`], in the unit of the measured value, named after the elements of SDF's `<noise>`.
/// All default to 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct GaussianNoiseConfig {
    /// Mean of the noise of each sample, finite. The default is 0.
    pub mean: f32,
    /// Standard deviation of the noise of each sample, 0 or more. The default is 0.
    pub stddev: f32,
    /// Mean of the bias of a run, finite. The sign of the bias is flipped with probability ½, as in SDF; for a bias of
    /// known sign, set `mean`. The default is 0.
    pub bias_mean: f32,
    /// Standard deviation of the bias of a run, 0 or more. The default is 0.
    pub bias_stddev: f32,
    /// The step to which outputs are rounded; 0 disables rounding. The default is 0.
    pub precision: f32,
}

impl GaussianNoiseConfig {
    const NONE: Self = Self { mean: 0.0, stddev: 0.0, bias_mean: 0.0, bias_stddev: 0.0, precision: 0.0 };

    setters! {
        /// Sets the mean of the noise of each sample.
        mean: f32,
        /// Sets the standard deviation of the noise of each sample.
        stddev: f32,
        /// Sets the mean of the bias of a run, whose sign is flipped with probability ½.
        bias_mean: f32,
        /// Sets the standard deviation of the bias of a run.
        bias_stddev: f32,
        /// Sets the step to which outputs are rounded.
        precision: f32,
    }
}

/// Additive Gaussian noise with a constant bias and an optional rounding, in the unit of the measured value.
///
/// out = in + bias + N(mean, stddev). With a precision other than 0, out = round(out / precision) · precision. If that
/// is not finite, because the precision is too small or too large for the value, out is not rounded. The bias is drawn
/// once per run from N(bias mean, bias stddev), and its sign is flipped with probability ½.
///
/// ```
/// use belvedere_sensors::noise::{GaussianNoise, GaussianNoiseConfig};
/// let lidar = GaussianNoise::new(GaussianNoiseConfig::default().stddev(0.01).precision(0.001))?;
/// assert_eq!(lidar.apply(2.0, 0.0, 1.234), 2.012); // 2 m + 1.234 σ, to the millimetre
/// assert_eq!(lidar.apply(f32::INFINITY, 0.0, 1.234), f32::INFINITY);
/// # Ok::<(), belvedere_sensors::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GaussianNoise {
    config: GaussianNoiseConfig,
}

impl GaussianNoise {
    /// No noise: SDF's default.
    pub const NONE: Self = Self { config: GaussianNoiseConfig::NONE };

    /// Creates the noise model after checking its parameters.
    ///
    /// # Errors
    /// Names the first value that is not finite, or that is negative where it must not be.
    pub fn new(config: GaussianNoiseConfig) -> Result<Self, ParameterError> {
        let GaussianNoiseConfig { mean, stddev, bias_mean, bias_stddev, precision } = config;
        let require = |parameter, value: f32, holds, rule| {
            ParameterError::require_f32("noise", parameter, value, holds, rule)
        };
        let is_spread = |value: f32| value.is_finite() && value >= 0.0;
        require("mean", mean, mean.is_finite(), "a finite number")?;
        require("stddev", stddev, is_spread(stddev), "a finite number, 0 or more")?;
        require("bias_mean", bias_mean, bias_mean.is_finite(), "a finite number")?;
        require("bias_stddev", bias_stddev, is_spread(bias_stddev), "a finite number, 0 or more")?;
        let is_step = precision == 0.0 || is_spread(precision) && precision.is_normal();
        require("precision", precision, is_step, "0 (none) or a finite number above 1.2e-38")?;
        Ok(Self { config })
    }

    /// Creates noise with mean 0 and the given standard deviation, without bias and without rounding.
    ///
    /// ```
    /// use belvedere_sensors::noise::GaussianNoise;
    /// assert_eq!(GaussianNoise::of_stddev(0.01)?.apply(2.0, 0.0, -1.0), 1.99);
    /// # Ok::<(), belvedere_sensors::ParameterError>(())
    /// ```
    ///
    /// # Errors
    /// If `stddev` is negative, NaN or infinite.
    pub fn of_stddev(stddev: f32) -> Result<Self, ParameterError> {
        Self::new(GaussianNoiseConfig::default().stddev(stddev))
    }

    /// The parameters of the noise.
    pub fn config(&self) -> &GaussianNoiseConfig {
        &self.config
    }

    /// The mean of the noise, without the bias.
    pub fn mean(&self) -> f32 {
        self.config.mean
    }

    /// The standard deviation of the noise.
    pub fn stddev(&self) -> f32 {
        self.config.stddev
    }

    /// The step to which outputs are rounded; 0 if they are not.
    pub fn precision(&self) -> f32 {
        self.config.precision
    }

    /// Returns true if [`GaussianNoise::apply`] with a bias of 0 changes nothing and no bias will be drawn.
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// Draws the bias of a sensor for the whole run. `component` distinguishes the quantities that one sensor measures,
    /// such as the axes of an IMU; it is 0 if there is only one.
    pub fn bias(&self, seed: u64, sensor: u32, component: u32) -> f32 {
        let stream = Stream { seed, sensor, frame: 0, channel: Stream::BIAS };
        let z = standard_normal(&stream, component);
        let flipped = Stream { channel: Stream::BIAS_SIGN, ..stream }.word(component) >> 31 == 1;
        let bias = self.config.bias_mean + self.config.bias_stddev * z;
        if flipped { -bias } else { bias }
    }

    /// Returns the noisy value for a true one, given the sensor's [`bias`](GaussianNoise::bias) and a standard normal
    /// `z` (from [`standard_normal`]). Infinities and NaN are returned unchanged, and rounding never makes another
    /// value infinite.
    #[must_use]
    #[allow(clippy::inline_always, reason = "called per sample inside vectorised kernels")]
    #[inline(always)]
    pub fn apply(&self, value: f32, bias: f32, z: f32) -> f32 {
        let noisy = value + ((bias + self.config.mean) + self.config.stddev * z);
        if self.config.precision == 0.0 {
            return noisy;
        }
        // If the value is more steps than f32 can count, the steps are finer than its last bit and it stays as it is,
        // so no precision has to be rejected. A value also stays as it is if its nearest step is outside the range of
        // f32.
        let stepped = round(noisy / self.config.precision) * self.config.precision;
        if stepped.abs() < f32::INFINITY { stepped } else { noisy }
    }

    /// The measurement of a true range between `min` and `max`: −∞ if it is too near, +∞ if it is too far (REP 117).
    #[inline(always)]
    pub(crate) fn apply_to_range(&self, truth: f32, bias: f32, z: f32, [min, max]: [f32; 2]) -> f32 {
        if truth >= max || truth == f32::INFINITY {
            f32::INFINITY
        } else if truth <= min {
            f32::NEG_INFINITY
        } else {
            let noisy = self.apply(truth, bias, z);
            if noisy < min {
                min
            } else if noisy > max {
                max
            } else {
                noisy
            }
        }
    }

    /// Vector form of [`GaussianNoise::apply`] for sixteen values.
    #[inline(always)]
    pub(crate) fn apply_vector<S: Simd>(
        &self,
        simd: S,
        values: f32x16<S>,
        bias: f32,
        normals: f32x16<S>,
    ) -> f32x16<S> {
        let noisy = values + (normals * self.config.stddev + (bias + self.config.mean));
        if self.config.precision == 0.0 {
            return noisy;
        }
        let stepped = round_vector(simd, noisy / self.config.precision) * self.config.precision;
        stepped.abs().simd_lt(f32x16::splat(simd, f32::INFINITY)).select(stepped, noisy)
    }

    /// Applies [`GaussianNoise::apply`] to an array, each value with the normal of the same index.
    #[inline(always)]
    pub(crate) fn apply_all<const N: usize>(&self, values: &mut [f32; N], bias: f32, normals: &[f32; N]) {
        // Testing the precision inside the loop would divide and round every value and then select.
        if self.config.precision == 0.0 {
            for lane in 0..N {
                values[lane] += (bias + self.config.mean) + self.config.stddev * normals[lane];
            }
        } else {
            for lane in 0..N {
                values[lane] = self.apply(values[lane], bias, normals[lane]);
            }
        }
    }
}

impl Default for GaussianNoise {
    fn default() -> Self {
        Self::NONE
    }
}

/// From this magnitude on, every f32 is an integer.
const ALL_INTEGERS: f32 = 8_388_608.0;

/// Rounds to the nearest integer, halves away from zero, like C's `round`. Written out because `core` has no rounding,
/// and in a form that vectorises.
#[allow(clippy::inline_always, reason = "called per sample inside vectorised kernels")]
#[inline(always)]
fn round(x: f32) -> f32 {
    let magnitude = x.abs();
    let whole = magnitude as i32 as f32;
    let rounded = if magnitude - whole >= 0.5 { whole + 1.0 } else { whole };
    // NaN and infinities fail the comparison too.
    if magnitude < ALL_INTEGERS { rounded.copysign(x) } else { x }
}

/// Vector form of [`round`] for sixteen values.
#[inline(always)]
fn round_vector<S: Simd>(simd: S, x: f32x16<S>) -> f32x16<S> {
    let magnitude = x.abs();
    let has_fraction = magnitude.simd_lt(f32x16::splat(simd, ALL_INTEGERS));
    // Larger values are integers already, or NaN, and may not fit into 32 bits.
    let magnitude = has_fraction.select(magnitude, f32x16::splat(simd, 0.0));
    let whole = simd.cvt_f32_i32x16(simd.cvt_i32_f32x16(magnitude));
    let is_half = (magnitude - whole).simd_ge(f32x16::splat(simd, 0.5));
    let rounded = is_half.select(whole + 1.0, whole);
    has_fraction.select(rounded.copysign(x), x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_are_rounded_like_single_values() {
        let places = [0.0, 0.5, 1.0, 1.5, 2.5, 12.5, 4_194_303.5, 4_194_304.0, 8_388_607.0, 8_388_607.5];
        let far =
            [8_388_608.0, 16_777_217.0, 2_147_483_520.0, 2_147_483_648.0, 1e20, f32::INFINITY, f32::NAN];
        let mut values: Vec<f32> = places.into_iter().chain(far).flat_map(|x| [x, -x]).collect();
        // Their neighbours in f32, and numbers of all sizes.
        values.extend(values.clone().iter().flat_map(|x| [x.next_up(), x.next_down()]));
        values.extend((0..40_000_u32).map(|index| f32::from_bits(index.wrapping_mul(107_374))));
        values.resize(values.len().next_multiple_of(16), 0.0);
        for precision in [0.0, 1.0, 0.001, 0.3, 1e30] {
            let noise = GaussianNoise::new(
                GaussianNoiseConfig::default().mean(0.01).stddev(0.02).precision(precision),
            )
            .unwrap();
            for sixteen in values.as_chunks::<16>().0 {
                let together: [f32; 16] = crate::simd::dispatch!(crate::simd::best_level(), simd => {
                    let z = f32x16::splat(simd, -0.75);
                    noise.apply_vector(simd, f32x16::load_array(simd, *sixteen), 0.25, z).into()
                });
                for (&value, together) in sixteen.iter().zip(together) {
                    let alone = noise.apply(value, 0.25, -0.75);
                    assert!(
                        together.to_bits() == alone.to_bits() || together.is_nan() && alone.is_nan(),
                        "{value} to {precision}: {together} instead of {alone}"
                    );
                }
            }
        }
    }
}
