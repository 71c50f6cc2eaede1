//! Rays in arbitrary directions, for distorted or fisheye lenses, and for lidars with unevenly spaced channels.
//!
//! Directions are read from the table, block by block. Bounds are computed on a [`chart`](chart::Chart), on which
//! columns and rows increase about evenly, and with two [look-ups](look_up::LookUp) from chart coordinates to columns
//! and rows.

mod build;
mod chart;
mod error;
mod layout;
mod look_up;
#[cfg(feature = "alloc")]
mod owned;
mod plan;

pub use build::RayTable;
pub use error::TableError;
#[cfg(feature = "alloc")]
pub use owned::RayTableBuf;

use super::projection::{
    Planes, Points, Projection, Rectangles, bounds_of, dot, inverse_distance, of_length_one, of_rows,
};
use super::ray_grid::RayGrid;
use crate::simd::{WIDTH, sqrt_f32};
use chart::{ChartKind, Windows};
use fearless_simd::{
    Select, Simd, SimdBase, SimdCombine, SimdWiden, f32x4, f32x16, f64x8, i32x16, mask32x16,
};
use glam::DVec3;

/// A table of rays, and the rows of it to draw.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TableRays<'a> {
    ray_grid: RayGrid,
    table: RayTable<'a>,
    /// First and last row to draw.
    rows: [i32; 2],
}

impl<'a> TableRays<'a> {
    pub(crate) fn new(table: &RayTable<'a>) -> Self {
        let ray_grid = table.ray_grid();
        Self { ray_grid, table: *table, rows: [0, ray_grid.height - 1] }
    }

    /// The lanes of a block without a ray, as one bit each.
    #[inline(always)]
    pub(crate) fn missing(&self, column: usize, row: usize) -> u16 {
        self.table.missing[row * self.ray_grid.blocks_across() + column]
    }

    /// Returns true if any ray of the table is missing.
    pub(crate) fn has_missing(&self) -> bool {
        self.table.has_missing
    }

    /// The exact directions of the rays of a block, eight lanes at a time.
    #[inline(always)]
    fn exact<S: Simd>(&self, simd: S, column: usize, row: usize) -> [[f64x8<S>; 2]; 3] {
        let [x, y, z] = self.block(simd, column, row);
        let (x, y, z) = (x.widen(), y.widen(), z.widen());
        [[x.0, x.1], [y.0, y.1], [z.0, z.1]]
    }

    /// The exact directions of sixteen adjacent rays in a row, eight lanes at a time. `column` must be a multiple of
    /// sixteen; beyond the last block, that block is repeated.
    #[inline(always)]
    pub(super) fn exact_line<S: Simd>(&self, simd: S, column: usize, row: usize) -> [[f64x8<S>; 2]; 3] {
        let (shift_x, shift_y) = (self.ray_grid.shift_x, self.ray_grid.shift_y);
        if shift_y == 0 {
            return self.exact(simd, column >> shift_x, row);
        }
        let (across, from) = (self.ray_grid.blocks_across(), (row & 3) * 4);
        let blocks = &self.table.directions[(row >> shift_y) * across..][..across];
        let first = column >> shift_x;
        let (a, b) = (&blocks[first], &blocks[(first + 1).min(across - 1)]);
        let (c, d) = (&blocks[(first + 2).min(across - 1)], &blocks[(first + 3).min(across - 1)]);
        let mut line = [[f64x8::splat(simd, 0.0); 2]; 3];
        for axis in 0..3 {
            let left = four(simd, &a[axis], from).combine(four(simd, &b[axis], from));
            let right = four(simd, &c[axis], from).combine(four(simd, &d[axis], from));
            let (left, right) = left.combine(right).widen();
            line[axis] = [left, right];
        }
        line
    }

    /// Index of a ray's block, and its lane. Finished lanes are past the end; any ray will do for them.
    #[inline(always)]
    fn place(&self, column: i32, row: i32) -> (usize, usize) {
        let column = column.min(self.ray_grid.width - 1);
        let row = row.min(self.ray_grid.height - 1);
        let block = (row >> self.ray_grid.shift_y) as usize * self.ray_grid.blocks_across()
            + (column >> self.ray_grid.shift_x) as usize;
        (block, self.ray_grid.lane(column, row))
    }

    /// Converts windows of the chart to rays.
    #[inline(always)]
    fn rectangles<S: Simd>(&self, simd: S, windows: &Windows<S>) -> Rectangles<S> {
        let table = &self.table;
        let [first_column, last_column] = if table.chart.kind == ChartKind::Cylindrical {
            table.columns.look_up_round(simd, windows.u, self.ray_grid.width, table.ring)
        } else {
            table.columns.look_up(simd, windows.u)
        };
        let [first_row, last_row] = table.rows.look_up(simd, windows.v);
        let (least, most) = (i32x16::splat(simd, self.rows[0]), i32x16::splat(simd, self.rows[1]));
        let first_row = first_row.simd_lt(least).select(least, first_row);
        let last_row = last_row.simd_gt(most).select(most, last_row);
        let some = windows.some & first_column.simd_le(last_column) & first_row.simd_le(last_row);
        Rectangles { first_column, last_column, first_row, last_row, some }
    }
}

