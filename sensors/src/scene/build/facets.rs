//! Normals of triangles.

use crate::Execution;
use crate::scene::tree::{Facet, TriangleBlock};
use crate::simd::{WIDTH, dispatch};
use fearless_simd::{Simd, SimdBase, f32x16, f64x8, prelude::*};

/// Computes the facets of blocks, sixteen per block. (Computing them block by block within
/// [`refit`](super::refit::refit) is not faster: refitting is limited by memory latency, and this would delay its
/// loads.)
///
/// # Panics
/// If there are not sixteen facets per block.
pub fn fill_facets(blocks: &[TriangleBlock], execution: Execution, facets: &mut [Facet]) {
    assert_eq!(facets.len(), blocks.len() * WIDTH, "sixteen facets for each block");
    dispatch!(execution.level, simd => fill_all(simd, blocks, facets));
}

#[inline(always)]
fn fill_all<S: Simd>(simd: S, blocks: &[TriangleBlock], facets: &mut [Facet]) {
    simd.vectorize(
        #[inline(always)]
        || {
            for (block, facets) in blocks.iter().zip(facets.as_chunks_mut::<WIDTH>().0) {
                fill(simd, block, facets);
            }
        },
    );
}

/// Computes the facets of one block.
#[inline(always)]
pub(super) fn fill<S: Simd>(simd: S, block: &TriangleBlock, facets: &mut [Facet; WIDTH]) {
    // In double precision, so that small triangles far from the origin keep their normals.
    let zero = f64x8::splat(simd, 0.0);
    // `[edge][axis][half]`, without `map`: it is not always inlined, and then each call stores its vectors.
    let mut edges = [[[zero; 2]; 3]; 2];
    for axis in 0..3 {
        let corner =
            |corner: usize| simd.widen_f32x16(f32x16::from_slice(simd, &block.corners[corner][axis]));
        let (a, b, c) = (corner(0), corner(1), corner(2));
        edges[0][axis] = [b.0 - a.0, b.1 - a.1];
        edges[1][axis] = [c.0 - a.0, c.1 - a.1];
    }
    let mut normals = [[zero; 2]; 3];
    for half in 0..2 {
        let [[ux, uy, uz], [vx, vy, vz]] = [
            [edges[0][0][half], edges[0][1][half], edges[0][2][half]],
            [edges[1][0][half], edges[1][1][half], edges[1][2][half]],
        ];
        let [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
        let length = (x * x + y * y + z * z).sqrt();
        let has_area = length.simd_gt(zero);
        normals[0][half] = has_area.select(x / length, zero);
        normals[1][half] = has_area.select(y / length, zero);
        normals[2][half] = has_area.select(z / length, zero);
    }
    let axis = |axis: usize| simd.narrow_f64x8(normals[axis][0], normals[axis][1]);
    // From four rows of sixteen to sixteen rows of four.
    let triangle: &[f32; WIDTH] = bytemuck::cast_ref(&block.triangle);
    let (xz, more_xz) = simd.interleave_f32x16(axis(0), axis(2));
    let (yt, more_yt) = simd.interleave_f32x16(axis(1), f32x16::from_slice(simd, triangle));
    let (first, second) = simd.interleave_f32x16(xz, yt);
    let (third, fourth) = simd.interleave_f32x16(more_xz, more_yt);
    let [a, b, c, d]: &mut [[f32; WIDTH]; 4] = bytemuck::cast_mut(facets);
    first.store_slice(a);
    second.store_slice(b);
    third.store_slice(c);
    fourth.store_slice(d);
}
