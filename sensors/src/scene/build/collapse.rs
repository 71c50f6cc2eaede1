//! Conversion of the binary tree to nodes of sixteen children, and to leaves as structures of arrays.

use super::TreeSize;
use super::bounds::Scratch;
use super::cut::children;
use crate::scene::SceneError;
use crate::scene::tree::{LEAF, MAX_DEPTH, NONE, TriangleBlock, WideNode};
use crate::scene::vertices::corners;
use crate::simd::WIDTH;

/// Maximum number of waiting nodes: on each level, all children but one.
const STACK: usize = MAX_DEPTH * (WIDTH - 1) + 1;

/// A wide node that is still to be made from a binary one, and the lane of the parent that needs its index.
#[derive(Clone, Copy, Default)]
struct Pending {
    binary: u32,
    parent: u32,
    lane: u32,
}

/// Computes the size of the wide tree over a binary one.
pub(super) fn measure(binary: &[Scratch], ways: &[u64]) -> TreeSize {
    let mut size = TreeSize { nodes: 0, blocks: 0 };
    let mut stack = [0; STACK];
    let mut waiting = 1;
    while waiting > 0 {
        waiting -= 1;
        size.nodes += 1;
        let (children, count) = children(binary, ways, stack[waiting]);
        for &child in &children[..count] {
            if binary[child as usize].count() == 0 {
                stack[waiting] = child;
                waiting += 1;
            } else {
                size.blocks += 1;
            }
        }
    }
    size
}

/// Writes the tree depth first: a node, its leaves, then the nodes below it, child by child. `nodes` and `blocks` must
/// have the size that [`measure`] returns.
pub(super) fn collapse(
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    items: &[Scratch],
    binary: &[Scratch],
    ways: &[u64],
    nodes: &mut [WideNode],
    blocks: &mut [TriangleBlock],
) -> Result<(), SceneError> {
    let mut size = TreeSize { nodes: 0, blocks: 0 };
    let mut stack = [Pending::default(); STACK];
    let mut waiting = 1;
    while waiting > 0 {
        waiting -= 1;
        let Pending { binary: top, parent, lane } = stack[waiting];
        let index = size.nodes;
        size.nodes += 1;
        if index > 0 {
            nodes[parent as usize].child[lane as usize] = index as u32;
        }
        let (children, count) = children(binary, ways, top);
        let node = &mut nodes[index];
        for lane in 0..WIDTH {
            let child = &binary[children[lane.min(count - 1)] as usize];
            let (min, max) = (child.min(), child.max());
            for axis in 0..3 {
                node.min[axis][lane] = min[axis];
                node.max[axis][lane] = max[axis];
            }
            node.child[lane] = NONE;
            if lane < count && child.count() > 0 {
                node.child[lane] = LEAF | size.blocks as u32;
                let first = child.tag() as usize;
                let members = &items[first..first + child.count() as usize];
                fill(&mut blocks[size.blocks], positions, triangles, members)?;
                size.blocks += 1;
            }
        }
        for lane in (0..count).rev() {
            if binary[children[lane] as usize].count() == 0 {
                stack[waiting] = Pending { binary: children[lane], parent: index as u32, lane: lane as u32 };
                waiting += 1;
            }
        }
    }
    Ok(())
}

/// Writes a leaf of one to sixteen triangles.
fn fill(
    block: &mut TriangleBlock,
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    members: &[Scratch],
) -> Result<(), SceneError> {
    let mut filler = [[0.0; 3]; 3];
    for lane in 0..WIDTH {
        let (triangle, index) = match members.get(lane) {
            Some(member) => (corners(positions, triangles, member.tag() as usize)?, member.tag()),
            None => (filler, NONE),
        };
        put(&mut block.corners, lane, &triangle);
        block.triangle[lane] = index;
        filler = [triangle[0]; 3];
    }
    Ok(())
}

/// Stores a triangle in `corners[corner][axis][lane]`.
#[inline(always)]
pub(super) fn put(corners: &mut [[[f32; WIDTH]; 3]; 3], lane: usize, triangle: &[[f32; 3]; 3]) {
    for corner in 0..3 {
        for axis in 0..3 {
            corners[corner][axis][lane] = triangle[corner][axis];
        }
    }
}
