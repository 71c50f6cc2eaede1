//! Traversal of one mesh's tree by sixteen rays at once.
//!
//! A single ray is a chain of dependent steps: box test, sorting, triangle test, distance, next box. Each step waits
//! for the previous one, for memory, and for branches that cannot be predicted. Many rays are therefore processed
//! together. Each round advances every ray by one node or one leaf, in passes over all rays that do the same: boxes,
//! triangles, nearest triangle, next child. Within a pass no ray depends on the one before, and hardly any branch
//! depends on the data, so the processor works on several rays, and waits for the memory of several, at once.
//!
//! The nearest triangle is found in single precision. Its exact hit is then computed in double precision, which also
//! decides between triangles that are about equally near. If the two disagree about the hit, the ray traverses the tree
//! again, alone and in double precision ([`nearest_in_tree`]).

#![allow(clippy::needless_bitwise_bool, reason = "lazy operators become branches that nobody can predict")]

use super::block::{self, SLACK};
use super::bundle::{Bundle, PerRay, RAYS};
use super::node;
use super::ray::{FrameRay, Nearest};
use super::settle::Settled;
use super::walk::{MeshTree, STACK, Stack, Waiting, nearest_in_tree};
use crate::scene::tree::{LEAF, NONE};
use crate::simd::WIDTH;
use bytemuck::{Pod, Zeroable};
use fearless_simd::{Simd, SimdBase, f32x16, prelude::*};
use glam::DVec3;

/// The largest number of nodes on the path from the root with waiting children, and the end; a ray that goes deeper is
/// traced alone.
const LEVELS: usize = 16;

/// The nearest t of a ray is known in single precision and may be too small. Boxes and triangles are tested up to this
/// multiple of t, so that the true nearest hit is among the tested ones. If t in double precision is larger than this,
/// the two disagree, and the ray is traced again, alone.
pub(super) const AGREES: f32 = 1.0 + f32::from_bits((127 - 17) << 23); // 1 + 2⁻¹⁷

/// Below this sine of the angle between a ray and a plane, any hit must be confirmed in double precision.
const LEAST_SINE: f64 = 1e-4;

/// A t for each child of a node or triangle of a leaf: where a ray enters or hits it, +∞ if it does not.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
struct Sixteen([f32; WIDTH]);

// The memory of the nodes on the path also holds the waiting children when a ray is traced alone.
const _: () = assert!(LEVELS * RAYS * size_of::<Sixteen>() >= STACK * size_of::<Waiting>());

/// Rays that wait for the same step.
#[derive(Clone, Copy)]
struct Queue {
    ids: PerRay<u8>,
    length: usize,
}

impl Queue {
    const EMPTY: Self = Self { ids: [0; RAYS], length: 0 };

    /// Adds the id if `really` is true, without a branch.
    #[inline(always)]
    fn push_if(&mut self, id: usize, really: bool) {
        self.ids[self.length % RAYS] = id as u8;
        self.length += usize::from(really);
    }

    #[inline(always)]
    fn ids(&self) -> &[u8] {
        &self.ids[..self.length.min(RAYS)]
    }
}

/// Memory for the nodes and leaves of the rays. All of it is written before it is read.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct WaveScratch {
    /// The end, and t of the children of the nodes on the path that have waiting children …
    near: [PerRay<Sixteen>; LEVELS],
    /// … and the indices of these nodes.
    node: [PerRay<u32>; LEVELS],
    /// t of the triangles of a leaf.
    leaf: PerRay<Sixteen>,
}

/// Rays that are traced together.
pub(crate) struct Wave<'m> {
    pub(super) bundle: Bundle,
    room: &'m mut WaveScratch,
    /// The number of nodes on each ray's path.
    depth: PerRay<u32>,
    /// The next node or leaf.
    child: PerRay<u32>,
    /// The rays that must be traced alone.
    alone: Queue,
    /// The nearest hits in double precision.
    pub(super) settled: Settled,
}

impl<'m> Wave<'m> {
    /// Creates an empty wave.
    #[inline(always)]
    pub(crate) fn new(room: &'m mut WaveScratch) -> Self {
        Self {
            bundle: const { Bundle::new() },
            room,
            depth: [0; RAYS],
            child: [0; RAYS],
            alone: Queue::EMPTY,
            settled: const { Settled::new() },
        }
    }

