//! Frames of rays from one point, band by band.

use super::image::{Fan, PinholeFan, Projection, RayTable, SphericalFan, Steps, TableFan, Target, walk};
use super::memory::Cutter;
use super::packet::Faces;
use super::view::View;
use crate::execution::{Execution, SplitRows, for_each_row};
use crate::lens::Pinhole;
use crate::scene::tree::WIDTH;
use fearless_simd::{Simd, dispatch};

/// Directions of rays from a sensor, which looks along +x, y is left, z is up; row after row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RayGrid<'a> {
    /// Pixels of a camera.
    Pinhole(Pinhole),
    /// Columns by azimuth around z from +x, rows by elevation, both in equal steps.
    Spherical(SphericalGrid),
    /// Any directions, from a table.
    Table(&'a RayTable<'a>),
}

/// The rays of a spinning lidar. Angles in radians; azimuth is counter-clockwise seen from +z, elevation up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphericalGrid {
    /// Columns, 1 … 16384.
    pub columns: u32,
    /// Rows, 1 … 16384.
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

impl RayGrid<'_> {
    /// Rays across and down.
    pub fn size(&self) -> [usize; 2] {
        let fan = self.fan();
        [fan.width as usize, fan.height as usize]
    }

    /// Rays, filled up to whole blocks: what [`super::Workspace`] must have room for.
    pub fn rays(&self) -> usize {
        let fan = self.fan();
        fan.blocks_across() * fan.blocks_down() * WIDTH
    }

    pub(crate) fn fan(&self) -> Fan {
        match self {
            Self::Pinhole(lens) => Fan::square(lens.width, lens.height),
            Self::Spherical(grid) => Fan::new(grid.columns, grid.rows),
            Self::Table(table) => table.fan(),
        }
    }
}

/// What counts as seen.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sight {
    pub(crate) faces: Faces,
    /// Least and most t.
    pub(crate) range: [f64; 2],
}

/// A band has about that many rays: what is worked on at a time should lie in the second-level cache.
const RAYS_IN_BAND: usize = 40_000;
/// Bands of the greatest grid, about.
pub(crate) const MOST_BANDS: usize = 64;

/// How a grid is cut into bands. It depends on nothing but the grid, so that neither the number of threads nor
/// the SIMD level decides in which order triangles are met.
#[derive(Debug, Clone, Copy)]
struct Bands {
    /// Rows of blocks in a band; the last may have fewer.
    block_rows: usize,
    count: usize,
}

impl Bands {
    fn new(fan: &Fan) -> Self {
        let rays_in_row = fan.blocks_across() * WIDTH;
        let wanted = RAYS_IN_BAND.div_ceil(rays_in_row).max(fan.blocks_down().div_ceil(MOST_BANDS));
        let count = fan.blocks_down().div_ceil(wanted);
        let block_rows = fan.blocks_down().div_ceil(count);
        Self { block_rows, count: fan.blocks_down().div_ceil(block_rows) }
    }
}

/// What is done with each band once it has been traced.
pub(crate) trait BandWork<O>: Sync {
    /// Works on a band of traced rays, inside `simd.vectorize`; `output` is cut by rows of blocks.
    fn finish<S: Simd, P: Projection>(&self, simd: S, band: &Band<'_, P>, output: O);
}

/// A traced band of a grid.
pub(crate) struct Band<'a, P> {
    pub(crate) view: &'a View<'a>,
    pub(crate) projection: P,
    /// First and last row of the grid.
    pub(crate) rows: [i32; 2],
    pub(crate) target: Target<'a>,
}

impl<P: Projection> Band<'_, P> {
    /// First and last row of blocks.
    pub(crate) fn block_rows(&self) -> core::ops::RangeInclusive<usize> {
        let shift = self.projection.fan().shift_y;
        (self.rows[0] >> shift) as usize..=(self.rows[1] >> shift) as usize
    }
}

/// Traces all rays of a grid and hands each band to `work`.
pub(crate) fn trace_grid<O: SplitRows, W: BandWork<O>>(
    view: &View<'_>,
    grid: &RayGrid<'_>,
    sight: &Sight,
    execution: Execution,
    memory: &mut Cutter<'_>,
    output: O,
    work: &W,
) {
    match grid {
        RayGrid::Pinhole(lens) => trace_pinhole(view, lens, sight, execution, memory, output, work),
        RayGrid::Spherical(grid) => trace_spherical(view, grid, sight, execution, memory, output, work),
        RayGrid::Table(table) => {
            trace_bands(view, TableFan::new(table), sight, execution, memory, output, work);
        }
    }
}

