//! The hits so far, block by block.

use crate::optics::rays::RayGrid;
use crate::simd::WIDTH;
use fearless_simd::{Simd, SimdBase, f32x16};

/// No slot: the ray has hit nothing.
pub(crate) const NO_HIT: u32 = u32::MAX;

/// This bit is set in the slot of a hit on a triangle that is seen nearly edge-on: there, 1/t in single precision is
/// not accurate enough. Slots themselves are smaller.
pub(crate) const GRAZING: u32 = 1 << 31;

/// (1 / sine of the angle between ray and plane)² from which on a hit is recomputed in double precision: 1.8°.
pub(crate) const GRAZING_SQUARED: f32 = 1000.0;

/// The nearest hits of a band of blocks, in the caller's memory.
pub(crate) struct Target<'a> {
    /// 1/t of each ray's nearest hit; if nothing is hit, 1/t of the farthest hit that counts, or 0 without a limit.
    pub(crate) inverse: &'a mut [[f32; WIDTH]],
    /// The slot of each ray's nearest hit, or [`NO_HIT`].
    pub(crate) slot: &'a mut [[u32; WIDTH]],
    /// The least of the sixteen `inverse` of each block: nothing with a smaller 1/t is visible there. It has sixteen
    /// elements more than there are blocks, so that sixteen can be read from any position.
    pub(crate) farthest: &'a mut [f32],
}

impl Target<'_> {
    /// Removes all hits; rays have the range 1/`inverse_range`.
    pub(crate) fn clear(&mut self, inverse_range: f32) {
        self.inverse.fill([inverse_range; WIDTH]);
        self.slot.fill([NO_HIT; WIDTH]);
        self.farthest.fill(inverse_range);
    }

    /// 1/t of one ray, whose column may be past the last one.
    #[inline(always)]
    pub(crate) fn inverse_of(&self, ray_grid: &RayGrid, first_block_row: usize, ray: [u16; 2]) -> f32 {
        let [column, row] = ray_grid.around(ray);
        let block_row = (row >> ray_grid.shift_y) as usize - first_block_row;
        self.inverse[block_row * ray_grid.blocks_across() + (column >> ray_grid.shift_x) as usize]
            [ray_grid.lane(column, row)]
    }

    /// Updates `farthest` for a block.
    #[inline(always)]
    pub(crate) fn update_farthest<S: Simd>(&mut self, simd: S, block: usize) {
        let inverse = f32x16::load_array_ref(simd, &self.inverse[block]);
        self.farthest[block] = simd.reduce_min_f32x16(inverse);
    }
}
