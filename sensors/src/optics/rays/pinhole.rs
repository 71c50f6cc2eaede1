//! Rays of a pinhole camera: (1, (cx − column)/fx, (cy − row)/fy), so that t is the depth along the optical axis and
//! 1/t of a plane takes two multiplications.

use super::projection::{Planes, Points, Projection, Rectangles, TINY, bounds_of, max, min, of_rows, whole};
use super::ray_grid::RayGrid;
use crate::ParameterError;
use crate::optics::{Intrinsics, Pinhole};
use crate::simd::WIDTH;
use fearless_simd::{
    Select, Simd, SimdBase, SimdFloat, SimdMask, SimdNarrow, f32x16, f64x8, i32x16, mask32x16,
};
use glam::DVec3;

/// The rays of a pinhole camera, given by a formula; other lenses need a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinholeGrid {
    width: u32,
    height: u32,
    lens: Pinhole,
}

impl PinholeGrid {
    /// Creates the rays of an image of `width` × `height` pixels.
    ///
    /// # Errors
    /// If a side is 0, or if the lens has skew, for which a [`RayTable`](crate::optics::RayTable) is needed.
    pub fn new(width: u32, height: u32, lens: Pinhole) -> Result<Self, ParameterError> {
        let wrong = |name, value, rule| Err(ParameterError::new("camera", name, value, rule));
        let skew = lens.intrinsics().skew;
        match (width, height) {
            (0, _) => wrong("width", 0.0, "at least 1"),
            (_, 0) => wrong("height", 0.0, "at least 1"),
            _ if skew != 0.0 => wrong("skew", skew, "0, or the rays in a table"),
            _ => Ok(Self { width, height, lens }),
        }
    }

    /// Creates the rays of a centred camera with square pixels: f = w / (2·tan(hfov / 2)), principal point ((w−1)/2,
    /// (h−1)/2).
    ///
    /// ```
    /// // The articles' ceiling camera.
    /// use belvedere_sensors::optics::PinholeGrid;
    /// let camera = PinholeGrid::from_fov(640, 480, 1.3962634)?;
    /// assert!((camera.intrinsics().fx - 381.36115).abs() < 1e-4);
    /// assert_eq!((camera.intrinsics().cx, camera.intrinsics().cy), (319.5, 239.5));
    /// # Ok::<(), belvedere_sensors::ParameterError>(())
    /// ```
    ///
    /// # Errors
    /// If a side is 0, or the field of view (in radians) is not between 0 and π.
    pub fn from_fov(width: u32, height: u32, horizontal_fov_rad: f64) -> Result<Self, ParameterError> {
        let lens = Pinhole::new(Intrinsics::from_fov(width, height, horizontal_fov_rad)?)?;
        Self::new(width, height, lens)
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// The lens.
    pub fn lens(&self) -> &Pinhole {
        &self.lens
    }

    /// The intrinsic parameters in pixels; the skew is 0.
    pub fn intrinsics(&self) -> Intrinsics {
        self.lens.intrinsics()
    }
}

/// Margin on each side of a projection for rounding errors, in rays.
const MARGIN: f32 = 0.02;

/// Columns and rows of the lanes within a block, for 4×4 and 16×1.
const ACROSS: [[f32; WIDTH]; 2] = [
    [0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0],
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0],
];
const DOWN: [[f32; WIDTH]; 2] =
    [[0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0, 3.0], [0.0; 16]];

/// The second array of [`ACROSS`] in double precision, in two halves.
const IN_LINE: [[f64; WIDTH / 2]; 2] =
    [[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0], [8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0]];

/// A pinhole camera.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PinholeRays {
    ray_grid: RayGrid,
    lens: Intrinsics,
    fx: f32,
    fy: f32,
    cx: f32,
    cy: f32,
    per_fx: f32,
    per_fy: f32,
    /// The exact inverses of fx and fy.
    per_focal: [f64; 2],
    /// First and last row to draw.
    rows: [i32; 2],
}

