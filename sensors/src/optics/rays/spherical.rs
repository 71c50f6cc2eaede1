//! Rays of a spinning lidar: columns by azimuth, rows by elevation, both in equal steps, so that t is the range.

use super::fan::Fan;
use super::projection::{Planes, Points, Projection, Rectangles, bounds_of, max, min, whole};
use crate::scene::tree::WIDTH;
use crate::simd::{sin_cos, sqrt, sqrt_f32};
use core::f32::consts::{FRAC_PI_2, PI, TAU};
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, i32x16, mask32x16};
use glam::DVec3;

/// The rays of a spinning lidar. Angles in radians; azimuth is counter-clockwise seen from +z, elevation up. Any finite
/// angles will do: azimuth a and elevation e are the direction (cos a cos e, sin a cos e, sin e), so beyond a pole rays
/// look the other way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphericalGrid {
    /// Columns, 1 … [`MAX_GRID_SIZE`](crate::optics::MAX_GRID_SIZE).
    pub columns: u32,
    /// Rows, 1 … [`MAX_GRID_SIZE`](crate::optics::MAX_GRID_SIZE).
    pub rows: u32,
    /// Of the first column.
    pub first_azimuth_rad: f64,
    /// From a column to the next.
    pub azimuth_step_rad: f64,
    /// Of the first row.
    pub first_elevation_rad: f64,
    /// From a row to the next.
    pub elevation_step_rad: f64,
}

/// More than the error of [`atan2`] and of the roundings around it, in radians.
const ANGLE_MARGIN: f32 = 4e-6;
/// Nearer than that in metres, ranges are not told apart when something is projected.
const TINY: f32 = 1e-12;
/// Grids that are narrower, in radians, are bounded as a whole.
const NARROW: f64 = 1e-5;

/// Cosines and sines of the grid's angles, in the caller's memory.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SphericalFan<'a> {
    fan: Fan,
    /// Cosine and sine of each column's azimuth and each row's elevation, exactly.
    azimuths: &'a [[f64; 2]],
    elevations: &'a [[f64; 2]],
    /// First and last row to draw.
    rows: [i32; 2],
    /// Of azimuths, column by column, filled up to whole blocks.
    cos_azimuth: &'a [f32],
    sin_azimuth: &'a [f32],
    /// Of elevations, for the lanes of each row of blocks.
    cos_elevation: &'a [[f32; WIDTH]],
    sin_elevation: &'a [[f32; WIDTH]],
    /// Of the middle azimuths of block columns, and sixteen more to read.
    cos_middle: &'a [f32],
    sin_middle: &'a [f32],
    /// Cosine and sine of the middle elevations of block rows.
    levels: &'a [[f32; 2]],
    /// No direction of a block is farther from that of its middle.
    radius: f32,
    /// Over the azimuths of a block, from that of its middle: the least cosine and the greatest sine.
    arc: [f32; 2],
    first_azimuth: f32,
    columns_per_radian: f32,
    first_elevation: f32,
    rows_per_radian: f32,
    /// What intervals of columns and of rows are widened by.
    column_margin: f32,
    row_margin: f32,
    /// Columns and rows in a whole turn.
    turn: f32,
    row_turn: f32,
    /// The columns close to a ring: the first follows the last.
    ring: bool,
    /// The columns go on for more than a turn.
    overlaps: bool,
    /// Some rows lie beyond a pole, where rays look the other way.
    tumbles: bool,
}

/// Angles of a grid in radians: that of the first column or row, and the step to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Steps {
    pub(crate) first: f64,
    pub(crate) step: f64,
}

impl Steps {
    /// The same directions by a first angle of at most `most` (π or more) to both sides, and a step of at most half
    /// a turn: single precision must tell the angles apart.
    fn reduced(self, most: f64) -> Self {
        let within = |angle: f64, most: f64| {
            if angle.abs() <= most {
                return angle;
            }
            let (sin, cos) = libm::sincos(angle);
            libm::atan2(sin, cos)
        };
        Self { first: within(self.first, most), step: within(self.step, core::f64::consts::PI) }
    }

