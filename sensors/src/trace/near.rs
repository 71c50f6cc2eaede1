//! Whether anything is near the sensor at all: most often nothing is, and a look at some boxes tells.

use super::view::{MAX_DEPTH, View};
use crate::scene::tree::{self, LEAF, NONE, WideNode};
use crate::simd::WIDTH;
use glam::DVec3;

impl View<'_> {
    /// False if no surface comes within `radius` metres of the sensor. Boxes decide, so true may be said of too much.
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
                // A ball of the frame lies in one of this radius in the instance: no row of the inverse stretches more
                // than all together.
                let stretch: f64 = placed.inverse.as_flattened().iter().map(|value| value * value).sum();
                visit(
                    |node| &self.scene.nodes[(placed.first_node + node) as usize],
                    DVec3::from_array(placed.origin_in_instance),
                    radius * crate::simd::sqrt(stretch),
                    |_| true,
                )
            },
        )
    }
}

/// Whether `leaf` says yes to a leaf of a tree whose box comes within `radius` of a point.
fn visit<'a>(
    node: impl Fn(u32) -> &'a WideNode,
    point: DVec3,
    radius: f64,
    leaf: impl Fn(u32) -> bool,
) -> bool {
    // Boxes hold what is in them but for rounding.
    let radius = radius * 1.001 + 1e-5 * point.abs().max_element();
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
