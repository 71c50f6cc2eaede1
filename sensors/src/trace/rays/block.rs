//! One ray against sixteen triangles, watertight: Woop, Benthin, Wald 2013, "Watertight Ray/Triangle
//! Intersection".
//!
//! The corners are sheared so that the ray runs along z from the origin. An edge of two triangles has then
//! exactly the opposite edge function in each, and 0 counts as inside for both: no ray slips between them.

use super::ray::{Nearest, Ray};
use crate::scene::tree::{TriangleBlock, WIDTH};
use fearless_simd::{Simd, SimdBase, f32x16, prelude::*};

/// Single precision decides which triangles are worth a second look; what is farther than the nearest hit by
/// less than this share of t gets one.
const SLACK: f32 = 1.0 + 1.0 / 1024.0;

/// The triangles that the ray meets up to about t = `limit`, as a mask.
#[inline(always)]
pub(super) fn meet<S: Simd>(simd: S, block: &TriangleBlock, ray: &Ray, limit: f32, cull_back: bool) -> u32 {
    let zero = f32x16::splat(simd, 0.0);
    let axes = ray.axes.map(|axis| usize::from(axis) % 3);
    let sheared = |corner: usize| {
        let rows = &block.corners[corner];
        let along = |axis: usize| f32x16::load_array_ref(simd, &rows[axis]) - ray.origin[axis];
        let z = along(axes[2]);
        (along(axes[0]) - z * ray.shear[0], along(axes[1]) - z * ray.shear[1], z)
    };
    let (ax, ay, az) = sheared(0);
    let (bx, by, bz) = sheared(1);
    let (cx, cy, cz) = sheared(2);
    let u = cx * by - cy * bx;
    let v = ax * cy - ay * cx;
    let w = bx * ay - by * ax;
    let least = u.min(v).min(w);
    let greatest = u.max(v).max(w);
    // All of one sign: u, v, w ≥ 0 is a back side, ≤ 0 a front side, seen against the ray.
    let det = u + v + w;
    let front = greatest.simd_le(zero);
    let inside = if cull_back { front } else { front | least.simd_ge(zero) };
    let candidates = inside.to_bitmask() & !det.simd_eq(zero).to_bitmask() & 0xffff;
    if candidates == 0 {
        return 0;
    }
    let t = (u * az + v * bz + w * cz) / det * ray.shear[2];
    let within = t.simd_le(f32x16::splat(simd, limit * SLACK));
    (candidates & within.to_bitmask()) as u32
}

/// Offers each triangle of the mask, at its exact distance, as the nearest hit.
#[inline(always)]
pub(super) fn offer(block: &TriangleBlock, index: u32, mut mask: u32, ray: &Ray, nearest: &mut Nearest) {
    while mask != 0 {
        let lane = mask.trailing_zeros() as usize % WIDTH;
        mask &= mask - 1;
        let t = exact_distance(block, lane, ray);
        nearest.offer(ray, t, index * WIDTH as u32 + lane as u32);
    }
}

/// t of the ray in the plane of a triangle, in double precision, kept within the depths of the corners: beyond
/// them lies nothing of the triangle, and only a ray along its plane could get there by rounding.
#[inline(always)]
pub(super) fn exact_distance(block: &TriangleBlock, lane: usize, ray: &Ray) -> f64 {
    let corner = |corner: usize| [0, 1, 2].map(|axis| f64::from(block.corners[corner][axis][lane]));
    let [a, b, c] = [corner(0), corner(1), corner(2)];
    let origin = ray.origin.map(f64::from);
    let direction = ray.direction.map(f64::from);
    let minus = |p: [f64; 3], q: [f64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let dot = |p: [f64; 3], q: [f64; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let (ab, ac, oa) = (minus(b, a), minus(c, a), minus(a, origin));
    let normal = [ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2], ab[0] * ac[1] - ab[1] * ac[0]];
    let t = dot(normal, oa) / dot(normal, direction);
    let z = usize::from(ray.axes[2]) % 3;
    let per_z = 1.0 / direction[z];
    let depths = [oa[z] * per_z, (b[z] - origin[z]) * per_z, (c[z] - origin[z]) * per_z];
    let least = depths[0].min(depths[1]).min(depths[2]);
    let greatest = depths[0].max(depths[1]).max(depths[2]);
    // Not `clamp`: a NaN (a ray in the very plane) becomes the nearest depth.
    if t > least { t.min(greatest) } else { least }
}
