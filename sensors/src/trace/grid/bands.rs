//! The division of a grid of rays into bands.

use crate::optics::rays::RayGrid;
use crate::simd::WIDTH;

/// The approximate number of rays of a band, chosen so that its data fits into the second-level cache.
const RAYS_IN_BAND: usize = 40_000;
/// The approximate number of bands of the largest grid.
const MOST_BANDS: usize = 64;

/// The division of a grid into bands. It depends only on the grid, so neither the number of threads nor the SIMD level
/// changes the order in which triangles are visited.
#[derive(Debug, Clone, Copy)]
pub(in crate::trace) struct Bands {
    /// Rows of blocks in a band; the last band may have fewer.
    pub(in crate::trace) block_rows: usize,
    pub(in crate::trace) count: usize,
    /// Blocks of the grid.
    pub(in crate::trace) blocks: usize,
    /// The distance from the beginning of one band's [`Target::farthest`](crate::trace::image::Target::farthest) to the
    /// next band's: whole cache lines, so that no two threads write to the same line, and at least sixteen elements
    /// more than a band has blocks.
    pub(in crate::trace) farthest_stride: usize,
}

impl Bands {
    pub(in crate::trace) fn new(ray_grid: &RayGrid) -> Self {
        let rays_in_row = ray_grid.blocks_across() * WIDTH;
        let wanted = RAYS_IN_BAND.div_ceil(rays_in_row).max(ray_grid.blocks_down().div_ceil(MOST_BANDS));
        let count = ray_grid.blocks_down().div_ceil(wanted);
        let block_rows = ray_grid.blocks_down().div_ceil(count);
        Self {
            block_rows,
            count: ray_grid.blocks_down().div_ceil(block_rows),
            blocks: ray_grid.blocks_across() * ray_grid.blocks_down(),
            farthest_stride: (block_rows * ray_grid.blocks_across() + WIDTH).next_multiple_of(WIDTH),
        }
    }

    /// The number of elements of `farthest` of all bands together.
    pub(in crate::trace) fn farthest_len(&self, ray_grid: &RayGrid) -> usize {
        let before_last = (self.count - 1) * self.block_rows * ray_grid.blocks_across();
        (self.count - 1) * self.farthest_stride + (self.blocks - before_last) + WIDTH
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(ray_grid: &RayGrid) {
        let bands = Bands::new(ray_grid);
        let (down, across) = (ray_grid.blocks_down(), ray_grid.blocks_across());
        let size = [ray_grid.width, ray_grid.height];
        assert!((1..=MOST_BANDS).contains(&bands.count), "{size:?}: {} bands", bands.count);
        assert!((bands.count - 1) * bands.block_rows < down && down <= bands.count * bands.block_rows);
        let len = bands.farthest_len(ray_grid);
        let mut last_end = 0;
        for band in 0..bands.count {
            let rows = bands.block_rows.min(down - band * bands.block_rows);
            // Sixteen elements past the end of a band's own are read.
            let end = band * bands.farthest_stride + rows * across + WIDTH;
            let next = if band + 1 < bands.count { (band + 1) * bands.farthest_stride } else { len };
            assert!(end <= next, "{size:?}: band {band} ends at {end}, the next begins at {next}");
            last_end = end;
        }
        assert!(bands.farthest_stride.is_multiple_of(WIDTH));
        assert_eq!(last_end, len, "{size:?}");
    }

    #[test]
    fn bands_of_all_sizes_have_enough_memory() {
        for width in 1..=200 {
            for height in 1..=200 {
                check(&RayGrid::square(width, height));
                check(&RayGrid::new(width, height));
                check(&RayGrid::new(width, height).by_rows());
            }
        }
        let stream = crate::noise::Stream { seed: 11, sensor: 0, frame: 0, channel: 0 };
        for sample in 0..10_000 {
            let size = [2 * sample, 2 * sample + 1]
                .map(|index| 1 + stream.word(index) % crate::optics::MAX_GRID_SIZE);
            check(&RayGrid::square(size[0], size[1]));
            check(&RayGrid::new(size[0], size[1]));
            check(&RayGrid::new(size[0], size[1]).by_rows());
        }
    }
}
