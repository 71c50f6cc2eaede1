//! Preparing a table of rays.

use super::chart::Chart;
use super::layout::{Grid, Layout};
use super::look_up::{Filling, LookUp, cells};
use crate::scene::tree::WIDTH;
use crate::simd::sqrt;
use crate::trace::image::Fan;
use crate::trace::memory::{CacheLine, Cutter};
use glam::DVec3;

/// Columns or rows of a table, at most.
const MOST: u32 = 16_384;
/// How far from 1 the length of a direction may be.
const LENGTH_TOLERANCE: f64 = 1e-4;
/// Directions of the rays of a sensor, prepared for tracing once and for all in the caller's memory: of a
/// distorted or fisheye lens, of a lidar with uneven rings, or any others.
///
/// Frames are fast if neighbours in a row or column are neighbours in space, and fastest if rows and columns of
/// rays are about straight or, for a lidar, circles. Any table gives right answers.
///
/// ```
/// use belvedere_sensors::trace::{CacheLine, RayGrid, RayTable};
/// let directions = [[1.0, 0.0, 0.0], [0.8, -0.6, 0.0]];
/// let mut buffer = vec![bytemuck::Zeroable::zeroed(); RayTable::required_len(2, 1)];
/// let table = RayTable::build(2, 1, &directions, &mut buffer)?;
/// assert_eq!(table.direction(1, 0), directions[1]);
/// let grid = RayGrid::Table(&table);
/// assert_eq!(grid.size(), [2, 1]);
/// # Ok::<(), belvedere_sensors::trace::TableError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayTable<'a> {
    width: u32,
    height: u32,
    /// All x, y and z of each block of sixteen rays; where it reaches over the edge, its last rays repeat.
    pub(super) directions: &'a [[[f32; WIDTH]; 3]],
    /// x, y and z of the middle direction of each block, and sixteen more to read.
    pub(super) middles: [&'a [f32]; 3],
    /// No direction of a block is farther from that of its middle; sixteen more, too.
    pub(super) radii: &'a [f32],
    pub(super) chart: Chart,
    pub(super) columns: LookUp<'a>,
    pub(super) rows: LookUp<'a>,
    /// The columns close to a ring: the first follows the last.
    pub(super) ring: bool,
}

/// What is wrong with a table of rays.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum TableError {
    /// There are no rays, or more than 16384 columns or rows.
    Size {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// Not one direction a ray.
    Count {
        /// Columns × rows.
        expected: usize,
        /// Directions.
        found: usize,
    },
    /// A direction has a coordinate that is not finite.
    NotFinite {
        /// Of the ray.
        column: u32,
        /// Of the ray.
        row: u32,
    },
    /// A direction's length is not 1 to within 1e-4.
    NotUnit {
        /// Of the ray.
        column: u32,
        /// Of the ray.
        row: u32,
        /// What it is.
        length: f64,
    },
    /// Fewer cache lines than [`RayTable::required_len`].
    BufferTooSmall {
        /// Cache lines that are needed.
        required: usize,
        /// Those that there are.
        found: usize,
    },
}

impl core::fmt::Display for TableError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::Size { width, height } => {
                write!(f, "a table of {width} × {height} rays: there must be 1 to {MOST} columns and rows")
            }
            Self::Count { expected, found } => {
                write!(f, "{found} directions for {expected} rays: give one for each, row after row")
            }
            Self::NotFinite { column, row } => {
                write!(f, "the direction at column {column}, row {row} is not finite")
            }
            Self::NotUnit { column, row, length } => {
                write!(
                    f,
                    "the direction at column {column}, row {row} has a length of {length}: normalise it to 1"
                )
            }
            Self::BufferTooSmall { required, found } => {
                write!(f, "a buffer of {found} cache lines: {required} are needed")
            }
        }
    }
}

impl core::error::Error for TableError {}

impl<'a> RayTable<'a> {
    /// Cache lines that a table needs: about 13 bytes a ray, 16 for each column and row, and 3 kB.
    pub const fn required_len(width: u32, height: u32) -> usize {
        let fan = Fan::new(width, height);
        let blocks = fan.blocks_across() * fan.blocks_down();
        3 * blocks
            + 4 * (blocks + WIDTH).div_ceil(WIDTH)
            + 2 * look_up_lines(width as usize)
            + 2 * look_up_lines(height as usize)
    }

