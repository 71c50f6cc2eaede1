//! The division of a picture into tiles of sixty-four rays.

use crate::optics::rays::RayGrid;
use crate::simd::{LANES, WIDTH, quarters};
use fearless_simd::{Simd, SimdBase, SimdCombine, f32x4, f32x16, u32x4, u32x16};

/// Blocks in a tile.
pub(crate) const BLOCKS: usize = LANES / WIDTH;

/// The division of a picture into tiles. Sixteen lanes at a time are side by side in a row: a *line* of the tile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Tiling {
    /// 16 × 4 pixels: four blocks of 4 × 4 side by side.
    Square,
    /// 64 × 1 pixels: four blocks of 16 × 1, for pictures whose rows are captured at different moments.
    Rows,
}

impl Tiling {
    /// The tiling of a picture whose rays are in the blocks of this grid.
    #[inline(always)]
    pub(crate) const fn of(ray_grid: &RayGrid) -> Self {
        if ray_grid.shift_y == 0 { Self::Rows } else { Self::Square }
    }

    /// Pixels across and down.
    #[inline(always)]
    pub(crate) const fn size(self) -> [usize; 2] {
        match self {
            Self::Square => [16, 4],
            Self::Rows => [64, 1],
        }
    }

    /// Tiles across a picture.
    #[inline(always)]
    pub(crate) const fn across(self, width: usize) -> usize {
        width.div_ceil(self.size()[0])
    }

    /// The column and row, relative to the tile's first, of the first pixel of a line.
    #[inline(always)]
    pub(crate) const fn line(self, line: usize) -> [usize; 2] {
        match self {
            Self::Square => [0, line],
            Self::Rows => [line * WIDTH, 0],
        }
    }

    /// The first pixel of each line of the tile in this column and row, as pixels of the picture.
    #[inline(always)]
    pub(crate) fn lines(self, [column, row]: [usize; 2]) -> [[usize; 2]; BLOCKS] {
        let [across, down] = self.size();
        let mut lines = [[0; 2]; BLOCKS];
        for line in 0..BLOCKS {
            let [x, y] = self.line(line);
            lines[line] = [column * across + x, row * down + y];
        }
        lines
    }
}

impl Tiling {
    /// The numbers of the sixteen random samples of each line of a tile. Each pixel has its own samples, independent of
    /// the tiling: they are counted in tiles of 16 × 4, row by row of tiles, with four lines to each tile.
    #[inline(always)]
    pub(crate) fn samples(self, width: usize, tile: [usize; 2]) -> [u32; BLOCKS] {
        let squares = Self::Square.across(width);
        self.lines(tile).map(|[x, y]| (4 * (y / 4 * squares + x / WIDTH) + y % 4) as u32)
    }
}

/// The lane of a tile that corresponds to a lane of one of its blocks.
#[inline(always)]
pub(crate) const fn lane_in_tile(tiling: Tiling, block: usize, lane: usize) -> usize {
    match tiling {
        Tiling::Square => lane / 4 * WIDTH + block * 4 + lane % 4,
        Tiling::Rows => block * WIDTH + lane,
    }
}

/// The block and lane of a pixel of a tile, given its column and row from the tile's first.
#[inline(always)]
pub(crate) const fn place_in_blocks(tiling: Tiling, [x, y]: [usize; 2]) -> (usize, usize) {
    match tiling {
        Tiling::Square => (x / 4, y * 4 + x % 4),
        Tiling::Rows => (x / WIDTH, x % WIDTH),
    }
}

/// Assembles a line of a tile from its four blocks.
#[inline(always)]
pub(crate) fn line_u32<S: Simd>(
    simd: S,
    tiling: Tiling,
    blocks: &[&[u32; WIDTH]; BLOCKS],
    line: usize,
) -> u32x16<S> {
    if tiling == Tiling::Rows {
        return u32x16::load_array_ref(simd, blocks[line]);
    }
    let [a, b, c, d] = blocks;
    let part = line * 4..line * 4 + 4;
    let left = u32x4::from_slice(simd, &a[part.clone()]).combine(u32x4::from_slice(simd, &b[part.clone()]));
    let right = u32x4::from_slice(simd, &c[part.clone()]).combine(u32x4::from_slice(simd, &d[part]));
    left.combine(right)
}

/// Assembles a line of a tile from its four blocks.
#[inline(always)]
pub(crate) fn line_f32<S: Simd>(
    simd: S,
    tiling: Tiling,
    blocks: &[&[f32; WIDTH]; BLOCKS],
    line: usize,
) -> f32x16<S> {
    if tiling == Tiling::Rows {
        return f32x16::load_array_ref(simd, blocks[line]);
    }
    let [a, b, c, d] = blocks;
    let part = line * 4..line * 4 + 4;
    let left = f32x4::from_slice(simd, &a[part.clone()]).combine(f32x4::from_slice(simd, &b[part.clone()]));
    let right = f32x4::from_slice(simd, &c[part.clone()]).combine(f32x4::from_slice(simd, &d[part]));
    left.combine(right)
}

/// Assembles all lines of a tile from its four blocks.
#[inline(always)]
pub(crate) fn lines_of<S: Simd>(simd: S, tiling: Tiling, blocks: [f32x16<S>; BLOCKS]) -> [f32x16<S>; BLOCKS] {
    if tiling == Tiling::Rows {
        return blocks;
    }
    let [a, b, c, d] = blocks;
    let (a, b, c, d) = (quarters(simd, a), quarters(simd, b), quarters(simd, c), quarters(simd, d));
    let mut lines = blocks;
    for line in 0..BLOCKS {
        lines[line] = a[line].combine(b[line]).combine(c[line].combine(d[line]));
    }
    lines
}
