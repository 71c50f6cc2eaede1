//! Planes of triangles in double precision, where single precision does not do.
//!
//! Corners in the sensor's frame are rounded by a share of their distance, and a normal by a share of the product of
//! two sides. That matters where a triangle's plane passes the sensor much nearer than its corners lie, as under a
//! robot that stands on a large triangle, and where a triangle is so thin that its normal is a small difference.
//! Such triangles are rare. Their planes are made again, from the corners as they are stored.

use crate::simd::WIDTH;
use crate::trace::placed::view::{Placed, View};
use fearless_simd::{Simd, mask32x16};
use glam::{DMat3, DVec3};

/// A triangle is blurred, that is to be made again, where its plane passes much nearer to the sensor than its corners
/// lie: from this square of (distance of the farthest corner / distance of the plane) on.
pub(super) const BLURRED_SQUARED: f32 = 700.0;
/// It is blurred too where it is thin: from this square of (product of two sides and the longer of them / volume of the
/// solid between triangle and sensor) on.
pub(super) const THIN_SQUARED: f32 = 1e4;
/// What [`BLURRED_SQUARED`] is for a plane, for the plane through the sensor and an edge, with the ends of the edge for
/// corners. An edge belongs to two triangles, which must give it the same plane, so that no ray slips between them. The
/// limit is higher, so that where an edge exceeds it both of its triangles are blurred.
const BLURRED_EDGE_SQUARED: f64 = 1600.0;

/// Where the triangles of a leaf come from.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) view: &'a View<'a>,
    pub(super) placed: &'a Placed,
    /// Which leaf of the instance.
    pub(super) leaf: u32,
}

/// Planes of sixteen triangles.
pub(super) struct PlaneArrays {
    /// Through the sensor and the edges, positive inside.
    pub(super) edges: [[[f32; WIDTH]; 3]; 3],
    /// Of 1/t.
    pub(super) inverse: [[f32; WIDTH]; 3],
    /// Lanes whose triangles have the sensor behind them, and in front.
    pub(super) sides: [u64; 2],
}

impl PlaneArrays {
    /// `sides` as masks.
    #[inline(always)]
    pub(super) fn sides_of<S: Simd>(&self, simd: S) -> [mask32x16<S>; 2] {
        let [behind, front] = self.sides;
        [simd.from_bitmask_mask32x16(behind), simd.from_bitmask_mask32x16(front)]
    }
}

impl Source<'_> {
    /// Makes the planes of the triangles in `lanes` again.
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
                // |sharp| = 2 |p × q| is twice the edge's length by the distance of its line, which need not be near
                // the edge itself unless that is long.
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
