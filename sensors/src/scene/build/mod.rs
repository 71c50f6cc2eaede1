//! Trees over triangles: built into the caller's memory, and refitted when vertices move.
//!
//! 1. The box of each triangle goes into scratch memory ([`Scratch`]).
//! 2. A binary tree: sets of boxes are cut where the surface area heuristic says, down to sixteen triangles.
//! 3. The binary tree is collapsed to nodes of sixteen children ([`WideNode`]); leaves become blocks
//!    ([`TriangleBlock`]). Nodes and blocks lie depth first, so what is visited together lies together.
//!
//! The same input gives the same bytes on every machine, SIMD level and number of threads.

mod binary;
mod bins;
mod bounds;
mod collapse;
#[cfg(feature = "alloc")]
mod owned;
mod refit;

pub use bounds::{MAX_COORDINATE, Scratch};
pub(super) use bounds::{check_vertices, corners};
#[cfg(feature = "alloc")]
pub use owned::Tree;
pub use refit::refit;

use super::SceneError;
use super::tree::{TriangleBlock, WIDTH, WideNode};
use crate::Execution;
use bytemuck::Zeroable;
use fearless_simd::dispatch;

/// No path from the root of a tree to a node has more nodes than this; a stack of `MAX_DEPTH * 15 + 1` nodes is
/// always enough to walk it.
pub const MAX_DEPTH: usize = 64;

/// How much effort goes into a tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Quality {
    /// For meshes that change often.
    Fast,
    /// For meshes that are traced often: slower to build, faster to trace.
    #[default]
    High,
}

/// How many nodes and blocks a tree has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TreeSize {
    /// [`WideNode`]s.
    pub nodes: usize,
    /// [`TriangleBlock`]s.
    pub blocks: usize,
}

/// The most that a tree over so many triangles can need.
///
/// The builder keeps the number of blocks below twice what full blocks would need. A node with fewer than
/// sixteen children has none but leaves, and at least two (but for the root), so with b blocks there are no more
/// than b/2 of these; and (b/2 − 1)/15 full nodes hold those.
pub const fn max_size(triangles: usize) -> TreeSize {
    let blocks = if triangles <= WIDTH { triangles.div_ceil(WIDTH) } else { 2 * triangles.div_ceil(WIDTH) };
    TreeSize { nodes: 1 + blocks / 2 + blocks / 30, blocks }
}

/// How much working memory [`build`] needs.
pub const fn scratch_len(triangles: usize) -> usize {
    triangles + 2 * max_size(triangles).blocks
}

/// Builds the tree of a mesh into the front of `nodes` and `blocks`, and says how many of each it took.
/// [`max_size`] and [`scratch_len`] tell what is always enough. `positions` are metres, `triangles` index them.
///
/// # Errors
/// [`SceneError::BadVertex`], [`SceneError::VertexTooFar`], [`SceneError::BadTriangle`] with the index of the
/// element; [`SceneError::TooMany`] when the blocks could not be counted in u32; and
/// [`SceneError::BufferTooSmall`].
pub fn build(
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    quality: Quality,
    execution: Execution,
    scratch: &mut [Scratch],
    nodes: &mut [WideNode],
    blocks: &mut [TriangleBlock],
) -> Result<TreeSize, SceneError> {
    let most = max_size(triangles.len());
    // A hit is a u32, block · 16 + lane, and the last u32 means none.
    if (most.blocks as u64 + 1) * WIDTH as u64 > u64::from(u32::MAX) || positions.len() > u32::MAX as usize {
        return Err(SceneError::TooMany);
    }
    let need = scratch_len(triangles.len());
    for (buffer, have, need) in [
        ("scratch", scratch.len(), need),
        ("nodes", nodes.len(), most.nodes),
        ("blocks", blocks.len(), most.blocks),
    ] {
        if have < need {
            return Err(SceneError::BufferTooSmall { buffer, have, need });
        }
    }
    bounds::check_vertices(positions)?;
    if triangles.is_empty() {
        nodes[0] = WideNode { child: [super::tree::NONE; WIDTH], ..WideNode::zeroed() };
        return Ok(TreeSize { nodes: 1, blocks: 0 });
    }
    let (items, rest) = scratch.split_at_mut(triangles.len());
    for (index, item) in items.iter_mut().enumerate() {
        *item = bounds::bounds_of(bounds::corners(positions, triangles, index)?).with_tags(index as u32, 0);
    }
    let _ = quality;
    dispatch!(execution.level, simd => binary::build(simd, execution, items, rest, most.blocks));
    collapse::collapse(positions, triangles, items, rest, nodes, blocks)
}
