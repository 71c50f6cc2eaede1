//! A quick test of whether anything is near the sensor. Usually nothing is, and testing some boxes is enough to show
//! it.

use crate::scene::tree::{self, LEAF, NONE, TriangleBlock, WideNode};
use crate::simd::WIDTH;
use crate::trace::placed::view::{MAX_DEPTH, View};
use glam::DVec3;

impl View<'_> {
    /// Returns false if no surface is within `radius` metres of the sensor. The test uses the boxes and planes of
    /// triangles, so it may return true although no surface is that near.
    pub(crate) fn may_be_within(&self, radius: f64) -> bool {
        visit(
            |node| &self.nodes[node as usize],
            DVec3::ZERO,
            radius,
            |index| {
                let placed = &self.placed[index as usize];
                if !placed.kind().is_mesh() {
                    return true;
                }
                // A ball in the frame is inside a ball of this radius in the instance: the inverse stretches no vector
                // by more than its Frobenius norm.
                let squared: f64 = placed.inverse.as_flattened().iter().map(|value| value * value).sum();
                let stretch = crate::simd::sqrt(squared);
                visit(
                    |node| &self.scene.nodes[(placed.first_node + node) as usize],
                    DVec3::from_array(placed.origin_in_instance),
                    radius * stretch,
                    |block| {
                        let first = (placed.first_block + block) as usize;
                        let centre = DVec3::from_array(placed.origin_in_instance);
                        any_triangle_within(&self.scene.blocks[first], centre, radius * stretch)
                    },
                )
            },
        )
    }
}

/// Returns true if both the box and the plane of a triangle are within `radius` of a point. The box alone is not
/// enough: the sensor may be inside the box of a leaf that combines a wall with an object in front of it.
fn any_triangle_within(block: &TriangleBlock, point: DVec3, radius: f64) -> bool {
    let margin = margin(point, radius);
    (0..WIDTH).any(|lane| {
        let corner = |[x, y, z]: &[[f32; WIDTH]; 3]| {
            DVec3::new(x[lane].into(), y[lane].into(), z[lane].into()) - point
        };
        let [a, b, c] = &block.corners;
        let (a, b, c) = (corner(a), corner(b), corner(c));
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let outside = low.max(-high).max(DVec3::ZERO);
        // Corners of large triangles have larger rounding errors.
        let radius = margin + 1e-6 * high.max(-low).max_element();
        let normal = (b - a).cross(c - a);
        let above = normal.dot(a);
        outside.length_squared() <= radius * radius
            && above * above <= radius * radius * normal.length_squared()
    })
}

/// The radius, enlarged by the rounding errors of boxes and planes.
fn margin(point: DVec3, radius: f64) -> f64 {
    radius * 1.001 + 1e-5 * point.abs().max_element()
}

/// Returns true if `leaf` returns true for any leaf of a tree whose box is within `radius` of a point.
fn visit<'a>(
    node: impl Fn(u32) -> &'a WideNode,
    point: DVec3,
    radius: f64,
    leaf: impl Fn(u32) -> bool,
) -> bool {
    let radius = margin(point, radius);
    let mut stack = [0_u32; (WIDTH - 1) * (tree::MAX_DEPTH + MAX_DEPTH) + 2];
    let mut waiting = 1;
    while waiting > 0 {
        waiting -= 1;
        let node = node(stack[waiting]);
        for lane in 0..WIDTH {
            let child = node.child[lane];
            if child == NONE {
                break;
            }
            let mut squared = 0.0;
            for axis in 0..3 {
                let (low, high) = (f64::from(node.min[axis][lane]), f64::from(node.max[axis][lane]));
                let outside = (low - point[axis]).max(point[axis] - high).max(0.0);
                squared += outside * outside;
            }
            if squared > radius * radius {
                continue;
            }
            if child & LEAF == 0 {
                stack[waiting] = child;
                waiting += 1;
            } else if leaf(child & !LEAF) {
                return true;
            }
        }
    }
    false
}