#[inline(always)]
fn four<S: Simd>(simd: S, values: &[f32; WIDTH], first: usize) -> f32x4<S> {
    f32x4::from_slice(simd, &values[first..][..4])
}

#[inline(always)]
fn sixteen<S: Simd>(simd: S, values: &[f32], first: usize) -> f32x16<S> {
    f32x16::from_slice(simd, &values[first..][..WIDTH])
}

impl Projection for TableRays<'_> {
    of_rows!();
    of_length_one!();

    fn direction(&self, column: i32, row: i32) -> DVec3 {
        let (block, lane) = self.place(column, row);
        let [x, y, z] = &self.table.directions[block];
        DVec3::new(x[lane].into(), y[lane].into(), z[lane].into())
    }

    #[inline(always)]
    fn exact_block(&self, column: usize, row: usize) -> [[f64; WIDTH]; 3] {
        let block = &self.table.directions[row * self.ray_grid.blocks_across() + column];
        let mut directions = [[0.0; WIDTH]; 3];
        for axis in 0..3 {
            for lane in 0..WIDTH {
                directions[axis][lane] = f64::from(block[axis][lane]);
            }
        }
        directions
    }

    #[inline(always)]
    fn block<S: Simd>(&self, simd: S, column: usize, row: usize) -> Self::Directions<S> {
        let [x, y, z] = &self.table.directions[row * self.ray_grid.blocks_across() + column];
        [f32x16::load_array_ref(simd, x), f32x16::load_array_ref(simd, y), f32x16::load_array_ref(simd, z)]
    }

    #[inline(always)]
    fn rays<S: Simd>(&self, simd: S, columns: i32x16<S>, rows: i32x16<S>) -> Self::Directions<S> {
        let ray_grid = &self.ray_grid;
        // Finished lanes are past the end; any ray will do for them.
        let (last_column, last_row) =
            (i32x16::splat(simd, ray_grid.width - 1), i32x16::splat(simd, ray_grid.height - 1));
        let columns = columns.simd_lt(last_column).select(columns, last_column);
        let rows = rows.simd_lt(last_row).select(rows, last_row);
        let block =
            (rows >> ray_grid.shift_y) * (ray_grid.blocks_across() as i32) + (columns >> ray_grid.shift_x);
        let lane = ((rows & ((1 << ray_grid.shift_y) - 1)) << ray_grid.shift_x)
            | (columns & ((1 << ray_grid.shift_x) - 1));
        let (mut blocks, mut lanes) = ([0_i32; WIDTH], [0_i32; WIDTH]);
        block.store_array(&mut blocks);
        lane.store_array(&mut lanes);
        let mut values = [[0.0_f32; WIDTH]; 3];
        for ray in 0..WIDTH {
            let [x, y, z] = &self.table.directions[blocks[ray] as usize];
            let lane = lanes[ray] as usize & (WIDTH - 1);
            values[0][ray] = x[lane];
            values[1][ray] = y[lane];
            values[2][ray] = z[lane];
        }
        [
            f32x16::load_array_ref(simd, &values[0]),
            f32x16::load_array_ref(simd, &values[1]),
            f32x16::load_array_ref(simd, &values[2]),
        ]
    }

    #[inline(always)]
    fn ray<S: Simd>(&self, simd: S, column: i32, row: i32) -> Self::Directions<S> {
        let (block, lane) = self.place(column, row);
        let [x, y, z] = &self.table.directions[block];
        [f32x16::splat(simd, x[lane]), f32x16::splat(simd, y[lane]), f32x16::splat(simd, z[lane])]
    }

    #[inline(always)]
    fn bound_boxes<S: Simd>(&self, simd: S, low: &Points<S>, high: &Points<S>) -> Rectangles<S> {
        self.rectangles(simd, &self.table.chart.windows_of_boxes(simd, low, high))
    }

    #[inline(always)]
    fn bound_triangles<S: Simd>(
        &self,
        simd: S,
        corners: &[Points<S>; 3],
        valid: mask32x16<S>,
    ) -> (Rectangles<S>, f32x16<S>) {
        let (low, high) = bounds_of(corners);
        let windows = self.table.chart.windows_of_triangles(simd, corners, valid);
        (self.rectangles(simd, &windows), self.inverse_of_boxes(simd, &low, &high))
    }

    #[inline(always)]
    fn most_over_blocks<S: Simd>(&self, simd: S, plane: &[f32; 3], column: usize, row: usize) -> f32x16<S> {
        let first = row * self.ray_grid.blocks_across() + column;
        // Written out, since calls in an array's `map` are not always inlined.
        let x = sixteen(simd, self.table.middles[0], first);
        let y = sixteen(simd, self.table.middles[1], first);
        let z = sixteen(simd, self.table.middles[2], first);
        let radii = sixteen(simd, self.table.radii, first);
        let length = sqrt_f32((plane[0] * plane[0] + plane[1] * plane[1]) + plane[2] * plane[2]);
        ((x * plane[0] + y * plane[1]) + z * plane[2]) + radii * length
    }
}
