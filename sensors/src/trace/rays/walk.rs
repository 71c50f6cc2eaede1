//! The way of one ray through a mesh's tree, front to back.

use super::block::{self, SLACK};
use super::node;
use super::ray::{Nearest, Ray};
use crate::scene::HeightGrid;
use crate::scene::tree::{LEAF, MAX_DEPTH, TriangleBlock, WideNode};
use crate::simd::WIDTH;
use bytemuck::{Pod, Zeroable};
use core::borrow::Borrow;
use fearless_simd::{Simd, SimdBase, f32x16, prelude::*, u32x16};

/// Room for the children that wait: fifteen a level, and sixteen that are being sorted in.
pub(super) const STACK: usize = (WIDTH - 1) * MAX_DEPTH + WIDTH;

/// The tree of one mesh.
#[derive(Debug, Clone, Copy)]
pub struct MeshTree<'a> {
    /// Boxes; the first is the root.
    pub nodes: &'a [WideNode],
    /// Triangles.
    pub blocks: &'a [TriangleBlock],
}

/// A child that waits: its entry distance's bits, and itself.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Waiting {
    key: u32,
    child: u32,
}

impl Waiting {
    pub(super) const NONE: Self = Self { key: 0, child: 0 };
}

/// Children that wait, the nearest of each node on top: memory of [`STACK`] or more, whatever is in it.
pub(crate) type Stack = [Waiting];

/// What can be walked: nodes of children, leaves of triangles.
pub(crate) trait Branches: Copy {
    /// A node, lent or made.
    type Node: core::borrow::Borrow<WideNode>;
    /// A leaf, lent or made.
    type Block: core::borrow::Borrow<TriangleBlock>;
    /// The node of that index.
    fn node(self, index: u32) -> Option<Self::Node>;
    /// The leaf of that index.
    fn block(self, index: u32) -> Option<Self::Block>;
}

impl<'a> Branches for MeshTree<'a> {
    type Node = &'a WideNode;
    type Block = &'a TriangleBlock;

    #[inline(always)]
    fn node(self, index: u32) -> Option<&'a WideNode> {
        self.nodes.get(index as usize)
    }

    #[inline(always)]
    fn block(self, index: u32) -> Option<&'a TriangleBlock> {
        self.blocks.get(index as usize)
    }
}

impl Branches for &HeightGrid<'_> {
    type Node = WideNode;
    type Block = TriangleBlock;

    #[inline(always)]
    fn node(self, index: u32) -> Option<WideNode> {
        Some(HeightGrid::node(self, index))
    }

    #[inline(always)]
    fn block(self, index: u32) -> Option<TriangleBlock> {
        (index < self.field().blocks()).then(|| HeightGrid::block(self, index))
    }
}

/// Finds the nearest hit of the ray on the triangles of a tree that is nearer than `nearest`.
#[inline(always)]
pub(crate) fn nearest_in_tree<S: Simd>(
    simd: S,
    tree: impl Branches,
    ray: &Ray,
    cull_back: bool,
    stack: &mut Stack,
    nearest: &mut Nearest,
) {
    children_of(
        simd,
        tree,
        ray,
        stack,
        #[inline(always)]
        |index| {
            if let Some(block) = tree.block(index) {
                let block = block.borrow();
                let (_, mask) =
                    block::meet_all(simd, block, ray, nearest.limit * SLACK + ray.doubt, cull_back);
                block::offer(block, index, mask, ray, nearest);
            }
            nearest.limit
        },
    );
}

/// Walks a tree front to back, and calls `leaf` for each leaf that the ray meets before the limit, in t, that it
/// returned last; that is the end of the ray's range at first.
#[inline(always)]
pub(crate) fn children_of<S: Simd>(
    simd: S,
    tree: impl Branches,
    ray: &Ray,
    stack: &mut Stack,
    mut leaf: impl FnMut(u32) -> f32,
) {
    let mut limit = ray.range[1];
    let mut child = 0_u32;
    let mut top = 0_usize;
    loop {
        if child & LEAF != 0 {
            limit = leaf(child & !LEAF);
        } else if let Some(node) = tree.node(child) {
            let node = node.borrow();
            let (near, mask) = node::meet(simd, node, ray, limit);
            if mask != 0 {
                if mask.is_power_of_two() {
                    child = node.child[mask.trailing_zeros() as usize % WIDTH];
                    continue;
                }
                top = push(simd, node, near, mask, stack, top);
            }
        }
        loop {
            if top == 0 {
                return;
            }
            top -= 1;
            let waiting = stack[top];
            if f32::from_bits(waiting.key) <= limit {
                child = waiting.child;
                break;
            }
        }
    }
}

/// Puts the children of the mask on the stack, the nearest on top, and returns the new top. The rank of each is
/// the number of those that are nearer: no branch depends on the order.
#[inline(always)]
fn push<S: Simd>(
    simd: S,
    node: &WideNode,
    near: f32x16<S>,
    mask: u32,
    stack: &mut Stack,
    top: usize,
) -> usize {
    let count = mask.count_ones() as usize;
    let Some(room) = stack.get_mut(top..top + WIDTH) else { return top };
    // t ≥ 0 orders like its bits (a negative t_min makes them large, which costs order, not hits); the lane in the
    // last four makes them differ.
    let lanes = u32x16::load_array_ref(simd, &LANE_NUMBERS);
    let keys = (near.bitcast::<u32x16<S>>() & !15_u32) | lanes;
    let array: [u32; WIDTH] = keys.into();
    let mut rest = mask;
    while rest != 0 {
        let lane = rest.trailing_zeros() as usize % WIDTH;
        rest &= rest - 1;
        let farther = keys.simd_gt(u32x16::splat(simd, array[lane])).to_bitmask() as u32 & mask;
        room[farther.count_ones() as usize % WIDTH] =
            Waiting { key: array[lane] & !15, child: node.child[lane] };
    }
    top + count
}

const LANE_NUMBERS: [u32; WIDTH] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];
