//! The positions of a block's rays in the rows of an output.

use crate::optics::rays::RayGrid;
use crate::simd::{WIDTH, quarters};
use crate::trace::grid::Band;
use fearless_simd::{Bytes, Simd, SimdBase, f32x4, f32x16, u32x16};

/// Calls `work` for each block of a band that is in no earlier slice, with its column and row among the blocks of the
/// grid.
#[inline(always)]
pub(crate) fn for_each_block(band: &Band<'_>, mut work: impl FnMut(&Place, [usize; 2])) {
    let ray_grid = band.rays.ray_grid();
    for row in band.block_rows() {
        if ((row << ray_grid.shift_y) as i32) < band.fresh_from {
            continue;
        }
        let mut place = Place::new(ray_grid, band, 0, row);
        for column in 0..ray_grid.blocks_across() {
            work(&place, [column, row]);
            place.step();
        }
    }
}

/// The position of a block's rays in a band's output.
pub(crate) struct Place {
    /// Index of the block in the band.
    pub(crate) block: usize,
    /// The number of rays across the grid.
    width: usize,
    /// The index of the first ray in the band's output, and the number of rays from it to the end of its row.
    first: usize,
    left: usize,
    /// The number of the block's columns and rows that are in the grid.
    across: usize,
    down: usize,
    shift_x: u32,
    /// True if the block is 4×4 and entirely in the grid.
    is_square: bool,
}

impl Place {
    #[inline(always)]
    pub(crate) fn new(ray_grid: &RayGrid, band: &Band<'_>, block_column: usize, block_row: usize) -> Self {
        let rows = band.rows;
        let (column, row) = (block_column << ray_grid.shift_x, block_row << ray_grid.shift_y);
        let width = ray_grid.width as usize;
        let mut place = Self {
            block: (block_row - (rows[0] >> ray_grid.shift_y) as usize) * ray_grid.blocks_across()
                + block_column,
            width,
            first: (row - band.first_row as usize) * width + column,
            left: width - column,
            across: 0,
            down: (1 << ray_grid.shift_y).min(rows[1] as usize + 1 - row),
            shift_x: ray_grid.shift_x,
            is_square: false,
        };
        place.measure();
        place
    }

    /// Computes which part of the block is in the grid.
    #[inline(always)]
    fn measure(&mut self) {
        self.across = (1 << self.shift_x).min(self.left);
        self.is_square = self.across == 4 && self.down == 4;
    }

    /// Advances to the next block of the row, if there is one.
    #[inline(always)]
    pub(crate) fn step(&mut self) {
        self.block += 1;
        self.first += self.across;
        self.left -= self.across;
        self.measure();
    }