    /// Of the last of so many.
    fn last(self, count: i32) -> f64 {
        self.first + self.step * f64::from(count - 1)
    }

    /// Columns or rows per radian, and what bounds are widened by.
    fn density(self, count: i32) -> (f64, f32) {
        let margin = |per_radian: f64| 0.01 + ANGLE_MARGIN * per_radian.abs() as f32;
        if self.step.abs() * f64::from(count - 1) < NARROW {
            // Angles that are all but the same: either none of them or all.
            return (1e3, margin(1e3) + (count - 1) as f32);
        }
        (1.0 / self.step, margin(1.0 / self.step))
    }

    /// The angles of the middles of blocks of 2^`shift` columns or rows, which lie `half` a block from the first.
    #[inline(always)]
    fn of_blocks(self, half: f64, shift: u32) -> Self {
        Self { first: self.first + self.step * half, step: self.step * f64::from(1 << shift) }
    }

    /// Calls `take` with the cosines and sines of each sixteen angles. Those of the first sixteen steps turn the
    /// first angle of each sixteen: a few products, where sine and cosine are dozens of them.
    #[inline(always)]
    fn fill(self, sixteens: usize, mut take: impl FnMut(usize, [f64; WIDTH], [f64; WIDTH])) {
        let (mut cos_step, mut sin_step) = ([0.0; WIDTH], [0.0; WIDTH]);
        for lane in 0..WIDTH {
            (sin_step[lane], cos_step[lane]) = sin_cos(self.step * lane as f64);
        }
        for block in 0..sixteens {
            let (sin, cos) = sin_cos(self.first + self.step * (block * WIDTH) as f64);
            let (mut cosines, mut sines) = ([0.0; WIDTH], [0.0; WIDTH]);
            for lane in 0..WIDTH {
                cosines[lane] = cos * cos_step[lane] - sin * sin_step[lane];
                sines[lane] = sin * cos_step[lane] + cos * sin_step[lane];
            }
            take(block, cosines, sines);
        }
    }
}

impl<'a> SphericalFan<'a> {
    /// Arrays of sixteen that the tables of a grid take.
    pub(crate) const fn table_len(fan: &Fan) -> usize {
        let columns = (fan.width as usize).div_ceil(WIDTH);
        let middles = fan.blocks_across().div_ceil(WIDTH) + 1;
        2 * columns
            + 2 * fan.blocks_down()
            + 2 * middles
            + (2 * fan.blocks_down()).div_ceil(WIDTH)
            + (4 * columns * WIDTH).div_ceil(WIDTH)
            + (4 * fan.blocks_down() * WIDTH).div_ceil(WIDTH)
    }

