//! Preparing a table of rays.

use super::super::Fan;
use super::chart::Chart;
use super::layout::{Grid, Layout};
use super::look_up::{Filling, LookUp, Scale, cells};
use crate::memory::{CacheLine, Cutter, Reader};
use crate::optics::Lens;
use crate::scene::tree::WIDTH;
use crate::simd::sqrt;
use glam::{DVec2, DVec3};

/// Columns or rows of a table, at most.
const MOST: u32 = 16_384;
/// How far from 1 the length of a direction may be.
const LENGTH_TOLERANCE: f64 = 1e-4;
/// A chart that takes more work must be so much tighter.
const TIGHTER: f64 = 0.9;

/// Directions of the rays of a sensor, prepared for tracing once and for all in the caller's memory: of a
/// distorted or fisheye lens, of a lidar with uneven rings, or any others.
///
/// Frames are fast if neighbours in a row or column are neighbours in space, and fastest if rows and columns of
/// rays are about straight or, for a lidar, circles. Any table gives right answers.
///
/// ```
/// use belvedere_sensors::optics::{Optics, RayTable};
/// let directions = [[1.0, 0.0, 0.0], [0.8, -0.6, 0.0]];
/// let mut buffer = vec![bytemuck::Zeroable::zeroed(); RayTable::required_len(2, 1)];
/// let table = RayTable::build(2, 1, &directions, &mut buffer)?;
/// assert_eq!(table.direction(1, 0), directions[1]);
/// let grid = Optics::Table(table);
/// assert_eq!(grid.size(), [2, 1]);
/// # Ok::<(), belvedere_sensors::optics::TableError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayTable<'a> {
    fan: Fan,
    /// All x, y and z of each block of sixteen rays; where it reaches over the edge, its last rays repeat.
    pub(super) directions: &'a [[[f32; WIDTH]; 3]],
    /// The lanes of each block that have no ray, a bit each.
    pub(super) missing: &'a [u16],
    pub(super) has_missing: bool,
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
    /// Not a single ray: all pixels lie beyond what the lens maps.
    Empty,
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
            Self::Empty => f.write_str("no pixel sees anything: the lens maps none of them"),
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
        let (any, square) = (Fan::new(width, height), Fan::square(width, height));
        let (any, square) =
            (any.blocks_across() * any.blocks_down(), square.blocks_across() * square.blocks_down());
        let blocks = if any > square { any } else { square };
        3 * blocks
            + (blocks * size_of::<u16>()).div_ceil(size_of::<CacheLine>())
            + 4 * (blocks + WIDTH).div_ceil(WIDTH)
            + 2 * look_up_lines(width as usize)
            + 2 * look_up_lines(height as usize)
    }

    /// Prepares a table of directions, row after row, in the sensor's frame: x forward, y left, z up. [0, 0, 0] says
    /// that a pixel has no ray: it sees nothing.
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
        check_size(width, height)?;
        let expected = width as usize * height as usize;
        if directions.len() != expected {
            return Err(TableError::Count { expected, found: directions.len() });
        }
        let direction = |column: u32, row: u32| {
            DVec3::from_array(directions[row as usize * width as usize + column as usize].map(f64::from))
        };
        Self::fill(Fan::new(width, height), direction, buffer)
    }

    /// Prepares the rays of the pixels of a picture, seen through a lens.
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
        Self::fill(Fan::square(width, height), direction, buffer)
    }

    fn fill(
        fan: Fan,
        direction: impl Fn(u32, u32) -> DVec3,
        buffer: &'a mut [CacheLine],
    ) -> Result<Self, TableError> {
        let (width, height) = (fan.width as u32, fan.height as u32);
        let required = Self::required_len(width, height);
        if buffer.len() < required {
            return Err(TableError::BufferTooSmall { required, found: buffer.len() });
        }
        let plan = Plan::fill(fan, direction, buffer)?;
        Ok(Self::cut(plan, buffer))
    }

    /// The table that lies in a buffer.
    fn cut(plan: Plan, buffer: &'a [CacheLine]) -> Self {
        let Plan { fan, layout, has_missing, scales } = plan;
        let count = fan.blocks_across() * fan.blocks_down();
        let mut memory = Reader(buffer);
        let directions = memory.take(count);
        let missing = memory.take(count);
        let [x, y, z, radii] = core::array::from_fn(|_| memory.take(count + WIDTH));
        let mut look_up = |scale: Scale, count: i32| {
            let [first, last] = core::array::from_fn(|_| memory.take(cells(count as usize) + 1));
            LookUp { scale, first, last }
        };
        let columns = look_up(scales[0], fan.width);
        let rows = look_up(scales[1], fan.height);
        Self {
            fan,
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

    /// The direction of a ray as it is traced; [0, 0, 0] where there is none.
    ///
    /// # Panics
    /// When there is no such ray.
    pub fn direction(&self, column: u32, row: u32) -> [f32; 3] {
        assert!(column < self.fan.width as u32 && row < self.fan.height as u32, "there is no such ray");
        let grid = Grid { fan: self.fan, blocks: self.directions, missing: self.missing };
        let (column, row) = (column as i32, row as i32);
        if grid.has(column, row) { grid.direction(column, row).as_vec3().to_array() } else { [0.0; 3] }
    }

    #[cfg(feature = "alloc")]
    fn plan(&self) -> Plan {
        let layout = Layout { chart: self.chart, ring: self.ring };
        let scales = [self.columns.scale, self.rows.scale];
        Plan { fan: self.fan, layout, has_missing: self.has_missing, scales }
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        [self.fan.width as u32, self.fan.height as u32]
    }

    pub(crate) fn fan(&self) -> Fan {
        self.fan
    }
}

/// What is known of a table besides what lies in its buffer.
#[derive(Debug, Clone, Copy)]
struct Plan {
    fan: Fan,
    layout: Layout,
    has_missing: bool,
    /// Of the look-ups of columns and of rows.
    scales: [Scale; 2],
}

impl Plan {
    /// Fills the buffer.
    fn fill(
        fan: Fan,
        direction: impl Fn(u32, u32) -> DVec3,
        buffer: &mut [CacheLine],
    ) -> Result<Self, TableError> {
        let (width, height) = (fan.width as usize, fan.height as usize);
        let count = fan.blocks_across() * fan.blocks_down();
        let mut memory = Cutter(buffer);
        let blocks: &mut [[[f32; WIDTH]; 3]] = memory.take(count);
        let missing: &mut [u16] = memory.take(count);
        fill_blocks(&fan, direction, blocks, missing)?;
        let (blocks, missing) = (&*blocks, &*missing);
        let mut values: [&mut [f32]; 4] = core::array::from_fn(|_| memory.take(count + WIDTH));
        fill_middles(blocks, &mut values);

        let rays = Grid { fan, blocks, missing };
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
        // The simplest of those that are about as tight.
        let mut layout = None;
        for candidate in [ahead, stretched, around].into_iter().flatten() {
            let looseness = looseness(&candidate);
            if layout.is_none_or(|(_, least)| looseness < least * TIGHTER) {
                layout = Some((candidate, looseness));
            }
        }
        let layout = layout.map_or_else(|| rays.cylindrical(), |(layout, _)| layout);
        let scales = tables.fill(&rays, &layout).map(|look_up| look_up.scale);
        Ok(Self { fan, layout, has_missing: missing.iter().any(|lanes| *lanes != 0), scales })
    }
}

/// A table of rays that owns its memory.
///
/// ```
/// use belvedere_sensors::camera::{Camera, CameraConfig};
/// use belvedere_sensors::optics::{Intrinsics, KannalaBrandt, RayTableBuf};
/// let intrinsics = Intrinsics { fx: 100.0, fy: 100.0, cx: 159.5, cy: 119.5, skew: 0.0 };
/// let fisheye = RayTableBuf::from_lens(320, 240, &KannalaBrandt::new(intrinsics, [0.0; 4])?)?;
/// // The pixel a quarter of a turn to the right of the axis: 100 px/rad · π/2.
/// let [forward, left, _] = fisheye.table().direction(317, 120);
/// assert!(forward.abs() < 0.01 && left < -0.99);
/// let camera = Camera::new(CameraConfig::new(&fisheye))?;
/// assert_eq!(camera.size(), [320, 240]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[cfg(feature = "alloc")]
#[derive(Debug, Clone)]
pub struct RayTableBuf {
    plan: Plan,
    buffer: alloc::vec::Vec<CacheLine>,
}

#[cfg(feature = "alloc")]
impl RayTableBuf {
    /// [`RayTable::build`] in memory of its own.
    ///
    /// # Errors
    /// Those of [`RayTable::build`].
    pub fn build(width: u32, height: u32, directions: &[[f32; 3]]) -> Result<Self, TableError> {
        Self::with(width, height, |buffer| RayTable::build(width, height, directions, buffer))
    }

    /// [`RayTable::from_lens`] in memory of its own.
    ///
    /// # Errors
    /// [`TableError::Size`]; [`TableError::Empty`] if the lens maps no pixel.
    pub fn from_lens(width: u32, height: u32, lens: &(impl Lens + ?Sized)) -> Result<Self, TableError> {
        Self::with(width, height, |buffer| RayTable::from_lens(width, height, lens, buffer))
    }

    fn with(
        width: u32,
        height: u32,
        build: impl FnOnce(&mut [CacheLine]) -> Result<RayTable<'_>, TableError>,
    ) -> Result<Self, TableError> {
        check_size(width, height)?;
        let zero = <CacheLine as bytemuck::Zeroable>::zeroed();
        let mut buffer = alloc::vec![zero; RayTable::required_len(width, height)];
        let plan = build(&mut buffer)?.plan();
        Ok(Self { plan, buffer })
    }

    /// Lends the table to a sensor.
    pub fn table(&self) -> RayTable<'_> {
        RayTable::cut(self.plan, &self.buffer)
    }
}

