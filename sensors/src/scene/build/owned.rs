//! A tree that owns its memory.

use super::facets::fill_facets;
use super::plan::plan;
use super::quality::Quality;
use super::refit::refit;
use super::{Scratch, scratch_len};
use crate::Execution;
use crate::scene::SceneError;
use crate::scene::tree::{Facet, TriangleBlock, WideNode};
use crate::scene::validate::{TreeFault, validate_scratch_len, validate_tree};
use crate::simd::WIDTH;
use alloc::vec::Vec;
use bytemuck::allocation::zeroed_vec;

/// The tree of a mesh: its nodes and blocks.
///
/// ```
/// use belvedere_sensors::{Execution, scene::build::{Quality, Tree}};
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
/// let tree = Tree::build(&corners, &faces, Quality::High, Execution::default())?;
/// assert_eq!((tree.nodes.len(), tree.blocks.len()), (1, 1));
/// # Ok::<(), belvedere_sensors::scene::SceneError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Tree {
    /// The nodes; the first is the root.
    pub nodes: Vec<WideNode>,
    /// The leaves.
    pub blocks: Vec<TriangleBlock>,
}

impl Tree {
    /// Builds the tree of a mesh like [`build`](super::plan::build), into allocated memory.
    ///
    /// # Errors
    /// The errors of [`build`](super::plan::build).
    pub fn build(
        positions: &[[f32; 3]],
        triangles: &[[u32; 3]],
        quality: Quality,
        execution: Execution,
    ) -> Result<Self, SceneError> {
        let mut scratch: Vec<Scratch> = zeroed_vec(scratch_len(triangles.len()));
        let plan = plan(positions, triangles, quality, execution, &mut scratch)?;
        let size = plan.size();
        let mut tree = Self { nodes: zeroed_vec(size.nodes), blocks: zeroed_vec(size.blocks) };
        plan.write(&mut tree.nodes, &mut tree.blocks)?;
        Ok(tree)
    }

    /// Refits the tree to moved vertices like [`refit`].
    ///
    /// # Errors
    /// The errors of [`refit`].
    pub fn refit(
        &mut self,
        positions: &[[f32; 3]],
        triangles: &[[u32; 3]],
        execution: Execution,
    ) -> Result<(), SceneError> {
        refit(positions, triangles, execution, &mut self.nodes, &mut self.blocks)
    }

    /// Checks the tree like [`validate_tree`].
    ///
    /// # Errors
    /// The errors of [`validate_tree`].
    pub fn validate(&self, positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<(), TreeFault> {
        let words = validate_scratch_len(triangles.len(), self.nodes.len(), self.blocks.len());
        validate_tree(positions, triangles, &self.nodes, &self.blocks, &mut zeroed_vec(words))
    }

    /// Corners of the bounding box of the mesh; both 0 for a mesh without triangles.
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        self.nodes[0].bounds()
    }

    /// Computes the normals of the triangles, sixteen facets per block.
    pub fn facets(&self) -> Vec<Facet> {
        let mut facets = zeroed_vec(self.blocks.len() * WIDTH);
        fill_facets(&self.blocks, Execution::default(), &mut facets);
        facets
    }
}
