//! One ray against sixteen boxes.

use super::bundle::Bundle;
use super::ray::Ray;
use crate::scene::tree::{NONE, WideNode};
use crate::simd::WIDTH;
use fearless_simd::{Simd, SimdBase, f32x16, prelude::*, u32x16};

/// The products and differences of a slab test, and the distance of the hit with which t is compared, have errors of at
/// most two units in the last place of t. The far side is moved outwards by the sum of these.
const FAR_PAD: f32 = 1.0 + f32::from_bits((127 - 21) << 23); // 1 + 2⁻²¹

/// The children that the ray hits up to t = `limit`, as a mask, and t at which it enters each.
///
/// With finite boxes and rays, no operand of a minimum or maximum is NaN, and the sign of a 0 does not affect any
/// result, so every machine gives the same.
#[inline(always)]
pub(super) fn meet<S: Simd>(simd: S, node: &WideNode, ray: &Ray, limit: f32) -> (f32x16<S>, u32) {
    let rows: &[[f32; WIDTH]; 7] = bytemuck::cast_ref(node);
    let mut near = f32x16::splat(simd, ray.range[0]);
    let mut far = f32x16::splat(simd, limit);
    for axis in 0..3 {
        let near_row = usize::from(ray.near_rows[axis]) % 6;
        let far_row = 2 * axis + 3 - near_row.min(2 * axis + 3);
        let near_plane = f32x16::load_array_ref(simd, &rows[near_row]);
        let far_plane = f32x16::load_array_ref(simd, &rows[far_row % 6]);
        let enter = (near_plane - ray.near_origin[axis]) * ray.inverse[axis];
        let exit = (far_plane - ray.far_origin[axis]) * ray.inverse[axis];
        near = near.max(enter);
        far = far.min(exit);
    }
    let met = near.simd_le(far * FAR_PAD);
    let used = u32x16::load_array_ref(simd, &node.child).simd_eq(u32x16::splat(simd, NONE));
    (near, met.to_bitmask() as u32 & !(used.to_bitmask() as u32) & 0xffff)
}

/// t at which ray `id` of the bundle enters each child, up to t = `limit`; +∞ for children that it does not hit. Also
/// returns whether it hits any child.
#[inline(always)]
pub(super) fn enter<S: Simd>(
    simd: S,
    node: &WideNode,
    rays: &Bundle,
    id: usize,
    limit: f32,
) -> (f32x16<S>, bool) {
    let rows: &[[f32; WIDTH]; 7] = bytemuck::cast_ref(node);
    let mut near = f32x16::splat(simd, rays.range[0][id]);
    let mut far = f32x16::splat(simd, limit);
    for axis in 0..3 {
        let backwards = rays.backwards[axis][id] as usize;
        let (Some(near_row), Some(far_row)) = (rows.get(axis + backwards), rows.get(axis + 3 - backwards))
        else {
            return (near, false);
        };
        let (near_plane, far_plane) =
            (f32x16::load_array_ref(simd, near_row), f32x16::load_array_ref(simd, far_row));
        let inverse = rays.inverse[axis][id];
        near = near.max((near_plane - rays.near_origin[axis][id]) * inverse);
        far = far.min((far_plane - rays.far_origin[axis][id]) * inverse);
    }
    let used = u32x16::load_array_ref(simd, &node.child).simd_ne(u32x16::splat(simd, NONE));
    let met = near.simd_le(far * FAR_PAD) & used;
    (met.select(near, f32x16::splat(simd, f32::INFINITY)), met.any_true())
}