    /// Sets a ray in the frame of the mesh in lane `id` of the bundle, which still has to be prepared.
    #[inline(always)]
    pub(crate) fn set(&mut self, id: usize, origin: DVec3, direction: DVec3, range: [f32; 2]) {
        let (high, along) = (origin.as_vec3().to_array(), direction.as_vec3().to_array());
        self.bundle.set(id, &FrameRay { origin: high, direction: along, range });
        self.bundle.set_low(id, origin, direction);
    }

    /// Prepares the first `count` rays of the bundle and finds their nearest hits. Unused lanes of the last sixteen
    /// must also contain rays.
    #[inline(always)]
    pub(crate) fn cast<S: Simd>(
        &mut self,
        simd: S,
        tree: MeshTree<'_>,
        (count, doubt): (usize, f32),
        cull_back: bool,
    ) {
        self.bundle.prepare(simd, count, doubt);
        self.nearest_hits(simd, tree, count, cull_back);
    }

    /// t and slot of the hit of a ray, or `None` if it hits nothing.
    #[inline(always)]
    pub(crate) fn hit(&self, id: usize) -> Option<(f64, u32)> {
        let slot = self.bundle.hit[id][0];
        (slot != NONE).then(|| (self.settled.t[id] * f64::from(self.bundle.unit[id]), slot))
    }

    /// Finds the nearest hits of the first `count` rays of the bundle, which must be prepared. Compiled once per level,
    /// for all callers.
    #[inline(never)]
    pub(super) fn nearest_hits<S: Simd>(
        &mut self,
        simd: S,
        tree: MeshTree<'_>,
        count: usize,
        cull_back: bool,
    ) {
        simd.vectorize(
            #[inline(always)]
            || self.find_nearest(simd, tree, count, cull_back),
        );
    }

    #[inline(always)]
    fn find_nearest<S: Simd>(&mut self, simd: S, tree: MeshTree<'_>, count: usize, cull_back: bool) {
        self.walk::<false, S>(simd, tree, count, cull_back);
        self.settled.compute(simd, tree, &self.bundle, count);
        for id in 0..count.min(RAYS) {
            if self.bundle.hit[id][0] != NONE {
                let t = self.settled.t[id];
                // They disagree if t is beyond the tested range, far less, out of the ray's range, or NaN.
                let agree = t <= f64::from(self.bundle.t[id] * AGREES + self.bundle.doubt)
                    && t >= f64::from(self.bundle.t[id] / SLACK - self.bundle.doubt)
                    && t >= f64::from(self.bundle.range[0][id])
                    && t <= f64::from(self.bundle.range[1][id]);
                self.alone.push_if(id, !agree);
            }
        }
        for index in 0..self.alone.length.min(RAYS) {
            let id = usize::from(self.alone.ids[index]) % RAYS;
            self.walk_alone(simd, tree, id, cull_back);
        }
    }

    /// Finds out whether each of the first `count` rays of the bundle, which must be prepared, hits anything. Its slot
    /// is then that of any of the triangles that it hits.
    #[inline(always)]
    pub(super) fn any_hits<S: Simd>(&mut self, simd: S, tree: MeshTree<'_>, count: usize, cull_back: bool) {
        self.walk::<true, S>(simd, tree, count, cull_back);
        self.settled.compute(simd, tree, &self.bundle, count);
        for id in 0..count.min(RAYS) {
            if self.bundle.hit[id][0] != NONE {
                // Out of range after all, or the ray runs along the plane: single precision may then have found a hit
                // anywhere.
                let t = self.settled.t[id];
                let sure = t >= f64::from(self.bundle.range[0][id])
                    && t <= f64::from(self.bundle.range[1][id])
                    && self.settled.sine(&self.bundle, id).abs() > LEAST_SINE;
                if !sure {
                    self.bundle.hit[id][0] = NONE;
                    self.alone.push_if(id, true);
                }
            }
        }
        for index in 0..self.alone.length.min(RAYS) {
            let id = usize::from(self.alone.ids[index]) % RAYS;
            if self.bundle.hit[id][0] == NONE {
                self.walk_alone(simd, tree, id, cull_back);
            }
        }
    }

