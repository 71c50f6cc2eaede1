//! Many rays at once on their way through one mesh's tree.
//!
//! A ray by itself is a chain: box test, order, triangle test, distance, next box; each waits for the one before,
//! for memory, and for branches that nobody can predict. So a few dozen rays are under way together. Each round
//! takes every ray one node or one leaf further; rays that wait for a node and rays that wait for a leaf queue
//! apart, and within a queue nothing depends on the ray before and hardly a branch on the data.
//!
//! Single precision finds the nearest triangle; double precision then says where it is hit, and decides between
//! triangles that are about equally near. Where the two disagree about what counts, the ray is walked once more,
//! alone and in double precision ([`nearest_in_mesh`]).

use super::block::{self, SLACK};
use super::ray::{Nearest, Ray};
use super::walk::{Stack, Tree, nearest_in_mesh};
use super::node;
use crate::scene::tree::{LEAF, NONE, TriangleBlock, WIDTH};
use fearless_simd::{Simd, SimdBase, f32x16, prelude::*, u32x16};

/// Rays under way.
pub(super) const RAYS: usize = 32;

/// Children that may wait per ray; a ray with more is walked alone.
const WAITING: usize = 112;

/// Entries below the first: they end the way, and are never too far.
const SENTINELS: usize = WIDTH;

/// By how much of t a hit in single precision may be too near and still nothing that matters lie before it.
const AGREES: f32 = 1.0 + f32::from_bits((127 - 17) << 23); // 1 + 2⁻¹⁷

/// One ray under way.
#[derive(Clone, Copy)]
struct Slot {
    ray: Ray,
    /// The nearest hit so far in single precision, or the end of the range.
    t: f32,
    /// Its slot.
    hit: u32,
    /// Next node or leaf.
    child: u32,
    /// Top of its stack.
    top: u32,
    /// Which of the rays it is.
    index: u32,
}

/// Ids of slots that wait for the same thing.
#[derive(Clone, Copy)]
struct Queue {
    ids: [u8; RAYS],
    length: usize,
}

impl Queue {
    const EMPTY: Self = Self { ids: [0; RAYS], length: 0 };

    /// Adds the id if `really`, without a branch.
    #[inline(always)]
    fn push_if(&mut self, id: usize, really: bool) {
        self.ids[self.length % RAYS] = id as u8;
        self.length += usize::from(really);
    }
}

/// Memory of the rays under way.
pub(super) struct Wave {
    keys: [[f32; WAITING + WIDTH]; RAYS],
    children: [[u32; WAITING + WIDTH]; RAYS],
    alone: Stack,
}

impl Wave {
    /// Nothing under way.
    pub(super) const fn new() -> Self {
        let mut keys = [[0.0; WAITING + WIDTH]; RAYS];
        let mut ray = 0;
        while ray < RAYS {
            let mut entry = 0;
            while entry < SENTINELS {
                keys[ray][entry] = f32::NEG_INFINITY;
                entry += 1;
            }
            ray += 1;
        }
        Self { keys, children: [[NONE; WAITING + WIDTH]; RAYS], alone: Stack::new() }
    }
}

