//! Conversion of intervals of angles to columns and rows.

use super::SphericalRays;
use super::angles::{atan2, magnitude};
use crate::optics::rays::Rectangles;
use crate::optics::rays::projection::{max, min, whole};
use core::f32::consts::PI;
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, i32x16, mask32x16};

impl SphericalRays<'_> {
    /// Intervals of elevation that contain boxes at a given height (`low` to `high`) and distance from the axis
    /// (`nearest` to `farthest`), and a mask of the boxes that can be hit by a ray at their height at all.
    #[inline(always)]
    pub(super) fn elevations_of_boxes<S: Simd>(
        &self,
        simd: S,
        low: f32x16<S>,
        high: f32x16<S>,
        nearest: f32x16<S>,
        farthest: f32x16<S>,
    ) -> ([f32x16<S>; 2], mask32x16<S>) {
        let [cos, sin] = self.levels[0];
        if self.ray_grid.height == 1 && cos > 0.01 {
            // A single row is a cone around the axis: compare the bottom and top of the box with it.
            let (top, bottom) = if sin > 0.0 { (nearest, farthest) } else { (farthest, nearest) };
            let slack = (magnitude(low, high) + farthest) * 1e-5;
            let some = (low * cos - bottom * sin).simd_le(slack) & (high * cos - top * sin).simd_ge(-slack);
            return ([f32x16::splat(simd, self.first_elevation); 2], some);
        }
        let zero = f32x16::splat(simd, 0.0);
        let elevation = [
            atan2(low, low.simd_lt(zero).select(nearest, farthest)),
            atan2(high, high.simd_gt(zero).select(nearest, farthest)),
        ];
        (elevation, mask32x16::splat(simd, true))
    }

    /// Converts intervals of elevation and of azimuth (its middle, and the offsets to both sides) to rays.
    #[inline(always)]
    pub(super) fn rectangles<S: Simd>(
        &self,
        simd: S,
        middle: f32x16<S>,
        [from, to]: [f32x16<S>; 2],
        elevation: [f32x16<S>; 2],
        all_round: mask32x16<S>,
        candidates: mask32x16<S>,
    ) -> Rectangles<S> {
        if self.tumbles {
            return self.rectangles_beyond(simd, middle, [from, to], elevation, all_round, candidates);
        }
        let rows = indices(elevation, self.first_elevation, self.rows_per_radian);
        let [first_row, last_row] = whole(simd, rows, self.row_margin, self.rows);

        let margin = self.column_margin;
        let columns = indices([middle + from, middle + to], self.first_azimuth, self.columns_per_radian);
        let first = columns[0] - margin;
        let length = (columns[1] - columns[0]) + 2.0 * margin;
        let turn = f32x16::splat(simd, self.turn);
        let last_column = f32x16::splat(simd, (self.ray_grid.width - 1) as f32);
        let zero = f32x16::splat(simd, 0.0);
        // The interval from [0, turn) on, and the same interval one turn earlier.
        let first = first - turn * simd.floor_f32x16(first / turn);
        let last = first + length;
        let starts = first.simd_le(last_column);
        let comes_round = last.simd_ge(turn);
        let both = starts & comes_round;
        let (begin, end) = if self.ring {
            (simd.ceil_f32x16(first), simd.floor_f32x16(last))
        } else {
            // Visible at both ends: take all columns, which is rare.
            let begin = both.select(zero, comes_round.select(zero, first));
            let mut end = both.select(
                last_column,
                comes_round.select(min(last - turn, last_column), min(last, last_column)),
            );
            if self.overlaps {
                // The interval one turn later.
                end = (first + turn).simd_le(last_column).select(last_column, end);
            }
            (simd.ceil_f32x16(begin), simd.floor_f32x16(end))
        };
        let all_round = all_round | length.simd_ge(turn - 1.0);
        let begin = all_round.select(zero, begin);
        let end = all_round.select(last_column, end);
        let limit = f32x16::splat(simd, 65_535.0);
        let first_column = simd.cvt_i32_f32x16(min(begin, limit));
        let last = simd.cvt_i32_f32x16(min(end, limit));
        // An interval of a ring that starts after the last column starts at the first one.
        let width = i32x16::splat(simd, self.ray_grid.width);
        let over = first_column.simd_ge(width);
        let none = i32x16::splat(simd, 0);
        let (first_column, last) = if self.ring {
            (over.select(first_column - width, first_column), over.select(last - width, last))
        } else {
            (first_column, last)
        };
        let some = candidates
            & first_row.simd_le(last_row)
            & first_column.simd_le(last)
            & last.simd_ge(none)
            & first_column.simd_lt(width);
        Rectangles { first_column, last_column: last, first_row, last_row, some }
    }

    /// The same conversion for a grid with rows beyond a pole: something is seen at its own elevation, and also at its
    /// elevation counted over the pole, by the columns on the opposite side.
    #[inline(never)]
    fn rectangles_beyond<S: Simd>(
        &self,
        simd: S,
        middle: f32x16<S>,
        [from, to]: [f32x16<S>; 2],
        [low, high]: [f32x16<S>; 2],
        all_round: mask32x16<S>,
        candidates: mask32x16<S>,
    ) -> Rectangles<S> {
        simd.vectorize(
            #[inline(always)]
            || {
                let half_turn = f32x16::splat(simd, PI);
                let columns = [0, self.ray_grid.width - 1];
                let window = |middle: f32x16<S>, elevation: [f32x16<S>; 2]| {
                    let across =
                        indices([middle + from, middle + to], self.first_azimuth, self.columns_per_radian);
                    let across = over_turns(across, self.column_margin, self.turn, columns);
                    let all = [f32x16::splat(simd, 0.0), f32x16::splat(simd, columns[1] as f32)];
                    let across = [all_round.select(all[0], across[0]), all_round.select(all[1], across[1])];
                    let down = indices(elevation, self.first_elevation, self.rows_per_radian);
                    let down = over_turns(down, self.row_margin, self.row_turn, self.rows);
                    let some = across[0].simd_le(across[1]) & down[0].simd_le(down[1]) & candidates;
                    ([across[0], down[0]], [across[1], down[1]], some)
                };
                let (first, last, ahead) = window(middle, [low, high]);
                let (first_over, last_over, over) =
                    window(middle + half_turn, [half_turn - high, half_turn - low]);
                let both = |own: f32x16<S>, other: f32x16<S>, joined: f32x16<S>| {
                    ahead.select(over.select(joined, own), other)
                };
                let least = |axis: usize| {
                    let value = both(first[axis], first_over[axis], min(first[axis], first_over[axis]));
                    simd.cvt_i32_f32x16(value)
                };
                let most = |axis: usize| {
                    let value = both(last[axis], last_over[axis], max(last[axis], last_over[axis]));
                    simd.cvt_i32_f32x16(value)
                };
                Rectangles {
                    first_column: least(0),
                    last_column: most(0),
                    first_row: least(1),
                    last_row: most(1),
                    some: ahead | over,
                }
            },
        )
    }
}

