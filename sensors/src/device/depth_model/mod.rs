//! Models of depth cameras: the measurement of true depths, with its errors. The sensor that has such a model is a
//! [`DepthCamera`](crate::depth::DepthCamera).
//!
//! ```text
//! true depth, ─► second eye ─► window ─► matching ─► noise ─► steps ─► range ─► image
//! incidence,     hidden:       own ray,  not found:  metres   of       too near,
//! brightness     NaN           beside,   NaN         or       1/z      too far
//!                              dots,                 pixels
//!                              light
//! ```
//!
//! A [`DepthModel`] is set by [`DepthCameraConfig::model`](crate::depth::DepthCameraConfig::model()); each of its
//! stages is optional. [Published models](published) and [presets] of cameras are included. A model that consists only
//! of [Gaussian noise](DepthNoise::Gaussian) is applied while rays are traced. All other models are a second pass over
//! the frame, which reads true depths and the angles of incidence from the workspace.

mod dots;
mod incidence;
mod lateral;
mod matching;
mod noise;
pub mod presets;
pub mod published;
mod second_eye;
mod steps;
mod time_of_flight;
mod turns;
mod window;

use crate::ParameterError;
use crate::noise::GaussianNoise;
pub use dots::DotWindow;
pub(crate) use dots::{Dots, dot, find_dot, squares};
use fearless_simd::{Select, Simd, SimdBase, f32x16};
pub use lateral::{LateralNoise, Sampling};
pub use matching::Matching;
pub(crate) use matching::{Matcher, REACH};
pub use noise::{AxialNoise, DepthNoise, DisparityNoise};
pub(crate) use second_eye::Eye;
pub use second_eye::SecondEye;
pub use steps::DisparitySteps;
pub use time_of_flight::TimeOfFlight;
pub(crate) use time_of_flight::{Around, FREQUENCIES, ModulatedLight};
pub(crate) use window::Look;
pub use window::Window;

/// The measurement model of a depth camera. By default, true depths are reported unchanged.
///
/// ```
/// use belvedere_sensors::device::depth_model::{AxialNoise, DepthModel, SecondEye};
/// use belvedere_sensors::noise::GaussianNoise;
/// let gazebo = DepthModel::from(GaussianNoise::of_stddev(0.01)?);
/// let noise = AxialNoise { polynomial: [0.001, 0.0, 0.002], ..AxialNoise::NONE };
/// let shadows = DepthModel::new().noise(noise).second_eye(SecondEye::at(0.075));
/// assert_ne!(gazebo, shadows);
/// # Ok::<(), belvedere_sensors::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct DepthModel {
    /// The second eye, from which a point must also be visible. The default is `None`.
    pub second_eye: Option<SecondEye>,
    /// The part of the image from which a pixel's depth is taken. The default is [`Window::Own`].
    pub window: Window,
    /// The contrast required to match a pixel in the second eye. The default is `None`.
    pub matching: Option<Matching>,
    /// Noise of the depth. Noisy depths at or beyond the limits of the range are reported as too near or too far. The
    /// default is [`GaussianNoise::NONE`].
    pub noise: DepthNoise,
    /// Disparity steps to which noisy depths are rounded. The default is `None`.
    pub steps: Option<DisparitySteps>,
}

impl DepthModel {
    /// Creates a model that reports true depths.
    pub const fn new() -> Self {
        Self {
            second_eye: None,
            window: Window::Own,
            matching: None,
            noise: DepthNoise::Gaussian(GaussianNoise::NONE),
            steps: None,
        }
    }

    /// Sets the second eye, from which a point must also be visible.
    #[must_use]
    pub fn second_eye(mut self, eye: impl Into<Option<SecondEye>>) -> Self {
        self.second_eye = eye.into();
        self
    }

    /// Sets the part of the image from which a pixel's depth is taken.
    #[must_use]
    pub fn window(mut self, window: impl Into<Window>) -> Self {
        self.window = window.into();
        self
    }

    /// Sets the contrast required to match a pixel in the second eye. Frames are then shaded even if no colours are
    /// requested.
    #[must_use]
    pub fn matching(mut self, matching: impl Into<Option<Matching>>) -> Self {
        self.matching = matching.into();
        self
    }

