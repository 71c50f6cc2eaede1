//! Planes of triangles in double precision, for triangles for which single precision is not enough.
//!
//! Corners in the sensor's frame have rounding errors proportional to their distance, and a normal has one proportional
//! to the product of two sides. These matter if a triangle's plane passes much nearer to the sensor than its corners,
//! as under a robot on a large triangle, or if a triangle is so thin that its normal is a small difference. Such
//! triangles are rare. Their planes are recomputed from the stored corners.

use crate::simd::WIDTH;
use crate::trace::placed::view::{Placed, View};
use fearless_simd::{Simd, mask32x16};
use glam::{DMat3, DVec3};

/// A triangle is blurred, and must be recomputed, if its plane passes much nearer to the sensor than its corners: from
/// this square of (distance of the farthest corner / distance of the plane) on.
pub(super) const BLURRED_SQUARED: f32 = 700.0;
/// A triangle is also blurred if it is thin: from this square of (product of two sides and the longer of them / volume
/// of the solid between triangle and sensor) on.
pub(super) const THIN_SQUARED: f32 = 1e4;
/// The same limit as [`BLURRED_SQUARED`], for the plane through the sensor and an edge, with the ends of the edge as
/// corners. An edge belongs to two triangles, which must use the same plane for it, so that no ray slips between them.
/// The limit is higher, so that if an edge exceeds it, both of its triangles are blurred.
const BLURRED_EDGE_SQUARED: f64 = 1600.0;

/// The source of the triangles of a leaf.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) view: &'a View<'a>,
    pub(super) placed: &'a Placed,
    /// The index of the leaf in the instance.
    pub(super) leaf: u32,
}

/// Planes of sixteen triangles.
pub(super) struct PlaneArrays {
    /// The planes through the sensor and the edges, positive inside.
    pub(super) edges: [[[f32; WIDTH]; 3]; 3],
    /// The planes of 1/t.
    pub(super) inverse: [[f32; WIDTH]; 3],
    /// The lanes whose triangles have the sensor behind them, and those that have it in front.
    pub(super) sides: [u64; 2],
}

impl PlaneArrays {
    /// Returns `sides` as masks.
    #[inline(always)]
    pub(super) fn sides_of<S: Simd>(&self, simd: S) -> [mask32x16<S>; 2] {
        let [behind, front] = self.sides;
        [simd.from_bitmask_mask32x16(behind), simd.from_bitmask_mask32x16(front)]
    }
}

impl Source<'_> {
    /// Recomputes the planes of the triangles in `lanes`.
    #[inline(never)]
    pub(super) fn sharpen(&self, mut lanes: u64, planes: &mut PlaneArrays) {
        let sensor_from_instance = self.view.sensor_from_world * DMat3::from_cols_array_2d(&self.placed.axes);
        let origin = DVec3::from_array(self.placed.origin_in_instance);
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize & (WIDTH - 1);
            let bit = 1 << lane;
            lanes &= lanes - 1;
            let [a, b, c] = self.view.corners(self.placed, self.leaf * WIDTH as u32 + lane as u32);
            let (a, b, c) = (
                sensor_from_instance * (a - origin),
                sensor_from_instance * (b - origin),
                sensor_from_instance * (c - origin),
            );
            let normal = (b - a).cross(c - a);
            let volume = normal.dot(a);
            let sides = [volume > 0.0, volume < 0.0];
            let turned = sides[0] != (planes.sides[0] & bit != 0);
            for (lanes, here) in planes.sides.iter_mut().zip(sides) {
                *lanes = *lanes & !bit | if here { bit } else { 0 };
            }
            for axis in 0..3 {
                planes.inverse[axis][lane] = (normal[axis] / volume) as f32;
            }
            let sign = if sides[0] { 1.0 } else { -1.0 };
            for (plane, [p, q]) in planes.edges.iter_mut().zip([[b, c], [c, a], [a, b]]) {
                let sharp = (p + q).cross((q - p) * sign);
                // The length of `sharp`, 2 |p × q|, is twice the product of the edge's length and the distance of its
                // line. The line may pass nearer than the edge itself, unless the edge is long.
                let (far, length) = (p.length_squared().max(q.length_squared()), (q - p).length_squared());
                let blurred =
                    length > 0.25 * far && far * length * 4.0 > sharp.length_squared() * BLURRED_EDGE_SQUARED;
                for axis in 0..3 {
                    let value = &mut plane[axis][lane];
                    *value = match (blurred, turned) {
                        (true, _) => sharp[axis] as f32,
                        (false, true) => -*value,
                        (false, false) => *value,
                    };
                }
            }
        }
    }
}
