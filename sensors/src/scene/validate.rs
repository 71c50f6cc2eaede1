//! Checks that a tree from an untrusted source, such as a file, can be traversed.
//!
//! Traversal indexes checked slices, so an invalid tree never causes an out-of-bounds read, but it could lead to missed
//! triangles or an endless loop. A tree that passes these checks does neither.

use super::SceneError;
use super::tree::{LEAF, MAX_DEPTH, NONE, TriangleBlock, WideNode};
use super::vertices::{MAX_COORDINATE, check_vertices, corners};
use crate::simd::WIDTH;

/// The fault of a tree. Nodes, blocks and triangles are named by their indices in the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum TreeFault {
    /// The vertices or triangles themselves are invalid.
    Mesh(SceneError),
    /// There is no root.
    NoNodes,
    /// The scratch memory is too small; this many words are needed.
    ScratchTooSmall(usize),
    /// A child is neither a later node nor a block.
    Child {
        /// Index of the parent.
        node: usize,
        /// Lane of the child.
        lane: usize,
    },
    /// Two lanes have the same child.
    SharedChild {
        /// Index of the second parent.
        node: usize,
        /// Lane of the child in the second parent.
        lane: usize,
    },
    /// A lane after an unused one is used, or an unused lane does not repeat the box of the last used one.
    UnusedChild {
        /// Index of the node.
        node: usize,
        /// The lane.
        lane: usize,
    },
    /// A box is not finite, or does not contain its descendants.
    Box {
        /// Index of the node.
        node: usize,
        /// The lane of the box.
        lane: usize,
    },
    /// The node with this index is deeper than [`MAX_DEPTH`].
    TooDeep(usize),
    /// The node with this index has no children although it is not the root of an empty tree, or no lane refers to it.
    StrayNode(usize),
    /// The block with this index has no triangles, or no lane refers to it.
    StrayBlock(usize),
    /// A lane of a block refers to a triangle that does not exist, or its corners differ from that triangle's.
    Triangle {
        /// Index of the block.
        block: usize,
        /// The lane.
        lane: usize,
    },
    /// A lane after an unused one is used, or an unused lane does not repeat the first corner of the last triangle.
    UnusedTriangle {
        /// Index of the block.
        block: usize,
        /// The lane.
        lane: usize,
    },
    /// The triangle with this index is in no block.
    MissingTriangle(usize),
}

impl core::fmt::Display for TreeFault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Mesh(error) => write!(f, "the mesh under the tree is faulty: {error}"),
            Self::NoNodes => f.write_str("a tree needs at least one node"),
            Self::ScratchTooSmall(need) => {
                write!(f, "checking this tree needs {need} words of scratch memory")
            }
            Self::Child { node, lane } => {
                write!(f, "child {lane} of node {node} is neither a later node nor a block of the tree")
            }
            Self::SharedChild { node, lane } => {
                write!(f, "child {lane} of node {node} is also the child of another node or lane")
            }
            Self::UnusedChild { node, lane } => write!(
                f,
                "lane {lane} of node {node}: unused lanes come last and repeat the box of the last child"
            ),
            Self::Box { node, lane } => {
                write!(f, "box {lane} of node {node} is not finite or does not contain what is below it")
            }
            Self::TooDeep(node) => write!(f, "node {node} has more than {} nodes above it", MAX_DEPTH - 1),
            Self::StrayNode(node) => write!(f, "node {node} has no children, or is not a child of any node"),
            Self::StrayBlock(block) => {
                write!(f, "block {block} has no triangles, or is not a child of any node")
            }
            Self::Triangle { block, lane } => {
                write!(f, "lane {lane} of block {block} does not hold a triangle of the mesh")
            }
            Self::UnusedTriangle { block, lane } => write!(
                f,
                "lane {lane} of block {block}: unused lanes come last and repeat the first corner of the last triangle"
            ),
            Self::MissingTriangle(triangle) => write!(f, "triangle {triangle} is in no leaf of the tree"),
        }
    }
}

