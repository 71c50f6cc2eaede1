//! Occlusion in the second eye of a triangulating sensor: the projector of structured light, or the other imager of a
//! stereo camera.

use super::check;
use crate::ParameterError;
use core::f64::consts::FRAC_PI_2;
use fearless_simd::{Simd, SimdBase, f32x16, mask32x16};
use glam::{DMat3, DVec3};

/// The second eye of a triangulating sensor, from which a point must also be visible to have a depth.
///
/// Visibility is tested with a separate ray; the depth of a hidden point is NaN. At the edge of a surface at depth z₁
/// in front of one at z₂, this leaves a shadow of f · `right_m` · (1/z₁ − 1/z₂) pixels. A surface that is nearer by a
/// thousandth of the distance or less casts no shadow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SecondEye {
    /// Position to the right of the camera in metres, −1000 to 1000; negative for a position to the left.
    pub right_m: f64,
    /// Half of the field of view in radians from the eye's axis, which is parallel to the camera's, 0.001 to π/2.
    /// Points outside have no depth: for an imager with the same field of view as the camera, a band of f · `right_m` /
    /// z pixels.
    pub half_view_rad: f64,
}

impl SecondEye {
    /// Creates an eye that sees everything in front of it.
    #[must_use]
    pub const fn at(right_m: f64) -> Self {
        Self { right_m, half_view_rad: FRAC_PI_2 }
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        check("second_eye.right_m", self.right_m, [-1e3, 1e3])?;
        check("second_eye.half_view_rad", self.half_view_rad, [1e-3, FRAC_PI_2])
    }
}

/// The second eye of a checked device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Eye {
    /// Position to the left, in the sensor's axes.
    left_m: f64,
    /// Tangent of half the field of view.
    most_slope: f64,
}

impl Eye {
    pub(super) fn new(eye: &SecondEye) -> Self {
        Self { left_m: -eye.right_m, most_slope: libm::tan(eye.half_view_rad) }
    }

    /// Position relative to the camera, in the axes of the world.
    pub(crate) fn place(self, axes: &DMat3) -> DVec3 {
        axes.y_axis * self.left_m
    }

    /// A mask of the points in its field of view, given by their distances ahead and to the left in the axes of the
    /// sensor.
    #[inline(always)]
    pub(crate) fn has_in_view<S: Simd>(self, simd: S, [ahead, left]: [f32x16<S>; 2]) -> mask32x16<S> {
        let off = left - f32x16::splat(simd, self.left_m as f32);
        off.abs().simd_le(ahead * self.most_slope as f32)
    }
}
