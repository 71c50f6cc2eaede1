//! Noise of a measured depth.

use super::check;
use super::incidence::{slant, slant_of};
use super::turns::sin_cos_of_turns;
use crate::ParameterError;
use crate::noise::GaussianNoise;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16};

/// Noise of a measured depth, in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum DepthNoise {
    /// Noise that is the same at every depth, as described by SDF's `<noise>`.
    Gaussian(GaussianNoise),
    /// Noise that grows with depth and with the angle of incidence. It describes measured depths, so the contribution
    /// of the [steps](super::DisparitySteps), a twelfth of their square, is subtracted from its variance.
    Axial(AxialNoise),
    /// Noise of the disparities of a triangulating sensor, in pixels.
    Disparity(DisparityNoise),
}

impl From<GaussianNoise> for DepthNoise {
    fn from(noise: GaussianNoise) -> Self {
        Self::Gaussian(noise)
    }
}

impl From<AxialNoise> for DepthNoise {
    fn from(noise: AxialNoise) -> Self {
        Self::Axial(noise)
    }
}

impl From<DisparityNoise> for DepthNoise {
    fn from(noise: DisparityNoise) -> Self {
        Self::Disparity(noise)
    }
}

impl DepthNoise {
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        match self {
            Self::Gaussian(_) => Ok(()),
            Self::Axial(noise) => noise.check(),
            Self::Disparity(noise) => noise.check(),
        }
    }
}

/// Axial noise: normally distributed, with the standard deviation
///
/// σ = p₀ + p₁·z + p₂·z² + (s₀/√z + s₁·z·√z) · θ²/(π/2 − θ)²
///
/// at a depth of z metres on a surface whose normal is at an angle of θ to the ray. If the sum is negative, σ is 0. The
/// last term applies from `slant_from_rad` on.
///
/// ```
/// use belvedere_sensors::device::depth_model::AxialNoise;
/// // Nguyen, Izadi, Lovell 2012: 0.0012 + 0.0019·(z − 0.4)², and more beyond 60°.
/// let kinect = AxialNoise {
///     polynomial: [0.0012 + 0.0019 * 0.16, -0.0019 * 0.8, 0.0019],
///     slant: [0.0001, 0.0],
///     slant_from_rad: 60_f64.to_radians(),
/// };
/// assert!((kinect.stddev_m(3.0, 0.0) - 0.014044).abs() < 1e-9);
/// assert!((kinect.stddev_m(1.0, 80_f64.to_radians()) - 0.008284).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxialNoise {
    /// p₀ in metres, p₁ without unit, and p₂ in 1/m, each −1000 to 1000.
    pub polynomial: [f64; 3],
    /// s₀ in m^1.5 and s₁ in m^−0.5, each 0 to 1000.
    pub slant: [f64; 2],
    /// Angle of incidence in radians from which the slant terms apply, 0 to π/2.
    pub slant_from_rad: f64,
}

impl AxialNoise {
    /// No noise.
    pub const NONE: Self = Self { polynomial: [0.0; 3], slant: [0.0; 2], slant_from_rad: 0.0 };

    /// Returns σ in metres.
    #[must_use]
    pub fn stddev_m(&self, depth_m: f64, incidence_rad: f64) -> f64 {
        let ([p0, p1, p2], [s0, s1]) = (self.polynomial, self.slant);
        let root = libm::sqrt(depth_m);
        let slant = if incidence_rad < self.slant_from_rad { 0.0 } else { slant_of(incidence_rad) };
        let sum = p0 + depth_m * (p1 + depth_m * p2) + (s0 / root + s1 * depth_m * root) * slant * slant;
        sum.max(0.0)
    }

    fn check(&self) -> Result<(), ParameterError> {
        for term in self.polynomial {
            check("noise.polynomial", term, [-1e3, 1e3])?;
        }
        for term in self.slant {
            check("noise.slant", term, [0.0, 1e3])?;
        }
        check("noise.slant_from_rad", self.slant_from_rad, [0.0, core::f64::consts::FRAC_PI_2])
    }
}

/// Noise of the disparity d = `focal_px` · `baseline_m` / z of a triangulating sensor.
///
/// It consists of normal noise, which at a depth of z metres has a standard deviation of z² · `stddev_px` / (`focal_px`
/// · `baseline_m`), and of subpixel locking: matchers that interpolate between whole pixels pull disparities towards
/// whole pixels, and d becomes d − `locking_px` · sin 2πd. As a result, planes ripple. Averaged over all positions
/// between pixels, this adds `locking_px`²/2 to the variance.
///
/// ```
/// use belvedere_sensors::device::depth_model::DisparityNoise;
/// // RealSense D435: 848 pixels in 90°, eyes 50 mm apart.
/// let d435 = DisparityNoise { focal_px: 424.0, baseline_m: 0.05, stddev_px: 0.08, locking_px: 0.0 };
/// assert!((d435.stddev_m(2.0) - 0.0151).abs() < 1e-5);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisparityNoise {
    /// Focal length in the pixels in which disparities are counted, 10⁻⁶ to 10⁶.
    pub focal_px: f64,
    /// Baseline between the two eyes in metres, 10⁻⁶ to 1000.
    pub baseline_m: f64,
    /// Standard deviation of the disparity in pixels, 0 to 1000.
    pub stddev_px: f64,
    /// Greatest displacement of disparities towards whole pixels, 0 to 0.15 pixels. From 1/2π on, their order would
    /// change.
    pub locking_px: f64,
}