impl core::error::Error for TreeFault {}

/// Number of words of scratch memory that [`validate_tree`] needs: one bit per element.
pub const fn validate_scratch_len(triangles: usize, nodes: usize, blocks: usize) -> usize {
    triangles.div_ceil(32) + nodes.div_ceil(32) + blocks.div_ceil(32)
}

/// Checks everything that traversal relies on, and that the tree contains every triangle of the mesh.
///
/// # Errors
/// The first [`TreeFault`] that is found.
pub fn validate_tree(
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    nodes: &[WideNode],
    blocks: &[TriangleBlock],
    scratch: &mut [u32],
) -> Result<(), TreeFault> {
    let need = validate_scratch_len(triangles.len(), nodes.len(), blocks.len());
    let scratch = scratch.get_mut(..need).ok_or(TreeFault::ScratchTooSmall(need))?;
    scratch.fill(0);
    let (has_triangle, rest) = scratch.split_at_mut(triangles.len().div_ceil(32));
    let (has_node, has_block) = rest.split_at_mut(nodes.len().div_ceil(32));
    check_vertices(positions).map_err(TreeFault::Mesh)?;
    for index in 0..triangles.len() {
        corners(positions, triangles, index).map_err(TreeFault::Mesh)?;
    }

    // Step 1: traverse the tree. A child comes after its parent and has no other parent, so the traversal ends.
    if nodes.is_empty() {
        return Err(TreeFault::NoNodes);
    }
    let mut stack = [(0_u32, 0_u32); MAX_DEPTH * (WIDTH - 1) + 1];
    let mut waiting = 1;
    set(has_node, 0);
    while waiting > 0 {
        waiting -= 1;
        let (index, above) = stack[waiting];
        if above as usize >= MAX_DEPTH {
            return Err(TreeFault::TooDeep(index as usize));
        }
        let index = index as usize;
        let node = &nodes[index];
        let used = used_lanes(&node.child).map_err(|lane| TreeFault::UnusedChild { node: index, lane })?;
        if used == 0 && !(index == 0 && triangles.is_empty()) {
            return Err(TreeFault::StrayNode(index));
        }
        for lane in 0..used {
            let child = node.child[lane];
            let fault = TreeFault::Child { node: index, lane };
            let (bounds, fresh) = if child & LEAF == 0 {
                let below = nodes.get(child as usize).filter(|_| child as usize > index).ok_or(fault)?;
                // On each level, at most all children but one are waiting, so there is room.
                stack[waiting] = (child, above + 1);
                waiting += 1;
                (Bounds::of_node(below), set(has_node, child))
            } else {
                let block = child & !LEAF;
                let leaf = blocks.get(block as usize).ok_or(fault)?;
                let bounds = check_block(positions, triangles, leaf, block as usize, has_triangle)?;
                (bounds, set(has_block, block))
            };
            if !fresh {
                return Err(TreeFault::SharedChild { node: index, lane });
            }
            if !Bounds::of_lane(node, lane).contains(&bounds) {
                return Err(TreeFault::Box { node: index, lane });
            }
        }
        for lane in used.max(1)..WIDTH {
            let same = |corner: &[[f32; WIDTH]; 3]| {
                corner.iter().all(|axis| used == 0 || axis[lane].to_bits() == axis[used - 1].to_bits())
            };
            if !same(&node.min) || !same(&node.max) {
                return Err(TreeFault::UnusedChild { node: index, lane });
            }
        }
    }

    // Step 2: check that nothing was left out.
    first_unset(has_node, nodes.len()).map_or(Ok(()), |node| Err(TreeFault::StrayNode(node)))?;
    first_unset(has_block, blocks.len()).map_or(Ok(()), |block| Err(TreeFault::StrayBlock(block)))?;
    first_unset(has_triangle, triangles.len())
        .map_or(Ok(()), |triangle| Err(TreeFault::MissingTriangle(triangle)))
}