impl PinholeRays {
    pub(crate) fn new(grid: &PinholeGrid, ray_grid: RayGrid) -> Self {
        let lens = grid.intrinsics();
        Self {
            ray_grid,
            lens,
            fx: lens.fx as f32,
            fy: lens.fy as f32,
            cx: lens.cx as f32,
            cy: lens.cy as f32,
            per_fx: (1.0 / lens.fx) as f32,
            per_fy: (1.0 / lens.fy) as f32,
            per_focal: [1.0 / lens.fx, 1.0 / lens.fy],
            rows: [0, ray_grid.height - 1],
        }
    }

    pub(crate) fn intrinsics(&self) -> &Intrinsics {
        &self.lens
    }

    /// Columns and rows of the rays of a block.
    #[inline(always)]
    pub(crate) fn pixels<S: Simd>(&self, simd: S, column: usize, row: usize) -> [f32x16<S>; 2] {
        let shape = usize::from(self.ray_grid.shift_y == 0);
        let first_column = (column << self.ray_grid.shift_x) as f32;
        let first_row = (row << self.ray_grid.shift_y) as f32;
        [
            f32x16::load_array_ref(simd, &ACROSS[shape]) + first_column,
            f32x16::load_array_ref(simd, &DOWN[shape]) + first_row,
        ]
    }

    /// The y coordinate of the directions of a column.
    #[inline(always)]
    fn left(&self, column: i32) -> f32 {
        (self.cx - column as f32) * self.per_fx
    }

    /// The z coordinate of the directions of a row.
    #[inline(always)]
    fn up(&self, row: i32) -> f32 {
        (self.cy - row as f32) * self.per_fy
    }

    /// The directions of the rays of a block, of length 1.
    #[inline(always)]
    pub(super) fn unit_directions<S: Simd>(&self, simd: S, column: usize, row: usize) -> Points<S> {
        let [y, z] = self.block(simd, column, row);
        let shorter = f32x16::splat(simd, 1.0) / ((y * y + z * z) + 1.0).sqrt();
        [shorter, y * shorter, z * shorter]
    }

    /// Distances in metres along the rays of a block, from 1/t.
    #[inline(always)]
    pub(super) fn distances<S: Simd>(
        &self,
        simd: S,
        inverse: f32x16<S>,
        column: usize,
        row: usize,
    ) -> f32x16<S> {
        let [y, z] = self.block(simd, column, row);
        ((y * y + z * z) + 1.0).sqrt() / inverse
    }

    /// Implements [`Rays::slopes`](super::Rays::slopes): the slope to the right depends only on the column, the slope
    /// down only on the row.
    #[inline(always)]
    pub(super) fn slopes<S: Simd>(&self, simd: S, column: usize, row: usize) -> [f32x16<S>; 2] {
        let ([per_fx, per_fy], zero) = (self.per_focal, f64x8::splat(simd, 0.0));
        let (cx, column) = (f64x8::splat(simd, self.lens.cx), column as f64);
        let [first, second] = &IN_LINE;
        let first = zero - (cx - (f64x8::load_array_ref(simd, first) + column)) * per_fx;
        let second = zero - (cx - (f64x8::load_array_ref(simd, second) + column)) * per_fx;
        let down = 0.0 - (self.lens.cy - row as f64) * per_fy;
        [first.narrow(second), f32x16::splat(simd, down as f32)]
    }

    /// Converts the projected intervals of columns and rows to whole rays.
    #[inline(always)]
    fn rectangles<S: Simd>(
        &self,
        simd: S,
        columns: [f32x16<S>; 2],
        rows: [f32x16<S>; 2],
        candidates: mask32x16<S>,
    ) -> Rectangles<S> {
        let [first_column, last_column] = whole(simd, columns, MARGIN, [0, self.ray_grid.width - 1]);
        let [first_row, last_row] = whole(simd, rows, MARGIN, self.rows);
        let some = candidates & first_column.simd_le(last_column) & first_row.simd_le(last_row);
        Rectangles { first_column, last_column, first_row, last_row, some }
    }
}

/// Directions of a pinhole camera in other axes, where they are linear in column and row too.
pub(crate) struct Turning {
    /// Direction of the ray at column 0 and row 0, and the increments per column and per row.
    origin: [f64; 3],
    across: [f64; 3],
    down: [f64; 3],
    /// Increments for the lanes of a block.
    lanes: [[f64; WIDTH]; 3],
}

