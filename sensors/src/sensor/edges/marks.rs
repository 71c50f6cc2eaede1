//! Marks of the pixels of a picture, from which edges are found once it is complete.

use crate::execution::SplitRows;
use crate::sensor::pixel::to_bytes;
use crate::shade::{Colours, Shader};
use crate::simd::load_row;
use crate::trace::grid::tiling::Tiling;
use fearless_simd::{Bytes, Select, Simd, SimdBase, u8x64, u32x16};

/// Width and height of a tile in pixels.
pub(crate) const TILE_WIDTH: usize = Tiling::Square.size()[0];
pub(crate) const TILE_HEIGHT: usize = Tiling::Square.size()[1];
/// There is an edge where some channel differs by more than this, of 255.
const LEAST_DIFFERENCE: u32 = 24;

/// The mark of a pixel without a ray, and of anything outside the picture.
pub(super) const NO_RAY: u32 = 0;
/// A bit that is set in all other marks.
const RAY: u32 = 1 << 31;
/// The bits of a mark that hold the colour. The higher ones hold a number for what the pixel shows.
pub(super) const COLOUR: u32 = 0x00ff_ffff;

/// The marks of the pixels of a picture, in row-major order; empty if edges are sharp.
pub(crate) struct Marks<'a> {
    marks: &'a mut [u32],
    width: usize,
}

impl<'a> Marks<'a> {
    pub(crate) fn new(marks: &'a mut [u32], width: usize) -> Self {
        Self { marks, width }
    }

    /// Writes the marks of a tile, given by its column and by its row in this part of the picture.
    #[inline(always)]
    pub(crate) fn put<S: Simd>(
        &mut self,
        simd: S,
        colours: &Colours,
        exposure: f32,
        shader: &Shader,
        missing: u64,
        [column, row]: [usize; 2],
    ) {
        let Some(seen) = shader.seen() else { return };
        let first = column * TILE_WIDTH;
        let lines = self.marks.chunks_mut(self.width).skip(row * TILE_HEIGHT).take(TILE_HEIGHT);
        for (row, line) in lines.enumerate() {
            let red = load_row(simd, &colours[0], row) * exposure;
            let green = load_row(simd, &colours[1], row) * exposure;
            let blue = load_row(simd, &colours[2], row) * exposure;
            let seen = u32x16::load_array_ref(simd, &seen.as_chunks().0[row]) << 24;
            let marks = to_bytes(simd, [red, green, blue]) | seen | u32x16::splat(simd, RAY);
            let rays = simd.from_bitmask_mask32x16(!(missing >> (row * TILE_WIDTH)) & 0xffff);
            let mut sixteen = [NO_RAY; TILE_WIDTH];
            rays.select(marks, u32x16::splat(simd, NO_RAY)).store_array(&mut sixteen);
            let across = TILE_WIDTH.min(line.len() - first);
            line[first..first + across].copy_from_slice(&sixteen[..across]);
        }
    }
}

impl SplitRows for Marks<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        let at = (rows * TILE_HEIGHT * self.width).min(self.marks.len());
        let (upper, lower) = self.marks.split_at_mut(at);
        (Self { marks: upper, width: self.width }, Self { marks: lower, width: self.width })
    }
}

/// Returns by how much the difference of marks exceeds the threshold of an edge; 0 where there is no edge.
#[inline(always)]
pub(super) fn beyond<S: Simd>(simd: S, own: u32x16<S>, other: u32x16<S>) -> u32x16<S> {
    // The tolerance in each byte: any difference where both show the same, otherwise the threshold.
    let elsewhere = (own ^ other).simd_gt(u32x16::splat(simd, COLOUR)) & other.simd_ne(NO_RAY);
    let least = u32x16::splat(simd, (LEAST_DIFFERENCE * 0x0001_0101) | !COLOUR);
    let passed: u8x64<S> = elsewhere.select(least, u32x16::splat(simd, u32::MAX)).bitcast();
    let (own, other): (u8x64<S>, u8x64<S>) = (own.bitcast(), other.bitcast());
    let difference = simd.saturating_sub_u8x64(own, other) | simd.saturating_sub_u8x64(other, own);
    simd.saturating_sub_u8x64(difference, passed).bitcast()
}
