//! The disparity steps of a triangulating sensor.

use super::check;
use crate::ParameterError;
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x16};

/// Rounding of disparities, `focal_px` · `baseline_m` / z, to a multiple of `step_px`, with halves to even. At a depth
/// of z metres, this is a step of z² · `step_px` / (`focal_px` · `baseline_m`).
///
/// ```
/// use belvedere_sensors::device::depth_model::DisparitySteps;
/// // Kinect v1: eighths of a pixel.
/// let kinect = DisparitySteps { focal_px: 580.0, baseline_m: 0.0756, step_px: 0.125 };
/// assert!((kinect.step_m(2.0) - 0.0114).abs() < 1e-5);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisparitySteps {
    /// Focal length in the pixels in which disparities are counted, above 0, at most 10⁶.
    pub focal_px: f64,
    /// Baseline between the two eyes in metres, above 0, at most 1000.
    pub baseline_m: f64,
    /// Step of the disparity in pixels, above 0, at most 1000.
    pub step_px: f64,
}

impl DisparitySteps {
    /// Returns the step in metres at the given depth.
    #[must_use]
    pub fn step_m(&self, depth_m: f64) -> f64 {
        depth_m * depth_m * self.step_px / (self.focal_px * self.baseline_m)
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        check("steps.focal_px", self.focal_px, [1e-6, 1e6])?;
        check("steps.baseline_m", self.baseline_m, [1e-6, 1e3])?;
        check("steps.step_px", self.step_px, [1e-6, 1e3])
    }
}

/// The steps of a checked device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Steps {
    /// Number of steps at a depth of 1 m.
    per_inverse: f32,
}

impl Steps {
    pub(super) fn new(steps: &DisparitySteps) -> Self {
        Self { per_inverse: (steps.focal_px * steps.baseline_m / steps.step_px) as f32 }
    }

    /// Rounds depths to whole steps.
    #[inline(always)]
    pub(super) fn round<S: Simd>(self, simd: S, depths: f32x16<S>) -> f32x16<S> {
        let all = f32x16::splat(simd, self.per_inverse);
        all / (all / depths).round_ties_even()
    }
}
