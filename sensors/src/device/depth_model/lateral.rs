//! Lateral noise: pixels measure at a position beside their own ray.

use super::check;
use super::incidence::{slant, slant_of};
use crate::ParameterError;
use fearless_simd::{Simd, SimdBase, f32x16};

/// Lateral noise: each pixel measures at a random offset from its own ray, to the right and down, drawn from a normal
/// distribution anew in every frame. As a result, edges are frayed.
///
/// σ = `stddev_px` + `slant_px` · θ/(π/2 − θ), where θ is the angle between the ray and the surface normal.
///
/// ```
/// use belvedere_sensors::device::depth_model::LateralNoise;
/// // Nguyen, Izadi, Lovell 2012.
/// let kinect = LateralNoise { stddev_px: 0.8, slant_px: 0.035, ..LateralNoise::NONE };
/// assert!((kinect.stddev_px(45_f64.to_radians()) - 0.835).abs() < 1e-9);
/// assert!((kinect.stddev_px(60_f64.to_radians()) - 0.870).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LateralNoise {
    /// Standard deviation at normal incidence, in pixels, 0 to 100.
    pub stddev_px: f64,
    /// Factor of the increase at other angles, in pixels, 0 to 100.
    pub slant_px: f64,
    /// The method of reading the depth at the offset position.
    pub sampling: Sampling,
}

/// The method of reading a depth between the rays of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// The depth of the nearest ray.
    Nearest,
    /// The depth of the nearest ray if that ray hits another surface; otherwise a pixel keeps its own depth. Edges are
    /// frayed, but the depths of slanted surfaces do not scatter by their slope. Surfaces that end more than sixteen
    /// columns or eight rows away are not considered.
    Edges,
    /// The depth interpolated between the four rays around the position, by distance; if one of them has no depth, the
    /// depth of the nearest ray. At edges, this produces depths where there is no surface.
    Bilinear,
}

impl LateralNoise {
    /// No lateral noise: pixels measure along their own rays.
    pub const NONE: Self = Self { stddev_px: 0.0, slant_px: 0.0, sampling: Sampling::Nearest };

    /// Returns σ in pixels for a surface that a ray hits at the given angle to its normal.
    #[must_use]
    pub fn stddev_px(&self, incidence_rad: f64) -> f64 {
        self.stddev_px + self.slant_px * slant_of(incidence_rad)
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        check("lateral.stddev_px", self.stddev_px, [0.0, 100.0])?;
        check("lateral.slant_px", self.slant_px, [0.0, 100.0])
    }
}

/// The lateral noise of a checked device.
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

    /// Standard deviations for sixteen pixels, in pixels.
    #[inline(always)]
    pub(crate) fn stddevs<S: Simd>(self, simd: S, cosines: f32x16<S>) -> f32x16<S> {
        let stddev = f32x16::splat(simd, self.stddev_px);
        if self.slant_px > 0.0 { stddev + slant(simd, cosines) * self.slant_px } else { stddev }
    }
}
