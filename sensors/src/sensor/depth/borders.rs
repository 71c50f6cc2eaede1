//! Tiles near the borders of surfaces. Only there can a ray beside that of a pixel meet another surface.

use super::look::{LINES, Looker, load};
use super::surface::is_same_surface;
use crate::sensor::camera::MAX_IMAGE_SIZE;
use crate::simd::WIDTH;
use crate::trace::grid::tiling::Tiling;
use fearless_simd::{Simd, SimdMask};

/// How far around a tile borders are searched: one tile to each side, and two rows of tiles above and below.
const REACH: [usize; 2] = [1, 2];
/// The largest number of tile rows that are searched together, without those around them.
pub(super) const MOST_ROWS: usize = 8;
/// A bit for each tile of a row, as wide as the widest picture.
type Row = [u64; MAX_IMAGE_SIZE as usize / WIDTH / 64];
const NO_ENDS: Row = [0; MAX_IMAGE_SIZE as usize / WIDTH / 64];
/// Rows of tiles, including those around.
const ROWS: usize = MOST_ROWS + 2 * REACH[1];

/// The tiles of some rows in which a surface ends, a bit each.
pub(super) struct Borders {
    /// The first of these rows, counted in tiles.
    first: usize,
    rows: [Row; ROWS],
}

impl Borders {
    /// Searches rows of tiles, and those around them that [`Borders::are_near`] needs.
    #[inline(always)]
    pub(super) fn find<S: Simd>(simd: S, looker: &Looker<'_>, tile_rows: core::ops::Range<usize>) -> Self {
        let [width, height] = looker.size;
        let first = tile_rows.start.saturating_sub(REACH[1]);
        let mut ends = Self { first, rows: [NO_ENDS; ROWS] };
        let last = (tile_rows.end + REACH[1]).min(height.div_ceil(LINES));
        for (tile_row, row) in (first..last).zip(&mut ends.rows) {
            for tile in 0..Tiling::Square.across(width) {
                let found = is_end(simd, looker, [tile * WIDTH, tile_row * LINES]);
                row[tile / 64] |= u64::from(found) << (tile % 64);
            }
        }
        ends
    }

    /// Returns true if a surface ends in a tile or near it.
    #[inline(always)]
    pub(super) fn are_near(&self, [tile, tile_row]: [usize; 2]) -> bool {
        let top = (tile_row - self.first).saturating_sub(REACH[1]);
        let rows = &self.rows[top..=tile_row - self.first + REACH[1]];
        let mut near = false;
        for at in tile.saturating_sub(REACH[0])..=tile + REACH[0] {
            near |= rows.iter().any(|row| row.get(at / 64).is_some_and(|word| word >> (at % 64) & 1 == 1));
        }
        near
    }
}

/// Returns true if a surface ends between two pixels of a tile, or between the tile and the next to the right or below.
#[inline(always)]
fn is_end<S: Simd>(simd: S, looker: &Looker<'_>, [column, first_row]: [usize; 2]) -> bool {
    let [width, height] = looker.size;
    let count = WIDTH.min(width - column);
    let mut same = u64::MAX;
    for row in first_row..height.min(first_row + LINES) {
        let at = row * width + column;
        let own = load(simd, &looker.seen[at..at + count]);
        let to_right = count.min(width - column - 1);
        let right = load(simd, &looker.seen[at + 1..at + 1 + to_right]);
        same &= is_same_surface(simd, own, right, looker.steps(simd)).to_bitmask() | u64::MAX << to_right;
        if row + 1 < height {
            let below = load(simd, &looker.seen[at + width..at + width + count]);
            same &= is_same_surface(simd, own, below, looker.steps(simd)).to_bitmask() | u64::MAX << count;
        }
    }
    same != u64::MAX
}