/// Converts intervals of angles to intervals of columns or rows.
#[inline(always)]
fn indices<S: Simd>([low, high]: [f32x16<S>; 2], first: f32, per_radian: f32) -> [f32x16<S>; 2] {
    let (a, b) = ((low - first) * per_radian, (high - first) * per_radian);
    [min(a, b), max(a, b)]
}

/// The first and last integer from `least` to `most` in the intervals widened by `margin`, or in the intervals shifted
/// by any number of `turn`s; first > last if there are none.
#[inline(always)]
fn over_turns<S: Simd>(
    [first, last]: [f32x16<S>; 2],
    margin: f32,
    turn: f32,
    [least, most]: [i32; 2],
) -> [f32x16<S>; 2] {
    let simd = first.simd;
    let (first, last) = (first - margin, last + margin);
    let length = last - first;
    let (least, most) = (f32x16::splat(simd, least as f32), f32x16::splat(simd, most as f32));
    // The earliest interval that ends within the range, and the latest that starts within it.
    let after = last - least;
    let earliest = (after - simd.floor_f32x16(after / turn) * turn) + least - length;
    let before = most - first;
    let latest = most - (before - simd.floor_f32x16(before / turn) * turn) + length;
    let all = length.simd_ge(f32x16::splat(simd, turn - 1.0));
    let begin = all.select(least, simd.ceil_f32x16(max(earliest, least)));
    let end = all.select(most, simd.floor_f32x16(min(latest, most)));
    // A start that is too late might exceed the range of integers.
    [min(begin, most + 1.0), max(end, least - 1.0)]
}
