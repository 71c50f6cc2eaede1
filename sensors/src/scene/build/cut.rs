//! Selects the nodes of the binary tree that become wide nodes, so that the sum of their surface areas is least.
//!
//! This is the dynamic programme of Ylitie, Karras and Laine, "Efficient incoherent ray traversal on GPUs through
//! compressed wide BVHs" (2017), section 3.1, for given leaves. A subtree can be attached to the wide node above it as
//! one child or as up to k children, and the cost of k is the least over all ways to divide k between its two sides.

use super::bounds::Scratch;
use crate::simd::WIDTH;

/// `costs[k]`: the least sum of surface areas of a subtree that takes at most k + 1 lanes of the node above.
type Costs = [f32; WIDTH - 1];

/// The number of lanes that the left side of a subtree gets if the subtree has `lanes` lanes. `ways` holds four bits
/// for each number of lanes from 2 to 16: the share of the left side, or 0 if fewer lanes are as good. With 16 lanes,
/// the subtree is a wide node itself, and is always divided.
#[inline(always)]
fn share(ways: u64, lanes: usize) -> usize {
    (ways >> (4 * (lanes - 2))) as usize & 15
}

/// Writes `ways` for the subtree of each inner node, at the node's index; other entries are left unchanged. Returns the
/// sum of the surface areas of wide nodes and leaves, which is proportional to the number of boxes that a ray meets.
pub(super) fn choose(binary: &[Scratch], ways: &mut [u64]) -> f32 {
    // Too small to change the optimum, but among equal costs it prefers the fewest nodes, for example for a mesh that
    // lies on a line.
    let area = binary[0].area();
    let tiny = if area > 0.0 { area * 1e-7 } else { 1.0 };
    let (costs, leaves) = subtree(binary, ways, 0, tiny);
    costs[0] + leaves
}

/// Returns the costs of the wide nodes, and the sum of the surface areas of the leaves. `tiny` is added to the area of
/// each wide node. The recursion is as deep as the binary tree, so its depth is bounded.
fn subtree(binary: &[Scratch], ways: &mut [u64], index: usize, tiny: f32) -> (Costs, f32) {
    let node = &binary[index];
    if node.count() > 0 {
        return ([0.0; WIDTH - 1], node.area());
    }
    let (left, left_leaves) = subtree(binary, ways, index + 1, tiny);
    let (right, right_leaves) = subtree(binary, ways, node.tag() as usize, tiny);
    let mut chosen = 0;
    let mut split = [0.0; WIDTH + 1];
    for lanes in 2..=WIDTH {
        let mut least = f32::INFINITY;
        let mut share = 1;
        for left_lanes in 1..lanes {
            let cost = left[left_lanes - 1] + right[lanes - left_lanes - 1];
            if cost < least {
                least = cost;
                share = left_lanes;
            }
        }
        split[lanes] = least;
        chosen |= (share as u64) << (4 * (lanes - 2));
    }
    let mut costs = [(node.area() + tiny) + split[WIDTH]; WIDTH - 1];
    for lanes in 2..WIDTH {
        costs[lanes - 1] = costs[lanes - 2];
        if split[lanes] < costs[lanes - 1] {
            costs[lanes - 1] = split[lanes];
        } else {
            chosen &= !(15 << (4 * (lanes - 2)));
        }
    }
    ways[index] = chosen;
    (costs, left_leaves + right_leaves)
}

/// The children of the wide node that is made from an inner binary node, in the order of the binary tree, so that
/// neighbours are adjacent.
pub(super) fn children(binary: &[Scratch], ways: &[u64], top: u32) -> ([u32; WIDTH], usize) {
    let mut children = [top; WIDTH];
    let mut count = 0;
    // Subtrees to visit with the lanes that they get; at most sixteen lanes are waiting.
    let mut stack = [(top, WIDTH); WIDTH];
    let mut waiting = 1;
    while waiting > 0 {
        waiting -= 1;
        let (index, mut lanes) = stack[waiting];
        let node = &binary[index as usize];
        if node.count() > 0 {
            lanes = 1;
        }
        while lanes > 1 && share(ways[index as usize], lanes) == 0 {
            lanes -= 1;
        }
        if lanes == 1 {
            children[count] = index;
            count += 1;
        } else {
            let left_lanes = share(ways[index as usize], lanes);
            stack[waiting] = (node.tag(), lanes - left_lanes);
            stack[waiting + 1] = (index + 1, left_lanes);
            waiting += 2;
        }
    }
    (children, count)
}
