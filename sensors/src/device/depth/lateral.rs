//! Lateral noise: pixels that see what lies beside their own ray.

use super::check;
use super::incidence::{slant, slant_of};
use crate::ParameterError;
use fearless_simd::{Simd, SimdBase, f32x16};

/// Pixels see what lies beside their own ray: to the right and down by one normal number each, anew in every frame. So edges
/// fray.
///
/// σ = `stddev_px` + `slant_px` · θ/(π/2 − θ), with θ between the ray and the surface's normal.
///
/// ```
/// use belvedere_sensors::device::depth::LateralNoise;
/// // Nguyen, Izadi, Lovell 2012.
/// let kinect = LateralNoise { stddev_px: 0.8, slant_px: 0.035, ..LateralNoise::NONE };
/// assert!((kinect.stddev_px(45_f64.to_radians()) - 0.835).abs() < 1e-9);
/// assert!((kinect.stddev_px(60_f64.to_radians()) - 0.870).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LateralNoise {
    /// At right angles, in pixels, 0 … 100.
    pub stddev_px: f64,
    /// Factor of what is added at other angles, in pixels, 0 … 100.
    pub slant_px: f64,
    /// How what lies there is read.
    pub sampling: Sampling,
}

/// What is seen beside the rays of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// What the nearest of them meets.
    Nearest,
    /// What the nearest of them meets, if that is another surface; else a pixel keeps its own depth. So edges fray, and
    /// depths of slanted surfaces do not scatter by their slope. Surfaces that end more than sixteen columns or eight rows
    /// away are not looked at.
    Edges,
    /// The depth between those of the four around, by distances; if one of them has none, what the nearest meets. At edges
    /// that is a depth where nothing is.
    Bilinear,
}

impl LateralNoise {
    /// Pixels see along their own rays.
    pub const NONE: Self = Self { stddev_px: 0.0, slant_px: 0.0, sampling: Sampling::Nearest };

    /// σ in pixels on a surface that a ray meets at that angle to its normal.
    #[must_use]
    pub fn stddev_px(&self, incidence_rad: f64) -> f64 {
        self.stddev_px + self.slant_px * slant_of(incidence_rad)
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        check("lateral.stddev_px", self.stddev_px, [0.0, 100.0])?;
        check("lateral.slant_px", self.slant_px, [0.0, 100.0])
    }
}

/// Lateral noise of a checked device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shift {
    stddev_px: f32,
    slant_px: f32,
    pub(crate) sampling: Sampling,
}

impl Shift {
    pub(super) fn new(noise: &LateralNoise) -> Option<Self> {
        let LateralNoise { stddev_px, slant_px, sampling } = *noise;
        (stddev_px > 0.0 || slant_px > 0.0).then_some(Self {
            stddev_px: stddev_px as f32,
            slant_px: slant_px as f32,
            sampling,
        })
    }

    pub(super) fn wants_incidence(self) -> bool {
        self.slant_px > 0.0 || self.sampling == Sampling::Edges
    }

    /// Standard deviations of sixteen pixels, in pixels.
    #[inline(always)]
    pub(crate) fn stddevs<S: Simd>(self, simd: S, cosines: f32x16<S>) -> f32x16<S> {
        let stddev = f32x16::splat(simd, self.stddev_px);
        if self.slant_px > 0.0 { stddev + slant(simd, cosines) * self.slant_px } else { stddev }
    }
}
