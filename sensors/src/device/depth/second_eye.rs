//! What the second eye of a triangulating sensor does not see: of structured light the projector, of a stereo camera the
//! other imager.

use super::check;
use crate::ParameterError;
use core::f64::consts::FRAC_PI_2;
use fearless_simd::{Simd, SimdBase, f32x16, mask32x16};
use glam::{DMat3, DVec3};

/// A point has a depth only if it is seen from there as well, by a ray of its own; where it is not, the depth is NaN. At the
/// edge of what is z₁ away, before what is z₂ away, that leaves a shadow of f · `right_m` · (1/z₁ − 1/z₂) pixels. What is
/// nearer by a thousandth of the distance, or by less, casts none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SecondEye {
    /// How far to the right of the camera, in metres, −1000 … 1000; of one to the left it is negative.
    pub right_m: f64,
    /// How far to either side it sees, in radians from its axis, which is parallel to the camera's: 0.001 … π/2. What lies
    /// beyond has no depth: of an imager as wide as the camera a band of f · `right_m` / z pixels.
    pub half_view_rad: f64,
}

impl SecondEye {
    /// One that sees all that is before it.
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
    /// To the left, as the sensor's axes go.
    left_m: f64,
    /// tan of half the view.
    most_slope: f64,
}

impl Eye {
    pub(super) fn new(eye: &SecondEye) -> Self {
        Self { left_m: -eye.right_m, most_slope: libm::tan(eye.half_view_rad) }
    }

    /// Where it is, in the axes of the world, relative to the camera.
    pub(crate) fn place(self, axes: &DMat3) -> DVec3 {
        axes.y_axis * self.left_m
    }

    /// Which points lie within its view: how far ahead they are, and to the left, in the axes of the sensor.
    #[inline(always)]
    pub(crate) fn has_in_view<S: Simd>(self, simd: S, [ahead, left]: [f32x16<S>; 2]) -> mask32x16<S> {
        let off = left - f32x16::splat(simd, self.left_m as f32);
        off.abs().simd_le(ahead * self.most_slope as f32)
    }
}
