//! Tests of single rays against the boxes of a node.
//!
//! Where triangles are smaller than the distance between two rays, most boxes are hit by one ray or by none. Testing
//! each ray in the frame of the mesh then costs less than projecting sixteen boxes onto the grid, and excludes more of
//! them, because a projection encloses the box around a rotated box.
//!
//! These tests do not decide what is hit. They only exclude what no ray can hit, with a margin greater than all later
//! rounding errors.

use super::corners::CornerFrame;
use crate::optics::rays::{Points, Projection, max, min};
use crate::scene::tree::{NONE, WideNode};
use crate::simd::WIDTH;
use crate::trace::placed::view::View;
use fearless_simd::{Simd, SimdBase, SimdMask, f32x16, u32x16};
use glam::DVec3;

/// Entries with up to this many rays are tested ray by ray.
pub(super) const MOST_RAYS: u32 = 4;

/// Smaller components of a direction are replaced by this value, so that 0·∞ does not occur; and so are smaller
/// distances.
const TINY: f32 = 1e-30;

/// Boxes and triangles are enlarged by this fraction of their distance, because drawing them involves rounding.
const SLACK: f32 = 3e-6;

/// A ray in the frame of an instance.
pub(super) struct SingleRay {
    placed: u32,
    at: [u16; 2],
    origin_high: [f32; 3],
    origin_low: [f32; 3],
    /// Reciprocals of the direction's components.
    inverse: [f32; 3],
    /// The axes; the last one is that of the direction's largest component.
    axes: [usize; 3],
    /// The ray's movement along the other two axes per metre along the last one.
    shear: [f32; 2],
}

impl SingleRay {
    /// A ray of no instance.
    pub(super) const NONE: Self = Self {
        placed: u32::MAX,
        at: [0; 2],
        origin_high: [0.0; 3],
        origin_low: [0.0; 3],
        inverse: [0.0; 3],
        axes: [0; 3],
        shear: [0.0; 2],
    };

    /// Sets the ray of a column and row, in the frame of an instance. Usually it is set already.
    #[inline(always)]
    pub(super) fn aim<P: Projection>(&mut self, view: &View<'_>, projection: P, placed: u32, at: [u16; 2]) {
        if self.placed == placed && self.at == at {
            return;
        }
        let [column, row] = projection.ray_grid().around(at);
        let direction = view.frame_from_sensor(projection.direction(column, row));
        let instance = &view.placed[placed as usize];
        let direction: DVec3 = instance.vector_in_instance(direction);
        let direction = direction.to_array().map(|component| component as f32);
        let size = direction.map(f32::abs);
        let z = usize::from(size[0] <= size[1]);
        let z = if size[2] >= size[z] { 2 } else { z };
        let (x, y) = ([1, 2, 0][z], [2, 0, 1][z]);
        self.axes = [x, y, z];
        self.shear = [direction[x] / direction[z], direction[y] / direction[z]];
        self.inverse = direction
            .map(|component| 1.0 / if component.abs() < TINY { TINY.copysign(component) } else { component });
        (self.placed, self.at) = (placed, at);
        self.origin_high = instance.to_sensor.origin_high;
        self.origin_low = instance.to_sensor.origin_low;
    }

    /// The children that the ray may hit before 1/t is as small as `so_far`, as one bit each, and an upper bound on
    /// 1/t.
    #[inline(always)]
    pub(super) fn meet<S: Simd>(&self, simd: S, node: &WideNode, so_far: f32) -> (f32x16<S>, u64) {
        let low = [
            self.relative(simd, &node.min[0], 0),
            self.relative(simd, &node.min[1], 1),
            self.relative(simd, &node.min[2], 2),
        ];
        let high = [
            self.relative(simd, &node.max[0], 0),
            self.relative(simd, &node.max[1], 1),
            self.relative(simd, &node.max[2], 2),
        ];
        let slack = max(max(max(high[0], -low[0]), max(high[1], -low[1])), max(high[2], -low[2])) * SLACK;
        let mut enters = f32x16::splat(simd, 0.0);
        let mut leaves = f32x16::splat(simd, f32::MAX);
        for axis in 0..3 {
            let first = (low[axis] - slack) * self.inverse[axis];
            let second = (high[axis] + slack) * self.inverse[axis];
            enters = max(enters, min(first, second));
            leaves = min(leaves, max(first, second));
        }
        let there = u32x16::load_array_ref(simd, &node.child).simd_ne(u32x16::splat(simd, NONE));
        let nearest = f32x16::splat(simd, 1.0001) / max(enters, f32x16::splat(simd, TINY));
        let met = enters.simd_le(leaves) & nearest.simd_gt(f32x16::splat(simd, so_far)) & there;
        (nearest, met.to_bitmask())
    }

    /// Returns true if the ray may hit one of the triangles, whose corners are given relative to the ray: if it passes
    /// the box around one of them.
    #[inline(always)]
    pub(super) fn meets_any<S: Simd>([a, b, c]: &[Points<S>; 3]) -> bool {
        let slack = max(max(a[2], b[2]), c[2]) * SLACK;
        let least = [min(min(a[0], b[0]), c[0]), min(min(a[1], b[1]), c[1])];
        let most = [max(max(a[0], b[0]), c[0]), max(max(a[1], b[1]), c[1])];
        let around = max(max(least[0], least[1]), -min(most[0], most[1]));
        around.simd_le(slack).any_true()
    }

    #[inline(always)]
    fn relative<S: Simd>(&self, simd: S, values: &[f32; WIDTH], axis: usize) -> f32x16<S> {
        (f32x16::load_array_ref(simd, values) - self.origin_high[axis]) - self.origin_low[axis]
    }
}

/// Coordinates relative to the ray: across it and along it.
impl CornerFrame for SingleRay {
    #[inline(always)]
    fn take<S: Simd>(&self, simd: S, points: &[[f32; WIDTH]; 3]) -> Points<S> {
        let [x, y, z] = self.axes;
        let far = self.relative(simd, &points[z % 3], z % 3);
        [
            self.relative(simd, &points[x % 3], x % 3) - far * self.shear[0],
            self.relative(simd, &points[y % 3], y % 3) - far * self.shear[1],
            far.abs(),
        ]
    }
}
