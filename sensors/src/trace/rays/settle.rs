//! The exact hits on triangles, in double precision, sixteen rays at a time.

use super::block;
use super::bundle::{Bundle, PerRay, RAYS, load};
use super::walk::MeshTree;
use crate::scene::tree::NONE;
use crate::simd::{WIDTH, sqrt};
use fearless_simd::{Simd, SimdBase, f32x16, f64x8, prelude::*};

/// The exact hits of a bundle.
pub(super) struct Settled {
    /// t, in units of the scaled direction; undefined without a hit.
    pub(super) t: PerRay<f64>,
    /// The normal of the triangle, with a length of twice its area.
    pub(super) normal: [PerRay<f64>; 3],
    /// The reciprocal of that length.
    pub(super) per_length: PerRay<f64>,
    corners: [[PerRay<f32>; 3]; 3],
}

type Vector<S> = [f64x8<S>; 3];

impl Settled {
    pub(super) const fn new() -> Self {
        Self {
            t: [0.0; RAYS],
            normal: [[0.0; RAYS]; 3],
            per_length: [0.0; RAYS],
            corners: [[[0.0; RAYS]; 3]; 3],
        }
    }

    /// Computes the hits of the first `count` rays.
    #[inline(always)]
    pub(super) fn compute<S: Simd>(&mut self, simd: S, tree: MeshTree<'_>, bundle: &Bundle, count: usize) {
        for id in 0..count.min(RAYS) {
            let slot = bundle.hit[id][0];
            if slot == NONE {
                continue;
            }
            let Some(block) = tree.blocks.get(slot as usize / WIDTH) else { continue };
            for corner in 0..3 {
                for axis in 0..3 {
                    self.corners[corner][axis][id] = block.corners[corner][axis][slot as usize % WIDTH];
                }
            }
        }
        let mut first = 0;
        while first < count.min(RAYS) {
            self.compute_sixteen(simd, bundle, first);
            first += WIDTH;
        }
    }

    /// The sine of the angle between a ray and the plane that it hits, times a length in [1, 2√3).
    #[inline(always)]
    pub(super) fn sine(&self, bundle: &Bundle, id: usize) -> f64 {
        let along = |axis: usize| self.normal[axis][id] * f64::from(bundle.direction[axis][id]);
        (along(0) + along(1) + along(2)) * self.per_length[id]
    }

    /// Computes the normal of another triangle for a ray.
    pub(super) fn take_normal(&mut self, tree: MeshTree<'_>, id: usize, slot: u32) {
        let Some(block) = tree.blocks.get(slot as usize / WIDTH) else { return };
        let normal = block::normal(block, slot as usize % WIDTH);
        for axis in 0..3 {
            self.normal[axis][id] = normal[axis];
        }
        self.per_length[id] = 1.0 / sqrt(block::dot(normal, normal));
    }

    #[inline(always)]
    fn compute_sixteen<S: Simd>(&mut self, simd: S, bundle: &Bundle, first: usize) {
        let corners = [
            self.widened(simd, bundle, 0, first),
            self.widened(simd, bundle, 1, first),
            self.widened(simd, bundle, 2, first),
        ];
        let widened = |values: &[PerRay<f32>; 3]| {
            [
                load(simd, &values[0], first).widen(),
                load(simd, &values[1], first).widen(),
                load(simd, &values[2], first).widen(),
            ]
        };
        let mut direction = widened(&bundle.direction);
        let mut corners = corners;
        if bundle.is_far {
            let (origin_low, direction_low) = (widened(&bundle.origin_low), widened(&bundle.direction_low));
            for axis in 0..3 {
                direction[axis].0 += direction_low[axis].0;
                direction[axis].1 += direction_low[axis].1;
                for corner in &mut corners {
                    corner[axis].0 -= origin_low[axis].0;
                    corner[axis].1 -= origin_low[axis].1;
                }
            }
        }
        self.compute_eight(simd, [low(corners[0]), low(corners[1]), low(corners[2])], low(direction), first);
        self.compute_eight(
            simd,
            [high(corners[0]), high(corners[1]), high(corners[2])],
            high(direction),
            first + 8,
        );
    }

    /// A corner relative to the origin, in double precision.
    #[inline(always)]
    fn widened<S: Simd>(
        &self,
        simd: S,
        bundle: &Bundle,
        corner: usize,
        first: usize,
    ) -> [(f64x8<S>, f64x8<S>); 3] {
        let at = &self.corners[corner];
        [
            difference(simd, &at[0], &bundle.origin[0], first),
            difference(simd, &at[1], &bundle.origin[1], first),
            difference(simd, &at[2], &bundle.origin[2], first),
        ]
    }

    #[inline(always)]
    fn compute_eight<S: Simd>(
        &mut self,
        simd: S,
        [a, b, c]: [Vector<S>; 3],
        direction: Vector<S>,
        first: usize,
    ) {
        let normal = cross(minus(b, a), minus(c, a));
        let t = dot(normal, a) / dot(normal, direction);
        let one = f64x8::splat(simd, 1.0);
        let length = dot(normal, normal).sqrt();
        t.store_slice(&mut self.t[first..first + 8]);
        (one / length).store_slice(&mut self.per_length[first..first + 8]);
        for axis in 0..3 {
            normal[axis].store_slice(&mut self.normal[axis][first..first + 8]);
        }
    }
}

#[inline(always)]
fn difference<S: Simd>(simd: S, p: &PerRay<f32>, q: &PerRay<f32>, first: usize) -> (f64x8<S>, f64x8<S>) {
    let (p, q): (f32x16<S>, f32x16<S>) = (load(simd, p, first), load(simd, q, first));
    let (p, q) = (p.widen(), q.widen());
    (p.0 - q.0, p.1 - q.1)
}

#[inline(always)]
fn low<S: Simd>(v: [(f64x8<S>, f64x8<S>); 3]) -> Vector<S> {
    [v[0].0, v[1].0, v[2].0]
}

#[inline(always)]
fn high<S: Simd>(v: [(f64x8<S>, f64x8<S>); 3]) -> Vector<S> {
    [v[0].1, v[1].1, v[2].1]
}

#[inline(always)]
fn minus<S: Simd>(p: Vector<S>, q: Vector<S>) -> Vector<S> {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

#[inline(always)]
fn dot<S: Simd>(p: Vector<S>, q: Vector<S>) -> f64x8<S> {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

#[inline(always)]
fn cross<S: Simd>(p: Vector<S>, q: Vector<S>) -> Vector<S> {
    [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
}