    /// Traverses the tree, for any hit or for the nearest, and stores the hits in single precision.
    #[inline(always)]
    fn walk<const ANY: bool, S: Simd>(&mut self, simd: S, tree: MeshTree<'_>, count: usize, cull_back: bool) {
        let mut nodes = Queue::EMPTY;
        let mut leaves = Queue::EMPTY;
        self.alone.length = 0;
        for id in 0..count.min(RAYS) {
            (self.depth[id], self.child[id]) = (1, 0);
            // The end, which is left when no other child waits. It is never too far.
            (self.room.near[0][id].0[0], self.room.node[0][id]) = (f32::NEG_INFINITY, NONE);
            nodes.push_if(id, true);
        }
        while nodes.length + leaves.length > 0 {
            for &id in nodes.ids() {
                self.enter_node(simd, tree, usize::from(id) % RAYS);
            }
            for &id in leaves.ids() {
                self.test_leaf(simd, tree, usize::from(id) % RAYS, cull_back);
            }
            for &id in leaves.ids() {
                if ANY {
                    self.take_any(simd, tree, usize::from(id) % RAYS);
                } else {
                    self.take_nearest(simd, tree, usize::from(id) % RAYS);
                }
            }
            let (mut more_nodes, mut more_leaves) = (Queue::EMPTY, Queue::EMPTY);
            for &id in nodes.ids() {
                self.next_child(simd, tree, usize::from(id) % RAYS, &mut more_nodes, &mut more_leaves);
            }
            for &id in leaves.ids() {
                self.next_child(simd, tree, usize::from(id) % RAYS, &mut more_nodes, &mut more_leaves);
            }
            (nodes, leaves) = (more_nodes, more_leaves);
        }
    }

    /// Memory for tracing a single ray through a tree, while no other rays are being traced.
    #[inline(always)]
    pub(crate) fn stack(&mut self) -> &mut Stack {
        bytemuck::cast_slice_mut(&mut self.room.near)
    }

    #[inline(always)]
    fn walk_alone<S: Simd>(&mut self, simd: S, tree: MeshTree<'_>, id: usize, cull_back: bool) {
        let ray = self.bundle.ray(id);
        let mut nearest = Nearest::none(&ray);
        nearest_in_tree(simd, tree, &ray, cull_back, self.stack(), &mut nearest);
        self.bundle.hit[id][0] = nearest.slot;
        self.settled.t[id] = nearest.t;
        self.settled.take_normal(tree, id, nearest.slot);
    }

    /// Adds the children of the next node to the waiting ones.
    #[inline(always)]
    fn enter_node<S: Simd>(&mut self, simd: S, tree: MeshTree<'_>, id: usize) {
        let Some(node) = tree.nodes.get(self.child[id] as usize) else { return };
        let depth = self.depth[id] as usize;
        let (near, any) =
            node::enter(simd, node, &self.bundle, id, self.bundle.t[id] * AGREES + self.bundle.doubt);
        near.store_array(&mut self.room.near[depth % LEVELS][id].0);
        self.room.node[depth % LEVELS][id] = self.child[id];
        self.depth[id] = depth as u32 + u32::from(any);
    }

    /// Computes where the ray hits the triangles of the next leaf.
    #[inline(always)]
    fn test_leaf<S: Simd>(&mut self, simd: S, tree: MeshTree<'_>, id: usize, cull_back: bool) {
        let Some(block) = tree.blocks.get((self.child[id] & !LEAF) as usize) else { return };
        let t = block::meet_lane(simd, block, &self.bundle, id, cull_back);
        t.store_array(&mut self.room.leaf[id].0);
    }

    /// Stores the nearest triangle of the leaf.
    #[inline(always)]
    fn take_nearest<S: Simd>(&mut self, simd: S, tree: MeshTree<'_>, id: usize) {
        let t = f32x16::load_array_ref(simd, &self.room.leaf[id].0);
        let least = t.reduce_min();
        // The first of the triangles within the slack; if there are several, they are compared.
        let limit = least * SLACK + self.bundle.doubt;
        let near = t.simd_le(f32x16::splat(simd, limit)).to_bitmask() as u32 & 0xffff;
        let before = self.bundle.t[id];
        let hit = least < f32::INFINITY;
        if hit & ((near & near.wrapping_sub(1) != 0) | (limit >= before)) {
            self.compare(&tree, id, near);
            return;
        }
        self.bundle.t[id] = if least < before { least } else { before };
        let slot = (self.child[id] & !LEAF) * WIDTH as u32 + near.trailing_zeros() % WIDTH as u32;
        self.bundle.hit[id][usize::from(!hit)] = slot;
    }