/// Traces all pixels of a pinhole camera.
pub(crate) fn trace_pinhole<O: SplitRows, W: BandWork<O>>(
    view: &View<'_>,
    lens: &Pinhole,
    sight: &Sight,
    execution: Execution,
    memory: &mut Cutter<'_>,
    output: O,
    work: &W,
) {
    trace_bands(view, PinholeFan::new(lens), sight, execution, memory, output, work);
}

/// Traces all beams of a spinning lidar.
pub(crate) fn trace_spherical<O: SplitRows, W: BandWork<O>>(
    view: &View<'_>,
    grid: &SphericalGrid,
    sight: &Sight,
    execution: Execution,
    memory: &mut Cutter<'_>,
    output: O,
    work: &W,
) {
    let fan = Fan::new(grid.columns, grid.rows);
    let azimuth = Steps { first: grid.first_azimuth_rad, step: grid.azimuth_step_rad };
    let elevation = Steps { first: grid.first_elevation_rad, step: grid.elevation_step_rad };
    let tables = memory.take(SphericalFan::table_len(&fan));
    let projection = dispatch!(execution.level, simd => simd.vectorize(
        #[inline(always)]
        || SphericalFan::new(fan, azimuth, elevation, tables)
    ));
    trace_bands(view, projection, sight, execution, memory, output, work);
}

fn trace_bands<P: Projection + Sync, O: SplitRows, W: BandWork<O>>(
    view: &View<'_>,
    projection: P,
    sight: &Sight,
    execution: Execution,
    memory: &mut Cutter<'_>,
    output: O,
    work: &W,
) {
    let fan = *projection.fan();
    let bands = Bands::new(&fan);
    let blocks = fan.blocks_across() * fan.blocks_down();
    let margin = bands.count * 3 * WIDTH;
    let output = BandOutput {
        inverse: memory.take(blocks),
        slot: memory.take(blocks),
        farthest: memory.take(blocks + margin),
        output,
        block_rows: bands.block_rows,
        blocks_across: fan.blocks_across(),
    };
    let inverse_far = (1.0 / sight.range[1]) as f32;
    for_each_row(execution, 0..bands.count, output, &|band, output: BandOutput<'_, O>| {
        let first = (band * bands.block_rows) << fan.shift_y;
        let last = ((((band + 1) * bands.block_rows) << fan.shift_y) - 1).min(fan.height as usize - 1);
        let rows = [first as i32, last as i32];
        let blocks = ((rows[1] >> fan.shift_y) - (rows[0] >> fan.shift_y) + 1) as usize * fan.blocks_across();
        let mut target = Target {
            inverse: &mut output.inverse[..blocks],
            slot: &mut output.slot[..blocks],
            farthest: &mut output.farthest[..blocks + WIDTH],
        };
        let projection = projection.with_rows(rows);
        dispatch!(execution.level, simd => {
            target.clear(inverse_far);
            draw(simd, view, projection, rows, sight, &mut target);
            let band = Band { view, projection, rows, target };
            simd.vectorize(
                #[inline(always)]
                || work.finish(simd, &band, output.output),
            );
        });
    });
}

/// [`walk`], compiled once for each kind of grid and SIMD level, whatever is done with the band afterwards.
fn draw<S: Simd, P: Projection>(
    simd: S,
    view: &View<'_>,
    projection: P,
    rows: [i32; 2],
    sight: &Sight,
    target: &mut Target<'_>,
) {
    simd.vectorize(
        #[inline(always)]
        || walk(simd, view, projection, rows, sight.faces, sight.range, target),
    );
}

/// A part of the memory and of the output, cut between bands.
struct BandOutput<'a, O> {
    inverse: &'a mut [[f32; WIDTH]],
    slot: &'a mut [[u32; WIDTH]],
    farthest: &'a mut [f32],
    output: O,
    block_rows: usize,
    blocks_across: usize,
}

impl<O: SplitRows> SplitRows for BandOutput<'_, O> {
    fn split_rows(self, bands: usize) -> (Self, Self) {
        let Self { block_rows, blocks_across, .. } = self;
        let blocks = bands * block_rows * blocks_across;
        let (inverse, inverse_rest) = self.inverse.split_at_mut(blocks);
        let (slot, slot_rest) = self.slot.split_at_mut(blocks);
        // Rounded up to a whole line, so that no two threads write to one.
        let (farthest, farthest_rest) =
            self.farthest.split_at_mut((blocks + bands * 2 * WIDTH).next_multiple_of(WIDTH));
        let (output, output_rest) = self.output.split_rows(bands * block_rows);
        (
            Self { inverse, slot, farthest, output, block_rows, blocks_across },
            Self {
                inverse: inverse_rest,
                slot: slot_rest,
                farthest: farthest_rest,
                output: output_rest,
                block_rows,
                blocks_across,
            },
        )
    }
}
