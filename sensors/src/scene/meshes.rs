//! Meshes and their trees in memory that the caller provides, for scenes without a heap.

use super::build::facets::fill_facets;
use super::build::plan::plan;
use super::build::quality::Quality;
use super::build::{Scratch, TreeSize};
use super::tree::{Facet, TriangleBlock, WideNode};
use super::{Mesh, MeshId, MeshSlices, SceneError, SceneFault, check, limits};
use crate::Execution;
use crate::simd::WIDTH;
use glam::DVec3;

/// Slots are counted in 32 bits, sixteen per block.
const MOST_BLOCKS: usize = 1 << (32 - WIDTH.ilog2());

/// Meshes with their trees, from a [`MeshStore`] or from elsewhere and then [checked](Meshes::new).
#[derive(Debug, Clone, Copy, Default)]
pub struct Meshes<'a>(MeshSlices<'a>);

impl<'a> Meshes<'a> {
    /// Checks and borrows stored meshes, such as a table that was generated at compile time.
    ///
    /// Everything that tracing relies on is checked, in time proportional to the length. `scratch` must hold
    /// [`Meshes::scratch_len`] words.
    ///
    /// # Errors
    /// [`SceneFault`] names the slice, the element and what is wrong.
    pub fn new(slices: MeshSlices<'a>, scratch: &mut [u32]) -> Result<Self, SceneFault> {
        check::meshes(&slices, scratch)?;
        Ok(Self(slices))
    }

    /// The slices of the meshes.
    pub fn slices(&self) -> MeshSlices<'a> {
        self.0
    }

    /// Number of words of scratch memory that [`Meshes::new`] needs.
    pub fn scratch_len(meshes: &[Mesh]) -> usize {
        check::scratch_len(meshes)
    }
}

/// The memory into which meshes are built, large enough for all meshes together.
#[derive(Debug, Default)]
pub struct MeshMemory<'a> {
    /// One entry per mesh.
    pub meshes: &'a mut [Mesh],
    /// Texture coordinates, one per vertex.
    pub uvs: &'a mut [[f32; 2]],
    /// Normals, one per vertex; empty if no mesh has normals.
    pub normals: &'a mut [[f32; 3]],
    /// One entry per triangle.
    pub triangles: &'a mut [[u32; 3]],
    /// Nodes of the trees: the sum of [`max_size`](super::build::max_size) over the meshes is always enough.
    pub nodes: &'a mut [WideNode],
    /// Blocks of the trees: the sum of [`max_size`](super::build::max_size) over the meshes is always enough.
    pub blocks: &'a mut [TriangleBlock],
    /// Facets, sixteen per block.
    pub facets: &'a mut [Facet],
    /// Working memory: [`scratch_len`](super::build::scratch_len) of the largest mesh. Not used after the meshes are
    /// built.
    pub scratch: &'a mut [Scratch],
}

/// Builds meshes one after the other into slices that the caller provides, as a [`SceneBuilder`](super::SceneBuilder)
/// does on the heap. The trees are bit for bit the same. See [`SceneSlices`](super::SceneSlices) for an example.
#[derive(Debug, Default)]
pub struct MeshStore<'a> {
    memory: MeshMemory<'a>,
    meshes: usize,
    vertices: usize,
    triangles: usize,
    size: TreeSize,
}

impl<'a> MeshStore<'a> {
    /// Creates an empty store that builds into `memory`.
    pub fn new(memory: MeshMemory<'a>) -> Self {
        Self { memory, ..Self::default() }
    }

