//! The binary tree from which the wide tree is made.

use super::bins::{blocks, find_cut};
use super::bounds::{Scratch, centre};
use super::cost::Power;
use super::quality::Quality;
use super::sweep::{SWEEP, sweep};
use crate::Execution;
use crate::simd::WIDTH;
use fearless_simd::{Simd, SimdBase, f32x4, f32x8};

/// From this depth on, sets are halved regardless of cost, so that the depth of every tree is bounded.
const HALVE_FROM_DEPTH: u32 = 32;

/// A set that fits into one block is still split if the areas of both sides sum to less than this fraction of its own.
/// This makes random rays in a room and a warehouse 2 to 3 % faster; with 0.9, leaves are emptier.
const WORTHWHILE: f32 = 0.7;

/// Sets smaller than this are not worth handing to another thread.
#[cfg(feature = "rayon")]
const PARALLEL_FROM: usize = 4096;

/// Settings that are the same for all sets.
#[derive(Clone, Copy)]
struct How<S> {
    simd: S,
    quality: Quality,
    power: Power,
    #[cfg_attr(not(feature = "rayon"), allow(dead_code, reason = "threads come with rayon"))]
    execution: Execution,
}

/// A set of primitives, with what its parent computed about it.
#[derive(Clone, Copy)]
struct Set {
    bounds: Scratch,
    /// Bounds of the primitives' [`centre`]s.
    centres: Scratch,
    /// Maximum number of blocks for the set.
    budget: usize,
    depth: u32,
}

/// Sorts `items` and fills `nodes` with the binary tree over them. The node of a set with a budget of b blocks owns 2b
/// − 1 nodes, and its left child is the next one, so the position of a node depends only on the input.
pub(super) fn build<S: Simd>(
    simd: S,
    quality: Quality,
    power: Power,
    execution: Execution,
    items: &mut [Scratch],
    nodes: &mut [Scratch],
    budget: usize,
) {
    let how = How { simd, quality, power, execution };
    let (bounds, centres) = simd.vectorize(
        #[inline(always)]
        || bounds_of(simd, items),
    );
    let set = Set { bounds, centres, budget, depth: 0 };
    build_set(how, items, nodes, 0, 0, set);
}

/// `first`: the scene-wide index of the first item. `base`: the index of the first node.
#[cfg_attr(not(feature = "rayon"), allow(clippy::only_used_in_recursion, reason = "threads come with rayon"))]
fn build_set<S: Simd>(
    how: How<S>,
    items: &mut [Scratch],
    nodes: &mut [Scratch],
    first: usize,
    base: usize,
    set: Set,
) {
    let Some((count, left, right)) = split(how, items, &set) else {
        nodes[0] = set.bounds.with_tags(first as u32, items.len() as u32);
        return;
    };
    let left_nodes = 2 * left.budget - 1;
    nodes[0] = set.bounds.with_tags((base + 1 + left_nodes) as u32, 0);
    let (left_items, right_items) = items.split_at_mut(count);
    let (left_part, right_part) = nodes[1..].split_at_mut(left_nodes);
    let (right_first, right_base) = (first + count, base + 1 + left_nodes);
    #[cfg(feature = "rayon")]
    if how.execution.parallel && left_items.len() + right_items.len() >= PARALLEL_FROM {
        rayon::join(
            || build_set(how, left_items, left_part, first, base + 1, left),
            || build_set(how, right_items, right_part, right_first, right_base, right),
        );
        return;
    }
    build_set(how, left_items, left_part, first, base + 1, left);
    build_set(how, right_items, right_part, right_first, right_base, right);
}

/// Partitions the items into two sides. Returns the number of items on the left, and both sides, or `None` if they are
/// better kept as one leaf.
fn split<S: Simd>(how: How<S>, items: &mut [Scratch], set: &Set) -> Option<(usize, Set, Set)> {
    let How { simd, quality, power, .. } = how;
    let fits = items.len() <= WIDTH;
    if fits && (set.budget == 1 || quality == Quality::Fast || set.depth >= HALVE_FROM_DEPTH) {
        return None;
    }
    simd.vectorize(
        #[inline(always)]
        || {
            let depth = set.depth + 1;
            let (count, [left, right], [left_centres, right_centres]) = if set.depth >= HALVE_FROM_DEPTH {
                halve(simd, items, &set.centres)
            } else if quality == Quality::High && items.len() <= SWEEP {
                let limit = if fits { WORTHWHILE * set.bounds.area() } else { f32::INFINITY };
                match sweep(simd, power, items, &set.centres, set.budget, limit) {
                    Some(count) => {
                        let (left, left_centres) = bounds_of(simd, &items[..count]);
                        let (right, right_centres) = bounds_of(simd, &items[count..]);
                        (count, [left, right], [left_centres, right_centres])
                    }
                    None if fits => return None,
                    None => halve(simd, items, &set.centres),
                }
            } else {
                match find_cut(simd, power, items, &set.centres, set.budget) {
                    Some(cut) => {
                        let centres = cut.plane.partition(simd, items);
                        (cut.left_count, [cut.left, cut.right], centres)
                    }
                    None => halve(simd, items, &set.centres),
                }
            };
            let (left_budget, right_budget) = share(set.budget, count, items.len() - count);
            Some((
                count,
                Set { bounds: left, centres: left_centres, budget: left_budget, depth },
                Set { bounds: right, centres: right_centres, budget: right_budget, depth },
            ))
        },
    )
}

/// Gives both sides the blocks that they need, and divides the spare ones in proportion to their sizes.
fn share(budget: usize, left: usize, right: usize) -> (usize, usize) {
    let spare = budget - blocks(left) - blocks(right);
    let extra = (spare as u64 * left as u64 / (left + right) as u64) as usize;
    (blocks(left) + extra, blocks(right) + spare - extra)
}

/// Splits in half by rank along the longest axis of the centres, at a multiple of a block.
#[inline(always)]
fn halve<S: Simd>(simd: S, items: &mut [Scratch], centres: &Scratch) -> (usize, [Scratch; 2], [Scratch; 2]) {
    let extent = |axis: usize| 0.0 - (centres.lanes[axis] + centres.lanes[axis + 4]);
    let mut longest = 0;
    for axis in 1..3 {
        if extent(axis) > extent(longest) {
            longest = axis;
        }
    }
    let count = blocks(items.len()).div_ceil(2) * WIDTH;
    let key = |item: &Scratch| item.lanes[longest] - item.lanes[longest + 4];
    items.select_nth_unstable_by(count, |a, b| key(a).total_cmp(&key(b)).then(a.tag().cmp(&b.tag())));
    let (left, left_centres) = bounds_of(simd, &items[..count]);
    let (right, right_centres) = bounds_of(simd, &items[count..]);
    (count, [left, right], [left_centres, right_centres])
}

/// The box of all items, and the box of their [`centre`]s.
#[inline(always)]
fn bounds_of<S: Simd>(simd: S, items: &[Scratch]) -> (Scratch, Scratch) {
    let zero = f32x4::splat(simd, 0.0);
    let mut bounds = f32x8::splat(simd, f32::INFINITY);
    let mut centres = bounds;
    for item in items {
        let item = f32x8::from_slice(simd, &item.lanes);
        let centre = centre(simd, item);
        bounds = bounds.min(item);
        centres = centres.min(simd.combine_f32x4(centre, zero - centre));
    }
    (Scratch { lanes: bounds.into() }, Scratch { lanes: centres.into() })
}
