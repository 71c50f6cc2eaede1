//! Where the rays of a block lie in the rows of an output.

use super::grid::Band;
use super::image::{Fan, NO_HIT, Projection};
use crate::scene::tree::WIDTH;

/// Calls `work` for each block of a band, with its column and row among the blocks of the grid.
#[inline(always)]
pub(crate) fn for_each_block<P: Projection>(band: &Band<'_, P>, mut work: impl FnMut(&Place, [usize; 2])) {
    let fan = band.projection.fan();
    for row in band.block_rows() {
        for column in 0..fan.blocks_across() {
            work(&Place::new(fan, band.rows, column, row), [column, row]);
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
}

impl Place {
    #[inline(always)]
    pub(crate) fn new(fan: &Fan, rows: [i32; 2], block_column: usize, block_row: usize) -> Self {
        let (column, row) = (block_column << fan.shift_x, block_row << fan.shift_y);
        Self {
            block: (block_row - (rows[0] >> fan.shift_y) as usize) * fan.blocks_across() + block_column,
            width: fan.width as usize,
            column,
            row,
            first_row: rows[0] as usize,
            across: (1 << fan.shift_x).min(fan.width as usize - column),
            down: (1 << fan.shift_y).min(rows[1] as usize + 1 - row),
            shift_x: fan.shift_x,
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

    #[inline(always)]
    pub(crate) fn write<T: Copy>(&self, values: &[T; WIDTH], output: &mut [T]) {
        for line in 0..self.down {
            let values = &values[line << self.shift_x..];
            let output = &mut output[self.index(line)..];
            // Of known length they are single moves.
            match self.across {
                4 => output[..4].copy_from_slice(&values[..4]),
                16 => output[..16].copy_from_slice(&values[..16]),
                across => output[..across].copy_from_slice(&values[..across]),
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
        for line in 0..self.down {
            let output = output[self.index(line)..][..self.across].as_flattened_mut();
            for output in output.chunks_mut(12) {
                match <&mut [f32; 12]>::try_from(&mut *output) {
                    Ok(output) => *output = *four,
                    Err(_) => output.copy_from_slice(&four[..output.len()]),
                }
            }
        }
    }

    #[inline(always)]
    pub(crate) fn fill<T: Copy>(&self, value: T, output: &mut [T]) {
        for line in 0..self.down {
            let output = &mut output[self.index(line)..];
            match self.across {
                4 => output[..4].copy_from_slice(&[value; 4]),
                16 => output[..16].copy_from_slice(&[value; 16]),
                across => output[..across].fill(value),
            }
        }
    }
}