    /// Prepares a table of directions, row after row, in the sensor's frame: x forward, y left, z up.
    ///
    /// Directions are normalised in double precision and rounded to single: what [`RayTable::direction`] then
    /// tells is what is traced, to the last bit.
    ///
    /// # Errors
    /// When there are no rays or too many, not one direction each, one that is not finite or not of length 1
    /// (± 1e-4), or the buffer is too small; the error names the ray.
    pub fn build(
        width: u32,
        height: u32,
        directions: &[[f32; 3]],
        buffer: &'a mut [CacheLine],
    ) -> Result<Self, TableError> {
        if !(1..=MOST).contains(&width) || !(1..=MOST).contains(&height) {
            return Err(TableError::Size { width, height });
        }
        let expected = width as usize * height as usize;
        if directions.len() != expected {
            return Err(TableError::Count { expected, found: directions.len() });
        }
        let required = Self::required_len(width, height);
        if buffer.len() < required {
            return Err(TableError::BufferTooSmall { required, found: buffer.len() });
        }
        let fan = Fan::new(width, height);
        let count = fan.blocks_across() * fan.blocks_down();
        let mut memory = Cutter(buffer);
        let blocks: &mut [[[f32; WIDTH]; 3]] = memory.take(count);
        fill_blocks(&fan, directions, blocks)?;
        let blocks = &*blocks;
        let mut values: [&mut [f32]; 4] = core::array::from_fn(|_| memory.take(count + WIDTH));
        fill_middles(blocks, &mut values);
        let [x, y, z, radii] = values.map(|values| &*values);

        let rays = Grid { fan, blocks };
        let mut take = |count: usize| [(); 2].map(|()| memory.take(cells(count) + 1));
        let mut tables = Tables { columns: take(width as usize), rows: take(height as usize) };
        let layout = rays.perspective().unwrap_or_else(|| {
            let around = rays.cylindrical();
            let mut looseness = |layout: &Layout| {
                let [columns, rows] = tables.reborrow().fill(&rays, layout);
                columns.looseness() / f64::from(width) + rows.looseness() / f64::from(height)
            };
            let tighter = |ahead: &Layout| looseness(ahead) < looseness(&around);
            rays.stereographic().filter(tighter).unwrap_or(around)
        });
        let [columns, rows] = tables.fill(&rays, &layout);
        Ok(Self {
            width,
            height,
            directions: blocks,
            middles: [x, y, z],
            radii,
            chart: layout.chart,
            columns,
            rows,
            ring: layout.ring,
        })
    }

    /// The direction of a ray as it is traced.
    ///
    /// # Panics
    /// When there is no such ray.
    pub fn direction(&self, column: u32, row: u32) -> [f32; 3] {
        assert!(column < self.width && row < self.height, "there is no such ray");
        let grid = Grid { fan: self.fan(), blocks: self.directions };
        grid.direction(column as i32, row as i32).as_vec3().to_array()
    }

    pub(crate) fn fan(&self) -> Fan {
        Fan::new(self.width, self.height)
    }
}

/// Cache lines of both look-ups of columns (or rows), each.
const fn look_up_lines(count: usize) -> usize {
    ((cells(count) + 1) * size_of::<i16>()).div_ceil(size_of::<CacheLine>())
}

/// Normalises directions and lays them out in blocks.
fn fill_blocks(
    fan: &Fan,
    directions: &[[f32; 3]],
    blocks: &mut [[[f32; WIDTH]; 3]],
) -> Result<(), TableError> {
    for (index, block) in blocks.iter_mut().enumerate() {
        let (across, down) = (index % fan.blocks_across(), index / fan.blocks_across());
        for lane in 0..WIDTH {
            let (x, y) = fan.lane_position(lane);
            let column = ((across << fan.shift_x) + x).min(fan.width as usize - 1);
            let row = ((down << fan.shift_y) + y).min(fan.height as usize - 1);
            let direction = DVec3::from_array(directions[row * fan.width as usize + column].map(f64::from));
            let (column, row) = (column as u32, row as u32);
            if !direction.is_finite() {
                return Err(TableError::NotFinite { column, row });
            }
            let length = sqrt(direction.length_squared());
            if (length - 1.0).abs() > LENGTH_TOLERANCE {
                return Err(TableError::NotUnit { column, row, length });
            }
            let [x, y, z] = (direction / length).as_vec3().to_array();
            (block[0][lane], block[1][lane], block[2][lane]) = (x, y, z);
        }
    }
    Ok(())
}

/// The middle and the radius of each block; of those past the last they are 0.
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
        // A little more, for what rounding does to planes.
        values[3][index] = sqrt(farthest) as f32 * 1.0001 + 2e-6;
    }
}

/// Memory for the look-ups: the first and the last for each cell.
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

    /// The look-ups of columns and rows.
    fn fill(self, rays: &Grid<'_>, layout: &Layout) -> [LookUp<'t>; 2] {
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
