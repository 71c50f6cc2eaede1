//! Frames of rays from one point, band by band.

use super::image::{Target, walk};
use super::packet::Faces;
use super::view::View;
use crate::execution::{Execution, SplitRows, for_each_row};
use crate::memory::Cutter;
use crate::optics::rays::{Fan, PinholeFan, Projection, Rays, SphericalFan, Steps, TableFan, each};
use crate::optics::{Optics, SphericalGrid};
use crate::scene::tree::WIDTH;
use fearless_simd::{Simd, dispatch};

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
    /// Blocks of the grid.
    blocks: usize,
    /// From where [`Target::farthest`] of a band begins to where that of the next does: whole cache lines, so that no
    /// two threads write to one, and sixteen more than a band has blocks.
    farthest_stride: usize,
}

impl Bands {
    fn new(fan: &Fan) -> Self {
        let rays_in_row = fan.blocks_across() * WIDTH;
        let wanted = RAYS_IN_BAND.div_ceil(rays_in_row).max(fan.blocks_down().div_ceil(MOST_BANDS));
        let count = fan.blocks_down().div_ceil(wanted);
        let block_rows = fan.blocks_down().div_ceil(count);
        Self {
            block_rows,
            count: fan.blocks_down().div_ceil(block_rows),
            blocks: fan.blocks_across() * fan.blocks_down(),
            farthest_stride: (block_rows * fan.blocks_across() + WIDTH).next_multiple_of(WIDTH),
        }
    }

    /// Elements of `farthest` of all bands.
    fn farthest_len(&self, fan: &Fan) -> usize {
        let before_last = (self.count - 1) * self.block_rows * fan.blocks_across();
        (self.count - 1) * self.farthest_stride + (self.blocks - before_last) + WIDTH
    }
}

/// What is done with each band once it has been traced.
pub(crate) trait BandWork<O>: Sync {
    /// Works on a band of traced rays, inside `simd.vectorize`; `output` is cut by rows of blocks.
    fn finish<S: Simd>(&self, simd: S, band: &Band<'_>, output: O);
}

/// A traced band of a grid.
pub(crate) struct Band<'a> {
    pub(crate) view: &'a View<'a>,
    pub(crate) rays: Rays<'a>,
    /// First and last row of the grid.
    pub(crate) rows: [i32; 2],
    pub(crate) target: Target<'a>,
}

impl Band<'_> {
    /// First and last row of blocks.
    pub(crate) fn block_rows(&self) -> core::ops::RangeInclusive<usize> {
        let shift = self.rays.fan().shift_y;
        (self.rows[0] >> shift) as usize..=(self.rows[1] >> shift) as usize
    }
}

/// Traces all rays of a grid and hands each band to `work`.
pub(crate) fn trace_grid<O: SplitRows, W: BandWork<O>>(
    view: &View<'_>,
    grid: &Optics<'_>,
    sight: &Sight,
    execution: Execution,
    memory: &mut Cutter<'_>,
    output: O,
    work: &W,
) {
    let rays = match grid {
        Optics::Pinhole(lens) => Rays::Pinhole(PinholeFan::new(lens)),
        Optics::Spherical(grid) => Rays::Spherical(spherical(grid, execution, memory)),
        Optics::Table(table) => Rays::Table(TableFan::new(table)),
    };
    let fan = *rays.fan();
    let bands = Bands::new(&fan);
    let output = BandOutput {
        inverse: memory.take(bands.blocks),
        slot: memory.take(bands.blocks),
        farthest: memory.take(bands.farthest_len(&fan)),
        output,
        farthest_stride: bands.farthest_stride,
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
        dispatch!(execution.level, simd => {
            target.clear(inverse_far);
            if let Rays::Table(table) = &rays && table.has_missing() {
                leave_out(&rays, rows, &mut target);
            }
            each!(rays, rule => draw(simd, view, rule.with_rows(rows), rows, sight, &mut target));
            let band = Band { view, rays, rows, target };
            simd.vectorize(
                #[inline(always)]
                || work.finish(simd, &band, output.output),
            );
        });
    });
}