/// Finds the nearest hits of `count` rays that `start` gives, and tells `finish` of each.
#[inline(always)]
pub(super) fn nearest_hits<S: Simd>(
    simd: S,
    tree: Tree<'_>,
    count: usize,
    cull_back: bool,
    wave: &mut Wave,
    start: impl Fn(usize) -> Ray,
    mut finish: impl FnMut(usize, &Ray, &Nearest),
) {
    if count == 0 {
        return;
    }
    let first = Slot { ray: start(0), t: 0.0, hit: NONE, child: 0, top: SENTINELS as u32, index: 0 };
    let mut slots = [first; RAYS];
    let mut nodes = Queue::EMPTY;
    let mut leaves = Queue::EMPTY;
    let mut done = Queue::EMPTY;
    let mut next = 0;
    while next < RAYS.min(count) {
        slots[next] = begin(start(next), next);
        nodes.push_if(next, true);
        next += 1;
    }
    loop {
        let mut more_nodes = Queue::EMPTY;
        let mut more_leaves = Queue::EMPTY;
        for &id in &nodes.ids[..nodes.length.min(RAYS)] {
            let id = usize::from(id) % RAYS;
            let slot = &mut slots[id];
            let (keys, children) = (&mut wave.keys[id], &mut wave.children[id]);
            let limit = slot.t * AGREES;
            if let Some(node) = tree.nodes.get(slot.child as usize) {
                let (near, mask) = node::meet(simd, node, &slot.ray, limit);
                slot.top = push(simd, &node.child, near, mask, keys, children, slot.top);
            }
            pop(simd, slot, limit, keys, children);
            more_leaves.push_if(id, slot.child & LEAF != 0 && slot.child != NONE);
            more_nodes.push_if(id, slot.child & LEAF == 0);
            done.push_if(id, slot.child == NONE);
        }
        for &id in &leaves.ids[..leaves.length.min(RAYS)] {
            let id = usize::from(id) % RAYS;
            let slot = &mut slots[id];
            let index = slot.child & !LEAF;
            if let Some(block) = tree.blocks.get(index as usize) {
                take(simd, tree, block, index, slot, cull_back);
            }
            pop(simd, slot, slot.t * AGREES, &wave.keys[id], &wave.children[id]);
            more_leaves.push_if(id, slot.child & LEAF != 0 && slot.child != NONE);
            more_nodes.push_if(id, slot.child & LEAF == 0);
            done.push_if(id, slot.child == NONE);
        }
        for &id in &done.ids[..done.length.min(RAYS)] {
            let id = usize::from(id) % RAYS;
            let slot = &mut slots[id];
            let nearest = settle(simd, tree, slot, cull_back, &mut wave.alone);
            finish(slot.index as usize, &slot.ray, &nearest);
            if next < count {
                *slot = begin(start(next), next);
                more_nodes.push_if(id, true);
                next += 1;
            }
        }
        done.length = 0;
        (nodes, leaves) = (more_nodes, more_leaves);
        if nodes.length + leaves.length == 0 {
            return;
        }
    }
}

#[inline(always)]
fn begin(ray: Ray, index: usize) -> Slot {
    Slot { ray, t: ray.range[1], hit: NONE, child: 0, top: SENTINELS as u32, index: index as u32 }
}

/// Puts the children of the mask on the stack, the nearest on top, and returns the new top. The rank of each is
/// the number of those that are farther: no branch depends on the order.
#[inline(always)]
fn push<S: Simd>(
    simd: S,
    child: &[u32; WIDTH],
    near: f32x16<S>,
    mask: u32,
    keys: &mut [f32; WAITING + WIDTH],
    children: &mut [u32; WAITING + WIDTH],
    top: u32,
) -> u32 {
    let top = top as usize;
    let (Some(keys), Some(children)) = (keys.get_mut(top..top + WIDTH), children.get_mut(top..top + WIDTH))
    else {
        return OVERFULL;
    };
    // t ≥ 0 orders like its bits (a negative t_min makes them large, which costs order, not hits); the lane in
    // the last four makes them differ.
    let order = (near.bitcast::<u32x16<S>>() & !15_u32) | u32x16::load_array_ref(simd, &LANE_NUMBERS);
    let order_of: [u32; WIDTH] = order.into();
    let mut rest = mask;
    for _ in 0..2 {
        let lane = rest.trailing_zeros() as usize % WIDTH;
        let farther = order.simd_gt(u32x16::splat(simd, order_of[lane])).to_bitmask() as u32 & mask;
        // Without a child left, the last place takes it: with fewer than sixteen, that is above the top.
        let rank = if rest == 0 { WIDTH - 1 } else { farther.count_ones() as usize % WIDTH };
        keys[rank] = f32::from_bits(order_of[lane] & !15);
        children[rank] = child[lane];
        rest &= rest.wrapping_sub(1);
    }
    while rest != 0 {
        let lane = rest.trailing_zeros() as usize % WIDTH;
        let farther = order.simd_gt(u32x16::splat(simd, order_of[lane])).to_bitmask() as u32 & mask;
        let rank = farther.count_ones() as usize % WIDTH;
        keys[rank] = f32::from_bits(order_of[lane] & !15);
        children[rank] = child[lane];
        rest &= rest - 1;
    }
    top as u32 + mask.count_ones()
}

