//! Tables of cosines and sines of a grid's angles.

use super::{ANGLE_MARGIN, SphericalRays};
use crate::optics::rays::RayGrid;
use crate::simd::{WIDTH, sin_cos, sin_cos_of, sqrt};
use fearless_simd::{Simd, SimdBase, f64x8};

/// A grid that is narrower than this, in radians, is bounded as a whole.
const NARROW: f64 = 1e-5;

/// The angles of a grid in radians: the angle of the first column or row, and the step to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AngleSteps {
    pub(crate) first: f64,
    pub(crate) step: f64,
}

impl AngleSteps {
    /// The same directions with a first angle of at most ±`most` (π or more) and a step of at most half a turn, so that
    /// single precision can distinguish the angles.
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

    /// The last of `count` angles.
    fn last(self, count: i32) -> f64 {
        self.first + self.step * f64::from(count - 1)
    }

    /// Number of columns or rows per radian, and the margin by which bounds are widened.
    fn density(self, count: i32) -> (f64, f32) {
        let margin = |per_radian: f64| 0.01 + ANGLE_MARGIN * per_radian.abs() as f32;
        if self.step.abs() * f64::from(count - 1) < NARROW {
            // The angles are practically equal: either none of them is hit or all.
            return (1e3, margin(1e3) + (count - 1) as f32);
        }
        (1.0 / self.step, margin(1.0 / self.step))
    }

    /// The angles of the middles of blocks of 2^`shift` columns or rows; the first middle is `half` steps from the
    /// first angle.
    #[inline(always)]
    fn of_blocks(self, half: f64, shift: u32) -> Self {
        Self { first: self.first + self.step * half, step: self.step * f64::from(1 << shift) }
    }

    /// The angles from the one with the given index on.
    fn from(self, index: u32) -> Self {
        Self { first: self.first + self.step * f64::from(index), ..self }
    }

    /// Calls `take` with the cosines and sines of each group of sixteen angles. The first angle of each group is
    /// rotated by the first sixteen steps, which takes a few products, whereas a sine and a cosine take dozens.
    #[inline(always)]
    fn fill<S: Simd>(
        self,
        simd: S,
        sixteens: core::ops::Range<usize>,
        mut take: impl FnMut(usize, [f64; WIDTH], [f64; WIDTH]),
    ) {
        let [sin_step, cos_step] = sixteen_sines_and_cosines(simd, |lane| self.step * lane as f64);
        let (start, end) = (sixteens.start, sixteens.end);
        for some in sixteens.step_by(WIDTH) {
            let angle = |sixteen: usize| self.first + self.step * ((some + sixteen) * WIDTH) as f64;
            let [sin, cos] = sixteen_sines_and_cosines(simd, angle);
            for (sixteen, (sin, cos)) in (some..end).zip(sin.into_iter().zip(cos)) {
                let (mut cosines, mut sines) = ([0.0; WIDTH], [0.0; WIDTH]);
                for lane in 0..WIDTH {
                    cosines[lane] = cos * cos_step[lane] - sin * sin_step[lane];
                    sines[lane] = sin * cos_step[lane] + cos * sin_step[lane];
                }
                take(sixteen - start, cosines, sines);
            }
        }
    }
}

/// The sines and the cosines of sixteen angles.
#[inline(always)]
fn sixteen_sines_and_cosines<S: Simd>(simd: S, angle: impl Fn(usize) -> f64) -> [[f64; WIDTH]; 2] {
    let mut both = [[0.0; WIDTH]; 2];
    for half in [0, WIDTH / 2] {
        let mut angles = [0.0; WIDTH / 2];
        for lane in 0..WIDTH / 2 {
            angles[lane] = angle(half + lane);
        }
        let [sin, cos] = sin_cos_of(simd, f64x8::load_array(simd, angles));
        sin.store_slice(&mut both[0][half..][..WIDTH / 2]);
        cos.store_slice(&mut both[1][half..][..WIDTH / 2]);
    }
    both
}

