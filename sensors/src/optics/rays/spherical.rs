//! Rays of a spinning lidar: columns by azimuth and rows by elevation, both equally spaced, with length 1, so that t is
//! the range.

mod angles;
mod grid;
mod tables;
mod windows;

pub use grid::SphericalGrid;
pub(crate) use tables::AngleSteps;

use super::projection::{
    Planes, Points, Projection, Rectangles, bounds_of, dot, inverse_distance, max, min, of_length_one,
    of_rows, outside,
};
use super::ray_grid::RayGrid;
use crate::simd::{WIDTH, sqrt_f32};
use angles::{atan2, azimuth_error, magnitude};
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, f64x8, i32x16, mask32x16};
use glam::DVec3;

/// An upper bound on the error of [`atan2`] and the rounding around it, in radians.
const ANGLE_MARGIN: f32 = 4e-6;

/// Margin of a slab on both sides of its rays, as the tangent of an angle: many times the rounding error …
const SLAB_MARGIN: f32 = 4e-5;
/// … unless rays are steep or a strip is wide. There are no slabs if the cosine of the elevation, or of half a strip's
/// width, is less than this.
const SLAB_COSINE: f32 = 0.25;

/// Cosines and sines of the grid's angles, in memory that the caller provides.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SphericalRays<'a> {
    ray_grid: RayGrid,
    /// Cosine and sine of each column's azimuth and each row's elevation, in double precision.
    azimuths: &'a [[f64; 2]],
    elevations: &'a [[f64; 2]],
    /// First and last row to draw.
    rows: [i32; 2],
    /// Cosines and sines of the azimuths, column by column, padded to whole blocks.
    cos_azimuth: &'a [f32],
    sin_azimuth: &'a [f32],
    /// Cosines and sines of the elevations, for the lanes of each row of blocks.
    cos_elevation: &'a [[f32; WIDTH]],
    sin_elevation: &'a [[f32; WIDTH]],
    /// Cosines and sines of the middle azimuths of block columns, with sixteen more so that vectors can be read.
    cos_middle: &'a [f32],
    sin_middle: &'a [f32],
    /// Cosine and sine of the middle elevations of block rows.
    levels: &'a [[f32; 2]],
    /// Upper bound on the distance of a block's directions from the direction of its middle.
    radius: f32,
    /// The least cosine and the greatest sine of azimuth offsets within a block from its middle.
    arc: [f32; 2],
    first_azimuth: f32,
    columns_per_radian: f32,
    first_elevation: f32,
    rows_per_radian: f32,
    /// Margins by which intervals of columns and of rows are widened.
    column_margin: f32,
    row_margin: f32,
    /// Number of columns and of rows in a full turn.
    turn: f32,
    row_turn: f32,
    /// True if the columns close to a ring: the first follows the last.
    ring: bool,
    /// True if the columns continue for more than a turn.
    overlaps: bool,
    /// True if some rows are beyond a pole, where rays look in the opposite direction.
    tumbles: bool,
}

impl SphericalRays<'_> {
    /// The exact directions of the rays of a block, eight lanes at a time.
    #[inline(always)]
    fn exact<S: Simd>(&self, simd: S, column: usize, row: usize) -> [[f64x8<S>; 2]; 3] {
        let directions = self.exact_block(column, row);
        let half = |axis: usize, first: usize| f64x8::from_slice(simd, &directions[axis][first..][..8]);
        [[half(0, 0), half(0, 8)], [half(1, 0), half(1, 8)], [half(2, 0), half(2, 8)]]
    }
}

impl SphericalRays<'_> {
    /// The exact directions of sixteen adjacent rays in a row, eight lanes at a time; beyond its end, the last ray is
    /// repeated.
    #[inline(always)]
    pub(super) fn exact_line<S: Simd>(&self, simd: S, column: usize, row: usize) -> [[f64x8<S>; 2]; 3] {
        let [level, up] = self.elevations[row];
        let up = f64x8::splat(simd, up);
        let mut line = [[up; 2]; 3];
        for half in 0..2 {
            let (mut cos, mut sin) = ([0.0; WIDTH / 2], [0.0; WIDTH / 2]);
            for lane in 0..WIDTH / 2 {
                let column = (column + half * WIDTH / 2 + lane).min(self.ray_grid.width as usize - 1);
                [cos[lane], sin[lane]] = self.azimuths[column];
            }
            line[0][half] = f64x8::load_array(simd, cos) * level;
            line[1][half] = f64x8::load_array(simd, sin) * level;
        }
        line
    }
}

