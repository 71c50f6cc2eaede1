//! One ray against sixteen triangles, watertight: Woop, Benthin, Wald 2013, "Watertight Ray/Triangle
//! Intersection".
//!
//! The corners are sheared so that the ray runs along z from the origin. The two triangles at an edge then have exactly
//! opposite edge functions, and 0 counts as inside for both, so no ray slips between them.

use super::bundle::Bundle;
use super::ray::{Nearest, Ray};
use crate::scene::tree::TriangleBlock;
use crate::simd::WIDTH;
use fearless_simd::{Simd, SimdBase, f32x16, prelude::*};

/// Single precision decides which triangles need a second test: those that are farther than the nearest hit by less
/// than this fraction of t.
pub(super) const SLACK: f32 = 1.0 + 1.0 / 4096.0;

/// t of the triangles that ray `id` of the bundle hits; +∞ for the others, and for those that are farther than its
/// nearest hit by more than the slack.
#[inline(always)]
pub(super) fn meet_lane<S: Simd>(
    simd: S,
    block: &TriangleBlock,
    rays: &Bundle,
    id: usize,
    cull_back: bool,
) -> f32x16<S> {
    let axes = [rays.axes[0][id] as usize, rays.axes[1][id] as usize, rays.axes[2][id] as usize];
    let origin = [rays.sheared_origin[0][id], rays.sheared_origin[1][id], rays.sheared_origin[2][id]];
    let shear = [rays.shear[0][id], rays.shear[1][id], rays.shear[2][id]];
    let low = rays.is_far.then(|| {
        [rays.sheared_origin_low[0][id], rays.sheared_origin_low[1][id], rays.sheared_origin_low[2][id]]
    });
    let range = [rays.least[id], rays.t[id] * SLACK + rays.doubt];
    meet(simd, block, axes, [origin, low.unwrap_or_default()], low.is_some(), shear, range, cull_back)
}

/// The triangles that the ray hits up to about t = `limit`, as a mask, with the t of each; +∞ for the others.
#[inline(always)]
pub(super) fn meet_all<S: Simd>(
    simd: S,
    block: &TriangleBlock,
    ray: &Ray,
    limit: f32,
    cull_back: bool,
) -> (f32x16<S>, u32) {
    let axes = [usize::from(ray.axes[0]), usize::from(ray.axes[1]), usize::from(ray.axes[2])];
    let origin = [ray.origin[axes[0] % 3], ray.origin[axes[1] % 3], ray.origin[axes[2] % 3]];
    let low = [ray.origin_low[axes[0] % 3], ray.origin_low[axes[1] % 3], ray.origin_low[axes[2] % 3]];
    let is_far = ray.origin_low != [0.0; 3];
    let t = meet(simd, block, axes, [origin, low], is_far, ray.shear, [ray.least, limit], cull_back);
    (t, t.simd_lt(f32x16::splat(simd, f32::INFINITY)).to_bitmask() as u32 & 0xffff)
}

/// t of the triangles that a ray hits within a range; +∞ for the others. The origin is given in two parts; the second
/// part is used if the ray `is_far` from the origin of the mesh.
#[allow(clippy::too_many_arguments, reason = "what a ray is made of")]
#[inline(always)]
fn meet<S: Simd>(
    simd: S,
    block: &TriangleBlock,
    axes: [usize; 3],
    origin: [[f32; 3]; 2],
    is_far: bool,
    shear: [f32; 3],
    range: [f32; 2],
    cull_back: bool,
) -> f32x16<S> {
    let zero = f32x16::splat(simd, 0.0);
    let mut corners = [
        from_origin(simd, &block.corners[0], axes, origin[0]),
        from_origin(simd, &block.corners[1], axes, origin[0]),
        from_origin(simd, &block.corners[2], axes, origin[0]),
    ];
    if is_far {
        for corner in &mut corners {
            for axis in 0..3 {
                corner[axis] -= origin[1][axis];
            }
        }
    }
    let [ax, ay, az] = sheared(corners[0], shear);
    let [bx, by, bz] = sheared(corners[1], shear);
    let [cx, cy, cz] = sheared(corners[2], shear);
    let u = cx * by - cy * bx;
    let v = ax * cy - ay * cx;
    let w = bx * ay - by * ax;
    let least = u.min(v).min(w);
    let greatest = u.max(v).max(w);
    // All three have the same sign: u, v, w ≥ 0 is an outside, ≤ 0 an inside.
    let front = least.simd_ge(zero);
    let inside = if cull_back { front } else { front | greatest.simd_le(zero) };
    let t = (u * az + v * bz + w * cz) / (u + v + w) * shear[2];
    // A determinant of 0 makes t infinite or NaN; neither is within a finite range.
    let to = if range[1] < f32::MAX { range[1] } else { f32::MAX };
    let within = t.simd_le(f32x16::splat(simd, to)) & t.simd_ge(f32x16::splat(simd, range[0]));
    (inside & within).select(t, f32x16::splat(simd, f32::INFINITY))
}

