//! The slices that meshes lie in.

use super::Mesh;
use super::tree::{Facet, TriangleBlock, WideNode};

/// The slices of meshes, each mesh's part behind that of the one before.
#[derive(Debug, Clone, Copy, Default)]
pub struct MeshSlices<'a> {
    /// One a mesh.
    pub meshes: &'a [Mesh],
    /// One a vertex.
    pub uvs: &'a [[f32; 2]],
    /// Vertices, counted from the first of their mesh.
    pub triangles: &'a [[u32; 3]],
    /// The nodes of the trees.
    pub nodes: &'a [WideNode],
    /// Their leaves.
    pub blocks: &'a [TriangleBlock],
    /// Sixteen for each block.
    pub facets: &'a [Facet],
}
