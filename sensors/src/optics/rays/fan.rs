//! The rays of a frame: a grid of directions from one origin, in blocks of sixteen.

use crate::simd::WIDTH;

/// How a grid of rays is cut into blocks of sixteen: 4×4, or 16×1 where it has few rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Fan {
    /// Rays across.
    pub(crate) width: i32,
    /// Rays down.
    pub(crate) height: i32,
    /// log₂ of a block's width.
    pub(crate) shift_x: u32,
    /// log₂ of a block's height.
    pub(crate) shift_y: u32,
}

impl Fan {
    /// The grid with the blocks that suit it.
    pub(crate) const fn new(width: u32, height: u32) -> Self {
        let square = height >= 32;
        let (shift_x, shift_y) = if square { (2, 2) } else { (4, 0) };
        Self { width: width as i32, height: height as i32, shift_x, shift_y }
    }

    /// The grid in square blocks, whatever its size.
    pub(crate) const fn square(width: u32, height: u32) -> Self {
        Self { width: width as i32, height: height as i32, shift_x: 2, shift_y: 2 }
    }

    /// The grid in blocks of a single row, whatever its size.
    pub(crate) const fn by_rows(&self) -> Self {
        Self { shift_x: 4, shift_y: 0, ..*self }
    }

    /// Blocks across.
    #[inline(always)]
    pub(crate) const fn blocks_across(&self) -> usize {
        (self.width as usize).div_ceil(1 << self.shift_x)
    }

    /// Blocks down.
    #[inline(always)]
    pub(crate) const fn blocks_down(&self) -> usize {
        (self.height as usize).div_ceil(1 << self.shift_y)
    }

    /// Columns of a rectangle in two pieces, as a ring's may run over its end; first > last where there is none.
    #[inline(always)]
    pub(crate) const fn pieces(&self, [first, last]: [i32; 2]) -> [[i32; 2]; 2] {
        if last < self.width {
            [[first, last], [1, 0]]
        } else {
            [[first, self.width - 1], [0, last - self.width]]
        }
    }

    /// Column within its block, and row, of a lane.
    #[inline(always)]
    pub(crate) const fn lane_position(&self, lane: usize) -> (usize, usize) {
        (lane & ((1 << self.shift_x) - 1), lane >> self.shift_x)
    }

    /// Lane of a ray in its block.
    #[inline(always)]
    pub(crate) const fn lane(&self, column: i32, row: i32) -> usize {
        let (mask_x, mask_y) = ((1 << self.shift_x) - 1, (1 << self.shift_y) - 1);
        ((((row & mask_y) << self.shift_x) | (column & mask_x)) as usize) & (WIDTH - 1)
    }
}
