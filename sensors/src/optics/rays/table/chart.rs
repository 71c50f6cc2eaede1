//! Flat charts of the directions of a table, on which boxes and triangles are bounded.
//!
//! A chart's first coordinate should rise with the column and its second with the row; how closely decides how
//! tight bounds are, never whether they hold.

use super::super::projection::{Points, bounds_of, max, min};
use crate::simd::sqrt;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16};
use glam::{DMat3, DVec3};

/// More than what rounding does to a direction, in radians.
const MARGIN: f32 = 4e-6;
/// A coordinate beyond all charts.
const BEYOND: f32 = 1e9;
/// A full turn in units of [`turn_of`].
pub(super) const TURN: f32 = 4.0;

/// How directions are laid out flat.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// y/x and z/x: for directions within 65° of the axis. Straight lines stay straight, and boxes tight.
    Perspective,
    /// y/(1 + x) and z/(1 + x), stereographic: for directions within 150° of the axis, as of a fisheye.
    Stereographic,
    /// Azimuth around z and half the elevation's tangent: for rings of a lidar, and whatever else.
    Cylindrical,
}

/// A chart and its axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Chart {
    pub(super) kind: Kind,
    /// Rows of the matrix from the sensor's axes to the chart's. It may mirror.
    rows: [[f32; 3]; 3],
    axes: [[f64; 3]; 3],
}

/// Sixteen windows of a chart, from the least to the greatest of each coordinate. Azimuths may go past the seam.
pub(super) struct Windows<S: Simd> {
    pub(super) u: [f32x16<S>; 2],
    pub(super) v: [f32x16<S>; 2],
    /// Those that hold anything.
    pub(super) some: mask32x16<S>,
}

/// A measure of the angle of (x, y) to the x axis that takes one division: from −2 to 2, exactly 2 more for a
/// half turn more, and never steeper than the angle in radians nor less than half as steep.
fn turn_of(x: f64, y: f64) -> f64 {
    let across = y / (x.abs() + y.abs()).max(1e-30);
    match (x < 0.0, y >= 0.0) {
        (false, _) => across,
        (true, true) => 2.0 - across,
        (true, false) => -2.0 - across,
    }
}

/// [`turn_of`] for sixteen.
#[inline(always)]
fn turns_of<S: Simd>(x: f32x16<S>, y: f32x16<S>) -> f32x16<S> {
    let simd = x.simd;
    let (zero, two) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 2.0));
    let across = y / max(x.abs() + y.abs(), f32x16::splat(simd, 1e-30));
    let behind = y.simd_ge(zero).select(two, -two) - across;
    x.simd_lt(zero).select(behind, across)
}

#[inline(always)]
fn rotate<S: Simd>(rows: &[[f32; 3]; 3], point: &Points<S>) -> Points<S> {
    let [x, y, z] = *point;
    [
        (x * rows[0][0] + y * rows[0][1]) + z * rows[0][2],
        (x * rows[1][0] + y * rows[1][1]) + z * rows[1][2],
        (x * rows[2][0] + y * rows[2][1]) + z * rows[2][2],
    ]
}

/// Least and greatest coordinate, and the greatest of 1 + u² + v², which bounds what an error of direction does
/// to a coordinate.
#[inline(always)]
fn spread_of<S: Simd>(u: &[f32x16<S>; 3], v: &[f32x16<S>; 3]) -> ([f32x16<S>; 2], [f32x16<S>; 2], f32x16<S>) {
    let low = [min(min(u[0], u[1]), u[2]), min(min(v[0], v[1]), v[2])];
    let high = [max(max(u[0], u[1]), u[2]), max(max(v[0], v[1]), v[2])];
    let (far_u, far_v) = (max(-low[0], high[0]), max(-low[1], high[1]));
    ([low[0], high[0]], [low[1], high[1]], (far_u * far_u + far_v * far_v) + 1.0)
}

/// Distance of 0 from an interval: 0 inside.
#[inline(always)]
fn outside<S: Simd>(low: f32x16<S>, high: f32x16<S>) -> f32x16<S> {
    max(max(low, -high), f32x16::splat(low.simd, 0.0))
}

impl Chart {
    pub(super) fn new(kind: Kind, axes: [DVec3; 3]) -> Self {
        Self {
            kind,
            rows: axes.map(|axis| axis.as_vec3().to_array()),
            axes: axes.map(|axis| axis.to_array()),
        }
    }

    /// Where a direction of length 1 lies.
    pub(super) fn coordinates(&self, direction: DVec3) -> [f32; 2] {
        let point = DMat3::from_cols_array_2d(&self.axes).transpose() * direction;
        let [u, v] = match self.kind {
            Kind::Perspective => [point.y / point.x, point.z / point.x],
            Kind::Stereographic => [point.y / (1.0 + point.x), point.z / (1.0 + point.x)],
            Kind::Cylindrical => {
                let level = sqrt(point.x * point.x + point.y * point.y);
                [turn_of(point.x, point.y), point.z / (level + 1.0)]
            }
        };
        [u as f32, v as f32]
    }

