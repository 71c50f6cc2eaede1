//! The memory layout of the tree of a mesh: sixteen boxes per node, sixteen triangles per leaf.
//!
//! Both are structures of arrays of sixteen, the number of lanes of every kernel at every SIMD level, so the layout
//! does not depend on the machine. Coordinates are metres in the frame of the mesh.
//!
//! A program without a heap makes arrays of [`WideNode`], [`TriangleBlock`] and [`Facet`] for a
//! [`MeshStore`](super::MeshStore). Only that, and their being plain data, is covered by semantic versioning: fields,
//! sizes and constants change when the trees do.

use crate::simd::WIDTH;
use bytemuck::{Pod, Zeroable};

/// Marks the unused lanes of a node or leaf: no child, or no triangle.
pub const NONE: u32 = u32::MAX;

/// Flag of a child that is a leaf. The remaining bits are then its index among the mesh's leaves, otherwise among its
/// nodes.
pub const LEAF: u32 = 1 << 31;

/// The greatest number of nodes on a path from the root of a tree to a node. A stack of `MAX_DEPTH * 15 + 1` nodes is
/// always enough to traverse the tree.
pub const MAX_DEPTH: usize = 64;

/// A node with the boxes of up to sixteen children. Unused lanes come last: they repeat the box of the last child, and
/// their `child` is [`NONE`]. The first node of a tree is its root; it always exists, and without triangles it has no
/// child.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct WideNode {
    /// Lower corners of the boxes: all x, all y, all z.
    pub min: [[f32; WIDTH]; 3],
    /// Upper corners of the boxes, in the same order.
    pub max: [[f32; WIDTH]; 3],
    /// Children: the index of a node, or of a leaf with [`LEAF`] set, or [`NONE`]. Children come after their parents.
    pub child: [u32; WIDTH],
}

impl WideNode {
    /// Corners of the bounding box of the children; both 0 for the root of an empty tree.
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        // Unused lanes repeat the last child's box.
        let least = |values: &[f32; WIDTH]| values.iter().copied().fold(f32::INFINITY, f32::min);
        let most = |values: &[f32; WIDTH]| values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        [self.min.each_ref().map(least), self.max.each_ref().map(most)]
    }
}

/// A leaf of up to sixteen triangles. Unused lanes come last: their `triangle` is [`NONE`], and all three corners are
/// the first corner of the last used triangle, so that no ray hits them.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct TriangleBlock {
    /// `corners[corner][axis][lane]`: bit for bit the vertices of the mesh.
    pub corners: [[[f32; WIDTH]; 3]; 3],
    /// Index of the triangle in its mesh, in the order in which the triangles were given.
    pub triangle: [u32; WIDTH],
}

/// The normal of a triangle: one for each lane of each block.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Facet {
    /// Unit normal, pointing outwards, in the frame of the mesh; 0 for a triangle without area.
    pub normal: [f32; 3],
    /// Index of the triangle, as in [`TriangleBlock::triangle`].
    pub triangle: u32,
}

const _: () = assert!(size_of::<WideNode>() == 448 && size_of::<TriangleBlock>() == 640);