    /// The index of a lane's ray in the band's output, or `None` if it is outside the grid.
    #[inline(always)]
    fn ray(&self, lane: usize) -> Option<usize> {
        let (x, y) = (lane & ((1 << self.shift_x) - 1), lane >> self.shift_x);
        (x < self.across && y < self.down).then_some(self.first + y * self.width + x)
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

    /// Writes a number for each ray of the block. The lines of a square block are written directly from the register:
    /// loading parts of a vector that has just been stored as a whole would stall.
    #[inline(always)]
    pub(crate) fn write_f32<S: Simd>(&self, simd: S, values: f32x16<S>, output: &mut [f32]) {
        if !self.is_square {
            return self.write(&values.into(), output);
        }
        self.write_four(output, quarters(simd, values), |values, output| values.store_slice(output));
    }

    /// The same for integers.
    #[inline(always)]
    pub(crate) fn write_u32<S: Simd>(&self, simd: S, values: u32x16<S>, output: &mut [u32]) {
        self.write_f32(simd, values.bitcast(), bytemuck::cast_slice_mut(output));
    }

    /// Writes a pair of numbers for each ray of the block.
    #[inline(always)]
    pub(crate) fn write_pairs<S: Simd>(&self, simd: S, [x, y]: [f32x16<S>; 2], output: &mut [[f32; 2]]) {
        let (upper, lower) = simd.interleave_f32x16(x, y);
        if self.is_square {
            let ((a, b), (c, d)) = (simd.split_f32x16(upper), simd.split_f32x16(lower));
            return self.write_four(output, [a, b, c, d], |pairs, output| {
                pairs.store_slice(output.as_flattened_mut());
            });
        }
        let mut pairs = [[0.0; 2]; WIDTH];
        let (first, last) = pairs.as_flattened_mut().split_at_mut(WIDTH);
        upper.store_slice(first);
        lower.store_slice(last);
        self.write(&pairs, output);
    }

    /// Fills the block with one normal.
    #[inline(always)]
    pub(crate) fn write_normal<S: Simd>(&self, simd: S, [x, y, z]: [f32; 3], output: &mut [[f32; 3]]) {
        if !self.is_square {
            return self.fill([x, y, z], output);
        }
        let vector = |values| f32x4::load_array(simd, values);
        let four = [vector([x, y, z, x]), vector([y, z, x, y]), vector([z, x, y, z])];
        self.write_four(output, [four; 4], |normals, output| {
            let output = output.as_flattened_mut();
            normals[0].store_slice(&mut output[..4]);
            normals[1].store_slice(&mut output[4..8]);
            normals[2].store_slice(&mut output[8..]);
        });
    }

    /// Writes a normal for each ray of the block: all x, all y, all z.
    #[inline(always)]
    pub(crate) fn write_normals<S: Simd>(&self, simd: S, normals: [f32x16<S>; 3], output: &mut [[f32; 3]]) {
        if !self.is_square {
            let [x, y, z] = normals.map(<[f32; WIDTH]>::from);
            let mut normals = [[0.0; 3]; WIDTH];
            for lane in 0..WIDTH {
                normals[lane] = [x[lane], y[lane], z[lane]];
            }
            return self.write(&normals, output);
        }
        let [x, y, z] = normals;
        let (x, y, z) = (quarters(simd, x), quarters(simd, y), quarters(simd, z));
        let lines = [[x[0], y[0], z[0]], [x[1], y[1], z[1]], [x[2], y[2], z[2]], [x[3], y[3], z[3]]];
        self.write_four(output, lines, |[x, y, z], output| {
            let ((xz, yz), (xz_2, yz_2)) = (
                (simd.zip_low_f32x4(x, z), simd.zip_low_f32x4(y, z)),
                (simd.zip_high_f32x4(x, z), simd.zip_high_f32x4(y, z)),
            );
            // Each has z twice; the second z is overwritten by the next vector.
            let (first, second) = (simd.zip_low_f32x4(xz, yz), simd.zip_high_f32x4(xz, yz));
            let (third, fourth) = (simd.zip_low_f32x4(xz_2, yz_2), simd.zip_high_f32x4(xz_2, yz_2));
            let output = output.as_flattened_mut();
            first.store_slice(&mut output[..4]);
            second.store_slice(&mut output[3..7]);
            third.store_slice(&mut output[6..10]);
            simd.slide_f32x4::<3>(third, fourth).store_slice(&mut output[8..]);
        });
    }

    /// Writes the lines of a square block.
    #[inline(always)]
    fn write_four<T, V>(&self, output: &mut [T], lines: [V; 4], store: impl Fn(V, &mut [T; 4])) {
        let first = self.first;
        for (line, values) in lines.into_iter().enumerate() {
            if let Some(output) = output[first + line * self.width..].first_chunk_mut() {
                store(values, output);
            }
        }
    }

    /// Calls `four` for each line of a complete 4×4 block, whose constant length makes each line a single move, and
    /// `some` for each line of any other block.
    #[inline(always)]
    fn write_lines<T>(
        &self,
        output: &mut [T],
        four: impl Fn(usize, &mut [T; 4]),
        some: impl Fn(usize, &mut [T]),
    ) {
        let first = self.first;
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

    /// Writes the values of the lanes whose bits are set.
    pub(crate) fn write_where<T: Copy>(&self, values: &[T; WIDTH], lanes: u16, output: &mut [T]) {
        for lane in 0..WIDTH {
            if let (true, Some(ray)) = (lanes >> lane & 1 == 1, self.ray(lane)) {
                output[ray] = values[lane];
            }
        }
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