/// One corner of each triangle, relative to the ray's origin, along the axes of the ray's space.
#[inline(always)]
fn from_origin<S: Simd>(
    simd: S,
    corner: &[[f32; WIDTH]; 3],
    axes: [usize; 3],
    origin: [f32; 3],
) -> [f32x16<S>; 3] {
    [
        f32x16::load_array_ref(simd, &corner[axes[0]]) - origin[0],
        f32x16::load_array_ref(simd, &corner[axes[1]]) - origin[1],
        f32x16::load_array_ref(simd, &corner[axes[2]]) - origin[2],
    ]
}

/// The same in the sheared space, in which the ray runs along z.
#[inline(always)]
fn sheared<S: Simd>([x, y, z]: [f32x16<S>; 3], shear: [f32; 3]) -> [f32x16<S>; 3] {
    [x - z * shear[0], y - z * shear[1], z]
}

/// Updates the nearest hit with each triangle of the mask, at its exact distance.
#[inline(always)]
pub(super) fn offer(block: &TriangleBlock, index: u32, mut mask: u32, ray: &Ray, nearest: &mut Nearest) {
    while mask != 0 {
        let lane = mask.trailing_zeros() as usize % WIDTH;
        mask &= mask - 1;
        let t = exact_distance(block, lane, ray);
        nearest.offer(ray, t, index * WIDTH as u32 + lane as u32);
    }
}

/// t of the ray in the plane of a triangle, in double precision, clamped to the depths of the corners: the triangle
/// does not extend beyond them, and only a ray along its plane could get there by rounding.
#[inline(always)]
pub(super) fn exact_distance(block: &TriangleBlock, lane: usize, ray: &Ray) -> f64 {
    let mut relative = [[0.0; 3]; 3];
    for corner in 0..3 {
        for axis in 0..3 {
            relative[corner][axis] = f64::from(block.corners[corner][axis][lane]) - ray.exact[0][axis];
        }
    }
    let [a, b, c] = relative;
    let direction = ray.exact[1];
    let normal = cross(minus(b, a), minus(c, a));
    let t = dot(normal, a) / dot(normal, direction);
    let z = usize::from(ray.axes[2]) % 3;
    let per_z = 1.0 / direction[z];
    let depths = [a[z] * per_z, b[z] * per_z, c[z] * per_z];
    let least = depths[0].min(depths[1]).min(depths[2]);
    let greatest = depths[0].max(depths[1]).max(depths[2]);
    // `clamp` would keep a NaN, which results from a ray in the plane; here it becomes the nearest depth.
    if t > least { t.min(greatest) } else { least }
}

/// The normal of a triangle, with a length of twice its area.
#[inline(always)]
pub(super) fn normal(block: &TriangleBlock, lane: usize) -> [f64; 3] {
    let mut corners = [[0.0; 3]; 3];
    for corner in 0..3 {
        for axis in 0..3 {
            corners[corner][axis] = f64::from(block.corners[corner][axis][lane]);
        }
    }
    let [a, b, c] = corners;
    cross(minus(b, a), minus(c, a))
}

#[inline(always)]
pub(super) fn minus(p: [f64; 3], q: [f64; 3]) -> [f64; 3] {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

#[inline(always)]
pub(super) fn dot(p: [f64; 3], q: [f64; 3]) -> f64 {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

#[inline(always)]
pub(super) fn cross(p: [f64; 3], q: [f64; 3]) -> [f64; 3] {
    [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
}
