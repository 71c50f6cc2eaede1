//! Building a table of rays.

use super::chart::Chart;
use super::error::{TableError, check_size};
use super::layout::TableDirections;
use super::look_up::{LookUp, Scale, cells};
use super::plan::TablePlan;
use crate::memory::{CacheLine, Reader};
use crate::optics::Lens;
use crate::optics::rays::RayGrid;
use crate::simd::WIDTH;
use glam::{DVec2, DVec3};

/// A table of ray directions, prepared for tracing in memory that the caller provides: for a distorted or fisheye lens,
/// a lidar with unevenly spaced channels, or any other directions.
///
/// Tracing is fast if neighbours in a row or column are neighbours in space, and fastest if rows and columns of rays
/// are approximately straight or, for a lidar, circles. The results are correct for any table.
///
/// ```
/// use belvedere_sensors::optics::{Optics, RayTable};
/// let directions = [[1.0, 0.0, 0.0], [0.8, -0.6, 0.0]];
/// let mut buffer = vec![belvedere_sensors::trace::CacheLine::ZERO; RayTable::required_len(2, 1)];
/// let table = RayTable::build(2, 1, &directions, &mut buffer)?;
/// assert_eq!(table.direction(1, 0), directions[1]);
/// let grid = Optics::Table(table);
/// assert_eq!(grid.size(), [2, 1]);
/// # Ok::<(), belvedere_sensors::optics::TableError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayTable<'a> {
    ray_grid: RayGrid,
    /// The memory of all slices below.
    pub(super) buffer: &'a [CacheLine],
    /// All x, y and z of each block of sixteen rays. In blocks that extend over the edge, the last rays are repeated.
    pub(super) directions: &'a [[[f32; WIDTH]; 3]],
    /// The lanes of each block without a ray, as one bit each.
    pub(super) missing: &'a [u16],
    pub(super) has_missing: bool,
    /// x, y and z of the middle direction of each block, with sixteen more so that vectors can be read.
    pub(super) middles: [&'a [f32]; 3],
    /// Upper bound on the distance of a block's directions from its middle direction, with sixteen more likewise.
    pub(super) radii: &'a [f32],
    pub(super) chart: Chart,
    pub(super) columns: LookUp<'a>,
    pub(super) rows: LookUp<'a>,
    /// True if the columns close to a ring: the first follows the last.
    pub(super) ring: bool,
}

impl<'a> RayTable<'a> {
    /// Returns the number of cache lines that a table needs: about 13 bytes per ray, 16 per column and row, and 3 kB.
    pub const fn required_len(width: u32, height: u32) -> usize {
        let (any, square) = (RayGrid::new(width, height), RayGrid::square(width, height));
        let (any, square) =
            (any.blocks_across() * any.blocks_down(), square.blocks_across() * square.blocks_down());
        let blocks = if any > square { any } else { square };
        3 * blocks
            + (blocks * size_of::<u16>()).div_ceil(size_of::<CacheLine>())
            + 4 * (blocks + WIDTH).div_ceil(WIDTH)
            + 2 * look_up_lines(width as usize)
            + 2 * look_up_lines(height as usize)
    }

    /// Builds a table of directions, row by row, in the sensor's frame: x forward, y left, z up. [0, 0, 0] means that a
    /// pixel has no ray and sees nothing.
    ///
    /// Directions are normalised in double precision and rounded to single precision. [`RayTable::direction`] returns
    /// exactly the direction that is traced.
    ///
    /// # Errors
    /// If there are no rays or too many, if the number of directions is wrong, if a direction is not finite or not of
    /// length 1 (± 1e-4), or if the buffer is too small. The error names the ray.
    pub fn build(
        width: u32,
        height: u32,
        directions: &[[f32; 3]],
        buffer: &'a mut [CacheLine],
    ) -> Result<Self, TableError> {
        check_size(width, height)?;
        let expected = width as usize * height as usize;
        if directions.len() != expected {
            return Err(TableError::Count { expected, found: directions.len() });
        }
        let direction = |column: u32, row: u32| {
            DVec3::from_array(directions[row as usize * width as usize + column as usize].map(f64::from))
        };
        Self::fill(RayGrid::new(width, height), direction, buffer)
    }