/// Number of groups of sixteen columns whose directions are stored: those that the blocks of the grid overlap.
const fn sixteens(ray_grid: &RayGrid, first_column: u32) -> usize {
    (first_column as usize % WIDTH + (ray_grid.width as usize).next_multiple_of(WIDTH)).div_ceil(WIDTH)
}

/// Number of groups of sixteen blocks whose middle directions are stored.
const fn middles(ray_grid: &RayGrid) -> usize {
    ray_grid.blocks_across().div_ceil(WIDTH) + 1
}

/// The tables of a grid, cut out of one slice.
struct Tables<'a> {
    cos_azimuth: &'a mut [[f32; WIDTH]],
    sin_azimuth: &'a mut [[f32; WIDTH]],
    cos_elevation: &'a mut [[f32; WIDTH]],
    sin_elevation: &'a mut [[f32; WIDTH]],
    cos_middle: &'a mut [[f32; WIDTH]],
    sin_middle: &'a mut [[f32; WIDTH]],
    levels: &'a mut [[f32; 2]],
    azimuths: &'a mut [[f64; 2]],
    elevations: &'a mut [[f64; 2]],
}

impl<'a> Tables<'a> {
    #[inline(always)]
    fn cut(ray_grid: &RayGrid, columns: usize, tables: &'a mut [[f32; WIDTH]]) -> Self {
        let rows = ray_grid.blocks_down();
        let middles = middles(ray_grid);
        let (cos_azimuth, rest) = tables.split_at_mut(columns);
        let (sin_azimuth, rest) = rest.split_at_mut(columns);
        let (cos_elevation, rest) = rest.split_at_mut(rows);
        let (sin_elevation, rest) = rest.split_at_mut(rows);
        let (cos_middle, rest) = rest.split_at_mut(middles);
        let (sin_middle, rest) = rest.split_at_mut(middles);
        let (levels, rest) = rest.split_at_mut((2 * rows).div_ceil(WIDTH));
        let (azimuths, rest) = rest.split_at_mut(4 * columns);
        Self {
            cos_azimuth,
            sin_azimuth,
            cos_elevation,
            sin_elevation,
            cos_middle,
            sin_middle,
            levels: &mut levels.as_flattened_mut().as_chunks_mut::<2>().0[..rows],
            azimuths: bytemuck::cast_slice_mut(azimuths),
            elevations: bytemuck::cast_slice_mut(&mut rest[..4 * rows]),
        }
    }

    /// Fills the tables. `all_azimuths` starts at the first column of the whole grid, `azimuth` at that of this one. `half`
    /// is the distance from the corner of a block to its middle, in columns and rows.
    #[inline(always)]
    fn fill<S: Simd>(
        &mut self,
        simd: S,
        ray_grid: &RayGrid,
        first_sixteen: usize,
        all_azimuths: AngleSteps,
        (azimuth, elevation): (AngleSteps, AngleSteps),
        half: [f64; 2],
    ) {
        all_azimuths.fill(
            simd,
            first_sixteen..first_sixteen + self.cos_azimuth.len(),
            #[inline(always)]
            |block, cos, sin| {
                for lane in 0..WIDTH {
                    self.azimuths[block * WIDTH + lane] = [cos[lane], sin[lane]];
                    self.cos_azimuth[block][lane] = cos[lane] as f32;
                    self.sin_azimuth[block][lane] = sin[lane] as f32;
                }
            },
        );
        // Computed one by one: there are few rows, and at a pole the sign of the cosine must be right, otherwise the
        // ray would not belong to its column.
        for (row, angles) in
            self.elevations[..ray_grid.blocks_down() << ray_grid.shift_y].iter_mut().enumerate()
        {
            let (sin, cos) = sin_cos(elevation.first + elevation.step * row as f64);
            *angles = [cos, sin];
        }
        for block in 0..ray_grid.blocks_down() {
            for lane in 0..WIDTH {
                let [cos, sin] =
                    self.elevations[(block << ray_grid.shift_y) + ray_grid.lane_position(lane).1];
                self.cos_elevation[block][lane] = cos as f32;
                self.sin_elevation[block][lane] = sin as f32;
            }
        }
        azimuth.of_blocks(half[0], ray_grid.shift_x).fill(
            simd,
            0..self.cos_middle.len(),
            #[inline(always)]
            |block, cos, sin| {
                self.cos_middle[block] = cos.map(|cos| cos as f32);
                self.sin_middle[block] = sin.map(|sin| sin as f32);
            },
        );
        elevation.of_blocks(half[1], ray_grid.shift_y).fill(
            simd,
            0..self.levels.len().div_ceil(WIDTH),
            #[inline(always)]
            |block, cos, sin| {
                for (lane, level) in self.levels[block * WIDTH..].iter_mut().take(WIDTH).enumerate() {
                    *level = [cos[lane] as f32, sin[lane] as f32];
                }
            },
        );
    }
}

