//! Where the rays of a block lie in the rows of an output.

use super::grid::Band;
use super::image::NO_HIT;
use crate::optics::rays::Fan;
use crate::simd::WIDTH;

/// Calls `work` for each block of a band that no slice before had, with its column and row among the blocks of the grid.
#[inline(always)]
pub(crate) fn for_each_block(band: &Band<'_>, mut work: impl FnMut(&Place, [usize; 2])) {
    let fan = band.rays.fan();
    for row in band.block_rows() {
        if ((row << fan.shift_y) as i32) < band.fresh_from {
            continue;
        }
        for column in 0..fan.blocks_across() {
            work(&Place::new(fan, band, column, row), [column, row]);
        }
    }
}

/// Where the rays of a block lie in a band's output.
pub(crate) struct Place {
    /// Index of the block in the band.
    pub(crate) block: usize,
    /// Rays across the grid.
    width: usize,
    /// First ray, in the grid and in the output.
    column: usize,
    row: usize,
    first_row: usize,
    /// Rays of the block that are in the grid.
    across: usize,
    down: usize,
    shift_x: u32,
    /// It is 4×4, and wholly in the grid.
    is_square: bool,
}

impl Place {
    #[inline(always)]
    pub(crate) fn new(fan: &Fan, band: &Band<'_>, block_column: usize, block_row: usize) -> Self {
        let rows = band.rows;
        let (column, row) = (block_column << fan.shift_x, block_row << fan.shift_y);
        let across = (1 << fan.shift_x).min(fan.width as usize - column);
        let down = (1 << fan.shift_y).min(rows[1] as usize + 1 - row);
        Self {
            block: (block_row - (rows[0] >> fan.shift_y) as usize) * fan.blocks_across() + block_column,
            width: fan.width as usize,
            column,
            row,
            first_row: band.first_row as usize,
            across,
            down,
            shift_x: fan.shift_x,
            is_square: across == 4 && down == 4,
        }
    }

    /// Column and row of a lane's ray in the grid; none if it lies outside.
    #[inline(always)]
    fn ray(&self, lane: usize) -> Option<[usize; 2]> {
        let (x, y) = (lane & ((1 << self.shift_x) - 1), lane >> self.shift_x);
        (x < self.across && y < self.down).then_some([self.column + x, self.row + y])
    }

    /// Index of the first ray of a line of the block in the band's output.
    #[inline(always)]
    fn index(&self, line: usize) -> usize {
        (self.row - self.first_row + line) * self.width + self.column
    }

    /// Writes a value for each ray of the block.
    #[inline(always)]
    pub(crate) fn write<T: Copy>(&self, values: &[T; WIDTH], output: &mut [T]) {
        self.write_lines(
            output,
            #[inline(always)]
            |line, output: &mut [T; 4]| output.copy_from_slice(&values[line * 4..line * 4 + 4]),
            #[inline(always)]
            |line, output| output.copy_from_slice(&values[line << self.shift_x..][..output.len()]),
        );
    }

    /// Calls `four` for each line of a whole block of 4×4, whose length is known, so that a line is a single move;
    /// `some` for those of others.
    #[inline(always)]
    fn write_lines<T>(
        &self,
        output: &mut [T],
        four: impl Fn(usize, &mut [T; 4]),
        some: impl Fn(usize, &mut [T]),
    ) {
        let first = self.index(0);
        if self.is_square {
            for line in 0..4 {
                if let Some(output) = output[first + line * self.width..].first_chunk_mut() {
                    four(line, output);
                }
            }
        } else {
            for line in 0..self.down {
                some(line, &mut output[first + line * self.width..][..self.across]);
            }
        }
    }

    /// Writes those lanes that have hit something.
    pub(crate) fn write_where<T: Copy>(&self, values: &[T; WIDTH], slots: &[u32; WIDTH], output: &mut [T]) {
        for lane in 0..WIDTH {
            if let (true, Some([column, row])) = (slots[lane] != NO_HIT, self.ray(lane)) {
                output[(row - self.first_row) * self.width + column] = values[lane];
            }
        }
    }

    /// Fills the block with one normal, given four times.
    #[inline(always)]
    pub(crate) fn write_normals(&self, four: &[f32; 12], output: &mut [[f32; 3]]) {
        self.write_lines(
            output,
            #[inline(always)]
            |_, output: &mut [[f32; 3]; 4]| output.as_flattened_mut().copy_from_slice(four),
            #[inline(always)]
            |_, output| {
                for output in output.as_flattened_mut().chunks_mut(12) {
                    output.copy_from_slice(&four[..output.len()]);
                }
            },
        );
    }

    /// Fills the block with one value.
    #[inline(always)]
    pub(crate) fn fill<T: Copy>(&self, value: T, output: &mut [T]) {
        self.write_lines(
            output,
            #[inline(always)]
            |_, output: &mut [T; 4]| *output = [value; 4],
            #[inline(always)]
            |_, output| output.fill(value),
        );
    }
}