    /// Fills the tables.
    #[inline(always)]
    pub(crate) fn new(fan: Fan, azimuth: Steps, elevation: Steps, tables: &'a mut [[f32; WIDTH]]) -> Self {
        let (azimuth, elevation) =
            (azimuth.reduced(core::f64::consts::TAU), elevation.reduced(core::f64::consts::PI));
        let columns = (fan.width as usize).div_ceil(WIDTH);
        let (cos_azimuth, rest) = tables.split_at_mut(columns);
        let (sin_azimuth, rest) = rest.split_at_mut(columns);
        let (cos_elevation, rest) = rest.split_at_mut(fan.blocks_down());
        let (sin_elevation, rest) = rest.split_at_mut(fan.blocks_down());
        let middles = fan.blocks_across().div_ceil(WIDTH) + 1;
        let (cos_middle, rest) = rest.split_at_mut(middles);
        let (sin_middle, rest) = rest.split_at_mut(middles);
        let (levels, rest) = rest.split_at_mut((2 * fan.blocks_down()).div_ceil(WIDTH));
        let levels = &mut levels.as_flattened_mut().as_chunks_mut::<2>().0[..fan.blocks_down()];
        let (azimuths, rest) = rest.split_at_mut(4 * columns);
        let azimuths: &mut [[f64; 2]] = bytemuck::cast_slice_mut(azimuths);
        let elevations: &mut [[f64; 2]] = bytemuck::cast_slice_mut(&mut rest[..4 * fan.blocks_down()]);
        azimuth.fill(
            columns,
            #[inline(always)]
            |block, cos, sin| {
                for lane in 0..WIDTH {
                    azimuths[block * WIDTH + lane] = [cos[lane], sin[lane]];
                    cos_azimuth[block][lane] = cos[lane] as f32;
                    sin_azimuth[block][lane] = sin[lane] as f32;
                }
            },
        );
        // One by one: there are few, and at a pole the sign of a cosine must be right, or the ray is none of its
        // column's.
        for (row, angles) in elevations[..fan.blocks_down() << fan.shift_y].iter_mut().enumerate() {
            let (sin, cos) = sin_cos(elevation.first + elevation.step * row as f64);
            *angles = [cos, sin];
        }
        for block in 0..fan.blocks_down() {
            for lane in 0..WIDTH {
                let [cos, sin] = elevations[(block << fan.shift_y) + fan.lane_position(lane).1];
                cos_elevation[block][lane] = cos as f32;
                sin_elevation[block][lane] = sin as f32;
            }
        }
        let half = [((1 << fan.shift_x) - 1) as f64 * 0.5, ((1 << fan.shift_y) - 1) as f64 * 0.5];
        azimuth.of_blocks(half[0], fan.shift_x).fill(
            middles,
            #[inline(always)]
            |block, cos, sin| {
                cos_middle[block] = cos.map(|cos| cos as f32);
                sin_middle[block] = sin.map(|sin| sin as f32);
            },
        );
        elevation.of_blocks(half[1], fan.shift_y).fill(
            levels.len().div_ceil(WIDTH),
            #[inline(always)]
            |block, cos, sin| {
                for (lane, level) in levels[block * WIDTH..].iter_mut().take(WIDTH).enumerate() {
                    *level = [cos[lane] as f32, sin[lane] as f32];
                }
            },
        );
        let reach = [half[0] * azimuth.step, half[1] * elevation.step];
        let arc = if reach[0].abs() <= core::f64::consts::FRAC_PI_2 {
            let (sin, cos) = sin_cos(reach[0].abs());
            [cos as f32, sin as f32]
        } else {
            [-1.0, 1.0]
        };
        let radius = sqrt(reach[0] * reach[0] + reach[1] * reach[1]);
        let (columns_per_radian, column_margin) = azimuth.density(fan.width);
        let (rows_per_radian, row_margin) = elevation.density(fan.height);
        let turn = core::f64::consts::TAU * columns_per_radian.abs();
        let beyond = |angle: f64| angle.abs() > core::f64::consts::FRAC_PI_2;
        let tumbles = beyond(elevation.first) || beyond(elevation.last(fan.height));
        Self {
            fan,
            azimuths,
            elevations,
            rows: [0, fan.height - 1],
            cos_azimuth: cos_azimuth.as_flattened(),
            sin_azimuth: sin_azimuth.as_flattened(),
            cos_elevation,
            sin_elevation,
            cos_middle: cos_middle.as_flattened(),
            sin_middle: sin_middle.as_flattened(),
            levels,
            radius: radius as f32 * 1.0001 + 2e-6,
            arc,
            first_azimuth: azimuth.first as f32,
            columns_per_radian: columns_per_radian as f32,
            first_elevation: elevation.first as f32,
            rows_per_radian: rows_per_radian as f32,
            column_margin,
            row_margin,
            turn: turn as f32,
            row_turn: (core::f64::consts::TAU * rows_per_radian.abs()) as f32,
            ring: (turn - f64::from(fan.width)).abs() < 1e-6 && !tumbles,
            overlaps: turn < f64::from(fan.width),
            tumbles,
        }
    }

