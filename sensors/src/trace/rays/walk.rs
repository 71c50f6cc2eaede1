//! Traversal of a mesh's tree by one ray, front to back.

use super::block::{self, SLACK};
use super::node;
use super::ray::{Nearest, Ray};
use crate::scene::HeightGrid;
use crate::scene::tree::{LEAF, MAX_DEPTH, TriangleBlock, WideNode};
use crate::simd::WIDTH;
use bytemuck::{Pod, Zeroable};
use core::borrow::Borrow;
use fearless_simd::{Simd, SimdBase, f32x16, prelude::*, u32x16};

/// The number of stack entries: fifteen waiting children per level, and sixteen that are being sorted.
pub(super) const STACK: usize = (WIDTH - 1) * MAX_DEPTH + WIDTH;

/// The tree of one mesh.
#[derive(Debug, Clone, Copy)]
pub struct MeshTree<'a> {
    /// The nodes with their boxes; the first is the root.
    pub nodes: &'a [WideNode],
    /// The leaves with their triangles.
    pub blocks: &'a [TriangleBlock],
}

/// A waiting child: the bits of its entry distance, and its index.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Waiting {
    key: u32,
    child: u32,
}

impl Waiting {
    pub(super) const NONE: Self = Self { key: 0, child: 0 };
}

/// The waiting children, with the nearest of each node on top. At least [`STACK`] entries, whose previous contents do
/// not matter.
pub(crate) type Stack = [Waiting];

/// A tree that can be traversed: nodes with children, leaves with triangles.
pub(crate) trait Branches: Copy {
    /// A node, borrowed or generated.
    type Node: core::borrow::Borrow<WideNode>;
    /// A leaf, borrowed or generated.
    type Block: core::borrow::Borrow<TriangleBlock>;
    /// The node with this index.
    fn node(self, index: u32) -> Option<Self::Node>;
    /// The leaf with this index.
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

/// Finds the nearest hit of the ray on the triangles of a tree, if it is nearer than `nearest`.
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

/// Traverses a tree front to back, and calls `leaf` for each leaf that the ray hits before the limit. The limit is the
/// value of t that `leaf` returned last, and at first the end of the ray's range.
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

/// Pushes the children of the mask, with the nearest on top, and returns the new number of entries. The position of
/// each is the number of nearer children, so no branch depends on the order.
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
    // t ≥ 0 has the same order as its bits. (A negative t_min makes them large, which changes the order, but loses no
    // hits.) The lane in the last four bits makes them distinct.
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
