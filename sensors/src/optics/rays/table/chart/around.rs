//! The chart around an axis.

use super::{MARGIN, Windows};
use crate::optics::rays::projection::{Points, max, min, outside};
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16};

/// A full turn in units of [`turn_of`].
pub(in super::super) const TURN: f32 = 4.0;

/// A measure of the angle of (x, y) from the x axis that takes a single division. It ranges from −2 to 2, increases by
/// exactly 2 per half turn, and its slope is between 0.5 and 1 per radian.
pub(super) fn turn_of(x: f64, y: f64) -> f64 {
    let across = y / (x.abs() + y.abs()).max(1e-30);
    match (x < 0.0, y >= 0.0) {
        (false, _) => across,
        (true, true) => 2.0 - across,
        (true, false) => -2.0 - across,
    }
}

/// Vector form of [`turn_of`] for sixteen values.
#[inline(always)]
fn turns_of<S: Simd>(x: f32x16<S>, y: f32x16<S>) -> f32x16<S> {
    let simd = x.simd;
    let (zero, two) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 2.0));
    let across = y / max(x.abs() + y.abs(), f32x16::splat(simd, 1e-30));
    let behind = y.simd_ge(zero).select(two, -two) - across;
    x.simd_lt(zero).select(behind, across)
}

/// The interval of azimuths of points that are all within half a turn of each other, and a mask of the valid results;
/// otherwise the whole turn. The interval may continue past the seam.
#[inline(always)]
fn azimuths<S: Simd, const N: usize>(
    simd: S,
    turns: [f32x16<S>; N],
    margin: f32x16<S>,
) -> ([f32x16<S>; 2], mask32x16<S>) {
    let (zero, turn) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, TURN));
    let (mut from, mut to) = (turns[0], turns[0]);
    let later = |turns: f32x16<S>| turns.simd_lt(zero).select(turns + turn, turns);
    let (mut from_later, mut to_later) = (later(turns[0]), later(turns[0]));
    for turns in &turns[1..] {
        from = min(from, *turns);
        to = max(to, *turns);
        from_later = min(from_later, later(*turns));
        to_later = max(to_later, later(*turns));
    }
    let nearly_half = f32x16::splat(simd, TURN * 0.499);
    let plain = (to - from).simd_lt(nearly_half);
    let over_seam = (to_later - from_later).simd_lt(nearly_half);
    let from = plain.select(from, from_later) - margin;
    let to = plain.select(to, to_later) + margin;
    let some = (plain | over_seam) & (to - from).simd_lt(f32x16::splat(simd, TURN * 0.9));
    // With the margin, an interval may also start before the seam.
    let before = from.simd_lt(f32x16::splat(simd, -TURN * 0.5));
    let (from, to) = (before.select(from + turn, from), before.select(to + turn, to));
    let half = f32x16::splat(simd, TURN * 0.5);
    ([some.select(from, -half), some.select(to, half)], some)
}

/// The rounding error of azimuths of points that are at least `from_axis` from the axis.
#[inline(always)]
fn azimuth_margin<S: Simd>(from_axis: f32x16<S>, farthest: f32x16<S>) -> f32x16<S> {
    let simd = farthest.simd;
    let error = farthest * 1e-6 / max(from_axis, f32x16::splat(simd, 1e-30));
    min(error, f32x16::splat(simd, TURN)) + MARGIN
}

#[inline(always)]
pub(super) fn boxes_in_cylindrical<S: Simd>(simd: S, low: &Points<S>, high: &Points<S>) -> Windows<S> {
    let zero = f32x16::splat(simd, 0.0);
    let tiny = f32x16::splat(simd, 1e-30);
    let far = |axis: usize| max(-low[axis], high[axis]);
    let (near_x, near_y) = (outside(low[0], high[0]), outside(low[1], high[1]));
    let nearest = near_x * near_x + near_y * near_y;
    let farthest = far(0) * far(0) + far(1) * far(1);
    let rise = |z: f32x16<S>, level: f32x16<S>| z / max(level.sqrt() + (level + z * z).sqrt(), tiny);
    let v = [
        rise(low[2], low[2].simd_lt(zero).select(nearest, farthest)) - MARGIN,
        rise(high[2], high[2].simd_gt(zero).select(nearest, farthest)) + MARGIN,
    ];
    let turns = [
        turns_of(low[0], low[1]),
        turns_of(high[0], low[1]),
        turns_of(low[0], high[1]),
        turns_of(high[0], high[1]),
    ];
    // The box has been widened by the rounding error.
    let (u, _) = azimuths(simd, turns, f32x16::splat(simd, MARGIN));
    Windows { u, v, some: mask32x16::splat(simd, true) }
}

/// The windows of triangles, and a mask of the triangles for which they are valid: those that look small from the axis.
#[inline(always)]
pub(super) fn triangles_in_cylindrical<S: Simd>(
    simd: S,
    corners: &[Points<S>; 3],
) -> (Windows<S>, mask32x16<S>) {
    let zero = f32x16::splat(simd, 0.0);
    let (mut turns, mut rises) = ([zero; 3], [zero; 3]);
    let (mut lowest, mut farthest) = (f32x16::splat(simd, f32::MAX), zero);
    for (index, corner) in corners.iter().enumerate() {
        let [x, y, z] = *corner;
        turns[index] = turns_of(x, y);
        let square = x * x + y * y;
        let (level, length) = (square.sqrt(), (square + z * z).sqrt());
        rises[index] = z / max(level + length, f32x16::splat(simd, 1e-30));
        lowest = min(lowest, level);
        farthest = max(farthest, length);
    }
    let (u, _) = azimuths(simd, turns, azimuth_margin(lowest, farthest));
    let span = u[1] - u[0];
    let sure = span.simd_lt(f32x16::splat(simd, 0.2));
    // An edge's great circle bulges above its ends by up to a sixteenth of the square of its azimuth range, which is up
    // to twice its measure.
    let margin = span * span * 0.28 + MARGIN;
    let v =
        [min(min(rises[0], rises[1]), rises[2]) - margin, max(max(rises[0], rises[1]), rises[2]) + margin];
    (Windows { u, v, some: sure }, sure)
}
