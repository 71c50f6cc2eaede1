//! Charts of directions ahead: perspective and stereographic.

use super::{BEYOND, MARGIN, Windows};
use crate::optics::rays::projection::{Points, max, min, outside};
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16};

/// Height of a triangle's edge above its chord on the stereographic chart, per square of the chord: edges are arcs of
/// circles of radius 1 or more, and rise by little more than an eighth.
pub(super) const ARC: f32 = 0.14;

#[inline(always)]
pub(super) fn boxes_in_perspective<S: Simd>(simd: S, low: &Points<S>, high: &Points<S>) -> Windows<S> {
    let (one, zero, tiny) = (f32x16::splat(simd, 1.0), f32x16::splat(simd, 0.0), f32x16::splat(simd, 1e-12));
    let nearest = one / max(low[0], tiny);
    let farthest = one / max(high[0], tiny);
    let slopes = |axis: usize| {
        let most = high[axis] * high[axis].simd_gt(zero).select(nearest, farthest);
        let least = low[axis] * low[axis].simd_lt(zero).select(nearest, farthest);
        // The chart contains slopes of up to 3.
        [least - 10.0 * MARGIN, most + 10.0 * MARGIN]
    };
    Windows { u: slopes(1), v: slopes(2), some: high[0].simd_gt(tiny) }
}

/// The tightest possible windows.
#[inline(always)]
pub(super) fn boxes_in_stereographic<S: Simd>(simd: S, low: &Points<S>, high: &Points<S>) -> Windows<S> {
    let u = window(simd, low, high, [1, 2]);
    let v = window(simd, low, high, [2, 1]);
    let (far_u, far_v) = (max(-u[0], u[1]), max(-v[0], v[1]));
    let margin = ((far_u * far_u + far_v * far_v) + 1.0) * MARGIN;
    Windows {
        u: [u[0] - margin, u[1] + margin],
        v: [v[0] - margin, v[1] + margin],
        some: mask32x16::splat(simd, true),
    }
}

/// The interval of one coordinate, along the first of two axes.
#[inline(always)]
fn window<S: Simd>(simd: S, low: &Points<S>, high: &Points<S>, [axis, other]: [usize; 2]) -> [f32x16<S>; 2] {
    let x = [low[0], high[0]];
    let others = [outside(low[other], high[other]), max(-low[other], high[other])];
    [
        -greatest(simd, x, [-high[axis], -low[axis]], others),
        greatest(simd, x, [low[axis], high[axis]], others),
    ]
}

/// The greatest y/(r + x) in boxes, given intervals of x, y and |z|.
///
/// Its magnitude falls as x or |z| increases, so x and |z| are at an end of their intervals. It rises with y while x ≥
/// 0; for x < 0 it rises up to r = (x² + z²)/|x|, and then falls again, to 1.
#[inline(always)]
fn greatest<S: Simd>(simd: S, x: [f32x16<S>; 2], y: [f32x16<S>; 2], z: [f32x16<S>; 2]) -> f32x16<S> {
    let (zero, tiny) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1e-30));
    let positive = y[1].simd_gt(zero);
    let (x, z) = (positive.select(x[0], x[1]), positive.select(z[0], z[1]));
    let square = x * x + z * z;
    let behind = x.simd_lt(zero);
    if !behind.any_true() {
        return y[1] / max((square + y[1] * y[1]).sqrt() + x, tiny);
    }
    let peak = z * square.sqrt() / max(-x, tiny);
    let at = max(min(peak, y[1]), max(y[0], zero));
    let at = (behind & positive).select(at, y[1]);
    let distance = (square + at * at).sqrt();
    let sum = distance + x;
    // Near the end of the chart, the coordinate is unbounded.
    let there = sum.simd_gt(distance * 1e-6);
    let most = there.select(at / max(sum, tiny), f32x16::splat(simd, BEYOND));
    let below = max(at / max(sum, tiny), f32x16::splat(simd, -1.0));
    (behind & !positive).select(below, most)
}

/// Coordinates of points, and a mask of the points that are well in front.
#[inline(always)]
pub(super) fn points_in_perspective<S: Simd>(
    simd: S,
    [x, y, z]: &Points<S>,
) -> ([f32x16<S>; 2], mask32x16<S>) {
    let ahead = max((y.abs() + z.abs()) * 1e-3, f32x16::splat(simd, 1e-12));
    let inverse = f32x16::splat(simd, 1.0) / max(*x, ahead);
    ([*y * inverse, *z * inverse], x.simd_gt(ahead))
}

/// Coordinates of points, and a mask of the points that are well away from straight backwards.
#[inline(always)]
pub(super) fn points_in_stereographic<S: Simd>(
    simd: S,
    [x, y, z]: &Points<S>,
) -> ([f32x16<S>; 2], mask32x16<S>) {
    let length = ((*x * *x + *y * *y) + *z * *z).sqrt();
    let ahead = max(length * 0.05, f32x16::splat(simd, 1e-12));
    let inverse = f32x16::splat(simd, 1.0) / max(length + *x, ahead);
    ([*y * inverse, *z * inverse], (length + *x).simd_gt(ahead))
}
