//! Which blocks of rays may hit a solid, from the outline of its box.
//!
//! From outside, a box covers a convex cone of directions. Along each axis of the box, the cone is between two planes
//! through the sensor, and everything hit in it is behind the faces that are turned to the sensor, for each of which
//! 1/t is linear in the direction. Testing sixteen blocks against these planes costs less than the exact test of one.

use crate::optics::rays::{Projection, min};
use fearless_simd::{Simd, SimdBase, f32x16, mask32x16};
use glam::DVec3;

/// If the sensor is nearer to a face's plane than this fraction of the box's size and distance, it counts as beside it.
const BESIDE: f64 = 1e-9;

/// A box as the sensor sees it, in the axes of the sensor.
pub(super) struct Silhouette {
    /// Planes through the sensor, positive inside.
    edges: [[f32; 3]; 6],
    edge_count: usize,
    /// 1/t of the planes of the faces that are turned to the sensor, which is an upper bound on 1/t of any hit.
    faces: [[f32; 3]; 3],
    face_count: usize,
}

impl Silhouette {
    /// Creates the silhouette of a box with half extents `half` around its origin, seen from `origin`. `rows` are those
    /// of the matrix from the axes of the sensor to the box's. If the sensor is inside the box, the silhouette has no
    /// planes and excludes nothing.
    pub(super) fn new(half: [f64; 3], origin: [f64; 3], rows: &[[f64; 3]; 3]) -> Self {
        let rows = rows.map(DVec3::from_array);
        let mut found = Self { edges: [[0.0; 3]; 6], edge_count: 0, faces: [[0.0; 3]; 3], face_count: 0 };
        let ends = |axis: usize| [-half[axis] - origin[axis], half[axis] - origin[axis]];
        // The face that is turned to the sensor.
        let face = |axis: usize| {
            let [low, high] = ends(axis);
            let beside = BESIDE * (half[axis] + origin[axis].abs());
            if low > beside {
                Some(low)
            } else if high < -beside {
                Some(high)
            } else {
                None
            }
        };
        for axis in 0..3 {
            if let Some(distance) = face(axis) {
                found.faces[found.face_count] = (rows[axis] / distance).as_vec3().to_array();
                found.face_count += 1;
            }
            // Seen along the axis, the box is a rectangle, whose outline is given by two of its corners.
            let [x, y] = [(axis + 1) % 3, (axis + 2) % 3];
            if face(x).is_none() && face(y).is_none() {
                continue;
            }
            for turn in [1.0, -1.0] {
                let mut outermost = [ends(x)[0], ends(y)[0]];
                for corner in [[0, 1], [1, 0], [1, 1]] {
                    let corner = [ends(x)[corner[0]], ends(y)[corner[1]]];
                    if (outermost[0] * corner[1] - outermost[1] * corner[0]) * turn < 0.0 {
                        outermost = corner;
                    }
                }
                let plane = (rows[y] * outermost[0] - rows[x] * outermost[1]) * turn;
                found.edges[found.edge_count] = plane.normalize().as_vec3().to_array();
                found.edge_count += 1;
            }
        }
        found
    }

    /// Returns which of the sixteen blocks from `column` on may show a part of the box that is nearer than `farthest`,
    /// their farthest hits so far.
    #[inline(always)]
    pub(super) fn shows<S: Simd, P: Projection>(
        &self,
        simd: S,
        projection: P,
        [column, row]: [usize; 2],
        farthest: f32x16<S>,
    ) -> mask32x16<S> {
        let mut inside = f32x16::splat(simd, 0.0);
        for plane in &self.edges[..self.edge_count] {
            inside = min(inside, projection.most_over_blocks(simd, plane, column, row));
        }
        let mut nearest = f32x16::splat(simd, f32::MAX);
        for plane in &self.faces[..self.face_count] {
            nearest = min(nearest, projection.most_over_blocks(simd, plane, column, row));
        }
        inside.simd_ge(f32x16::splat(simd, 0.0)) & nearest.simd_gt(farthest)
    }
}
