//! The rays of a frame: a grid of directions from one origin, in blocks of sixteen.

use crate::simd::WIDTH;
use fearless_simd::{Simd, i32x16};

/// The division of a grid of rays into blocks of sixteen: 4×4, or 16×1 if it has few rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RayGrid {
    /// Number of columns of rays.
    pub(crate) width: i32,
    /// Number of rows of rays.
    pub(crate) height: i32,
    /// log₂ of a block's width.
    pub(crate) shift_x: u32,
    /// log₂ of a block's height.
    pub(crate) shift_y: u32,
}

impl RayGrid {
    /// Creates a grid with the block shape that suits its height.
    pub(crate) const fn new(width: u32, height: u32) -> Self {
        let square = height >= 32;
        let (shift_x, shift_y) = if square { (2, 2) } else { (4, 0) };
        Self { width: width as i32, height: height as i32, shift_x, shift_y }
    }

    /// Creates a grid with square blocks, whatever its size.
    pub(crate) const fn square(width: u32, height: u32) -> Self {
        Self { width: width as i32, height: height as i32, shift_x: 2, shift_y: 2 }
    }

    /// The grid with blocks of a single row, whatever its size.
    pub(crate) const fn by_rows(&self) -> Self {
        Self { shift_x: 4, shift_y: 0, ..*self }
    }

    /// Number of block columns.
    #[inline(always)]
    pub(crate) const fn blocks_across(&self) -> usize {
        (self.width as usize).div_ceil(1 << self.shift_x)
    }

    /// Number of block rows.
    #[inline(always)]
    pub(crate) const fn blocks_down(&self) -> usize {
        (self.height as usize).div_ceil(1 << self.shift_y)
    }

    /// Splits the columns of a rectangle into two ranges, since on a ring they may run past its end. A range with first
    /// > last is empty.
    #[inline(always)]
    pub(crate) const fn pieces(&self, [first, last]: [i32; 2]) -> [[i32; 2]; 2] {
        if last < self.width {
            [[first, last], [1, 0]]
        } else {
            [[first, self.width - 1], [0, last - self.width]]
        }
    }

    /// Column and row of a ray whose column may exceed the last one, in which case it wraps to column 0.
    #[inline(always)]
    pub(crate) const fn around(&self, [column, row]: [u16; 2]) -> [i32; 2] {
        let column = column as i32;
        [if column >= self.width { column - self.width } else { column }, row as i32]
    }

    /// Column and row of a lane within its block.
    #[inline(always)]
    pub(crate) const fn lane_position(&self, lane: usize) -> (usize, usize) {
        (lane & ((1 << self.shift_x) - 1), lane >> self.shift_x)
    }

    /// The lanes of a block that lie in a rectangle of the grid, as one bit each. At least one lane must.
    #[inline(always)]
    pub(crate) const fn lanes_within(&self, columns: [i32; 2], rows: [i32; 2], block: [usize; 2]) -> u64 {
        let [first_column, last_column] = clipped(columns, block[0], self.shift_x);
        let [first_row, last_row] = clipped(rows, block[1], self.shift_y);
        let line = (2 << last_column) - (1 << first_column);
        // A bit for the first lane of each row of the block; multiplying by these copies the bits of a line to each
        // row.
        let starts = if self.shift_y == 0 { 1 } else { 0x1111 };
        let wanted = (2_u64 << (last_row << self.shift_x)) - (1 << (first_row << self.shift_x));
        line * (starts & wanted)
    }

    /// The positions of rays among the lanes of all blocks, counted from a row of blocks on.
    #[inline(always)]
    pub(crate) fn places<S: Simd>(
        &self,
        columns: i32x16<S>,
        rows: i32x16<S>,
        first_block_row: usize,
    ) -> i32x16<S> {
        let (mask_x, mask_y) = ((1 << self.shift_x) - 1, (1 << self.shift_y) - 1);
        let blocks = ((rows >> self.shift_y) - first_block_row as i32) * self.blocks_across() as i32
            + (columns >> self.shift_x);
        blocks * WIDTH as i32 + ((rows & mask_y) << self.shift_x) + (columns & mask_x)
    }

    /// The lane of a ray in its block.
    #[inline(always)]
    pub(crate) const fn lane(&self, column: i32, row: i32) -> usize {
        let (mask_x, mask_y) = ((1 << self.shift_x) - 1, (1 << self.shift_y) - 1);
        ((((row & mask_y) << self.shift_x) | (column & mask_x)) as usize) & (WIDTH - 1)
    }
}

/// The part of a range of columns or rows that lies in a block, counted from the block's first.
#[inline(always)]
const fn clipped([first, last]: [i32; 2], block: usize, shift: u32) -> [u32; 2] {
    let start = (block << shift) as i32;
    let end = start + (1 << shift) - 1;
    [
        (if first > start { first } else { start } - start) as u32,
        (if last < end { last } else { end } - start) as u32,
    ]
}
