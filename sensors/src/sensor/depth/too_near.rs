//! Pixels in front of which something is nearer than the near clip distance.

use crate::execution::SplitRows;
use crate::trace::grid::{Band, BandWork};
use crate::trace::image::NO_HIT;
use fearless_simd::{Select, Simd, SimdBase, f32x16};

/// The lanes of each block that something too near blocks, a bit each; empty if nothing is too near.
#[derive(Clone, Copy)]
pub(super) struct Obstacles<'a>(pub(super) &'a [u16]);

impl Obstacles<'_> {
    /// Returns the depths of a block of the grid, with −∞ where something is in the way.
    #[inline(always)]
    pub(super) fn hide<S: Simd>(self, simd: S, block: usize, depths: f32x16<S>) -> f32x16<S> {
        let Some(&lanes) = self.0.get(block) else { return depths };
        let hidden = simd.from_bitmask_mask32x16(u64::from(lanes));
        hidden.select(f32x16::splat(simd, f32::NEG_INFINITY), depths)
    }
}

/// Finds the lanes that something too near blocks.
pub(super) struct Blocking;

impl BandWork<Blocked<'_>> for Blocking {
    #[inline(always)]
    fn finish<S: Simd>(&self, _simd: S, band: &Band<'_>, blocked: &mut Blocked<'_>) {
        let first = band.row_in_output(*band.block_rows().start()) * blocked.across;
        for (lanes, slots) in blocked.lanes[first..].iter_mut().zip(band.target.slot.iter()) {
            *lanes = 0;
            for (lane, &slot) in slots.iter().enumerate() {
                *lanes |= u16::from(slot != NO_HIT) << lane;
            }
        }
    }
}

/// A bit for each lane of each block, split between rows of blocks.
pub(super) struct Blocked<'a> {
    pub(super) lanes: &'a mut [u16],
    pub(super) across: usize,
}

impl SplitRows for Blocked<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        let (lanes, rest) = self.lanes.split_at_mut(rows * self.across);
        (Self { lanes, across: self.across }, Self { lanes: rest, across: self.across })
    }
}