impl DisparityNoise {
    /// Returns σ of the normal noise in metres.
    #[must_use]
    pub fn stddev_m(&self, depth_m: f64) -> f64 {
        depth_m * depth_m * self.stddev_px / (self.focal_px * self.baseline_m)
    }

    fn check(&self) -> Result<(), ParameterError> {
        check("noise.focal_px", self.focal_px, [1e-6, 1e6])?;
        check("noise.baseline_m", self.baseline_m, [1e-6, 1e3])?;
        check("noise.stddev_px", self.stddev_px, [0.0, 1e3])?;
        check("noise.locking_px", self.locking_px, [0.0, 0.15])
    }
}

/// The noise of a checked device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Sigma {
    Gaussian(GaussianNoise),
    Axial {
        polynomial: [f32; 3],
        slant: [f32; 2],
        /// Cosine of the angle from which the slant terms apply.
        slant_below: f32,
        /// Standard deviation that rounding adds at 1 m.
        rounding: f32,
    },
    /// Noise of 1/z.
    Inverse {
        stddev: f32,
        /// Disparity at 1 m.
        pixels: f32,
        /// Greatest displacement towards whole pixels.
        locking: f32,
    },
}

impl Sigma {
    /// Creates the noise before rounding to steps whose width at 1 m is `step_m`.
    pub(super) fn new(noise: &DepthNoise, step_m: f64) -> Self {
        match *noise {
            DepthNoise::Gaussian(noise) => Self::Gaussian(noise),
            DepthNoise::Axial(AxialNoise { polynomial, slant, slant_from_rad }) => Self::Axial {
                polynomial: polynomial.map(|term| term as f32),
                slant: slant.map(|term| term as f32),
                slant_below: libm::cos(slant_from_rad) as f32,
                rounding: (step_m / libm::sqrt(12.0)) as f32,
            },
            DepthNoise::Disparity(noise) => {
                let pixels = noise.focal_px * noise.baseline_m;
                Self::Inverse {
                    stddev: noise.stddev_m(1.0) as f32,
                    pixels: pixels as f32,
                    locking: (noise.locking_px / pixels) as f32,
                }
            }
        }
    }

    pub(super) fn is_noisy(&self) -> bool {
        !matches!(self, Self::Gaussian(noise) if noise.is_none())
    }

    pub(super) fn wants_incidence(&self) -> bool {
        matches!(self, Self::Axial { slant, .. } if *slant != [0.0; 2])
    }

    /// Adds noise to finite depths.
    #[inline(always)]
    pub(super) fn apply<S: Simd>(
        &self,
        simd: S,
        depths: f32x16<S>,
        cosines: f32x16<S>,
        bias: f32,
        normals: f32x16<S>,
    ) -> f32x16<S> {
        let number = |value: f32| f32x16::splat(simd, value);
        match self {
            Self::Gaussian(noise) => noise.apply_vector(simd, depths, bias, normals),
            Self::Axial { .. } => depths + self.stddevs(simd, depths, cosines) * normals,
            // A depth that noise moves beyond infinity is infinite.
            Self::Inverse { stddev, pixels, locking } => {
                let mut inverse = number(1.0) / depths;
                if *locking > 0.0 {
                    let disparity = inverse * *pixels;
                    let [sine, _] = sin_cos_of_turns(simd, disparity - disparity.round_ties_even());
                    inverse -= sine * *locking;
                }
                number(1.0) / (inverse + normals * *stddev).max(number(0.0))
            }
        }
    }

    /// Standard deviations in metres of axial noise; 0 for any other noise.
    #[inline(always)]
    pub(super) fn stddevs<S: Simd>(&self, simd: S, depths: f32x16<S>, cosines: f32x16<S>) -> f32x16<S> {
        let number = |value: f32| f32x16::splat(simd, value);
        let Self::Axial { polynomial: [p0, p1, p2], slant: [s0, s1], slant_below, rounding } = self else {
            return number(0.0);
        };
        let mut sigma = (depths * *p2 + *p1) * depths + *p0;
        let is_slanted = cosines.simd_le(*slant_below);
        if self.wants_incidence() && is_slanted.any_true() {
            let slant = slant(simd, cosines);
            let root = depths.sqrt();
            let factor = number(*s0) / root + depths * root * *s1;
            let more = sigma + factor * (slant * slant);
            sigma = is_slanted.select(more, sigma);
        }
        if *rounding > 0.0 {
            let rounded = depths * depths * *rounding;
            sigma = (sigma * sigma - rounded * rounded).max(number(0.0)).sqrt();
        }
        sigma.max(number(0.0))
    }
}
