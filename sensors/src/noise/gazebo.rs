//! SDF's Gaussian noise, as Gazebo's `GaussianNoiseModel` applies it.
//!
//! out = in + bias + N(mean, stddev); with a precision other than 0, out = round(out / precision) · precision.
//! The bias is drawn once per run from N(bias mean, bias stddev), and its sign is flipped with probability ½.

use super::{Stream, standard_normal};
use fearless_simd::{Simd, SimdBase, f32x16};

/// Additive Gaussian noise with a constant bias and an optional rounding, in the unit of the measured value.
///
/// ```
/// use belvedere_sensors::noise::GaussianNoise;
/// let lidar = GaussianNoise::new(0.0, 0.01, 0.0, 0.0, 0.001)?;
/// assert_eq!(lidar.apply(2.0, 0.0, 1.234), 2.012); // 2 m + 1.234 σ, to the millimetre
/// assert_eq!(lidar.apply(f32::INFINITY, 0.0, 1.234), f32::INFINITY);
/// # Ok::<(), belvedere_sensors::noise::GaussianNoiseError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GaussianNoise {
    mean: f32,
    stddev: f32,
    bias_mean: f32,
    bias_stddev: f32,
    precision: f32,
}

/// Why a [`GaussianNoise`] was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum GaussianNoiseError {
    /// `mean` is NaN or infinite.
    Mean,
    /// `stddev` is negative, NaN or infinite.
    Stddev,
    /// `bias_mean` is NaN or infinite.
    BiasMean,
    /// `bias_stddev` is negative, NaN or infinite.
    BiasStddev,
    /// `precision` is negative, NaN, infinite or too small for a normal f32.
    Precision,
}

impl core::fmt::Display for GaussianNoiseError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Mean => "the noise mean must be a finite number",
            Self::Stddev => "the noise stddev must be a finite number, 0 or more",
            Self::BiasMean => "the noise bias_mean must be a finite number",
            Self::BiasStddev => "the noise bias_stddev must be a finite number, 0 or more",
            Self::Precision => "the noise precision must be 0 (none) or a finite number above 1.2e-38",
        })
    }
}

impl core::error::Error for GaussianNoiseError {}

impl GaussianNoise {
    /// No noise: SDF's default.
    pub const NONE: Self = Self { mean: 0.0, stddev: 0.0, bias_mean: 0.0, bias_stddev: 0.0, precision: 0.0 };

    /// From the elements of SDF's `<noise>`, all in the unit of the measured value. A precision of 0 rounds
    /// nothing.
    ///
    /// # Errors
    /// Names the first value that is not finite, or negative where it must not be.
    pub fn new(
        mean: f32,
        stddev: f32,
        bias_mean: f32,
        bias_stddev: f32,
        precision: f32,
    ) -> Result<Self, GaussianNoiseError> {
        let is_spread = |value: f32| value.is_finite() && value >= 0.0;
        if !mean.is_finite() {
            Err(GaussianNoiseError::Mean)
        } else if !is_spread(stddev) {
            Err(GaussianNoiseError::Stddev)
        } else if !bias_mean.is_finite() {
            Err(GaussianNoiseError::BiasMean)
        } else if !is_spread(bias_stddev) {
            Err(GaussianNoiseError::BiasStddev)
        } else if !(precision == 0.0 || is_spread(precision) && precision.is_normal()) {
            Err(GaussianNoiseError::Precision)
        } else {
            Ok(Self { mean, stddev, bias_mean, bias_stddev, precision })
        }
    }

    /// The same bias and rounding with another mean and standard deviation.
    ///
    /// # Errors
    /// Names the one that is out of range.
    pub fn with(self, mean: f32, stddev: f32) -> Result<Self, GaussianNoiseError> {
        Self::new(mean, stddev, self.bias_mean, self.bias_stddev, self.precision)
    }

    /// The mean of the noise without the bias.
    pub fn mean(&self) -> f32 {
        self.mean
    }

    /// The standard deviation of the noise.
    pub fn stddev(&self) -> f32 {
        self.stddev
    }

    /// The step to which outputs are rounded; 0 is none.
    pub fn precision(&self) -> f32 {
        self.precision
    }

    /// True when [`GaussianNoise::apply`] with a bias of 0 changes nothing and no bias will be drawn.
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// The bias of a sensor for the whole run. `component` tells apart the quantities that one sensor measures
    /// (the axes of an IMU); it is 0 where there is but one.
    pub fn bias(&self, seed: u64, sensor: u32, component: u32) -> f32 {
        let stream = Stream { seed, sensor, frame: 0, channel: Stream::BIAS };
        let z = standard_normal(&stream, component);
        let flipped = Stream { channel: Stream::BIAS_SIGN, ..stream }.word(component) >> 31 == 1;
        let bias = self.bias_mean + self.bias_stddev * z;
        if flipped { -bias } else { bias }
    }

    /// The noisy value of a true one, from the sensor's [`bias`](GaussianNoise::bias) and a standard normal `z`
    /// ([`standard_normal`]). Infinities and NaN stay what they are.
    #[must_use]
    #[allow(clippy::inline_always, reason = "called per sample inside vectorised kernels")]
    #[inline(always)]
    pub fn apply(&self, value: f32, bias: f32, z: f32) -> f32 {
        let noisy = value + ((bias + self.mean) + self.stddev * z);
        if self.precision == 0.0 { noisy } else { round(noisy / self.precision) * self.precision }
    }

    /// What is measured of a true range, from `min` to `max`: −∞ if that is too near, +∞ if it is too far (REP-117).
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

    /// [`GaussianNoise::apply`] to sixteen values.
    #[inline(always)]
    pub(crate) fn apply_vector<S: Simd>(
        &self,
        simd: S,
        values: f32x16<S>,
        bias: f32,
        normals: f32x16<S>,
    ) -> f32x16<S> {
        if self.precision == 0.0 {
            return values + (normals * self.stddev + (bias + self.mean));
        }
        let mut noisy = values.into();
        self.apply_all(&mut noisy, bias, &normals.into());
        f32x16::load_array(simd, noisy)
    }

    /// [`GaussianNoise::apply`] to many values, each with the normal of its place.
    #[inline(always)]
    pub(crate) fn apply_all<const N: usize>(&self, values: &mut [f32; N], bias: f32, normals: &[f32; N]) {
        // A loop that asks each time would divide and round each time, and then choose.
        if self.precision == 0.0 {
            for lane in 0..N {
                values[lane] += (bias + self.mean) + self.stddev * normals[lane];
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

/// To the nearest integer, halves away from zero, as C's `round`. Written out because `core` has no rounding,
/// and in a form that vectorises.
#[allow(clippy::inline_always, reason = "called per sample inside vectorised kernels")]
#[inline(always)]
fn round(x: f32) -> f32 {
    /// From here on every f32 is an integer.
    const ALL_INTEGERS: f32 = 8_388_608.0;
    let magnitude = x.abs();
    let whole = magnitude as i32 as f32;
    let rounded = if magnitude - whole >= 0.5 { whole + 1.0 } else { whole };
    // NaN and infinities fail the comparison too.
    if magnitude < ALL_INTEGERS { rounded.copysign(x) } else { x }
}