impl<'a> SphericalRays<'a> {
    /// Number of arrays of sixteen in the tables of a grid that starts at a column of another grid.
    pub(crate) const fn table_len(ray_grid: &RayGrid, first_column: u32) -> usize {
        let columns = sixteens(ray_grid, first_column);
        2 * columns
            + 2 * ray_grid.blocks_down()
            + 2 * middles(ray_grid)
            + (2 * ray_grid.blocks_down()).div_ceil(WIDTH)
            + (4 * columns * WIDTH).div_ceil(WIDTH)
            + (4 * ray_grid.blocks_down() * WIDTH).div_ceil(WIDTH)
    }

    /// Fills the tables of a grid that starts at a column of the grid with the given angles.
    #[inline(always)]
    pub(crate) fn new<S: Simd>(
        simd: S,
        (ray_grid, first_column): (RayGrid, u32),
        azimuth: AngleSteps,
        elevation: AngleSteps,
        tables: &'a mut [[f32; WIDTH]],
    ) -> Self {
        let (all_azimuths, elevation) =
            (azimuth.reduced(core::f64::consts::TAU), elevation.reduced(core::f64::consts::PI));
        // The directions of columns are computed in groups of sixteen, counted from the first column of the whole grid.
        let skipped = first_column as usize % WIDTH;
        let azimuth = all_azimuths.from(first_column).reduced(core::f64::consts::TAU);
        let columns = sixteens(&ray_grid, first_column);
        let mut cut = Tables::cut(&ray_grid, columns, tables);
        let half = [((1 << ray_grid.shift_x) - 1) as f64 * 0.5, ((1 << ray_grid.shift_y) - 1) as f64 * 0.5];
        cut.fill(simd, &ray_grid, first_column as usize / WIDTH, all_azimuths, (azimuth, elevation), half);
        let reach = [half[0] * azimuth.step, half[1] * elevation.step];
        let arc = if reach[0].abs() <= core::f64::consts::FRAC_PI_2 {
            let (sin, cos) = sin_cos(reach[0].abs());
            [cos as f32, sin as f32]
        } else {
            [-1.0, 1.0]
        };
        let radius = sqrt(reach[0] * reach[0] + reach[1] * reach[1]);
        let (columns_per_radian, column_margin) = azimuth.density(ray_grid.width);
        let (rows_per_radian, row_margin) = elevation.density(ray_grid.height);
        let turn = core::f64::consts::TAU * columns_per_radian.abs();
        let beyond = |angle: f64| angle.abs() > core::f64::consts::FRAC_PI_2;
        let tumbles = beyond(elevation.first) || beyond(elevation.last(ray_grid.height));
        Self {
            ray_grid,
            azimuths: &cut.azimuths[skipped..],
            elevations: cut.elevations,
            rows: [0, ray_grid.height - 1],
            cos_azimuth: &cut.cos_azimuth.as_flattened()[skipped..],
            sin_azimuth: &cut.sin_azimuth.as_flattened()[skipped..],
            cos_elevation: cut.cos_elevation,
            sin_elevation: cut.sin_elevation,
            cos_middle: cut.cos_middle.as_flattened(),
            sin_middle: cut.sin_middle.as_flattened(),
            levels: cut.levels,
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
            ring: (turn - f64::from(ray_grid.width)).abs() < 1e-6 && !tumbles,
            overlaps: turn < f64::from(ray_grid.width),
            tumbles,
        }
    }
}