    /// Returns the model with its projector switched off, so that the pattern adds no contrast, or `None` if it cannot
    /// measure without a projector.
    #[must_use]
    pub fn without_projector(mut self) -> Option<Self> {
        let matching = self.matching?;
        self.matching = Some(Matching { projector: 0.0, ..matching });
        Some(self)
    }

    /// Sets the noise of the depth.
    #[must_use]
    pub fn noise(mut self, noise: impl Into<DepthNoise>) -> Self {
        self.noise = noise.into();
        self
    }

    /// Sets the disparity steps to which noisy depths are rounded.
    #[must_use]
    pub fn steps(mut self, steps: impl Into<Option<DisparitySteps>>) -> Self {
        self.steps = steps.into();
        self
    }

    /// Checks that all parameters are in range.
    ///
    /// # Errors
    /// Names the first parameter that is out of range.
    pub fn check(&self) -> Result<(), ParameterError> {
        if let Some(eye) = &self.second_eye {
            eye.check()?;
        }
        self.window.check()?;
        if let Some(matching) = &self.matching {
            matching.check()?;
        }
        self.noise.check()?;
        self.steps.as_ref().map_or(Ok(()), DisparitySteps::check)
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

/// Checks that a parameter is in range.
fn check(parameter: &'static str, value: f64, range: [f64; 2]) -> Result<(), ParameterError> {
    ParameterError::require_in("device", parameter, value, range)
}

/// A checked model with more than Gaussian noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DepthDevice {
    pub(crate) eye: Option<Eye>,
    pub(crate) look: Look,
    pub(crate) matcher: Option<Matcher>,
    noise: noise::Sigma,
    /// Bias of the Gaussian noise.
    bias: f32,
    steps: Option<steps::Steps>,
}

impl DepthDevice {
    /// Creates the device, or `None` for Gaussian noise alone, which has the given bias.
    pub(crate) fn new(model: &DepthModel, bias: f32) -> Result<Option<Self>, ParameterError> {
        model.check()?;
        let step_m = model.steps.map_or(0.0, |steps| steps.step_m(1.0));
        let device = Self {
            eye: model.second_eye.as_ref().map(Eye::new),
            look: Look::new(&model.window),
            matcher: model.matching.as_ref().map(Matcher::new),
            noise: noise::Sigma::new(&model.noise, step_m),
            bias,
            steps: model.steps.as_ref().map(steps::Steps::new),
        };
        let is_plain = device.eye.is_none()
            && device.look == Look::Own
            && device.matcher.is_none()
            && device.steps.is_none();
        Ok((!is_plain || !matches!(model.noise, DepthNoise::Gaussian(_))).then_some(device))
    }

    /// Returns true if the device needs the angles of incidence.
    pub(crate) fn wants_incidence(&self) -> bool {
        self.noise.wants_incidence() || self.look.wants_incidence() || self.matcher.is_some()
    }

    /// Returns true if the device draws random numbers for depths.
    pub(crate) fn is_noisy(&self) -> bool {
        self.noise.is_noisy() && !self.has_noisy_phases()
    }

    /// Returns true if the noise is applied to phases, before their turns are counted.
    pub(crate) fn has_noisy_phases(&self) -> bool {
        matches!(self.look, Look::Light(light) if light.has_several())
            && matches!(self.noise, noise::Sigma::Axial { .. })
    }

    /// Standard deviations in metres of the depths from its phases.
    #[inline(always)]
    pub(crate) fn phase_stddevs<S: Simd>(&self, simd: S, depths: f32x16<S>, cosines: f32x16<S>) -> f32x16<S> {
        self.noise.stddevs(simd, depths, cosines)
    }

    /// Measures sixteen depths of surfaces that the rays hit at angles with the given cosines, with one normal number
    /// each. Depths that are not finite are left unchanged.
    #[inline(always)]
    pub(crate) fn measure<S: Simd>(
        &self,
        simd: S,
        depths: f32x16<S>,
        cosines: f32x16<S>,
        normals: f32x16<S>,
    ) -> f32x16<S> {
        let mut noisy = depths;
        if !self.has_noisy_phases() {
            noisy = self.noise.apply(simd, depths, cosines, self.bias, normals);
        }
        if let Some(steps) = self.steps {
            noisy = steps.round(simd, noisy);
        }
        depths.abs().simd_lt(f32x16::splat(simd, f32::INFINITY)).select(noisy, depths)
    }
}