impl Projection for PinholeRays {
    /// y and z; x is 1.
    type Directions<S: Simd> = [f32x16<S>; 2];
    type Turning = Turning;

    of_rows!();

    fn direction(&self, column: i32, row: i32) -> DVec3 {
        let [per_fx, per_fy] = self.per_focal;
        let left = (self.lens.cx - f64::from(column)) * per_fx;
        DVec3::new(1.0, left, (self.lens.cy - f64::from(row)) * per_fy)
    }

    #[inline(always)]
    fn exact_block(&self, column: usize, row: usize) -> [[f64; WIDTH]; 3] {
        let [per_fx, per_fy] = self.per_focal;
        let shape = usize::from(self.ray_grid.shift_y == 0);
        let first_column = (column << self.ray_grid.shift_x) as f64;
        let first_row = (row << self.ray_grid.shift_y) as f64;
        let mut directions = [[1.0; WIDTH], [0.0; WIDTH], [0.0; WIDTH]];
        for lane in 0..WIDTH {
            let column = first_column + f64::from(ACROSS[shape][lane]);
            let row = first_row + f64::from(DOWN[shape][lane]);
            directions[1][lane] = (self.lens.cx - column) * per_fx;
            directions[2][lane] = (self.lens.cy - row) * per_fy;
        }
        directions
    }

    #[inline(always)]
    fn turning(&self, rows: &[[f64; 3]; 3]) -> Turning {
        let ([per_fx, per_fy], shape) = (self.per_focal, usize::from(self.ray_grid.shift_y == 0));
        let mut turning =
            Turning { origin: [0.0; 3], across: [0.0; 3], down: [0.0; 3], lanes: [[0.0; WIDTH]; 3] };
        for (axis, [ahead, left, up]) in rows.iter().enumerate() {
            let (across, down) = (-left * per_fx, -up * per_fy);
            turning.origin[axis] = (ahead - self.lens.cx * across) - self.lens.cy * down;
            (turning.across[axis], turning.down[axis]) = (across, down);
            for lane in 0..WIDTH {
                turning.lanes[axis][lane] =
                    f64::from(ACROSS[shape][lane]) * across + f64::from(DOWN[shape][lane]) * down;
            }
        }
        turning
    }

    #[inline(always)]
    fn turned<S: Simd>(&self, _simd: S, turning: &Turning, column: usize, row: usize) -> [[f64; WIDTH]; 3] {
        let (column, row) = ((column << self.ray_grid.shift_x) as f64, (row << self.ray_grid.shift_y) as f64);
        let mut turned = [[0.0; WIDTH]; 3];
        for axis in 0..3 {
            let Turning { origin, across, down, lanes } = turning;
            let first = (origin[axis] + across[axis] * column) + down[axis] * row;
            for lane in 0..WIDTH {
                turned[axis][lane] = first + lanes[axis][lane];
            }
        }
        turned
    }

    #[inline(always)]
    fn block<S: Simd>(&self, simd: S, column: usize, row: usize) -> Self::Directions<S> {
        let [columns, rows] = self.pixels(simd, column, row);
        [
            (f32x16::splat(simd, self.cx) - columns) * self.per_fx,
            (f32x16::splat(simd, self.cy) - rows) * self.per_fy,
        ]
    }

    #[inline(always)]
    fn rays<S: Simd>(&self, simd: S, columns: i32x16<S>, rows: i32x16<S>) -> Self::Directions<S> {
        [
            (f32x16::splat(simd, self.cx) - simd.cvt_f32_i32x16(columns)) * self.per_fx,
            (f32x16::splat(simd, self.cy) - simd.cvt_f32_i32x16(rows)) * self.per_fy,
        ]
    }

    #[inline(always)]
    fn ray<S: Simd>(&self, simd: S, column: i32, row: i32) -> Self::Directions<S> {
        [f32x16::splat(simd, self.left(column)), f32x16::splat(simd, self.up(row))]
    }

    #[inline(always)]
    fn dot<S: Simd>(plane: &Planes<S>, directions: &Self::Directions<S>) -> f32x16<S> {
        (plane[1] * directions[0] + plane[2] * directions[1]) + plane[0]
    }

