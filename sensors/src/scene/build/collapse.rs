//! From the binary tree to nodes of sixteen children and leaves as structures of arrays.

use super::bounds::{Scratch, corners};
use super::{MAX_DEPTH, TreeSize};
use crate::scene::SceneError;
use crate::scene::tree::{LEAF, NONE, TriangleBlock, WIDTH, WideNode};
use bytemuck::Zeroable;

/// A wide node to be made of a binary one, and the lane of the parent that waits for its index.
#[derive(Clone, Copy, Default)]
struct Pending {
    binary: u32,
    parent: u32,
    lane: u32,
}

/// Writes the tree depth first: a node, its leaves, then the nodes below it, child by child.
pub(super) fn collapse(
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    items: &[Scratch],
    binary: &[Scratch],
    nodes: &mut [WideNode],
    blocks: &mut [TriangleBlock],
) -> Result<TreeSize, SceneError> {
    let mut size = TreeSize { nodes: 0, blocks: 0 };
    // Of each level at most all but one child waits.
    let mut stack = [Pending::default(); MAX_DEPTH * (WIDTH - 1) + 1];
    let mut waiting = 1;
    while waiting > 0 {
        waiting -= 1;
        let Pending { binary: top, parent, lane } = stack[waiting];
        let index = size.nodes;
        size.nodes += 1;
        if index > 0 {
            nodes[parent as usize].child[lane as usize] = index as u32;
        }
        let (children, count) = open(binary, top);
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
                blocks[size.blocks] = block(positions, triangles, members)?;
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
    Ok(size)
}

/// Up to sixteen descendants that cover a node: again and again the child with the largest surface is replaced
/// by its two. They stay in the order of the binary tree, neighbours side by side.
fn open(binary: &[Scratch], top: u32) -> ([u32; WIDTH], usize) {
    let mut children = [top; WIDTH];
    let mut areas = [0.0; WIDTH];
    let mut count = 1;
    let openable = |index: u32| {
        let node = &binary[index as usize];
        if node.count() == 0 { node.area() } else { -1.0 }
    };
    areas[0] = openable(top);
    while count < WIDTH {
        let mut largest = 0;
        for lane in 1..count {
            if areas[lane] > areas[largest] {
                largest = lane;
            }
        }
        if areas[largest] < 0.0 {
            break;
        }
        let parent = children[largest];
        children.copy_within(largest + 1..count, largest + 2);
        areas.copy_within(largest + 1..count, largest + 2);
        for (lane, child) in [(largest, parent + 1), (largest + 1, binary[parent as usize].tag())] {
            children[lane] = child;
            areas[lane] = openable(child);
        }
        count += 1;
    }
    (children, count)
}

/// A leaf of up to sixteen triangles, at least one.
fn block(
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    members: &[Scratch],
) -> Result<TriangleBlock, SceneError> {
    let mut block = TriangleBlock::zeroed();
    let mut filler = [[0.0; 3]; 3];
    for (lane, member) in members.iter().enumerate() {
        let triangle = corners(positions, triangles, member.tag() as usize)?;
        put(&mut block, lane, triangle);
        block.triangle[lane] = member.tag();
        filler = [triangle[0]; 3];
    }
    for lane in members.len()..WIDTH {
        put(&mut block, lane, filler);
        block.triangle[lane] = NONE;
    }
    Ok(block)
}

#[inline(always)]
pub(super) fn put(block: &mut TriangleBlock, lane: usize, triangle: [[f32; 3]; 3]) {
    for corner in 0..3 {
        for axis in 0..3 {
            block.corners[corner][axis][lane] = triangle[corner][axis];
        }
    }
}