    /// Adds triangles, counter-clockwise seen from outside, and builds their tree. `uvs` holds one texture coordinate
    /// per vertex, or is empty.
    ///
    /// # Errors
    /// [`SceneError::BadVertex`], [`SceneError::VertexTooFar`], [`SceneError::BadTriangle`] with the index of the
    /// element, [`SceneError::TooMany`] if 32 bits cannot count the elements, [`SceneError::UvCount`],
    /// [`SceneError::BadUv`], and [`SceneError::BufferTooSmall`] with the name of the slice of [`MeshMemory`] and the
    /// number of elements that it must have. After an error, the store holds the same meshes as before.
    pub fn add(
        &mut self,
        positions: &[[f32; 3]],
        uvs: &[[f32; 2]],
        triangles: &[[u32; 3]],
        execution: Execution,
    ) -> Result<MeshId, SceneError> {
        limits::uvs(uvs, positions.len())?;
        let Self { memory, size: before, .. } = self;
        let plan = plan(positions, triangles, Quality::High, execution, memory.scratch)?;
        let TreeSize { nodes, blocks } = plan.size();
        let after = TreeSize { nodes: before.nodes + nodes, blocks: before.blocks + blocks };
        if after.blocks >= MOST_BLOCKS || after.nodes > u32::MAX as usize {
            return Err(SceneError::TooMany);
        }
        let place = &mut part("meshes", memory.meshes, self.meshes, 1)?[0];
        let own_uvs = part("uvs", memory.uvs, self.vertices, positions.len())?;
        let smooth = !memory.normals.is_empty();
        let of_normals = if smooth { positions.len() } else { 0 };
        let own_normals =
            part("normals", memory.normals, if smooth { self.vertices } else { 0 }, of_normals)?;
        let own_triangles = part("triangles", memory.triangles, self.triangles, triangles.len())?;
        let own_nodes = part("nodes", memory.nodes, before.nodes, nodes)?;
        let own_blocks = part("blocks", memory.blocks, before.blocks, blocks)?;
        let own_facets = part("facets", memory.facets, before.blocks * WIDTH, blocks * WIDTH)?;

        plan.write(own_nodes, own_blocks)?;
        fill_facets(own_blocks, execution, own_facets);
        if uvs.is_empty() {
            own_uvs.fill([0.0; 2]);
        } else {
            own_uvs.copy_from_slice(uvs);
        }
        own_normals.fill([0.0; 3]);
        own_triangles.copy_from_slice(triangles);
        let [min, max] = own_nodes[0].bounds();
        *place = Mesh {
            first_vertex: self.vertices as u32,
            vertices: positions.len() as u32,
            first_triangle: self.triangles as u32,
            triangles: triangles.len() as u32,
            first_node: before.nodes as u32,
            nodes: nodes as u32,
            first_block: before.blocks as u32,
            blocks: blocks as u32,
            min,
            max,
        };
        let id = MeshId(self.meshes as u32);
        (self.meshes, self.size) = (self.meshes + 1, after);
        (self.vertices, self.triangles) = (self.vertices + positions.len(), self.triangles + triangles.len());
        Ok(id)
    }

    /// Sets the normals of the vertices of a mesh, of any length but 0, between which shading interpolates. With an
    /// empty slice, the mesh becomes flat again, as it is when it is added.
    ///
    /// # Errors
    /// [`SceneError::NoSuchMesh`], [`SceneError::NormalCount`], [`SceneError::BadNormal`], and
    /// [`SceneError::BufferTooSmall`] if [`MeshMemory::normals`] does not have an element for each vertex.
    pub fn set_normals(&mut self, mesh: MeshId, normals: &[[f32; 3]]) -> Result<(), SceneError> {
        let Self { memory, meshes, vertices, .. } = self;
        let of = memory.meshes[..*meshes].get(mesh.0 as usize).ok_or(SceneError::NoSuchMesh(mesh.0))?;
        limits::normals(normals, of.vertices as usize)?;
        if normals.is_empty() && memory.normals.is_empty() {
            return Ok(());
        }
        let all = part("normals", memory.normals, 0, *vertices)?;
        store_normals(normals, &mut all[of.first_vertex as usize..][..of.vertices as usize]);
        Ok(())
    }

    /// Returns the meshes that were added, for use in a scene.
    pub fn meshes(&self) -> Meshes<'_> {
        let Self { memory, meshes, vertices, triangles, size } = self;
        Meshes(MeshSlices {
            meshes: &memory.meshes[..*meshes],
            uvs: &memory.uvs[..*vertices],
            normals: memory.normals.get(..*vertices).unwrap_or_default(),
            triangles: &memory.triangles[..*triangles],
            nodes: &memory.nodes[..size.nodes],
            blocks: &memory.blocks[..size.blocks],
            facets: &memory.facets[..size.blocks * WIDTH],
        })
    }
}

/// Stores the normals of a mesh with length 1, or 0 for all of its vertices if none are given.
pub(super) fn store_normals(normals: &[[f32; 3]], own: &mut [[f32; 3]]) {
    own.fill([0.0; 3]);
    for (own, normal) in own.iter_mut().zip(normals) {
        // In double precision, no square of a number of single precision overflows, or becomes 0.
        let normal = DVec3::from_array(normal.map(f64::from));
        *own = (normal / normal.length()).as_vec3().to_array();
    }
}

/// The `count` elements from `first` on.
fn part<'a, T>(
    buffer: &'static str,
    memory: &'a mut [T],
    first: usize,
    count: usize,
) -> Result<&'a mut [T], SceneError> {
    let (have, need) = (memory.len(), first + count);
    memory.get_mut(first..need).ok_or(SceneError::BufferTooSmall { buffer, have, need })
}