/// The angles of a spinning lidar, with their tables.
fn spherical<'a>(grid: &SphericalGrid, execution: Execution, memory: &mut Cutter<'a>) -> SphericalFan<'a> {
    let fan = Fan::new(grid.columns, grid.rows);
    let azimuth = Steps { first: grid.first_azimuth_rad, step: grid.azimuth_step_rad };
    let elevation = Steps { first: grid.first_elevation_rad, step: grid.elevation_step_rad };
    let tables = memory.take(SphericalFan::table_len(&fan));
    dispatch!(execution.level, simd => simd.vectorize(
        #[inline(always)]
        || SphericalFan::new(fan, azimuth, elevation, tables)
    ))
}

/// Sees to it that lanes without a ray hit nothing: nothing is nearer than 0 m.
fn leave_out(rays: &Rays<'_>, rows: [i32; 2], target: &mut Target<'_>) {
    let fan = rays.fan();
    let across = fan.blocks_across();
    let first_row = (rows[0] >> fan.shift_y) as usize;
    for block in 0..target.inverse.len() {
        let mut lanes = rays.missing(block % across, first_row + block / across);
        if lanes == 0 {
            continue;
        }
        while lanes != 0 {
            target.inverse[block][lanes.trailing_zeros() as usize] = f32::INFINITY;
            lanes &= lanes - 1;
        }
        target.update_farthest(block);
    }
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
    farthest_stride: usize,
    block_rows: usize,
    blocks_across: usize,
}

impl<O: SplitRows> SplitRows for BandOutput<'_, O> {
    fn split_rows(self, bands: usize) -> (Self, Self) {
        let Self { farthest_stride, block_rows, blocks_across, .. } = self;
        let blocks = bands * block_rows * blocks_across;
        let (inverse, inverse_rest) = self.inverse.split_at_mut(blocks);
        let (slot, slot_rest) = self.slot.split_at_mut(blocks);
        let (farthest, farthest_rest) = self.farthest.split_at_mut(bands * farthest_stride);
        let (output, output_rest) = self.output.split_rows(bands * block_rows);
        (
            Self { inverse, slot, farthest, output, farthest_stride, block_rows, blocks_across },
            Self {
                inverse: inverse_rest,
                slot: slot_rest,
                farthest: farthest_rest,
                output: output_rest,
                farthest_stride,
                block_rows,
                blocks_across,
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::memory::BAND_MARGIN;

    fn check(fan: &Fan) {
        let bands = Bands::new(fan);
        let (down, across) = (fan.blocks_down(), fan.blocks_across());
        let size = [fan.width, fan.height];
        assert!((1..=MOST_BANDS).contains(&bands.count), "{size:?}: {} bands", bands.count);
        assert!((bands.count - 1) * bands.block_rows < down && down <= bands.count * bands.block_rows);
        let len = bands.farthest_len(fan);
        for band in 0..bands.count {
            let rows = bands.block_rows.min(down - band * bands.block_rows);
            // Sixteen past the end of a band's own are read.
            let end = band * bands.farthest_stride + rows * across + WIDTH;
            let next = if band + 1 < bands.count { (band + 1) * bands.farthest_stride } else { len };
            assert!(end <= next, "{size:?}: band {band} ends at {end}, the next begins at {next}");
        }
        assert!(bands.farthest_stride.is_multiple_of(WIDTH));
        assert!(len <= bands.blocks + BAND_MARGIN, "{size:?}: {len} elements for {} blocks", bands.blocks);
    }

    #[test]
    fn bands_of_all_sizes_have_room() {
        for width in 1..=200 {
            for height in 1..=200 {
                check(&Fan::square(width, height));
                check(&Fan::new(width, height));
            }
        }
        let stream = crate::noise::Stream { seed: 11, sensor: 0, frame: 0, channel: 0 };
        for sample in 0..10_000 {
            let size = [2 * sample, 2 * sample + 1]
                .map(|index| 1 + stream.word(index) % crate::optics::MAX_GRID_SIZE);
            check(&Fan::square(size[0], size[1]));
            check(&Fan::new(size[0], size[1]));
        }
    }
}