    /// Intervals of elevation that hold boxes which lie so far up from the sensor and so far from its axis, and
    /// which of the boxes have a ray at their height at all.
    #[inline(always)]
    fn elevations_of_boxes<S: Simd>(
        &self,
        simd: S,
        low: f32x16<S>,
        high: f32x16<S>,
        nearest: f32x16<S>,
        farthest: f32x16<S>,
    ) -> ([f32x16<S>; 2], mask32x16<S>) {
        let [cos, sin] = self.levels[0];
        if self.fan.height == 1 && cos > 0.01 {
            // One row is a cone around the axis: how far below and above it is the box?
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

    /// From intervals of elevation and of azimuth (its middle, and how far to both sides) to rays.
    #[inline(always)]
    fn rectangles<S: Simd>(
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
        let last_column = f32x16::splat(simd, (self.fan.width - 1) as f32);
        let zero = f32x16::splat(simd, 0.0);
        // The interval from [0, turn) on, and the same a turn earlier.
        let first = first - turn * simd.floor_f32x16(first / turn);
        let last = first + length;
        let starts = first.simd_le(last_column);
        let comes_round = last.simd_ge(turn);
        let both = starts & comes_round;
        let (begin, end) = if self.ring {
            (simd.ceil_f32x16(first), simd.floor_f32x16(last))
        } else {
            // From both ends at once: all of it, which is rare.
            let begin = both.select(zero, comes_round.select(zero, first));
            let mut end = both.select(
                last_column,
                comes_round.select(min(last - turn, last_column), min(last, last_column)),
            );
            if self.overlaps {
                // And once more a turn later.
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
        // A ring's interval that starts after the last column starts at the first.
        let width = i32x16::splat(simd, self.fan.width);
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

    /// The same of a grid with rows beyond a pole: something is seen at its own elevation, and at its elevation over
    /// the pole by the columns that look the other way.
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
                let columns = [0, self.fan.width - 1];
                let window = |middle: f32x16<S>, elevation: [f32x16<S>; 2]| {
                    let across =
                        indices([middle + from, middle + to], self.first_azimuth, self.columns_per_radian);
                    let across = over_turns(across, self.column_margin, self.turn, columns);
                    let all = [f32x16::splat(simd, 0.0), f32x16::splat(simd, columns[1] as f32)];
                    let across = [0, 1].map(|end| all_round.select(all[end], across[end]));
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
                let first = [0, 1].map(|axis| {
                    let value = both(first[axis], first_over[axis], min(first[axis], first_over[axis]));
                    simd.cvt_i32_f32x16(value)
                });
                let last = [0, 1].map(|axis| {
                    let value = both(last[axis], last_over[axis], max(last[axis], last_over[axis]));
                    simd.cvt_i32_f32x16(value)
                });
                Rectangles {
                    first_column: first[0],
                    last_column: last[0],
                    first_row: first[1],
                    last_row: last[1],
                    some: ahead | over,
                }
            },
        )
    }
}

/// Intervals of columns or rows from intervals of angles.
#[inline(always)]
fn indices<S: Simd>([low, high]: [f32x16<S>; 2], first: f32, per_radian: f32) -> [f32x16<S>; 2] {
    let (a, b) = ((low - first) * per_radian, (high - first) * per_radian);
    [min(a, b), max(a, b)]
}

/// The first and last whole number from `least` to `most` that lie in the intervals, widened by `margin`, or in those
/// any number of `turn`s away; first > last if there are none.
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
    let [least, most] = [least, most].map(|end| f32x16::splat(simd, end as f32));
    // The earliest that ends within, and the latest that begins within.
    let after = last - least;
    let earliest = (after - simd.floor_f32x16(after / turn) * turn) + least - length;
    let before = most - first;
    let latest = most - (before - simd.floor_f32x16(before / turn) * turn) + length;
    let all = length.simd_ge(f32x16::splat(simd, turn - 1.0));
    let begin = all.select(least, simd.ceil_f32x16(max(earliest, least)));
    let end = all.select(most, simd.floor_f32x16(min(latest, most)));
    // What begins too late might be beyond what integers hold.
    [min(begin, most + 1.0), max(end, least - 1.0)]
}

/// Signed distance of 0 from an interval: 0 inside.
#[inline(always)]
fn outside<S: Simd>(low: f32x16<S>, high: f32x16<S>) -> f32x16<S> {
    max(max(low, -high), f32x16::splat(low.simd, 0.0))
}

/// The greatest magnitude in an interval.
#[inline(always)]
fn magnitude<S: Simd>(low: f32x16<S>, high: f32x16<S>) -> f32x16<S> {
    max(-low, high)
}

/// What rounding may do to azimuths of points that far from the vertical axis, given their greatest coordinate.
#[inline(always)]
fn azimuth_error<S: Simd>(from_axis: f32x16<S>, farthest: f32x16<S>) -> f32x16<S> {
    let simd = farthest.simd;
    let error = farthest * 1e-6 / max(from_axis, f32x16::splat(simd, 1e-30));
    min(error, f32x16::splat(simd, TAU))
}

/// Angle of (x, y) to the x axis, to 2e-6 radians: a minimax polynomial for the arc tangent up to 1.
#[inline(always)]
fn atan2<S: Simd>(y: f32x16<S>, x: f32x16<S>) -> f32x16<S> {
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

impl Projection for SphericalFan<'_> {
    type Directions<S: Simd> = [f32x16<S>; 3];

    const HAS_STRIPS: bool = true;

    #[inline(always)]
    fn fan(&self) -> &Fan {
        &self.fan
    }

    #[inline(always)]
    fn with_rows(self, rows: [i32; 2]) -> Self {
        Self { rows, ..self }
    }

    fn direction(&self, column: i32, row: i32) -> DVec3 {
        let ([cos, sin], [level, up]) = (self.azimuths[column as usize], self.elevations[row as usize]);
        DVec3::new(cos * level, sin * level, up)
    }

    #[inline(always)]
    fn exact_block(&self, column: usize, row: usize) -> [[f64; WIDTH]; 3] {
        let mut directions = [[0.0; WIDTH]; 3];
        for lane in 0..WIDTH {
            let (x, y) = self.fan.lane_position(lane);
            let column = ((column << self.fan.shift_x) + x).min(self.fan.width as usize - 1);
            let row = ((row << self.fan.shift_y) + y).min(self.fan.height as usize - 1);
            let ([cos, sin], [level, up]) = (self.azimuths[column], self.elevations[row]);
            directions[0][lane] = cos * level;
            directions[1][lane] = sin * level;
            directions[2][lane] = up;
        }
        directions
    }

    #[inline(always)]
    fn unit_directions<S: Simd>(&self, simd: S, column: usize, row: usize) -> Points<S> {
        self.block(simd, column, row)
    }

    #[inline(always)]
    fn distances<S: Simd>(&self, simd: S, inverse: f32x16<S>, _column: usize, _row: usize) -> f32x16<S> {
        f32x16::splat(simd, 1.0) / inverse
    }

    #[inline(always)]
    fn block<S: Simd>(&self, simd: S, column: usize, row: usize) -> Self::Directions<S> {
        let (cos, sin) = if self.fan.shift_x == 2 {
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
        let (mut at_column, mut at_row) = ([0_i32; WIDTH], [0_i32; WIDTH]);
        columns.store_array(&mut at_column);
        rows.store_array(&mut at_row);
        let mut values = [[0.0_f32; WIDTH]; 4];
        for lane in 0..WIDTH {
            // Lanes that are done stand past the end; any value will do.
            let column = (at_column[lane] as usize).min(self.cos_azimuth.len() - 1);
            let row = at_row[lane].min(self.fan.height - 1);
            let (block, place) = ((row >> self.fan.shift_y) as usize, self.fan.lane(0, row));
            values[0][lane] = self.cos_azimuth[column];
            values[1][lane] = self.sin_azimuth[column];
            values[2][lane] = self.cos_elevation[block][place];
            values[3][lane] = self.sin_elevation[block][place];
        }
        let level = f32x16::load_array_ref(simd, &values[2]);
        [
            f32x16::load_array_ref(simd, &values[0]) * level,
            f32x16::load_array_ref(simd, &values[1]) * level,
            f32x16::load_array_ref(simd, &values[3]),
        ]
    }

    #[inline(always)]
    fn ray<S: Simd>(&self, simd: S, column: i32, row: i32) -> Self::Directions<S> {
        let (block, place) = ((row >> self.fan.shift_y) as usize, self.fan.lane(0, row));
        let level = self.cos_elevation[block][place];
        [
            f32x16::splat(simd, self.cos_azimuth[column as usize] * level),
            f32x16::splat(simd, self.sin_azimuth[column as usize] * level),
            f32x16::splat(simd, self.sin_elevation[block][place]),
        ]
    }

    #[inline(always)]
    fn dot<S: Simd>(plane: &Planes<S>, directions: &Self::Directions<S>) -> f32x16<S> {
        (plane[0] * directions[0] + plane[1] * directions[1]) + plane[2] * directions[2]
    }

    #[inline(always)]
    fn inverse_of_boxes<S: Simd>(&self, simd: S, low: &Points<S>, high: &Points<S>) -> f32x16<S> {
        let [x, y, z] = [outside(low[0], high[0]), outside(low[1], high[1]), outside(low[2], high[2])];
        let distance = ((x * x + y * y) + z * z).sqrt();
        f32x16::splat(simd, 1.0001) / max(distance, f32x16::splat(simd, TINY))
    }

    #[inline(always)]
    fn bound_boxes<S: Simd>(&self, simd: S, low: &Points<S>, high: &Points<S>) -> Rectangles<S> {
        let zero = f32x16::splat(simd, 0.0);
        let (x, y) = (outside(low[0], high[0]), outside(low[1], high[1]));
        let nearest = (x * x + y * y).sqrt();
        let (x, y) = (magnitude(low[0], high[0]), magnitude(low[1], high[1]));
        let farthest = (x * x + y * y).sqrt();
        let (elevation, candidates) = self.elevations_of_boxes(simd, low[2], high[2], nearest, farthest);
        // Seen from above, a box that is not around the axis lies between two of its corners.
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
        // Angles from those of the centroid. For small ones, tan(angle) = cross / dot bounds the angle closely.
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
            // Both dot products say that the corner lies within a right angle of the centroid.
            least = min(least, min(dot, rise_dot));
        }
        let spread = to - from;
        let small = spread.simd_lt(f32x16::splat(simd, 0.4))
            & (above - below).simd_lt(f32x16::splat(simd, 0.4))
            & least.simd_gt(f32x16::splat(simd, 1e-25));
        // An edge's great circle bulges above its ends.
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
            // Rounding may have put a corner that lies on the vertical axis beside it.
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
        // Of a strip, the closer bound of `most_over_strip` costs more than it saves: S1/R3 10 % slower.
        let length = sqrt_f32(plane[0] * plane[0] + plane[1] * plane[1] + plane[2] * plane[2]);
        (cos * (plane[0] * cos_level) + sin * (plane[1] * cos_level))
            + (plane[2] * sin_level + length * self.radius)
    }

    #[inline(always)]
    fn most_over_strip<S: Simd>(&self, _simd: S, planes: &Planes<S>, column: usize, row: usize) -> f32x16<S> {
        // With δ from the middle, plane · direction = along · cos δ + across · sin δ + what z gives.
        let [level, up] = self.levels[row];
        let (cos, sin) = (self.cos_middle[column] * level, self.sin_middle[column] * level);
        let along = planes[0] * cos + planes[1] * sin;
        let across = planes[1] * cos - planes[0] * sin;
        let [cos_arc, sin_arc] = self.arc;
        let rounding = ((planes[0].abs() + planes[1].abs()) + planes[2].abs()) * 4e-6;
        (max(along, along * cos_arc) + across.abs() * sin_arc) + (planes[2] * up + rounding)
    }
}