    /// Windows that hold the boxes.
    #[inline(always)]
    pub(super) fn windows_of_boxes<S: Simd>(&self, simd: S, low: &Points<S>, high: &Points<S>) -> Windows<S> {
        let (mut centre, mut half) = (*low, *low);
        for axis in 0..3 {
            centre[axis] = (low[axis] + high[axis]) * 0.5;
            half[axis] = (high[axis] - low[axis]) * 0.500_001;
        }
        // Rounding moves the turned box by less than that.
        let far = |axis: usize| centre[axis].abs() + half[axis];
        let slack = max(max(far(0), far(1)), far(2)) * 1e-6;
        centre = rotate(&self.rows, &centre);
        let reach = rotate(&self.rows.map(|row| row.map(f32::abs)), &half);
        let (mut low, mut high) = (centre, centre);
        for axis in 0..3 {
            half[axis] = reach[axis] + slack;
            low[axis] = centre[axis] - half[axis];
            high[axis] = centre[axis] + half[axis];
        }
        match self.kind {
            Kind::Perspective => boxes_in_perspective(simd, &low, &high),
            Kind::Stereographic => balls_in_stereographic(simd, &centre, &half),
            Kind::Cylindrical => boxes_in_cylindrical(simd, &low, &high),
        }
    }

    /// Windows that hold the triangles.
    #[inline(always)]
    pub(super) fn windows_of_triangles<S: Simd>(
        &self,
        simd: S,
        corners: &[Points<S>; 3],
        valid: mask32x16<S>,
    ) -> Windows<S> {
        let turned = [
            rotate(&self.rows, &corners[0]),
            rotate(&self.rows, &corners[1]),
            rotate(&self.rows, &corners[2]),
        ];
        let (mut windows, sure) = match self.kind {
            Kind::Perspective => triangles_in_perspective(simd, &turned),
            Kind::Stereographic => triangles_in_stereographic(simd, &turned),
            Kind::Cylindrical => triangles_in_cylindrical(simd, &turned),
        };
        if (valid & !sure).any_true() {
            let (low, high) = bounds_of(corners);
            let loose = self.windows_of_boxes(simd, &low, &high);
            for end in 0..2 {
                windows.u[end] = sure.select(windows.u[end], loose.u[end]);
                windows.v[end] = sure.select(windows.v[end], loose.v[end]);
            }
            windows.some = sure | loose.some;
        }
        windows.some &= valid;
        windows
    }
}

#[inline(always)]
fn boxes_in_perspective<S: Simd>(simd: S, low: &Points<S>, high: &Points<S>) -> Windows<S> {
    let (one, zero, tiny) = (f32x16::splat(simd, 1.0), f32x16::splat(simd, 0.0), f32x16::splat(simd, 1e-12));
    let nearest = one / max(low[0], tiny);
    let farthest = one / max(high[0], tiny);
    let slopes = |axis: usize| {
        let most = high[axis] * high[axis].simd_gt(zero).select(nearest, farthest);
        let least = low[axis] * low[axis].simd_lt(zero).select(nearest, farthest);
        // Slopes of up to 3 are in the chart.
        [least - 10.0 * MARGIN, most + 10.0 * MARGIN]
    };
    Windows { u: slopes(1), v: slopes(2), some: high[0].simd_gt(tiny) }
}

/// Where all corners are well in front, and then the windows.
#[inline(always)]
fn triangles_in_perspective<S: Simd>(simd: S, corners: &[Points<S>; 3]) -> (Windows<S>, mask32x16<S>) {
    let one = f32x16::splat(simd, 1.0);
    let (mut u, mut v) = ([one; 3], [one; 3]);
    let mut sure = mask32x16::splat(simd, true);
    for (index, corner) in corners.iter().enumerate() {
        let ahead = max((corner[1].abs() + corner[2].abs()) * 1e-3, f32x16::splat(simd, 1e-12));
        sure &= corner[0].simd_gt(ahead);
        let inverse = one / max(corner[0], ahead);
        u[index] = corner[1] * inverse;
        v[index] = corner[2] * inverse;
    }
    let (u, v, steepness) = spread_of(&u, &v);
    let margin = steepness * MARGIN;
    (Windows { u: [u[0] - margin, u[1] + margin], v: [v[0] - margin, v[1] + margin], some: sure }, sure)
}

