//! The power that a surface sends back, the threshold of the receiver, and the reported intensity.

use super::returns::Echo;
use crate::ParameterError;
use crate::scene::Scene;

/// The quantity that is reported as the intensity of a return.
///
/// The power of a return from a surface of reflectivity ρ at a range r, in units of the return of a white surface at 1
/// m, is P = ρ·cos θ·e^(−2αr)/r², where θ is the angle of incidence and α the extinction of the
/// [weather](super::Weather) (V. Kilic et al., "Lidar Light Scattering Augmentation (LISA)", 2021, arXiv:2107.07004).
///
/// ρ follows from the [`laser_retro`](crate::scene::InstanceConfig::laser_retro) of the instance, on the scale of
/// Velodyne's calibrated reflectivity. Up to 100 it is the reflectivity of a diffuse surface in per cent. From 101 to
/// 255 it is a retroreflector, which sends back 1 to 100 times as much as a white surface, at any angle. If it is 0,
/// the default, ρ is the mean of the diffuse colour of the material.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Intensity {
    /// The [`laser_retro`](crate::scene::InstanceConfig::laser_retro) as given; the mean if a return comes from several
    /// surfaces.
    #[default]
    Retro,
    /// The power P.
    Power,
    /// Reflectivity calibrated for range, like Velodyne's: P·r² in per cent up to 100, and beyond that on the scale of
    /// retroreflectors up to 255.
    Reflectivity,
}

/// A receiver, which detects returns from a certain power on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Receiver {
    /// The reach in metres: the range up to which a surface of reflectivity 0.9 that faces the scanner is detected in
    /// clear air and darkness. Returns weaker than P = 0.9/reach² are lost.
    pub reach_m: f64,
    /// The standard deviation of ranges is this length in metres, divided by √(2·SNR), in addition to all other noise.
    /// The SNR is P divided by the smallest power that is detected.
    pub resolution_m: f64,
    /// The power of the noise that sunlight adds, in units of the noise in darkness. The smallest power that is
    /// detected grows by √(1 + background).
    pub background: f64,
}

impl Receiver {
    /// Creates a receiver with a reach in metres, in darkness, whose range noise does not depend on the power of
    /// returns.
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

    /// Returns the smallest power that is detected.
    pub(super) fn least(&self) -> f64 {
        0.9 / (self.reach_m * self.reach_m) * crate::simd::sqrt(1.0 + self.background)
    }
}

/// The largest `laser_retro` of a diffuse surface, and that of the best retroreflector.
const DIFFUSE: f64 = 100.0;
const MOST: f64 = 255.0;
/// The light that the best retroreflector sends back, in units of a white surface.
const GAIN: f64 = 100.0;

/// Returns the light that an instance sends back at an angle of incidence, in units of a white surface that faces the
/// scanner.
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
    /// Returns the intensity of a return.
    pub(super) fn of(self, echo: &Echo) -> f32 {
        (match self {
            Self::Retro => echo.signal / echo.weight,
            Self::Power => echo.weight,
            Self::Reflectivity if echo.signal <= 1.0 => DIFFUSE * echo.signal,
            Self::Reflectivity => (DIFFUSE + (MOST - DIFFUSE) * (echo.signal - 1.0) / (GAIN - 1.0)).min(MOST),
        }) as f32
    }

    /// Returns the contribution of an echo to the intensity. `weight` is its power; `laser_retro` is that of the
    /// surface, or 0.
    #[inline(always)]
    pub(super) fn signal(self, range: f64, weight: f64, laser_retro: f32) -> f64 {
        match self {
            Self::Retro => weight * f64::from(laser_retro),
            Self::Power => 0.0,
            Self::Reflectivity => weight * (range * range),
        }
    }
}
