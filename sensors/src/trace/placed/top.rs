//! The tree over the instances of a frame.

use crate::scene::Aabb;
use crate::scene::tree::{LEAF, NONE, WideNode};
use crate::simd::WIDTH;
use bytemuck::Zeroable;

/// The number of nodes of a tree over this many instances.
pub(crate) const fn top_nodes(instances: usize) -> usize {
    let mut level = instances.div_ceil(WIDTH);
    let mut nodes = 1;
    while level > 1 {
        nodes += level;
        level = level.div_ceil(WIDTH);
    }
    nodes
}

/// Builds the tree over the boxes, sixteen neighbours on a Morton curve at a time, and returns its nodes.
///
/// The tree is rebuilt every frame, because instances move. There are few of them, so fast construction is more
/// important than a good tree: it takes a few microseconds per hundred instances.
pub(in crate::trace) fn build_top(bounds: &[Aabb], order: &mut [u64], nodes: &mut [WideNode]) -> usize {
    // A key is the position on the curve, followed by the index: the fewer boxes there are, the finer the curve.
    let index_bits = usize::BITS - bounds.len().leading_zeros();
    let cell_bits = ((64 - index_bits) / 3).min(21);
    let half = (1_u32 << (cell_bits - 1)) as f32;
    let per_metre = half / most_reach(bounds);
    let cell = |bounds: &Aabb, axis: usize| {
        // Casts saturate, so everything farther out is in the outermost cell.
        let place = (middle(bounds, axis) * per_metre + half) as u32;
        spread(place.min((1 << cell_bits) - 1))
    };
    for (index, (key, bounds)) in order.iter_mut().zip(bounds).enumerate() {
        let code = cell(bounds, 0) | cell(bounds, 1) << 1 | cell(bounds, 2) << 2;
        *key = code << index_bits | index as u64;
    }
    order.sort_unstable();
    let index_mask = (1_u64 << index_bits) - 1;

    // Level by level from the leaves up; in memory, each level precedes the one below it.
    let used = top_nodes(bounds.len());
    let mut below = 0..0;
    let mut elements = bounds.len();
    let mut end = used;
    loop {
        let count = elements.div_ceil(WIDTH).max(1);
        let start = end - count;
        for node in 0..count {
            let mut wide = WideNode::zeroed();
            wide.child = [NONE; WIDTH];
            let mut last = Aabb { min: [0.0; 3], max: [0.0; 3] };
            for lane in 0..WIDTH {
                let element = node * WIDTH + lane;
                if element < elements {
                    (wide.child[lane], last) = if below.is_empty() {
                        let index = (order[element] & index_mask) as u32;
                        (LEAF | index, bounds[index as usize])
                    } else {
                        let index = below.start + element;
                        (index as u32, bounds_of(&nodes[index]))
                    };
                }
                for axis in 0..3 {
                    wide.min[axis][lane] = last.min[axis];
                    wide.max[axis][lane] = last.max[axis];
                }
            }
            nodes[start + node] = wide;
        }
        below = start..end;
        (elements, end) = (count, start);
        if count == 1 {
            return used;
        }
    }
}

fn bounds_of(node: &WideNode) -> Aabb {
    let mut bounds = Aabb::EMPTY;
    for axis in 0..3 {
        for lane in 0..WIDTH {
            bounds.min[axis] = bounds.min[axis].min(node.min[axis][lane]);
            bounds.max[axis] = bounds.max[axis].max(node.max[axis][lane]);
        }
    }
    bounds
}

fn middle(bounds: &Aabb, axis: usize) -> f32 {
    bounds.min[axis] * 0.5 + bounds.max[axis] * 0.5
}

/// A power of two that the coordinates of the centres do not exceed, except for at most one in sixteen.
///
/// A few distant or huge objects must not determine the resolution for all others: a body that has fallen out of the
/// world, or a floor of 20 km that extends to one side.
fn most_reach(bounds: &[Aabb]) -> f32 {
    // The number of coordinates with each exponent.
    let mut count = [0_u32; 256];
    for bounds in bounds {
        let reach = (0..3).map(|axis| middle(bounds, axis).abs()).fold(f32::MIN_POSITIVE, f32::max);
        count[(reach.to_bits() >> 23) as usize & 0xff] += 1;
    }
    let mut left = (bounds.len() / 16) as u32;
    // No box reaches 2¹²⁷ m, and below 2⁻⁶³ m nothing needs to be resolved.
    let mut exponent = 254;
    while exponent > 64 && count[exponent - 1] <= left {
        exponent -= 1;
        left -= count[exponent];
    }
    f32::from_bits((exponent as u32) << 23)
}

