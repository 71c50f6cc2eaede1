//! The device behind a depth camera's lens: what it makes of true depths.
//!
//! ```text
//! true depth, incidence ─► lateral ─► noise ─► range ─► picture
//!                          pixels     metres   too near,
//!                          trade                too far
//!                          places
//! ```
//!
//! A [`DepthModel`] is set by [`DepthCameraConfig::model`](crate::depth::DepthCameraConfig::model()); each of its stages may
//! be left out. One that is [noise of one size](DepthNoise::Gaussian) alone is added while the rays are traced; all others are a second
//! pass over the frame, which reads true depths, and the angles at which the rays meet the surfaces, from the workspace.

mod incidence;
mod lateral;
mod noise;

use super::DeviceError;
use crate::noise::GaussianNoise;
use fearless_simd::{Select, Simd, SimdBase, f32x16};
pub use lateral::LateralNoise;
pub(crate) use lateral::Shift;
pub use noise::{AxialNoise, DepthNoise};

/// What a depth camera makes of true depths; nothing at first.
///
/// ```
/// use belvedere_sensors::device::depth::{AxialNoise, DepthModel};
/// use belvedere_sensors::noise::GaussianNoise;
/// let gazebo = DepthModel::from(GaussianNoise::new(0.0, 0.01, 0.0, 0.0, 0.0)?);
/// let flat = DepthModel::new().noise(AxialNoise { polynomial: [0.001, 0.0, 0.002], ..AxialNoise::NONE });
/// assert_ne!(gazebo, flat);
/// # Ok::<(), belvedere_sensors::noise::GaussianNoiseError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct DepthModel {
    /// By how much pixels see beside their own ray.
    pub lateral: LateralNoise,
    /// Noise of a depth; what it takes to the limits of the range or beyond is too near or too far.
    pub noise: DepthNoise,
}

impl DepthModel {
    /// True depths.
    pub const fn new() -> Self {
        Self { lateral: LateralNoise::NONE, noise: DepthNoise::Gaussian(GaussianNoise::NONE) }
    }

    setters! {
        /// Sets by how much pixels see beside their own ray.
        lateral: LateralNoise,
    }

    /// Sets the noise of a depth.
    #[must_use]
    pub fn noise(mut self, noise: impl Into<DepthNoise>) -> Self {
        self.noise = noise.into();
        self
    }

    /// Whether a camera can have it.
    ///
    /// # Errors
    /// Names the first parameter that is out of its range.
    pub fn check(&self) -> Result<(), DeviceError> {
        self.lateral.check()?;
        self.noise.check()
    }
}

impl Default for DepthModel {
    fn default() -> Self {
        Self::new()
    }
}

impl From<GaussianNoise> for DepthModel {
    fn from(noise: GaussianNoise) -> Self {
        Self::new().noise(noise)
    }
}

/// That a parameter is in its range.
fn check(parameter: &'static str, value: f64, range: [f64; 2]) -> Result<(), DeviceError> {
    if value >= range[0] && value <= range[1] { Ok(()) } else { Err(DeviceError { parameter, value, range }) }
}

/// A checked model of more than Gaussian noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DepthDevice {
    lateral: Option<Shift>,
    noise: noise::Sigma,
    /// Of the Gaussian noise.
    bias: f32,
}

impl DepthDevice {
    /// None for Gaussian noise alone, which has this bias.
    pub(crate) fn new(model: &DepthModel, bias: f32) -> Result<Option<Self>, DeviceError> {
        model.check()?;
        let lateral = Shift::new(&model.lateral);
        if matches!(model.noise, DepthNoise::Gaussian(_)) && lateral.is_none() {
            return Ok(None);
        }
        Ok(Some(Self { lateral, noise: noise::Sigma::new(&model.noise), bias }))
    }

    /// By how much pixels see beside their own ray.
    pub(crate) fn lateral(&self) -> Option<Shift> {
        self.lateral
    }

    /// Whether it asks how the rays meet the surfaces.
    pub(crate) fn wants_incidence(&self) -> bool {
        self.noise.wants_incidence() || self.lateral.is_some_and(Shift::wants_incidence)
    }

    /// Whether it draws random numbers for depths.
    pub(crate) fn is_noisy(&self) -> bool {
        self.noise.is_noisy()
    }

    /// Sixteen depths as they are measured, of surfaces that the rays meet at an angle of this cosine, each with a normal
    /// number. What is not finite stays.
    #[inline(always)]
    pub(crate) fn measure<S: Simd>(
        &self,
        simd: S,
        depths: f32x16<S>,
        cosines: f32x16<S>,
        normals: f32x16<S>,
    ) -> f32x16<S> {
        let noisy = self.noise.apply(simd, depths, cosines, self.bias, normals);
        depths.abs().simd_lt(f32x16::splat(simd, f32::INFINITY)).select(noisy, depths)
    }
}
