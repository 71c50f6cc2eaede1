//! A tree that owns its memory.

use super::{Quality, Scratch, build, max_size, refit, scratch_len};
use crate::Execution;
use crate::scene::tree::{TriangleBlock, WideNode};
use crate::scene::{SceneError, TreeFault, validate_scratch_len, validate_tree};
use alloc::vec::Vec;
use bytemuck::allocation::zeroed_vec;

/// Nodes and blocks of a mesh.
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
    /// The root is the first.
    pub nodes: Vec<WideNode>,
    /// The leaves.
    pub blocks: Vec<TriangleBlock>,
}

impl Tree {
    /// As [`build`], in memory of its own.
    ///
    /// # Errors
    /// As [`build`].
    pub fn build(
        positions: &[[f32; 3]],
        triangles: &[[u32; 3]],
        quality: Quality,
        execution: Execution,
    ) -> Result<Self, SceneError> {
        let most = max_size(triangles.len());
        let mut scratch: Vec<Scratch> = zeroed_vec(scratch_len(triangles.len()));
        let mut nodes: Vec<WideNode> = zeroed_vec(most.nodes);
        let mut blocks: Vec<TriangleBlock> = zeroed_vec(most.blocks);
        let size = build(positions, triangles, quality, execution, &mut scratch, &mut nodes, &mut blocks)?;
        nodes.truncate(size.nodes);
        blocks.truncate(size.blocks);
        nodes.shrink_to_fit();
        blocks.shrink_to_fit();
        Ok(Self { nodes, blocks })
    }

    /// As [`refit`].
    ///
    /// # Errors
    /// As [`refit`].
    pub fn refit(
        &mut self,
        positions: &[[f32; 3]],
        triangles: &[[u32; 3]],
        execution: Execution,
    ) -> Result<(), SceneError> {
        refit(positions, triangles, execution, &mut self.nodes, &mut self.blocks)
    }

    /// As [`validate_tree`].
    ///
    /// # Errors
    /// As [`validate_tree`].
    pub fn validate(&self, positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<(), TreeFault> {
        let words = validate_scratch_len(triangles.len(), self.nodes.len(), self.blocks.len());
        validate_tree(positions, triangles, &self.nodes, &self.blocks, &mut zeroed_vec(words))
    }
}