impl Projection for SphericalRays<'_> {
    of_rows!();
    of_length_one!();

    const HAS_STRIPS: bool = true;

    fn direction(&self, column: i32, row: i32) -> DVec3 {
        let ([cos, sin], [level, up]) = (self.azimuths[column as usize], self.elevations[row as usize]);
        DVec3::new(cos * level, sin * level, up)
    }

    #[inline(always)]
    fn exact_block(&self, column: usize, row: usize) -> [[f64; WIDTH]; 3] {
        let mut directions = [[0.0; WIDTH]; 3];
        for lane in 0..WIDTH {
            let (x, y) = self.ray_grid.lane_position(lane);
            let column = ((column << self.ray_grid.shift_x) + x).min(self.ray_grid.width as usize - 1);
            let row = ((row << self.ray_grid.shift_y) + y).min(self.ray_grid.height as usize - 1);
            let ([cos, sin], [level, up]) = (self.azimuths[column], self.elevations[row]);
            directions[0][lane] = cos * level;
            directions[1][lane] = sin * level;
            directions[2][lane] = up;
        }
        directions
    }

    #[inline(always)]
    fn block<S: Simd>(&self, simd: S, column: usize, row: usize) -> Self::Directions<S> {
        let (cos, sin) = if self.ray_grid.shift_x == 2 {
            let four = |values: &[f32]| {
                f32x16::block_splat(fearless_simd::f32x4::from_slice(simd, &values[column * 4..][..4]))
            };
            (four(self.cos_azimuth), four(self.sin_azimuth))
        } else {
            let sixteen = |values: &[f32]| f32x16::from_slice(simd, &values[column * WIDTH..][..WIDTH]);
            (sixteen(self.cos_azimuth), sixteen(self.sin_azimuth))
        };
        let level = f32x16::load_array_ref(simd, &self.cos_elevation[row]);
        [cos * level, sin * level, f32x16::load_array_ref(simd, &self.sin_elevation[row])]
    }

    #[inline(always)]
    fn rays<S: Simd>(&self, simd: S, columns: i32x16<S>, rows: i32x16<S>) -> Self::Directions<S> {
        let RayGrid { shift_x, shift_y, height, .. } = self.ray_grid;
        // Finished lanes are past the end; any value will do for them.
        let columns = columns.min(i32x16::splat(simd, self.cos_azimuth.len() as i32 - 1));
        let rows = rows.min(i32x16::splat(simd, height - 1));
        let lines = (rows >> shift_y) * WIDTH as i32 + ((rows & ((1 << shift_y) - 1)) << shift_x);
        let (mut at_column, mut at_line) = ([0_i32; WIDTH], [0_i32; WIDTH]);
        columns.store_array(&mut at_column);
        lines.store_array(&mut at_line);
        let (levels, ups) = (self.cos_elevation.as_flattened(), self.sin_elevation.as_flattened());
        let mut values = [[0.0_f32; WIDTH]; 3];
        for lane in 0..WIDTH {
            let (column, line) = (at_column[lane] as usize, at_line[lane] as usize);
            let level = levels[line];
            values[0][lane] = self.cos_azimuth[column] * level;
            values[1][lane] = self.sin_azimuth[column] * level;
            values[2][lane] = ups[line];
        }
        [
            f32x16::load_array_ref(simd, &values[0]),
            f32x16::load_array_ref(simd, &values[1]),
            f32x16::load_array_ref(simd, &values[2]),
        ]
    }

    #[inline(always)]
    fn ray<S: Simd>(&self, simd: S, column: i32, row: i32) -> Self::Directions<S> {
        let (block, place) = ((row >> self.ray_grid.shift_y) as usize, self.ray_grid.lane(0, row));
        let level = self.cos_elevation[block][place];
        [
            f32x16::splat(simd, self.cos_azimuth[column as usize] * level),
            f32x16::splat(simd, self.sin_azimuth[column as usize] * level),
            f32x16::splat(simd, self.sin_elevation[block][place]),
        ]
    }

    #[inline(always)]
    fn bound_boxes<S: Simd>(&self, simd: S, low: &Points<S>, high: &Points<S>) -> Rectangles<S> {
        let zero = f32x16::splat(simd, 0.0);
        let (x, y) = (outside(low[0], high[0]), outside(low[1], high[1]));
        let nearest = (x * x + y * y).sqrt();
        let (x, y) = (magnitude(low[0], high[0]), magnitude(low[1], high[1]));
        let farthest = (x * x + y * y).sqrt();
        let (elevation, candidates) = self.elevations_of_boxes(simd, low[2], high[2], nearest, farthest);
        // Seen from above, a box that does not contain the axis lies between two of its corners.
        let (left, right) = (low[1].simd_gt(zero), high[1].simd_lt(zero));
        let ahead = low[0].simd_gt(zero);
        let behind = high[0].simd_lt(zero);
        let clockwise = [
            left.select(high[0], right.select(low[0], ahead.select(low[0], high[0]))),
            left.select(behind.select(high[1], low[1]), ahead.select(low[1], high[1])),
        ];
        let counter = [
            left.select(low[0], right.select(high[0], ahead.select(low[0], high[0]))),
            left.select(
                ahead.select(high[1], low[1]),
                right.select(behind.select(low[1], high[1]), ahead.select(high[1], low[1])),
            ),
        ];
        let from = atan2(clockwise[1], clockwise[0]);
        let cross = clockwise[0] * counter[1] - clockwise[1] * counter[0];
        let dot = clockwise[0] * counter[0] + clockwise[1] * counter[1];
        let length = atan2(max(cross, zero), dot);
        let all_round =
            low[0].simd_le(zero) & high[0].simd_ge(zero) & low[1].simd_le(zero) & high[1].simd_ge(zero);
        self.rectangles(simd, from, [zero, length], elevation, all_round, candidates)
    }

    #[inline(always)]
    fn bound_triangles<S: Simd>(
        &self,
        simd: S,
        corners: &[Points<S>; 3],
        valid: mask32x16<S>,
    ) -> (Rectangles<S>, f32x16<S>) {
        let (low, high) = bounds_of(corners);
        let nearest = self.inverse_of_boxes(simd, &low, &high);
        let zero = f32x16::splat(simd, 0.0);
        // Angles relative to the centroid. For small triangles, tan(angle) = cross / dot bounds the angle closely.
        let x = (corners[0][0] + corners[1][0]) + corners[2][0];
        let y = (corners[0][1] + corners[1][1]) + corners[2][1];
        let z = (corners[0][2] + corners[1][2]) + corners[2][2];
        let level = (x * x + y * y).sqrt();
        let (mut from, mut to, mut below, mut above) = (zero, zero, zero, zero);
        let mut least = f32x16::splat(simd, f32::MAX);
        let mut lowest = level;
        for corner in corners {
            let dot = x * corner[0] + y * corner[1];
            let turn = (x * corner[1] - y * corner[0]) / max(dot, f32x16::splat(simd, 1e-30));
            from = min(from, turn);
            to = max(to, turn);
            let corner_level = (corner[0] * corner[0] + corner[1] * corner[1]).sqrt();
            lowest = min(lowest, corner_level);
            let rise_dot = level * corner_level + z * corner[2];
            let rise = (level * corner[2] - z * corner_level) / max(rise_dot, f32x16::splat(simd, 1e-30));
            below = min(below, rise);
            above = max(above, rise);
            // Both dot products show that the corner is within a right angle of the centroid.
            least = min(least, min(dot, rise_dot));
        }
        let spread = to - from;
        let small = spread.simd_lt(f32x16::splat(simd, 0.4))
            & (above - below).simd_lt(f32x16::splat(simd, 0.4))
            & least.simd_gt(f32x16::splat(simd, 1e-25));
        // The great circle of an edge bulges above its ends.
        let bulge = spread * spread * 0.07;
        let rise = atan2(z, level);
        let elevation = [rise + below - bulge, rise + above + bulge];
        let azimuth = atan2(y, x);
        let farthest =
            max(magnitude(low[2], high[2]), max(magnitude(low[0], high[0]), magnitude(low[1], high[1])));
        let unsure = azimuth_error(lowest, farthest);
        let (from, to) = (from - unsure, to + unsure);
        let never = mask32x16::splat(simd, false);
        let mut close = self.rectangles(simd, azimuth, [from, to], elevation, never, valid);
        if (valid & !small).any_true() {
            // Rounding may have moved a corner on the vertical axis off it.
            let slack = farthest * 1e-6;
            let (mut low, mut high) = (low, high);
            for axis in 0..2 {
                (low[axis], high[axis]) = (low[axis] - slack, high[axis] + slack);
            }
            let loose = self.bound_boxes(simd, &low, &high);
            close.first_column = small.select(close.first_column, loose.first_column);
            close.last_column = small.select(close.last_column, loose.last_column);
            close.first_row = small.select(close.first_row, loose.first_row);
            close.last_row = small.select(close.last_row, loose.last_row);
            close.some = valid & ((small & close.some) | (!small & loose.some));
        }
        (close, nearest)
    }

    #[inline(always)]
    fn most_over_blocks<S: Simd>(&self, simd: S, plane: &[f32; 3], column: usize, row: usize) -> f32x16<S> {
        let cos = f32x16::from_slice(simd, &self.cos_middle[column..][..WIDTH]);
        let sin = f32x16::from_slice(simd, &self.sin_middle[column..][..WIDTH]);
        let [cos_level, sin_level] = self.levels[row];
        // The tighter bound of `most_over_strip` costs more than it saves here: S1/R3 would be 10 % slower.
        let length = sqrt_f32(plane[0] * plane[0] + plane[1] * plane[1] + plane[2] * plane[2]);
        (cos * (plane[0] * cos_level) + sin * (plane[1] * cos_level))
            + (plane[2] * sin_level + length * self.radius)
    }

    #[inline(always)]
    fn most_over_strip<S: Simd>(&self, _simd: S, planes: &Planes<S>, column: usize, row: usize) -> f32x16<S> {
        // At δ from the middle, plane · direction = along · cos δ + across · sin δ + the contribution of z.
        let [level, up] = self.levels[row];
        let (cos, sin) = (self.cos_middle[column] * level, self.sin_middle[column] * level);
        let along = planes[0] * cos + planes[1] * sin;
        let across = planes[1] * cos - planes[0] * sin;
        let [cos_arc, sin_arc] = self.arc;
        let rounding = ((planes[0].abs() + planes[1].abs()) + planes[2].abs()) * 4e-6;
        (max(along, along * cos_arc) + across.abs() * sin_arc) + (planes[2] * up + rounding)
    }

    #[inline(always)]
    fn slab(&self, column: usize, row: usize) -> Option<[[f32; 3]; 2]> {
        let [level, up] = self.levels[row];
        if level < SLAB_COSINE || self.arc[0] < SLAB_COSINE {
            return None;
        }
        // A plane through the origin that rises by the angle p towards the middle azimuth of the strip has, at an
        // azimuth offset of δ, the elevation atan(tan p · cos δ). All rays have one elevation, so a plane that rises at
        // their elevation touches them at the middle, and one with the tangent multiplied by 1/cos δ touches them at
        // both ends. Multiplied by the cosine of the elevation:
        let (near, far) = (up, up / self.arc[0]);
        let (low, high) = if up < 0.0 { (far, near) } else { (near, far) };
        let (low, high) = (low - SLAB_MARGIN, high + SLAB_MARGIN);
        let (cos, sin) = (self.cos_middle[column], self.sin_middle[column]);
        Some([[-(low * cos), -(low * sin), level], [high * cos, high * sin, -level]])
    }
}