/// Spreads 21 bits, with two zeros between neighbours.
fn spread(bits: u32) -> u64 {
    let mut x = u64::from(bits) & 0x1f_ffff;
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(all(test, feature = "alloc"))]
mod tests {
    use super::*;
    use crate::memory::Cutter;
    use crate::pose::Pose;
    use crate::scene::{InstanceConfig, MaterialConfig, SceneBuilder, Shape, visibility};
    use crate::trace::WorkspaceBuf;
    use crate::trace::placed::memory::view_lines;
    use crate::trace::placed::view::View;
    use alloc::vec;
    use glam::DVec3;

    /// Returns the number of visited nodes for 500 boxes within 30 m and the given other objects.
    fn visits(others: &[(Shape, Pose)]) -> usize {
        let mut builder = SceneBuilder::new();
        let material = builder.add_material(&MaterialConfig::default()).expect("a plain material");
        let mut add = |shape, world_from_instance| {
            let config = InstanceConfig { shape, world_from_instance, material, ..Default::default() };
            builder.add_instance(&config).expect("a valid instance");
        };
        for index in 0..500 {
            let i = f64::from(index);
            let place = DVec3::new((i * 0.618).fract() - 0.5, (i * 0.414).fract() - 0.5, (i * 0.732).fract());
            add(Shape::Box { size: [0.4; 3] }, Pose::from_translation(place * 30.0));
        }
        for (shape, pose) in others {
            add(*shape, *pose);
        }
        let scene = builder.scene();
        let mut workspace = WorkspaceBuf::default();
        let lent = workspace.lend(view_lines(500 + others.len(), 1));
        let mut memory = Cutter(lent.buffer);
        let moment = builder.moment(Pose::from_translation(DVec3::new(1.0, 2.0, 3.0)));
        let view = View::new(&scene, &moment, visibility::VISUAL, memory.views(scene.instances().len(), 1));
        (0..2000).map(|ray| nodes_on(&view, direction(ray))).sum()
    }

    /// Directions all around.
    fn direction(ray: u32) -> [f32; 3] {
        let i = f64::from(ray);
        let part = |step: f64| ((i * step).fract() - 0.5) as f32;
        [part(0.754_877_7), part(0.569_840_3), part(0.430_159_7) + 1e-3]
    }

    /// The number of nodes that a ray from the origin hits.
    fn nodes_on(view: &View<'_>, direction: [f32; 3]) -> usize {
        let meets = |node: &WideNode, lane: usize| {
            let (mut near, mut far) = (0.0_f32, f32::INFINITY);
            for axis in 0..3 {
                let ends = [node.min[axis][lane], node.max[axis][lane]].map(|x| x / direction[axis]);
                near = near.max(ends[0].min(ends[1]));
                far = far.min(ends[0].max(ends[1]));
            }
            near <= far
        };
        let (mut visited, mut stack) = (0, vec![0]);
        while let Some(index) = stack.pop() {
            let node = &view.nodes[index as usize];
            visited += 1;
            for lane in (0..WIDTH).filter(|&lane| node.child[lane] != NONE && meets(node, lane)) {
                if node.child[lane] & LEAF == 0 {
                    stack.push(node.child[lane]);
                }
            }
        }
        visited
    }

    #[test]
    fn a_huge_or_distant_object_does_not_spoil_the_tree() {
        let floor = |size: f64, at: DVec3| (Shape::Rectangle { size: [size; 2] }, Pose::from_translation(at));
        let none = visits(&[]);
        let fallen = (Shape::Sphere { radius: 0.5 }, Pose::from_translation(DVec3::Z * -3e8));
        let others = [
            ("a floor of 20 km", floor(20_000.0, DVec3::ZERO)),
            ("a floor of 20 km that lies to one side", floor(20_000.0, DVec3::new(9_900.0, 9_900.0, 0.0))),
            ("an endless plane", (Shape::Plane, Pose::IDENTITY)),
            ("a ball that has fallen for hours", fallen),
        ];
        for (name, other) in others {
            let found = visits(&[other]);
            assert!(found * 10 <= none * 11, "{name}: {found} nodes, and {none} without it");
        }
    }
}
