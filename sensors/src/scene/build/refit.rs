//! New boxes for moved vertices.

use super::bounds::{check_vertices, corners, larger, smaller};
use super::collapse::put;
use crate::Execution;
use crate::scene::SceneError;
use crate::scene::tree::{LEAF, NONE, TriangleBlock, WIDTH, WideNode};
use fearless_simd::{Simd, dispatch};

/// Takes over moved vertices: the same triangles, the same tree, new boxes. `nodes` and `blocks` are what
/// [`build`](super::build) wrote for `triangles`, no more and no less.
///
/// The boxes stay exact, but the farther the vertices move apart, the more the boxes overlap and the slower
/// tracing gets: build anew after a large change of shape.
///
/// # Errors
/// [`SceneError::BadVertex`], [`SceneError::VertexTooFar`], [`SceneError::BadTriangle`],
/// [`SceneError::BadTree`] with the first node or block that no build made; the tree is then in part of the old
/// vertices and in part of the new.
pub fn refit(
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    execution: Execution,
    nodes: &mut [WideNode],
    blocks: &mut [TriangleBlock],
) -> Result<(), SceneError> {
    check_vertices(positions)?;
    dispatch!(execution.level, simd => refit_on(simd, positions, triangles, nodes, blocks))
}

#[inline(always)]
fn refit_on<S: Simd>(
    simd: S,
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    nodes: &mut [WideNode],
    blocks: &mut [TriangleBlock],
) -> Result<(), SceneError> {
    simd.vectorize(
        #[inline(always)]
        || {
            // Children come after their parents, so the last node is done first.
            for index in (0..nodes.len()).rev() {
                let (front, below) = nodes[index..].split_at_mut(1);
                refit_node(positions, triangles, &mut front[0], below, index, blocks)?;
            }
            Ok(())
        },
    )
}

#[inline(always)]
fn refit_node(
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    node: &mut WideNode,
    below: &[WideNode],
    index: usize,
    blocks: &mut [TriangleBlock],
) -> Result<(), SceneError> {
    let mut bounds = ([0.0; 3], [0.0; 3]);
    for lane in 0..WIDTH {
        let child = node.child[lane];
        if child == NONE {
            // Unused lanes repeat the box of the last child.
        } else if child & LEAF != 0 {
            let block = blocks.get_mut((child & !LEAF) as usize).ok_or(SceneError::BadTree(index))?;
            refit_block(positions, triangles, block)?;
            bounds = block_bounds(block);
        } else {
            let child = (child as usize).checked_sub(index + 1).and_then(|child| below.get(child));
            bounds = node_bounds(child.ok_or(SceneError::BadTree(index))?);
        }
        for axis in 0..3 {
            node.min[axis][lane] = bounds.0[axis];
            node.max[axis][lane] = bounds.1[axis];
        }
    }
    Ok(())
}

#[inline(always)]
fn refit_block(
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    block: &mut TriangleBlock,
) -> Result<(), SceneError> {
    let mut filler = [[0.0; 3]; 3];
    for lane in 0..WIDTH {
        let index = block.triangle[lane];
        let triangle = if index == NONE {
            filler
        } else if (index as usize) < triangles.len() {
            corners(positions, triangles, index as usize)?
        } else {
            return Err(SceneError::BadTriangle(index as usize));
        };
        put(block, lane, triangle);
        filler = [triangle[0]; 3];
    }
    Ok(())
}

/// Box of the triangles of a block; those that fill it up lie inside.
#[inline(always)]
fn block_bounds(block: &TriangleBlock) -> ([f32; 3], [f32; 3]) {
    let [a, b, c] = &block.corners;
    let mut bounds = ([0.0; 3], [0.0; 3]);
    for axis in 0..3 {
        let mut min = [0.0; WIDTH];
        let mut max = [0.0; WIDTH];
        for lane in 0..WIDTH {
            min[lane] = smaller(smaller(a[axis][lane], b[axis][lane]), c[axis][lane]);
            max[lane] = larger(larger(a[axis][lane], b[axis][lane]), c[axis][lane]);
        }
        bounds.0[axis] = least(min);
        bounds.1[axis] = greatest(max);
    }
    bounds
}

/// Box of the children of a node.
#[inline(always)]
fn node_bounds(node: &WideNode) -> ([f32; 3], [f32; 3]) {
    (node.min.map(least), node.max.map(greatest))
}

/// Never −0, as the builder has it.
#[inline(always)]
fn least(mut values: [f32; WIDTH]) -> f32 {
    for half in [8, 4, 2, 1] {
        for lane in 0..half {
            values[lane] = smaller(values[lane], values[lane + half]);
        }
    }
    values[0] + 0.0
}

#[inline(always)]
fn greatest(mut values: [f32; WIDTH]) -> f32 {
    for half in [8, 4, 2, 1] {
        for lane in 0..half {
            values[lane] = larger(values[lane], values[lane + half]);
        }
    }
    values[0] + 0.0
}