fn check_size(width: u32, height: u32) -> Result<(), TableError> {
    let size = 1..=MOST;
    if size.contains(&width) && size.contains(&height) {
        Ok(())
    } else {
        Err(TableError::Size { width, height })
    }
}

/// Cache lines of both look-ups of columns (or rows), each.
const fn look_up_lines(count: usize) -> usize {
    ((cells(count) + 1) * size_of::<i16>()).div_ceil(size_of::<CacheLine>())
}

/// Normalises directions and lays them out in blocks. Where there is no ray, another of its block stands, so that the
/// block is not wider for it.
fn fill_blocks(
    fan: &Fan,
    direction: impl Fn(u32, u32) -> DVec3,
    blocks: &mut [[[f32; WIDTH]; 3]],
    missing: &mut [u16],
) -> Result<(), TableError> {
    let mut is_empty = true;
    for (index, (block, missing)) in blocks.iter_mut().zip(missing).enumerate() {
        let (across, down) = (index % fan.blocks_across(), index / fan.blocks_across());
        *missing = 0;
        let mut filler = None;
        for lane in 0..WIDTH {
            let (x, y) = fan.lane_position(lane);
            let column = ((across << fan.shift_x) + x).min(fan.width as usize - 1) as u32;
            let row = ((down << fan.shift_y) + y).min(fan.height as usize - 1) as u32;
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
