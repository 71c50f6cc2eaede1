//! How far the rays of a block reach.

use super::grid::Band;
use super::hit_point::block_index;
use super::image::{NO_HIT, Projection};
use super::tile::{TILE_HEIGHT, TILE_WIDTH};
use crate::scene::tree::WIDTH;
use crate::simd::{LANES, Lanes};
use fearless_simd::{Select, Simd, SimdBase, f32x16, u32x16};

/// t of a block's hits, or metres along the rays unless it is `DEPTH` that is asked for; +∞ where nothing is hit.
#[inline(always)]
pub(crate) fn measure_block<S: Simd, P: Projection, const DEPTH: bool>(
    simd: S,
    band: &Band<'_, P>,
    [column, row]: [usize; 2],
) -> [f32; WIDTH] {
    let block = block_index(band, [column, row]);
    let slots = u32x16::load_array_ref(simd, &band.target.slot[block]);
    let inverse = f32x16::load_array_ref(simd, &band.target.inverse[block]);
    let hit = slots.simd_ne(u32x16::splat(simd, NO_HIT));
    let far = if DEPTH {
        f32x16::splat(simd, 1.0) / inverse
    } else {
        band.projection.distances(simd, inverse, column, row)
    };
    let mut values = [0.0; WIDTH];
    hit.select(far, f32x16::splat(simd, f32::INFINITY)).store_array(&mut values);
    values
}

/// Depths of a tile of a pinhole camera, row after row.
#[inline(always)]
pub(crate) fn measure_tile<S: Simd, P: Projection>(
    simd: S,
    band: &Band<'_, P>,
    [tile_column, row]: [usize; 2],
) -> Lanes<f32> {
    let mut depths = [f32::INFINITY; LANES];
    for part in 0..TILE_WIDTH / 4 {
        let column = tile_column * (TILE_WIDTH / 4) + part;
        if column >= band.projection.fan().blocks_across() {
            break;
        }
        let block = measure_block::<S, P, true>(simd, band, [column, row]);
        for line in 0..TILE_HEIGHT {
            let first = line * TILE_WIDTH + part * 4;
            depths[first..first + 4].copy_from_slice(&block[line * 4..line * 4 + 4]);
        }
    }
    depths
}