/// The balls around the boxes: the image of a ball's outline is a circle.
#[inline(always)]
fn balls_in_stereographic<S: Simd>(simd: S, centre: &Points<S>, half: &Points<S>) -> Windows<S> {
    let one = f32x16::splat(simd, 1.0);
    let radius = (half[0] * half[0] + half[1] * half[1]) + half[2] * half[2];
    let distance = (centre[0] * centre[0] + centre[1] * centre[1]) + centre[2] * centre[2];
    let per_distance = one / max(distance, f32x16::splat(simd, 1e-30));
    let sine_squared = min(radius * per_distance, one);
    let (sine, cosine) = (sine_squared.sqrt(), (one - sine_squared).sqrt());
    let shorter = per_distance.sqrt();
    let ahead = centre[0] * shorter + cosine;
    let least_ahead = f32x16::splat(simd, 0.02);
    let inverse = one / max(ahead, least_ahead);
    let (u, v) = (centre[1] * shorter * inverse, centre[2] * shorter * inverse);
    let reach = sine * inverse;
    let (far_u, far_v) = (u.abs() + reach, v.abs() + reach);
    let reach = reach + ((far_u * far_u + far_v * far_v) + 1.0) * MARGIN;
    // The ball holds the origin, nearly, or reaches round to the back.
    let everything = sine_squared.simd_gt(f32x16::splat(simd, 0.95)) | ahead.simd_le(least_ahead);
    let reach = everything.select(f32x16::splat(simd, BEYOND), reach);
    Windows { u: [u - reach, u + reach], v: [v - reach, v + reach], some: mask32x16::splat(simd, true) }
}

/// Where triangles are small and well in front of the back, and then the windows.
#[inline(always)]
fn triangles_in_stereographic<S: Simd>(simd: S, corners: &[Points<S>; 3]) -> (Windows<S>, mask32x16<S>) {
    let one = f32x16::splat(simd, 1.0);
    let (mut u, mut v) = ([one; 3], [one; 3]);
    let mut sure = mask32x16::splat(simd, true);
    for (index, corner) in corners.iter().enumerate() {
        let [x, y, z] = *corner;
        let length = ((x * x + y * y) + z * z).sqrt();
        let ahead = max(length * 0.05, f32x16::splat(simd, 1e-12));
        sure &= (length + x).simd_gt(ahead);
        let inverse = one / max(length + x, ahead);
        u[index] = y * inverse;
        v[index] = z * inverse;
    }
    let (u, v, steepness) = spread_of(&u, &v);
    let (across, down) = (u[1] - u[0], v[1] - v[0]);
    let square = across * across + down * down;
    sure &= square.simd_lt(f32x16::splat(simd, 0.04));
    // Edges are arcs of circles of radius 1 or more: they rise above a chord c by little more than c²/8.
    let margin = steepness * MARGIN + square * 0.14;
    (Windows { u: [u[0] - margin, u[1] + margin], v: [v[0] - margin, v[1] + margin], some: sure }, sure)
}

/// The interval of azimuths of points of which each is within half a turn of the others, and all of them where
/// there is none such. It may go past the seam.
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
    // With the margin an interval may begin before the seam, too.
    let before = from.simd_lt(f32x16::splat(simd, -TURN * 0.5));
    let (from, to) = (before.select(from + turn, from), before.select(to + turn, to));
    let half = f32x16::splat(simd, TURN * 0.5);
    ([some.select(from, -half), some.select(to, half)], some)
}

/// What rounding may do to azimuths of points at least that far from the axis.
#[inline(always)]
fn azimuth_margin<S: Simd>(from_axis: f32x16<S>, farthest: f32x16<S>) -> f32x16<S> {
    let simd = farthest.simd;
    let error = farthest * 1e-6 / max(from_axis, f32x16::splat(simd, 1e-30));
    min(error, f32x16::splat(simd, TURN)) + MARGIN
}

#[inline(always)]
fn boxes_in_cylindrical<S: Simd>(simd: S, low: &Points<S>, high: &Points<S>) -> Windows<S> {
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
    // The box has been widened by what rounding may do.
    let (u, _) = azimuths(simd, turns, f32x16::splat(simd, MARGIN));
    Windows { u, v, some: mask32x16::splat(simd, true) }
}

/// Where triangles are small as seen from the axis, and then the windows.
#[inline(always)]
fn triangles_in_cylindrical<S: Simd>(simd: S, corners: &[Points<S>; 3]) -> (Windows<S>, mask32x16<S>) {
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
    // An edge's great circle bulges above its ends by up to a sixteenth of the square of the azimuths between
    // them, which are up to twice their measure.
    let margin = span * span * 0.28 + MARGIN;
    let v =
        [min(min(rises[0], rises[1]), rises[2]) - margin, max(max(rises[0], rises[1]), rises[2]) + margin];
    (Windows { u, v, some: sure }, sure)
}