    /// Builds a table of the rays of an image's pixels, seen through a lens.
    ///
    /// # Errors
    /// [`TableError::Size`], [`TableError::BufferTooSmall`]; [`TableError::Empty`] if the lens maps no pixel.
    pub fn from_lens(
        width: u32,
        height: u32,
        lens: &(impl Lens + ?Sized),
        buffer: &'a mut [CacheLine],
    ) -> Result<Self, TableError> {
        check_size(width, height)?;
        let direction = |column: u32, row: u32| {
            lens.unproject(DVec2::new(column.into(), row.into()))
                .map_or(DVec3::ZERO, |ray| DVec3::new(ray.z, -ray.x, -ray.y))
        };
        Self::fill(RayGrid::square(width, height), direction, buffer)
    }

    fn fill(
        ray_grid: RayGrid,
        direction: impl Fn(u32, u32) -> DVec3,
        buffer: &'a mut [CacheLine],
    ) -> Result<Self, TableError> {
        let (width, height) = (ray_grid.width as u32, ray_grid.height as u32);
        let required = Self::required_len(width, height);
        if buffer.len() < required {
            return Err(TableError::BufferTooSmall { required, found: buffer.len() });
        }
        let plan = TablePlan::fill(ray_grid, direction, buffer)?;
        Ok(Self::cut(&plan, buffer))
    }

    /// Borrows the table that is stored in a buffer.
    pub(super) fn cut(plan: &TablePlan, buffer: &'a [CacheLine]) -> Self {
        let TablePlan { ray_grid, layout, has_missing, scales } = *plan;
        let count = ray_grid.blocks_across() * ray_grid.blocks_down();
        let mut memory = Reader(buffer);
        let directions = memory.take(count);
        let missing = memory.take(count);
        let [x, y, z, radii] = core::array::from_fn(|_| memory.take(count + WIDTH));
        let mut look_up = |scale: Scale, count: i32| {
            let [first, last] = core::array::from_fn(|_| memory.take(cells(count as usize) + 1));
            LookUp { scale, first, last }
        };
        let columns = look_up(scales[0], ray_grid.width);
        let rows = look_up(scales[1], ray_grid.height);
        Self {
            ray_grid,
            buffer,
            directions,
            missing,
            has_missing,
            middles: [x, y, z],
            radii,
            chart: layout.chart,
            columns,
            rows,
            ring: layout.ring,
        }
    }

    /// Returns the direction of a ray exactly as it is traced, or [0, 0, 0] if the pixel has no ray.
    ///
    /// # Panics
    /// If `column` or `row` is outside the table.
    pub fn direction(&self, column: u32, row: u32) -> [f32; 3] {
        assert!(
            column < self.ray_grid.width as u32 && row < self.ray_grid.height as u32,
            "there is no such ray"
        );
        let grid =
            TableDirections { ray_grid: self.ray_grid, blocks: self.directions, missing: self.missing };
        let (column, row) = (column as i32, row as i32);
        if grid.has(column, row) { grid.direction(column, row).as_vec3().to_array() } else { [0.0; 3] }
    }

    #[cfg(feature = "alloc")]
    pub(super) fn plan(&self) -> TablePlan {
        let layout = super::layout::Layout { chart: self.chart, ring: self.ring };
        let scales = [self.columns.scale, self.rows.scale];
        TablePlan { ray_grid: self.ray_grid, layout, has_missing: self.has_missing, scales }
    }

    /// Number of columns and rows.
    pub fn size(&self) -> [u32; 2] {
        [self.ray_grid.width as u32, self.ray_grid.height as u32]
    }

    pub(crate) fn ray_grid(&self) -> RayGrid {
        self.ray_grid
    }
}

/// Number of cache lines of each of the two look-up arrays for columns (or rows).
const fn look_up_lines(count: usize) -> usize {
    ((cells(count) + 1) * size_of::<i16>()).div_ceil(size_of::<CacheLine>())
}
