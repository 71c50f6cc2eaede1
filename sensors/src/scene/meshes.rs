//! Meshes and their trees in memory of the caller's: for scenes without a heap.

use super::build::{Quality, Scratch, TreeSize, fill_facets, plan};
use super::tree::{Facet, TriangleBlock, WideNode};
use super::{Mesh, MeshId, MeshSlices, SceneError, SceneFault, check, limits};
use crate::Execution;
use crate::simd::WIDTH;

/// Slots are counted in 32 bits, sixteen to a block.
const MOST_BLOCKS: usize = 1 << (32 - WIDTH.ilog2());

/// Meshes with their trees: those of a [`MeshStore`], or from elsewhere and [checked](Meshes::new).
#[derive(Debug, Clone, Copy, Default)]
pub struct Meshes<'a>(MeshSlices<'a>);

impl<'a> Meshes<'a> {
    /// Takes meshes that somebody else has stored, such as those of a table that was made when a program was compiled.
    /// All is checked that tracing relies on, at a cost in proportion to the length. `scratch` is as long as
    /// [`Meshes::scratch_len`] says.
    ///
    /// # Errors
    /// [`SceneFault`] names the slice, the element and what is wrong with it.
    pub fn new(slices: MeshSlices<'a>, scratch: &mut [u32]) -> Result<Self, SceneFault> {
        check::meshes(&slices, scratch)?;
        Ok(Self(slices))
    }

    /// The slices.
    pub fn slices(&self) -> MeshSlices<'a> {
        self.0
    }

    /// Words that [`Meshes::new`] works in.
    pub fn scratch_len(meshes: &[Mesh]) -> usize {
        check::scratch_len(meshes)
    }
}

/// The memory that meshes are built into: what each holds at the most, in all meshes together.
#[derive(Debug, Default)]
pub struct MeshMemory<'a> {
    /// One a mesh.
    pub meshes: &'a mut [Mesh],
    /// One a vertex.
    pub uvs: &'a mut [[f32; 2]],
    /// One a triangle.
    pub triangles: &'a mut [[u32; 3]],
    /// [`max_size`](super::build::max_size) of each mesh is always enough.
    pub nodes: &'a mut [WideNode],
    /// Of these too.
    pub blocks: &'a mut [TriangleBlock],
    /// Sixteen for each block.
    pub facets: &'a mut [Facet],
    /// What the largest mesh needs by [`scratch_len`](super::build::scratch_len); not used afterwards.
    pub scratch: &'a mut [Scratch],
}

/// Builds meshes into slices of the caller's, one after the other: what a [`SceneBuilder`](super::SceneBuilder) does with
/// a heap. The trees are the same, to the last bit. An example is at [`SceneSlices`](super::SceneSlices).
#[derive(Debug, Default)]
pub struct MeshStore<'a> {
    memory: MeshMemory<'a>,
    meshes: usize,
    vertices: usize,
    triangles: usize,
    size: TreeSize,
}

impl<'a> MeshStore<'a> {
    /// With room for meshes, and none yet.
    pub fn new(memory: MeshMemory<'a>) -> Self {
        Self { memory, ..Self::default() }
    }

    /// Takes in triangles, counter-clockwise seen from outside, and builds their tree. `uvs` holds one texture
    /// coordinate per vertex, or none at all.
    ///
    /// # Errors
    /// Those of [`plan`], [`SceneError::UvCount`], [`SceneError::BadUv`], [`SceneError::BufferTooSmall`] with the name of
    /// the slice of [`MeshMemory`] and the elements that it must have; the meshes are those of before then.
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

    /// The meshes that were added, for a scene.
    pub fn meshes(&self) -> Meshes<'_> {
        let Self { memory, meshes, vertices, triangles, size } = self;
        Meshes(MeshSlices {
            meshes: &memory.meshes[..*meshes],
            uvs: &memory.uvs[..*vertices],
            triangles: &memory.triangles[..*triangles],
            nodes: &memory.nodes[..size.nodes],
            blocks: &memory.blocks[..size.blocks],
            facets: &memory.facets[..size.blocks * WIDTH],
        })
    }
}

/// So many elements from `first` on.
fn part<'a, T>(
    buffer: &'static str,
    memory: &'a mut [T],
    first: usize,
    count: usize,
) -> Result<&'a mut [T], SceneError> {
    let (have, need) = (memory.len(), first + count);
    memory.get_mut(first..need).ok_or(SceneError::BufferTooSmall { buffer, have, need })
}
