//! Planning and writing of the tree of a mesh.

use super::cost::Power;
use super::quality::Quality;
use super::{Scratch, TreeSize, binary, bounds, collapse, cut, max_size, scratch_len};
use crate::Execution;
use crate::scene::SceneError;
use crate::scene::tree::{NONE, TriangleBlock, WideNode};
use crate::scene::vertices::{check_vertices, corners};
use crate::simd::{WIDTH, dispatch};
use bytemuck::Zeroable;

/// Meshes up to this size are built with several weights, and the best tree is kept. This takes half a millisecond more
/// per thousand triangles.
const TRIED: usize = 16_384;

/// Builds the tree of a mesh into the front of `nodes` and `blocks`, and returns the number of each that it used.
///
/// [`max_size`] and [`scratch_len`] give sizes that are always enough. `positions` are in metres; `triangles` are
/// indices into them.
///
/// # Errors
/// The errors of [`plan`] and [`Plan::write`].
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

/// A tree that has been planned but not written. Its size is known, so that memory for it can be allocated.
#[derive(Debug)]
pub struct Plan<'a> {
    positions: &'a [[f32; 3]],
    triangles: &'a [[u32; 3]],
    /// The sorted primitives.
    items: &'a [Scratch],
    binary: &'a [Scratch],
    /// See [`cut`].
    ways: &'a [u64],
    size: TreeSize,
}

/// The first half of [`build`]: everything except the writing. `scratch` must hold [`scratch_len`] elements.
///
/// # Errors
/// [`SceneError::BadVertex`], [`SceneError::VertexTooFar`], [`SceneError::BadTriangle`] with the index of the element;
/// [`SceneError::TooMany`] if the slots of the blocks or the vertices cannot be counted in a u32;
/// [`SceneError::BufferTooSmall`].
pub fn plan<'a>(
    positions: &'a [[f32; 3]],
    triangles: &'a [[u32; 3]],
    quality: Quality,
    execution: Execution,
    scratch: &'a mut [Scratch],
) -> Result<Plan<'a>, SceneError> {
    let most = max_size(triangles.len());
    // A hit is a u32, block · 16 + lane; the last u32 means no hit.
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
            // Which exponent is best for a small mesh is unpredictable, and trying all three is quick.
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
    /// The size of the tree that [`Plan::write`] writes.
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
