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
mod cost;
mod cut;
mod facets;
#[cfg(feature = "alloc")]
mod owned;
mod refit;
mod sweep;

pub use bounds::Scratch;
pub use facets::fill_facets;
#[cfg(feature = "alloc")]
pub use owned::Tree;
pub use refit::refit;

use super::SceneError;
use super::tree::{NONE, TriangleBlock, WideNode};
use super::vertices::{check_vertices, corners};
use crate::Execution;
use crate::simd::{WIDTH, dispatch};
use bytemuck::Zeroable;
use cost::Power;

/// How much effort goes into a tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Quality {
    /// For meshes that change often.
    Fast,
    /// For meshes that are traced often: slower to build, faster to trace.
    #[default]
    High,
}

/// Meshes up to this size are built with several weights, and the best tree is kept: half a millisecond more per
/// thousand triangles.
const TRIED: usize = 16_384;

/// How many nodes and blocks a tree has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TreeSize {
    /// [`WideNode`]s.
    pub nodes: usize,
    /// [`TriangleBlock`]s.
    pub blocks: usize,
}

/// The most that a tree over so many triangles can need.
///
/// The builder keeps the number of blocks below twice what full blocks would need. All nodes have at least two
/// children (but for the root, which can have one), and everything but the root is the child of one node, so there
/// are fewer nodes than blocks. [`plan`] knows the numbers of a given mesh, which are a small part of this.
pub const fn max_size(triangles: usize) -> TreeSize {
    let blocks = if triangles <= WIDTH { triangles.div_ceil(WIDTH) } else { 2 * triangles.div_ceil(WIDTH) };
    TreeSize { nodes: if blocks > 2 { blocks - 1 } else { 1 }, blocks }
}

/// How much working memory [`build`] needs.
pub const fn scratch_len(triangles: usize) -> usize {
    // A box for each triangle and each node of the binary tree, and the eight bytes of `cut` for the latter.
    let binary = 2 * max_size(triangles).blocks;
    triangles + binary + binary.div_ceil(4)
}

/// Builds the tree of a mesh into the front of `nodes` and `blocks`, and says how many of each it took.
/// [`max_size`] and [`scratch_len`] tell what is always enough. `positions` are metres, `triangles` index them.
///
/// # Errors
/// Those of [`plan`] and [`Plan::write`].
pub fn build(
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    quality: Quality,
    execution: Execution,
    scratch: &mut [Scratch],
    nodes: &mut [WideNode],
    blocks: &mut [TriangleBlock],
) -> Result<TreeSize, SceneError> {
    let plan = plan(positions, triangles, quality, execution, scratch)?;
    plan.write(nodes, blocks)?;
    Ok(plan.size())
}

/// A tree that is only to be written: its size is known, so memory can be got for it.
#[derive(Debug)]
pub struct Plan<'a> {
    positions: &'a [[f32; 3]],
    triangles: &'a [[u32; 3]],
    /// The primitives, sorted.
    items: &'a [Scratch],
    binary: &'a [Scratch],
    /// See [`cut`].
    ways: &'a [u64],
    size: TreeSize,
}

/// The first half of [`build`]: all but the writing. [`scratch_len`] tells how much `scratch` must hold.
///
/// # Errors
/// [`SceneError::BadVertex`], [`SceneError::VertexTooFar`], [`SceneError::BadTriangle`] with the index of the
/// element; [`SceneError::TooMany`] when there would be more triangles in blocks than a u32 counts;
/// [`SceneError::BufferTooSmall`].
pub fn plan<'a>(
    positions: &'a [[f32; 3]],
    triangles: &'a [[u32; 3]],
    quality: Quality,
    execution: Execution,
    scratch: &'a mut [Scratch],
) -> Result<Plan<'a>, SceneError> {
    let most = max_size(triangles.len());
    // A hit is a u32, block · 16 + lane, and the last u32 means none.
    if (most.blocks as u64 + 1) * WIDTH as u64 > u64::from(u32::MAX) || positions.len() > u32::MAX as usize {
        return Err(SceneError::TooMany);
    }
    enough("scratch", scratch.len(), scratch_len(triangles.len()))?;
    check_vertices(positions)?;
    let (items, rest) = scratch.split_at_mut(triangles.len());
    let (binary, rest) = rest.split_at_mut(2 * most.blocks);
    let ways: &mut [u64] = bytemuck::cast_slice_mut(rest);
    let mut make = |power| -> Result<_, SceneError> {
        for (index, item) in items.iter_mut().enumerate() {
            let corners = corners(positions, triangles, index)?;
            *item = bounds::bounds_of(corners).with_tags(index as u32, 0);
        }
        dispatch!(execution.level, simd => {
            binary::build(simd, quality, power, execution, items, binary, most.blocks);
        });
        Ok(cut::choose(binary, ways))
    };
    let mut size = TreeSize { nodes: 1, blocks: 0 };
    if !triangles.is_empty() {
        if quality == Quality::High && triangles.len() <= TRIED {
            // Which power is best for a small mesh is luck, and all three are soon tried.
            let costs = [make(Power::One)?, make(Power::Half)?, make(Power::ThreeQuarters)?];
            if costs[1] < costs[2] && costs[1] <= costs[0] {
                make(Power::Half)?;
            } else if costs[0] < costs[2] {
                make(Power::One)?;
            }
        } else {
            make(Power::ThreeQuarters)?;
        }
        size = collapse::measure(binary, ways);
    }
    Ok(Plan { positions, triangles, items, binary, ways, size })
}

impl Plan<'_> {
    /// What [`Plan::write`] fills.
    pub const fn size(&self) -> TreeSize {
        self.size
    }

    /// Writes the tree into the front of `nodes` and `blocks`.
    ///
    /// # Errors
    /// [`SceneError::BufferTooSmall`].
    pub fn write(&self, nodes: &mut [WideNode], blocks: &mut [TriangleBlock]) -> Result<(), SceneError> {
        enough("nodes", nodes.len(), self.size.nodes)?;
        enough("blocks", blocks.len(), self.size.blocks)?;
        if self.items.is_empty() {
            nodes[0] = WideNode { child: [NONE; WIDTH], ..WideNode::zeroed() };
            return Ok(());
        }
        collapse::collapse(self.positions, self.triangles, self.items, self.binary, self.ways, nodes, blocks)
    }
}

const fn enough(buffer: &'static str, have: usize, need: usize) -> Result<(), SceneError> {
    if have < need { Err(SceneError::BufferTooSmall { buffer, have, need }) } else { Ok(()) }
}