/// Checks the triangles of a block against the mesh, and returns their box.
fn check_block(
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    leaf: &TriangleBlock,
    block: usize,
    has_triangle: &mut [u32],
) -> Result<Bounds, TreeFault> {
    let used = used_lanes(&leaf.triangle).map_err(|lane| TreeFault::UnusedTriangle { block, lane })?;
    if used == 0 {
        return Err(TreeFault::StrayBlock(block));
    }
    let mut bounds = Bounds::EMPTY;
    let mut filler = [[0.0; 3]; 3];
    for lane in 0..WIDTH {
        let held = core::array::from_fn::<[f32; 3], 3, _>(|corner| {
            core::array::from_fn(|axis| leaf.corners[corner][axis][lane])
        });
        if lane >= used {
            if !same_bits(&held, &filler) {
                return Err(TreeFault::UnusedTriangle { block, lane });
            }
            continue;
        }
        let index = leaf.triangle[lane];
        if index as usize >= triangles.len() {
            return Err(TreeFault::Triangle { block, lane });
        }
        let triangle = corners(positions, triangles, index as usize).map_err(TreeFault::Mesh)?;
        if !same_bits(&held, &triangle) {
            return Err(TreeFault::Triangle { block, lane });
        }
        set(has_triangle, index);
        for corner in &triangle {
            bounds.join(corner, corner);
        }
        filler = [triangle[0]; 3];
    }
    Ok(bounds)
}

/// The number of lanes before the first [`NONE`], or the first used lane after it as an error.
fn used_lanes(lanes: &[u32; WIDTH]) -> Result<usize, usize> {
    let used = lanes.iter().position(|&x| x == NONE).unwrap_or(WIDTH);
    match lanes[used..].iter().position(|&x| x != NONE) {
        Some(behind) => Err(used + behind),
        None => Ok(used),
    }
}

fn same_bits(a: &[[f32; 3]; 3], b: &[[f32; 3]; 3]) -> bool {
    a.as_flattened().iter().zip(b.as_flattened()).all(|(x, y)| x.to_bits() == y.to_bits())
}

/// Sets a bit and returns true if it was not set before.
fn set(bits: &mut [u32], index: u32) -> bool {
    let word = &mut bits[index as usize / 32];
    let bit = 1 << (index % 32);
    let fresh = *word & bit == 0;
    *word |= bit;
    fresh
}

fn first_unset(bits: &[u32], count: usize) -> Option<usize> {
    (0..count).find(|&index| bits[index / 32] & (1 << (index % 32)) == 0)
}

/// An unchecked box.
struct Bounds {
    min: [f32; 3],
    max: [f32; 3],
}

impl Bounds {
    const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    fn of_lane(node: &WideNode, lane: usize) -> Self {
        Self { min: node.min.map(|axis| axis[lane]), max: node.max.map(|axis| axis[lane]) }
    }

    /// The box of all children, including unused lanes: these repeat a box, and the traversal checks that they do.
    fn of_node(node: &WideNode) -> Self {
        let mut bounds = Self::EMPTY;
        for lane in 0..WIDTH {
            let Self { min, max } = Self::of_lane(node, lane);
            bounds.join(&min, &max);
        }
        bounds
    }

    fn join(&mut self, min: &[f32; 3], max: &[f32; 3]) {
        for axis in 0..3 {
            self.min[axis] = self.min[axis].min(min[axis]);
            self.max[axis] = self.max[axis].max(max[axis]);
        }
    }

    /// Returns true if the box contains the other one; false if either is not finite.
    fn contains(&self, other: &Self) -> bool {
        (0..3).all(|axis| {
            -MAX_COORDINATE <= self.min[axis]
                && self.min[axis] <= other.min[axis]
                && other.max[axis] <= self.max[axis]
                && self.max[axis] <= MAX_COORDINATE
        })
    }
}
