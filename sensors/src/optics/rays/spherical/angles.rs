//! Angles of points, sixteen at a time.

use crate::optics::rays::projection::{max, min};
use core::f32::consts::{FRAC_PI_2, PI, TAU};
use fearless_simd::{Select, Simd, SimdBase, f32x16};

/// The greatest magnitude in an interval.
#[inline(always)]
pub(super) fn magnitude<S: Simd>(low: f32x16<S>, high: f32x16<S>) -> f32x16<S> {
    max(-low, high)
}

/// The rounding error of azimuths of points at a distance from the vertical axis, given their greatest coordinate.
#[inline(always)]
pub(super) fn azimuth_error<S: Simd>(from_axis: f32x16<S>, farthest: f32x16<S>) -> f32x16<S> {
    let simd = farthest.simd;
    let error = farthest * 1e-6 / max(from_axis, f32x16::splat(simd, 1e-30));
    min(error, f32x16::splat(simd, TAU))
}

/// The angle of (x, y) from the x axis, with an error of 2e-6 radians: a minimax polynomial of the arc tangent up to 1.
#[inline(always)]
pub(super) fn atan2<S: Simd>(y: f32x16<S>, x: f32x16<S>) -> f32x16<S> {
    let zero = f32x16::splat(y.simd, 0.0);
    let (across, along) = (y.abs(), x.abs());
    let larger = max(max(across, along), f32x16::splat(y.simd, 1e-30));
    let ratio = min(across, along) / larger;
    let square = ratio * ratio;
    let mut series = square * -0.011_719_112 + 0.052_647_293;
    series = square * series - 0.116_426_43;
    series = square * series + 0.193_540_36;
    series = square * series - 0.332_622_83;
    series = square * series + 0.999_977_23;
    let angle = ratio * series;
    let angle = across.simd_gt(along).select(f32x16::splat(y.simd, FRAC_PI_2) - angle, angle);
    let angle = x.simd_lt(zero).select(f32x16::splat(y.simd, PI) - angle, angle);
    y.simd_lt(zero).select(-angle, angle)
}