    #[inline(always)]
    fn inverse_of_boxes<S: Simd>(&self, simd: S, low: &Points<S>, _high: &Points<S>) -> f32x16<S> {
        f32x16::splat(simd, 1.0001) / max(low[0], f32x16::splat(simd, TINY))
    }

    #[inline(always)]
    fn bound_boxes<S: Simd>(&self, simd: S, low: &Points<S>, high: &Points<S>) -> Rectangles<S> {
        let (one, tiny, zero) =
            (f32x16::splat(simd, 1.0), f32x16::splat(simd, TINY), f32x16::splat(simd, 0.0));
        let in_front = high[0].simd_gt(tiny);
        let nearest = one / max(low[0], tiny);
        let farthest = one / max(high[0], tiny);
        let slopes = |axis: usize| {
            let most = high[axis] * high[axis].simd_gt(zero).select(nearest, farthest);
            let least = low[axis] * low[axis].simd_lt(zero).select(nearest, farthest);
            [least, most]
        };
        let columns = pixels(simd, slopes(1), self.fx, self.cx);
        let rows = pixels(simd, slopes(2), self.fy, self.cy);
        self.rectangles(simd, columns, rows, in_front)
    }

    #[inline(always)]
    fn bound_triangles<S: Simd>(
        &self,
        simd: S,
        corners: &[Points<S>; 3],
        valid: mask32x16<S>,
    ) -> (Rectangles<S>, f32x16<S>) {
        let (low, high) = bounds_of(corners);
        let tiny = f32x16::splat(simd, TINY);
        if (valid & low[0].simd_le(tiny)).any_true() {
            let mut rectangles = self.bound_boxes(simd, &low, &high);
            rectangles.some &= valid;
            return (rectangles, self.inverse_of_boxes(simd, &low, &high));
        }
        // All corners are in front of the camera, so their own projections are tight bounds.
        let one = f32x16::splat(simd, 1.0);
        let inverse =
            [one / max(corners[0][0], tiny), one / max(corners[1][0], tiny), one / max(corners[2][0], tiny)];
        let slopes = |axis: usize| {
            let a = corners[0][axis] * inverse[0];
            let b = corners[1][axis] * inverse[1];
            let c = corners[2][axis] * inverse[2];
            [min(min(a, b), c), max(max(a, b), c)]
        };
        let columns = pixels(simd, slopes(1), self.fx, self.cx);
        let rows = pixels(simd, slopes(2), self.fy, self.cy);
        let nearest = max(max(inverse[0], inverse[1]), inverse[2]) * 1.0001;
        (self.rectangles(simd, columns, rows, valid), nearest)
    }

    #[inline(always)]
    fn most_over_blocks<S: Simd>(&self, simd: S, plane: &[f32; 3], column: usize, row: usize) -> f32x16<S> {
        // Half of a block's extent in y and z, and the middle of each block.
        let (half_x, half_y) = (
            ((1 << self.ray_grid.shift_x) - 1) as f32 * 0.5,
            ((1 << self.ray_grid.shift_y) - 1) as f32 * 0.5,
        );
        let step = (1 << self.ray_grid.shift_x) as f32;
        let first = (column << self.ray_grid.shift_x) as f32 + half_x;
        let middle = (row << self.ray_grid.shift_y) as f32 + half_y;
        let left = (f32x16::splat(simd, self.cx - first) - f32x16::load_array_ref(simd, &ACROSS[1]) * step)
            * self.per_fx;
        let up = (self.cy - middle) * self.per_fy;
        let spread = (plane[1].abs() * (half_x + MARGIN)) * self.per_fx
            + (plane[2].abs() * (half_y + MARGIN)) * self.per_fy;
        left * plane[1] + ((plane[0] + plane[2] * up) + (spread + plane[0].abs() * 1e-6))
    }
}

/// Fractional columns or rows, from the least and the greatest y/x or z/x.
#[inline(always)]
fn pixels<S: Simd>(simd: S, [least, most]: [f32x16<S>; 2], focal: f32, centre: f32) -> [f32x16<S>; 2] {
    let centre = f32x16::splat(simd, centre);
    [centre - most * focal, centre - least * focal]
}
