//! Fingerprints of what the lanes of a tile see, by which two neighbours are told apart.

use super::ROWS;
use super::surface::Surfaces;
use super::tile::Tile;
use crate::simd::{Lanes, load_row};
use fearless_simd::{Bytes, Select, Simd, SimdBase, SimdFloat, f32x16, u32x16};

/// Fingerprints of the surfaces of a tile, from the instance, the normal, and the distance from the sensor to the plane
/// through the point with that normal; the last two in coarse steps.
#[inline(always)]
pub(super) fn tell_surfaces<S: Simd>(simd: S, tile: &Tile, surfaces: &Surfaces, seen: &mut Lanes<u32>) {
    for row in 0..ROWS {
        let zero = f32x16::splat(simd, 0.0);
        let mut offset = zero;
        let mut number = u32x16::load_array_ref(simd, &tile.placed.as_chunks().0[row]);
        for axis in 0..3 {
            let normal = load_row(simd, &surfaces.normal[axis], row);
            offset += normal * load_row(simd, &tile.point[axis], row);
            let step = normal * 2.3 + 2.5;
            // NaN becomes a number.
            let step = step.simd_gt(zero).select(step, zero);
            number = number * 5 + step.to_int::<u32x16<S>>();
        }
        // Steps of a quarter, whose bounds are not at round numbers of metres.
        let steps: u32x16<S> = (offset * 1.37).bitcast();
        let mixed = (number * 0x9e37_79b1 + (steps >> 21)) * 0x85eb_ca6b;
        (mixed >> 25).store_array(&mut seen.as_chunks_mut().0[row]);
    }
}
