//! Refits a tree to moved vertices.

use super::collapse::put;
use crate::Execution;
use crate::scene::SceneError;
use crate::scene::tree::{LEAF, NONE, TriangleBlock, WideNode};
use crate::scene::vertices::check_vertices;
use crate::simd::{WIDTH, dispatch};
use fearless_simd::{Simd, SimdBase, f32x16};

/// Refits a tree to moved vertices: the same triangles and the same tree with new boxes.
///
/// `nodes` and `blocks` must be exactly what [`build`](super::plan::build) wrote for `triangles`. The boxes stay exact,
/// but the farther vertices move apart, the more the boxes overlap and the slower tracing becomes. Rebuild the tree
/// after a large change of shape.
///
/// # Errors
/// [`SceneError::BadVertex`], [`SceneError::VertexTooFar`], [`SceneError::BadTriangle`], or [`SceneError::BadTree`]
/// with the first node or block that cannot come from a build. After an error, part of the tree has the old vertices
/// and part the new ones.
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
            // Children come after their parents, so process the last node first.
            for index in (0..nodes.len()).rev() {
                let (front, below) = nodes[index..].split_at_mut(1);
                refit_node(simd, positions, triangles, &mut front[0], below, index, blocks)?;
            }
            Ok(())
        },
    )
}

#[inline(always)]
fn refit_node<S: Simd>(
    simd: S,
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    node: &mut WideNode,
    below: &[WideNode],
    index: usize,
    blocks: &mut [TriangleBlock],
) -> Result<(), SceneError> {
    // Step 1: find the vertices that the leaves need. These reads are independent and overlap; done leaf by leaf, each
    // would cost a memory latency.
    let mut vertices = [[[0; 3]; WIDTH]; WIDTH];
    for (child, vertices) in node.child.iter().zip(&mut vertices) {
        if *child != NONE && child & LEAF != 0 {
            let block = blocks.get((child & !LEAF) as usize).ok_or(SceneError::BadTree(index))?;
            for (&triangle, vertices) in block.triangle.iter().zip(vertices) {
                if triangle != NONE {
                    *vertices = *triangles
                        .get(triangle as usize)
                        .ok_or(SceneError::BadTriangle(triangle as usize))?;
                }
            }
        }
    }

    // Step 2: update corners and boxes.
    let mut bounds = ([0.0; 3], [0.0; 3]);
    for lane in 0..WIDTH {
        let child = node.child[lane];
        if child == NONE {
            // Unused lanes repeat the box of the last child.
        } else if child & LEAF != 0 {
            let block = &mut blocks[(child & !LEAF) as usize];
            bounds = refit_block(simd, positions, &vertices[lane], block)?;
        } else {
            let child = (child as usize).checked_sub(index + 1).and_then(|child| below.get(child));
            bounds = node_bounds(simd, child.ok_or(SceneError::BadTree(index))?);
        }
        for axis in 0..3 {
            node.min[axis][lane] = bounds.0[axis];
            node.max[axis][lane] = bounds.1[axis];
        }
    }
    Ok(())
}

/// Updates the corners of a block from the given vertices, and returns its box.
#[inline(always)]
fn refit_block<S: Simd>(
    simd: S,
    positions: &[[f32; 3]],
    vertices: &[[u32; 3]; WIDTH],
    block: &mut TriangleBlock,
) -> Result<([f32; 3], [f32; 3]), SceneError> {
    let mut filler = [[0.0; 3]; 3];
    for lane in 0..WIDTH {
        let triangle = if block.triangle[lane] == NONE {
            filler
        } else {
            let [a, b, c] = vertices[lane];
            match (positions.get(a as usize), positions.get(b as usize), positions.get(c as usize)) {
                (Some(&a), Some(&b), Some(&c)) => [a, b, c],
                _ => return Err(SceneError::BadTriangle(block.triangle[lane] as usize)),
            }
        };
        put(&mut block.corners, lane, &triangle);
        filler = [triangle[0]; 3];
    }
    let [a, b, c] = &block.corners;
    let mut bounds = ([0.0; 3], [0.0; 3]);
    for axis in 0..3 {
        // Without `map`: it is not always inlined, and then each call stores its vectors.
        let a = f32x16::from_slice(simd, &a[axis]);
        let b = f32x16::from_slice(simd, &b[axis]);
        let c = f32x16::from_slice(simd, &c[axis]);
        bounds.0[axis] = least(a.min(b).min(c));
        bounds.1[axis] = greatest(a.max(b).max(c));
    }
    Ok(bounds)
}

/// The box of the children of a node.
#[inline(always)]
fn node_bounds<S: Simd>(simd: S, node: &WideNode) -> ([f32; 3], [f32; 3]) {
    let mut bounds = ([0.0; 3], [0.0; 3]);
    for axis in 0..3 {
        bounds.0[axis] = least(f32x16::from_slice(simd, &node.min[axis]));
        bounds.1[axis] = greatest(f32x16::from_slice(simd, &node.max[axis]));
    }
    bounds
}

/// The minimum, never −0, as in the builder: SIMD levels may differ in which of two zeros is smaller.
#[inline(always)]
fn least<S: Simd>(values: f32x16<S>) -> f32 {
    values.reduce_min() + 0.0
}

#[inline(always)]
fn greatest<S: Simd>(values: f32x16<S>) -> f32 {
    values.reduce_max() + 0.0
}
