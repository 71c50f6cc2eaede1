//! Bounding volume hierarchies: axis-aligned boxes in a binary tree, built by binned surface area heuristic
//! (Wald 2007, "On fast construction of SAH-based bounding volume hierarchies").

use bytemuck::{Pod, Zeroable};

/// An axis-aligned box in single precision, rounded outwards.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Aabb {
    pub(crate) min: [f32; 3],
    pub(crate) max: [f32; 3],
}

impl Aabb {
    /// Holds nothing; growing it by a box gives that box.
    pub(crate) const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    /// The smallest box that holds the given interval. The margin of 1e-6 relative covers the rounding from f64
    /// and of the traversal itself.
    pub(crate) fn from_f64(min: [f64; 3], max: [f64; 3]) -> Self {
        let mut bounds = Self::EMPTY;
        for axis in 0..3 {
            let margin = 1e-6 * (1e-3 + min[axis].abs().max(max[axis].abs()));
            bounds.min[axis] = (min[axis] - margin) as f32;
            bounds.max[axis] = (max[axis] + margin) as f32;
        }
        bounds
    }

    pub(crate) fn union(&self, other: &Self) -> Self {
        let mut bounds = *self;
        for axis in 0..3 {
            bounds.min[axis] = bounds.min[axis].min(other.min[axis]);
            bounds.max[axis] = bounds.max[axis].max(other.max[axis]);
        }
        bounds
    }

    fn half_area(&self) -> f32 {
        let [x, y, z] = [self.max[0] - self.min[0], self.max[1] - self.min[1], self.max[2] - self.min[2]];
        if x < 0.0 { 0.0 } else { x * y + y * z + z * x }
    }

    fn centre(&self, axis: usize) -> f32 {
        self.min[axis] * 0.5 + self.max[axis] * 0.5
    }
}

/// A node of a tree. A leaf has `count` > 0 elements from `first` of the order; an inner node has its children
/// at `first` and `first + 1` of the nodes.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct Node {
    pub(crate) bounds: Aabb,
    pub(crate) first: u32,
    pub(crate) count: u32,
}

/// Nodes that a tree over `elements` boxes can need.
pub const fn max_nodes(elements: usize) -> usize {
    if elements == 0 { 1 } else { 2 * elements - 1 }
}

/// Deepest a tree gets; a split that would go deeper makes a leaf of whatever size instead.
pub(crate) const MAX_DEPTH: usize = 64;
const BINS: usize = 16;

/// Builds a tree over `bounds` into `nodes` and `order`, and returns how many nodes it has. `order` holds the
/// elements' indices and is reordered so that each leaf's lie together.
///
/// `nodes` holds [`max_nodes`] at least, `order` as many as `bounds`. Leaves hold at most `leaf_size`, unless
/// the boxes cannot be told apart.
pub(crate) fn build(bounds: &[Aabb], order: &mut [u32], nodes: &mut [Node], leaf_size: usize) -> usize {
    debug_assert!(order.len() == bounds.len() && nodes.len() >= max_nodes(bounds.len()));
    for (slot, index) in order.iter_mut().zip(0..) {
        *slot = index;
    }
    nodes[0] = Node { bounds: bounds_of(bounds, order), first: 0, count: order.len() as u32 };
    let mut used = 1;
    let mut stack = [(0_u32, 0_u32); MAX_DEPTH + 1];
    let mut depth = 1;
    while depth > 0 {
        depth -= 1;
        let (index, level) = stack[depth];
        let node = nodes[index as usize];
        let range = node.first as usize..(node.first + node.count) as usize;
        if range.len() <= leaf_size || level as usize >= MAX_DEPTH - 1 {
            continue;
        }
        let Some(left_count) = split(bounds, &mut order[range.clone()]) else { continue };
        let (left, right) = order[range.clone()].split_at(left_count);
        let children = [
            Node { bounds: bounds_of(bounds, left), first: range.start as u32, count: left.len() as u32 },
            Node {
                bounds: bounds_of(bounds, right),
                first: (range.start + left_count) as u32,
                count: right.len() as u32,
            },
        ];
        nodes[used..used + 2].copy_from_slice(&children);
        nodes[index as usize].first = used as u32;
        nodes[index as usize].count = 0;
        // Each level leaves at most one sibling waiting, so the stack cannot outgrow the depth.
        stack[depth] = (used as u32, level + 1);
        stack[depth + 1] = (used as u32 + 1, level + 1);
        depth += 2;
        used += 2;
    }
    used
}

fn bounds_of(bounds: &[Aabb], order: &[u32]) -> Aabb {
    order.iter().fold(Aabb::EMPTY, |all, &index| all.union(&bounds[index as usize]))
}

/// Reorders `order` into a left and a right part, and returns the size of the left one; none when all centres
/// coincide.
fn split(bounds: &[Aabb], order: &mut [u32]) -> Option<usize> {
    let mut low = [f32::INFINITY; 3];
    let mut high = [f32::NEG_INFINITY; 3];
    for &index in order.iter() {
        for axis in 0..3 {
            let centre = bounds[index as usize].centre(axis);
            low[axis] = low[axis].min(centre);
            high[axis] = high[axis].max(centre);
        }
    }
    let axis = (0..3).max_by(|&a, &b| (high[a] - low[a]).total_cmp(&(high[b] - low[b])))?;
    let extent = high[axis] - low[axis];
    if extent.is_nan() || extent <= 0.0 {
        return None;
    }
    let scale = BINS as f32 / extent;
    let bin_of =
        |index: u32| (((bounds[index as usize].centre(axis) - low[axis]) * scale) as usize).min(BINS - 1);

    let mut bins = [(Aabb::EMPTY, 0_u32); BINS];
    for &index in order.iter() {
        let bin = &mut bins[bin_of(index)];
        *bin = (bin.0.union(&bounds[index as usize]), bin.1 + 1);
    }
    // Cost of a cut after each bin: area times count on both sides.
    let mut cost = [0.0_f32; BINS - 1];
    let mut sweep = (Aabb::EMPTY, 0_u32);
    for bin in 0..BINS - 1 {
        sweep = (sweep.0.union(&bins[bin].0), sweep.1 + bins[bin].1);
        cost[bin] = sweep.0.half_area() * sweep.1 as f32;
    }
    sweep = (Aabb::EMPTY, 0);
    for bin in (0..BINS - 1).rev() {
        sweep = (sweep.0.union(&bins[bin + 1].0), sweep.1 + bins[bin + 1].1);
        cost[bin] += sweep.0.half_area() * sweep.1 as f32;
    }
    let cut = (0..BINS - 1).min_by(|&a, &b| cost[a].total_cmp(&cost[b]))?;

    // Hoare's partition: deterministic, in place.
    let (mut left, mut right) = (0, order.len());
    while left < right {
        if bin_of(order[left]) <= cut {
            left += 1;
        } else {
            right -= 1;
            order.swap(left, right);
        }
    }
    (left > 0 && left < order.len()).then_some(left)
}
