//! The tree of a mesh as it lies in memory: sixteen boxes to a node, sixteen triangles to a leaf.
//!
//! Both are structures of arrays of sixteen, the number of lanes that every kernel works on at every SIMD level,
//! so the layout never depends on the machine. Coordinates are metres in the frame of the mesh.

use crate::simd::WIDTH;
use bytemuck::{Pod, Zeroable};

/// No child, no triangle: what fills the lanes that a node or leaf does not need.
pub const NONE: u32 = u32::MAX;

/// Set in a child that is a leaf; the rest is then its index among the mesh's leaves, else among its nodes.
pub const LEAF: u32 = 1 << 31;

/// No path from the root of a tree to a node has more nodes than this; a stack of `MAX_DEPTH * 15 + 1` nodes is
/// always enough to walk it.
pub const MAX_DEPTH: usize = 64;

/// Boxes of up to sixteen children. Unused lanes come last: they repeat the box of the last child, and their
/// `child` is [`NONE`]. A tree's root is its first node, and always there: without triangles it has no child.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct WideNode {
    /// Lower corners: all x, all y, all z.
    pub min: [[f32; WIDTH]; 3],
    /// Upper corners.
    pub max: [[f32; WIDTH]; 3],
    /// Index of a node, or of a leaf with [`LEAF`] set, or [`NONE`]. Children come after their parents.
    pub child: [u32; WIDTH],
}

impl WideNode {
    /// Corners of the box that holds the children; both 0 for the root of an empty tree.
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        // Unused lanes repeat the last child's box.
        let least = |values: &[f32; WIDTH]| values.iter().copied().fold(f32::INFINITY, f32::min);
        let most = |values: &[f32; WIDTH]| values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        [self.min.each_ref().map(least), self.max.each_ref().map(most)]
    }
}

/// Up to sixteen triangles. Unused lanes come last; they hold a triangle without area, which nothing hits, made
/// of the first corner of the last one, and their `triangle` is [`NONE`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct TriangleBlock {
    /// `corners[corner][axis][lane]`, bit for bit the vertices of the mesh.
    pub corners: [[[f32; WIDTH]; 3]; 3],
    /// Index of the triangle in its mesh, in the caller's order.
    pub triangle: [u32; WIDTH],
}

/// What is known of a triangle besides its corners: one for each lane of each block.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Facet {
    /// Unit, outwards, in the frame of the mesh; 0 for a triangle without area.
    pub normal: [f32; 3],
    /// As in [`TriangleBlock::triangle`].
    pub triangle: u32,
}

const _: () = assert!(size_of::<WideNode>() == 448 && size_of::<TriangleBlock>() == 640);
