//! How much of a pulse a surface sends back, what the receiver notices of it, and what is reported as intensity.

use super::returns::Echo;
use crate::ParameterError;
use crate::scene::Scene;

/// What is reported as the intensity of a return.
///
/// What comes back of a pulse from a surface of reflectivity ρ at a range r is, in units of what a white surface sends back
/// from 1 m, P = ρ·cos θ·e^(−2αr)/r², with the angle of incidence θ and the [weather](super::Weather)'s extinction α
/// (V. Kilic et al., "Lidar Light Scattering Augmentation (LISA)", 2021, arXiv:2107.07004). ρ is that of the instance's
/// [`laser_retro`](crate::scene::InstanceConfig::laser_retro), on the scale of Velodyne's calibrated reflectivity: up to
/// 100 it is a diffuse surface's in per cent; 101 to 255 is a retroreflector, which sends back 1 to 100 times as much as
/// a white surface, whatever the angle. Where it is 0, as it is where nothing is written, ρ is the mean of the diffuse colour of
/// the material.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Intensity {
    /// [`laser_retro`](crate::scene::InstanceConfig::laser_retro) as it is written, of several surfaces the mean.
    #[default]
    Retro,
    /// P.
    Power,
    /// Calibrated for range, as Velodyne's: P·r² in per cent up to 100, and beyond on the scale of retroreflectors up to
    /// 255.
    Reflectivity,
}

/// How little a receiver notices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Receiver {
    /// From so far, in metres, a surface of reflectivity 0.9 that faces the scanner is just noticed in clear air and the
    /// dark: what is weaker than P = 0.9/reach² is lost.
    pub reach_m: f64,
    /// Standard deviation of ranges, in metres, is this over √(2·SNR), besides all other noise; SNR is P over the least that
    /// is noticed.
    pub resolution_m: f64,
    /// Power of the noise that sunlight adds, in units of that in the dark: the least that is noticed grows by
    /// √(1 + background).
    pub background: f64,
}

impl Receiver {
    /// One with a reach, in the dark, whose ranges do not depend on what comes back.
    pub const fn new(reach_m: f64) -> Self {
        Self { reach_m, resolution_m: 0.0, background: 0.0 }
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let wrong = |parameter, value, rule| Err(ParameterError::new("scanner", parameter, value, rule));
        if !(self.reach_m > 0.0 && self.reach_m < f64::INFINITY) {
            return wrong("reach_m of the receiver", self.reach_m, "more than 0, and finite");
        }
        if !(0.0..f64::INFINITY).contains(&self.resolution_m) {
            return wrong("resolution_m of the receiver", self.resolution_m, "0 or more, and finite");
        }
        if !(0.0..f64::INFINITY).contains(&self.background) {
            return wrong("background of the receiver", self.background, "0 or more, and finite");
        }
        Ok(())
    }

    /// The least that it notices.
    pub(super) fn least(&self) -> f64 {
        0.9 / (self.reach_m * self.reach_m) * crate::simd::sqrt(1.0 + self.background)
    }
}

/// `laser_retro` up to which surfaces are diffuse, and that of the best retroreflector.
const DIFFUSE: f64 = 100.0;
const MOST: f64 = 255.0;
/// What the best retroreflector sends back, in units of a white surface.
const GAIN: f64 = 100.0;

/// What an instance sends back of light that meets it at an angle, in units of a white surface that faces it.
#[inline(always)]
pub(super) fn reflected(scene: &Scene<'_>, instance: u32, cos_incidence: f64) -> f64 {
    let instance = &scene.instances[instance as usize];
    let retro = f64::from(instance.laser_retro);
    if retro > DIFFUSE {
        return 1.0 + (GAIN - 1.0) * (retro.min(MOST) - DIFFUSE) / (MOST - DIFFUSE);
    }
    let reflectivity = if retro > 0.0 {
        retro / DIFFUSE
    } else {
        let [red, green, blue] = scene.materials[instance.material as usize].diffuse.map(f64::from);
        ((red + green + blue) / 3.0).clamp(0.0, 1.0)
    };
    reflectivity * cos_incidence.abs()
}

impl Intensity {
    /// What is reported of a return.
    pub(super) fn of(self, echo: &Echo) -> f32 {
        (match self {
            Self::Retro => echo.signal / echo.weight,
            Self::Power => echo.weight,
            Self::Reflectivity if echo.signal <= 1.0 => DIFFUSE * echo.signal,
            Self::Reflectivity => (DIFFUSE + (MOST - DIFFUSE) * (echo.signal - 1.0) / (GAIN - 1.0)).min(MOST),
        }) as f32
    }

    /// What an echo adds to that: of a surface with a `laser_retro` or none, of which so much comes back.
    #[inline(always)]
    pub(super) fn signal(self, range: f64, weight: f64, laser_retro: f32) -> f64 {
        match self {
            Self::Retro => weight * f64::from(laser_retro),
            Self::Power => 0.0,
            Self::Reflectivity => weight * (range * range),
        }
    }
}
