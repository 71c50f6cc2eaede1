//! Bands of a grid: the rows that are traced at a time, and the processing of their hits.

use crate::execution::SplitRows;
use crate::optics::rays::Rays;
use crate::simd::WIDTH;
use crate::trace::image::Target;
use crate::trace::packet::scratch::SpecularScratch;
use crate::trace::placed::view::{View, ViewMemory};
use core::cell::RefCell;
use fearless_simd::Simd;

/// The processing of each band after it has been traced.
pub(crate) trait BandWork<O>: Sync {
    /// Processes a band of traced rays, inside `simd.vectorize`. `output` is split by rows of blocks; it begins with
    /// the band's [`first_row`](Band::first_row).
    fn finish<S: Simd>(&self, simd: S, band: &Band<'_>, output: &mut O);

    /// Returns true if lines are needed from every slice that contains them, and not only from the first.
    fn is_mean(&self) -> bool {
        false
    }
}

/// A traced band of a grid, or the part of it that is captured at one moment.
pub(crate) struct Band<'a> {
    pub(crate) view: &'a View<'a>,
    pub(crate) rays: Rays<'a>,
    /// First and last row of the grid.
    pub(crate) rows: [i32; 2],
    /// The first row of the output.
    pub(crate) first_row: i32,
    /// Rows from this one on are in no earlier slice.
    pub(crate) fresh_from: i32,
    /// Rows from this one on are also in a later slice.
    pub(crate) open_from: i32,
    pub(crate) target: Target<'a>,
    /// Scratch memory for rays that are followed beyond mirrors and panes, if there are any.
    pub(crate) room: RefCell<&'a mut [SpecularScratch]>,
}

impl Band<'_> {
    /// First and last row of blocks.
    pub(crate) fn block_rows(&self) -> core::ops::RangeInclusive<usize> {
        let shift = self.rays.ray_grid().shift_y;
        (self.rows[0] >> shift) as usize..=(self.rows[1] >> shift) as usize
    }

    /// The index of a row of blocks, counted from the first of the output.
    #[inline(always)]
    pub(crate) fn row_in_output(&self, block_row: usize) -> usize {
        block_row - (self.first_row >> self.rays.ray_grid().shift_y) as usize
    }
}

/// The rows of a band; see [`Band`].
pub(super) struct BandPart {
    pub(super) rows: [i32; 2],
    pub(super) first_row: i32,
    pub(super) fresh_from: i32,
    pub(super) open_from: i32,
}

/// A part of the memory and of the output, split between bands.
pub(super) struct BandOutput<'a, O> {
    /// Memory for one view per band, if bands make their own views.
    pub(super) views: Option<ViewMemory<'a>>,
    pub(super) instances: usize,
    pub(super) inverse: &'a mut [[f32; WIDTH]],
    pub(super) slot: &'a mut [[u32; WIDTH]],
    pub(super) farthest: &'a mut [f32],
    /// Scratch memory for each band; empty if it is not needed.
    pub(super) rooms: &'a mut [SpecularScratch],
    pub(super) output: O,
    pub(super) farthest_stride: usize,
    pub(super) block_rows: usize,
    pub(super) blocks_across: usize,
}

impl<O: SplitRows> SplitRows for BandOutput<'_, O> {
    fn split_rows(self, bands: usize) -> (Self, Self) {
        let Self { instances, farthest_stride, block_rows, blocks_across, .. } = self;
        let (views, views_rest) = self.views.map(|views| views.split(bands, instances)).unzip();
        let blocks = bands * block_rows * blocks_across;
        let (inverse, inverse_rest) = self.inverse.split_at_mut(blocks);
        let (slot, slot_rest) = self.slot.split_at_mut(blocks);
        let (farthest, farthest_rest) = self.farthest.split_at_mut(bands * farthest_stride);
        let (rooms, rooms_rest) = self.rooms.split_at_mut(bands.min(self.rooms.len()));
        let (output, output_rest) = self.output.split_rows(bands * block_rows);
        (
            Self {
                views,
                instances,
                inverse,
                slot,
                farthest,
                rooms,
                output,
                farthest_stride,
                block_rows,
                blocks_across,
            },
            Self {
                views: views_rest,
                instances,
                inverse: inverse_rest,
                slot: slot_rest,
                farthest: farthest_rest,
                rooms: rooms_rest,
                output: output_rest,
                farthest_stride,
                block_rows,
                blocks_across,
            },
        )
    }
}
