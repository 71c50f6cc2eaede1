//! The slices that store meshes.

use super::Mesh;
use super::tree::{Facet, TriangleBlock, WideNode};

/// The slices that store meshes. In each slice, the parts of the meshes are consecutive, in the order of the meshes.
#[derive(Debug, Clone, Copy, Default)]
pub struct MeshSlices<'a> {
    /// One entry per mesh.
    pub meshes: &'a [Mesh],
    /// Texture coordinates, one per vertex.
    pub uvs: &'a [[f32; 2]],
    /// Unit normals for shading, one per vertex, and 0 for all vertices of a mesh without normals; or empty, if no mesh
    /// has normals.
    pub normals: &'a [[f32; 3]],
    /// Vertex indices of the triangles, counted from the first vertex of the mesh.
    pub triangles: &'a [[u32; 3]],
    /// Nodes of the trees.
    pub nodes: &'a [WideNode],
    /// Leaves of the trees.
    pub blocks: &'a [TriangleBlock],
    /// Facets, sixteen per block.
    pub facets: &'a [Facet],
}