    /// Ends the traversal of a ray that hits a triangle of the leaf.
    #[inline(always)]
    fn take_any<S: Simd>(&mut self, simd: S, tree: MeshTree<'_>, id: usize) {
        let t = f32x16::load_array_ref(simd, &self.room.leaf[id].0);
        let (from, to) = (self.bundle.range[0][id], self.bundle.range[1][id]);
        // Certain hits: further inside the range than the error of single precision.
        let to = if to < f32::MAX { to / SLACK - self.bundle.doubt } else { f32::MAX };
        let sure = t.simd_gt(f32x16::splat(simd, from + (from - self.bundle.least[id])))
            & t.simd_lt(f32x16::splat(simd, to));
        let sure = sure.to_bitmask() as u32 & 0xffff;
        let met = t.simd_lt(f32x16::splat(simd, f32::INFINITY)).to_bitmask() as u32 & 0xffff;
        if (sure == 0) & (met != 0) {
            self.compare(&tree, id, met);
            self.depth[id] = if self.bundle.hit[id][0] == NONE { self.depth[id] } else { 1 };
            self.bundle.t[id] = self.bundle.range[1][id];
            return;
        }
        let slot = (self.child[id] & !LEAF) * WIDTH as u32 + sure.trailing_zeros() % WIDTH as u32;
        self.bundle.hit[id][usize::from(sure == 0)] = slot;
        self.depth[id] = if sure == 0 { self.depth[id] } else { 1 };
    }

    /// Takes the nearest waiting child of the deepest node, and queues the ray for it.
    #[inline(always)]
    fn next_child<S: Simd>(
        &mut self,
        simd: S,
        tree: MeshTree<'_>,
        id: usize,
        nodes: &mut Queue,
        leaves: &mut Queue,
    ) {
        let limit = self.bundle.t[id] * AGREES + self.bundle.doubt;
        let limit = if limit < f32::MAX { limit } else { f32::MAX };
        let mut depth = self.depth[id] as usize;
        if depth >= LEVELS {
            self.alone.push_if(id, true);
            return;
        }
        loop {
            depth = depth.wrapping_sub(1) % LEVELS;
            let waiting = &mut self.room.near[depth][id].0;
            let near = f32x16::load_array_ref(simd, waiting);
            let least = near.reduce_min();
            // The end is always near enough.
            if least <= limit || depth == 0 {
                let wait = near.simd_le(f32x16::splat(simd, limit)).to_bitmask() as u32 & 0xffff;
                let nearest = near.simd_eq(f32x16::splat(simd, least)).to_bitmask() as u32;
                let lane = nearest.trailing_zeros() as usize % WIDTH;
                waiting[lane] = f32::INFINITY;
                let child =
                    tree.nodes.get(self.room.node[depth][id] as usize).map_or(NONE, |node| node.child[lane]);
                self.child[id] = child;
                leaves.push_if(id, (child & LEAF != 0) & (child != NONE));
                nodes.push_if(id, child & LEAF == 0);
                self.depth[id] = depth as u32 + u32::from(wait & wait.wrapping_sub(1) != 0);
                return;
            }
        }
    }

    /// Decides between the hit so far and triangles at about the same distance, in double precision.
    #[inline(never)]
    fn compare(&mut self, tree: &MeshTree<'_>, id: usize, mask: u32) {
        let index = self.child[id] & !LEAF;
        let ray = self.bundle.ray(id);
        let mut nearest = Nearest::none(&ray);
        let hit = self.bundle.hit[id][0];
        if let Some(block) = tree.blocks.get(hit as usize / WIDTH) {
            nearest.offer(&ray, block::exact_distance(block, hit as usize % WIDTH, &ray), hit);
        }
        if let Some(block) = tree.blocks.get(index as usize) {
            block::offer(block, index, mask, &ray, &mut nearest);
        }
        if nearest.slot != NONE {
            (self.bundle.t[id], self.bundle.hit[id][0]) = (nearest.t as f32, nearest.slot);
        }
    }
}