/// The top of a stack that was too small.
const OVERFULL: u32 = u32::MAX;

const LANE_NUMBERS: [u32; WIDTH] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

/// Takes the topmost child that begins before `limit` off the stack.
#[inline(always)]
fn pop<S: Simd>(
    simd: S,
    slot: &mut Slot,
    limit: f32,
    keys: &[f32; WAITING + WIDTH],
    children: &[u32; WAITING + WIDTH],
) {
    let mut top = slot.top as usize;
    loop {
        // Sixteen at once; the sentinels always fit.
        let Some(window) = keys.get(top.wrapping_sub(WIDTH)..top) else {
            slot.child = NONE;
            return;
        };
        let near = f32x16::from_slice(simd, window).simd_le(f32x16::splat(simd, limit));
        let near = near.to_bitmask() as u32 & 0xffff;
        if near != 0 {
            top = top - WIDTH + near.ilog2() as usize;
            slot.child = children.get(top).copied().unwrap_or(NONE);
            slot.top = top as u32;
            return;
        }
        top -= WIDTH;
    }
}

/// Tests a leaf.
#[inline(always)]
fn take<S: Simd>(
    simd: S,
    tree: Tree<'_>,
    block: &TriangleBlock,
    index: u32,
    slot: &mut Slot,
    cull_back: bool,
) {
    let (t, mask) = block::meet_all(simd, block, &slot.ray, slot.t * SLACK, cull_back);
    let least = t.reduce_min();
    let near = t.simd_le(f32x16::splat(simd, least * SLACK)).to_bitmask() as u32 & mask;
    let rivals = near & near.wrapping_sub(1) != 0 || (slot.t <= least * SLACK && slot.hit != NONE && mask != 0);
    if rivals {
        compare(tree, block, index, near, slot);
        return;
    }
    let lane = near.trailing_zeros() % WIDTH as u32;
    slot.t = if mask != 0 { least } else { slot.t };
    slot.hit = if mask != 0 { index * WIDTH as u32 + lane } else { slot.hit };
}

/// Decides between the hit so far and triangles that lie at about the same distance.
#[inline(never)]
fn compare(tree: Tree<'_>, block: &TriangleBlock, index: u32, mask: u32, slot: &mut Slot) {
    let mut nearest = Nearest::none(&slot.ray);
    if let Some(block) = tree.blocks.get(slot.hit as usize / WIDTH) {
        let t = block::exact_distance(block, slot.hit as usize % WIDTH, &slot.ray);
        nearest.offer(&slot.ray, t, slot.hit);
    }
    block::offer(block, index, mask, &slot.ray, &mut nearest);
    if nearest.slot != NONE {
        (slot.t, slot.hit) = (nearest.t as f32, nearest.slot);
    }
}

/// The hit in double precision.
#[inline(always)]
fn settle<S: Simd>(
    simd: S,
    tree: Tree<'_>,
    slot: &Slot,
    cull_back: bool,
    stack: &mut Stack,
) -> Nearest {
    let mut nearest = Nearest::none(&slot.ray);
    let mut agree = slot.top != OVERFULL;
    if let Some(block) = tree.blocks.get(slot.hit as usize / WIDTH) {
        let t = block::exact_distance(block, slot.hit as usize % WIDTH, &slot.ray);
        nearest.offer(&slot.ray, t, slot.hit);
        agree &= nearest.slot != NONE && t <= f64::from(slot.t * AGREES);
    }
    if !agree {
        nearest = Nearest::none(&slot.ray);
        nearest_in_mesh(simd, tree, &slot.ray, cull_back, stack, &mut nearest);
    }
    nearest
}
