//! Fills the memory of a table.

use super::error::TableError;
use super::layout::{Layout, TableDirections};
use super::look_up::{Filling, LookUp, Scale, cells};
use crate::memory::{CacheLine, Cutter};
use crate::optics::rays::RayGrid;
use crate::simd::{WIDTH, sqrt};
use glam::DVec3;

/// Tolerance for the length of a direction, which must be 1.
const LENGTH_TOLERANCE: f64 = 1e-4;
/// A more expensive chart is used only if its looseness is less than this fraction of the cheaper one's.
const TIGHTER: f64 = 0.9;

/// The properties of a table that are not stored in its buffer.
#[derive(Debug, Clone, Copy)]
pub(super) struct TablePlan {
    pub(super) ray_grid: RayGrid,
    pub(super) layout: Layout,
    pub(super) has_missing: bool,
    /// Scales of the look-ups of columns and of rows.
    pub(super) scales: [Scale; 2],
}

impl TablePlan {
    /// Builds the table in the buffer.
    pub(super) fn fill(
        ray_grid: RayGrid,
        direction: impl Fn(u32, u32) -> DVec3,
        buffer: &mut [CacheLine],
    ) -> Result<Self, TableError> {
        let (width, height) = (ray_grid.width as usize, ray_grid.height as usize);
        let count = ray_grid.blocks_across() * ray_grid.blocks_down();
        let mut memory = Cutter(buffer);
        let blocks: &mut [[[f32; WIDTH]; 3]] = memory.take(count);
        let missing: &mut [u16] = memory.take(count);
        fill_blocks(&ray_grid, direction, blocks, missing)?;
        let (blocks, missing) = (&*blocks, &*missing);
        let mut values: [&mut [f32]; 4] = core::array::from_fn(|_| memory.take(count + WIDTH));
        fill_middles(blocks, &mut values);

        let rays = TableDirections { ray_grid, blocks, missing };
        let mut take = |count: usize| [(); 2].map(|()| memory.take(cells(count) + 1));
        let mut tables = Tables { columns: take(width), rows: take(height) };
        let mut looseness = |layout: &Layout| {
            let [columns, rows] = tables.reborrow().fill(&rays, layout);
            columns.looseness() / width as f64 + rows.looseness() / height as f64
        };
        let perspective = rays.perspective();
        let ahead = perspective.or_else(|| rays.stereographic());
        let around = if perspective.is_none() { Some(rays.cylindrical()) } else { None };
        let stretched = ahead.and_then(|layout| rays.stretched(&layout));
        // Choose the simplest of the charts that are about equally tight.
        let mut layout = None;
        for candidate in [ahead, stretched, around].into_iter().flatten() {
            let looseness = looseness(&candidate);
            if layout.is_none_or(|(_, least)| looseness < least * TIGHTER) {
                layout = Some((candidate, looseness));
            }
        }
        let layout = layout.map_or_else(|| rays.cylindrical(), |(layout, _)| layout);
        let scales = tables.fill(&rays, &layout).map(|look_up| look_up.scale);
        Ok(Self { ray_grid, layout, has_missing: missing.iter().any(|lanes| *lanes != 0), scales })
    }
}

/// Normalises directions and stores them in blocks. A missing ray is filled with another direction of its block, so
/// that it does not enlarge the block.
fn fill_blocks(
    ray_grid: &RayGrid,
    direction: impl Fn(u32, u32) -> DVec3,
    blocks: &mut [[[f32; WIDTH]; 3]],
    missing: &mut [u16],
) -> Result<(), TableError> {
    let mut is_empty = true;
    for (index, (block, missing)) in blocks.iter_mut().zip(missing).enumerate() {
        let (across, down) = (index % ray_grid.blocks_across(), index / ray_grid.blocks_across());
        *missing = 0;
        let mut filler = None;
        for lane in 0..WIDTH {
            let (x, y) = ray_grid.lane_position(lane);
            let column = ((across << ray_grid.shift_x) + x).min(ray_grid.width as usize - 1) as u32;
            let row = ((down << ray_grid.shift_y) + y).min(ray_grid.height as usize - 1) as u32;
            let direction = direction(column, row);
            if direction == DVec3::ZERO {
                *missing |= 1 << lane;
                continue;
            }
            if !direction.is_finite() {
                return Err(TableError::NotFinite { column, row });
            }
            let length = sqrt(direction.length_squared());
            if (length - 1.0).abs() > LENGTH_TOLERANCE {
                return Err(TableError::NotUnit { column, row, length });
            }
            let direction = (direction / length).as_vec3().to_array();
            filler.get_or_insert(direction);
            for axis in 0..3 {
                block[axis][lane] = direction[axis];
            }
        }
        is_empty &= filler.is_none();
        let filler = filler.unwrap_or([1.0, 0.0, 0.0]);
        for lane in (0..WIDTH).filter(|lane| *missing >> lane & 1 != 0) {
            for axis in 0..3 {
                block[axis][lane] = filler[axis];
            }
        }
    }
    if is_empty { Err(TableError::Empty) } else { Ok(()) }
}

/// The middle and the radius of each block; 0 for blocks past the last one.
fn fill_middles(blocks: &[[[f32; WIDTH]; 3]], values: &mut [&mut [f32]; 4]) {
    for values in values.iter_mut() {
        values.fill(0.0);
    }
    for (index, block) in blocks.iter().enumerate() {
        let middle = block.map(|values| values.iter().sum::<f32>() / WIDTH as f32);
        let farthest = (0..WIDTH).fold(0.0_f64, |farthest, lane| {
            let offset = |axis: usize| f64::from(block[axis][lane]) - f64::from(middle[axis]);
            farthest.max(offset(0) * offset(0) + offset(1) * offset(1) + offset(2) * offset(2))
        });
        for axis in 0..3 {
            values[axis][index] = middle[axis];
        }
        // Slightly enlarged for the rounding error of planes.
        values[3][index] = sqrt(farthest) as f32 * 1.0001 + 2e-6;
    }
}

/// Memory of the look-ups: the first and the last number for each cell.
struct Tables<'t> {
    columns: [&'t mut [i16]; 2],
    rows: [&'t mut [i16]; 2],
}

impl<'t> Tables<'t> {
    fn reborrow(&mut self) -> Tables<'_> {
        let [first_column, last_column] = &mut self.columns;
        let [first_row, last_row] = &mut self.rows;
        Tables { columns: [first_column, last_column], rows: [first_row, last_row] }
    }

    /// Fills the look-ups of columns and rows.
    fn fill(self, rays: &TableDirections<'_>, layout: &Layout) -> [LookUp<'t>; 2] {
        let mut extent = [[f32::INFINITY, f32::NEG_INFINITY]; 2];
        rays.for_each(|_, _, direction| {
            for (extent, at) in extent.iter_mut().zip(layout.chart.coordinates(direction)) {
                *extent = [extent[0].min(at), extent[1].max(at)];
            }
        });
        let [first, last] = self.columns;
        let mut columns = Filling::new(extent[0], first, last);
        let [first, last] = self.rows;
        let mut rows = Filling::new(extent[1], first, last);
        rays.for_each(|column, row, direction| {
            let [u, v] = layout.chart.coordinates(direction);
            columns.add(u, layout.column(rays, column, u));
            rows.add(v, row);
        });
        [columns.finish(), rows.finish()]
    }
}
