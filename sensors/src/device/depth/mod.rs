//! The device behind a depth camera's lens: what it makes of true depths.
//!
//! ```text
//! true depth, ─► second eye ─► window ─► matching ─► noise ─► steps ─► range ─► picture
//! incidence,     hidden:       own ray,  not found:  metres   of       too near,
//! brightness     NaN           beside,   NaN         or       1/z      too far
//!                              dots,                 pixels
//!                              light
//! ```
//!
//! A [`DepthModel`] is set by [`DepthCameraConfig::model`](crate::depth::DepthCameraConfig::model()); each of its stages may
//! be left out. [Models of the literature](published) and [presets] of cameras are there. A model of
//! [Gaussian noise](DepthNoise::Gaussian) alone adds it while rays are traced; all others are a second pass over the frame,
//! which reads true depths, and the angles at which the rays meet the surfaces, from the workspace.

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
pub(crate) use time_of_flight::{Around, FREQUENCIES, Light};
pub(crate) use window::Look;
pub use window::Window;

/// What a depth camera makes of true depths; nothing at first.
///
/// ```
/// use belvedere_sensors::device::depth::{AxialNoise, DepthModel, SecondEye};
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
    /// Where a point must be seen from as well.
    pub second_eye: Option<SecondEye>,
    /// What a pixel's depth is taken from.
    pub window: Window,
    /// By what contrast a pixel is found in the second eye.
    pub matching: Option<Matching>,
    /// Noise of a depth; what it takes to the limits of the range or beyond is too near or too far.
    pub noise: DepthNoise,
    /// Steps that noisy depths are rounded to.
    pub steps: Option<DisparitySteps>,
}

impl DepthModel {
    /// True depths.
    pub const fn new() -> Self {
        Self {
            second_eye: None,
            window: Window::Own,
            matching: None,
            noise: DepthNoise::Gaussian(GaussianNoise::NONE),
            steps: None,
        }
    }

    /// Sets where a point must be seen from as well.
    #[must_use]
    pub fn second_eye(mut self, eye: impl Into<Option<SecondEye>>) -> Self {
        self.second_eye = eye.into();
        self
    }

    /// Sets what a pixel's depth is taken from.
    #[must_use]
    pub fn window(mut self, window: impl Into<Window>) -> Self {
        self.window = window.into();
        self
    }

    /// Sets by what contrast a pixel is found in the second eye. Frames are shaded for it, whoever asks for colours.
    #[must_use]
    pub fn matching(mut self, matching: impl Into<Option<Matching>>) -> Self {
        self.matching = matching.into();
        self
    }

    /// The same with its projector switched off, whose pattern then adds nothing to the contrast of what is seen; none if
    /// it cannot measure without.
    #[must_use]
    pub fn without_projector(mut self) -> Option<Self> {
        let matching = self.matching?;
        self.matching = Some(Matching { projector: 0.0, ..matching });
        Some(self)
    }

    /// Sets the noise of a depth.
    #[must_use]
    pub fn noise(mut self, noise: impl Into<DepthNoise>) -> Self {
        self.noise = noise.into();
        self
    }

    /// Sets the steps that noisy depths are rounded to.
    #[must_use]
    pub fn steps(mut self, steps: impl Into<Option<DisparitySteps>>) -> Self {
        self.steps = steps.into();
        self
    }

    /// Whether a camera can have it.
    ///
    /// # Errors
    /// Names the first parameter that is out of its range.
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

/// That a parameter is in its range.
fn check(parameter: &'static str, value: f64, range: [f64; 2]) -> Result<(), ParameterError> {
    ParameterError::require_in("device", parameter, value, range)
}

/// A checked model of more than Gaussian noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DepthDevice {
    pub(crate) eye: Option<Eye>,
    pub(crate) look: Look,
    pub(crate) matcher: Option<Matcher>,
    noise: noise::Sigma,
    /// Of the Gaussian noise.
    bias: f32,
    steps: Option<steps::Steps>,
}

impl DepthDevice {
    /// None for Gaussian noise alone, which has this bias.
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

    /// Whether it asks how the rays meet the surfaces.
    pub(crate) fn wants_incidence(&self) -> bool {
        self.noise.wants_incidence() || self.look.wants_incidence() || self.matcher.is_some()
    }

    /// Whether it draws random numbers for depths.
    pub(crate) fn is_noisy(&self) -> bool {
        self.noise.is_noisy() && !self.has_noisy_phases()
    }

    /// Whether its noise is that of phases, before their turns are counted.
    pub(crate) fn has_noisy_phases(&self) -> bool {
        matches!(self.look, Look::Light(light) if light.has_several())
            && matches!(self.noise, noise::Sigma::Axial { .. })
    }

    /// Standard deviations in metres of the depths of its phases.
    #[inline(always)]
    pub(crate) fn phase_stddevs<S: Simd>(&self, simd: S, depths: f32x16<S>, cosines: f32x16<S>) -> f32x16<S> {
        self.noise.stddevs(simd, depths, cosines)
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
