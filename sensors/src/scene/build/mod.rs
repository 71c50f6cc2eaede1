//! Trees over triangles: built into the caller's memory, and refitted when vertices move.
//!
//! 1. The box of each triangle goes into scratch memory ([`Scratch`]).
//! 2. A binary tree is built: the surface area heuristic splits sets of boxes until they hold at most sixteen
//!    triangles.
//! 3. The binary tree is collapsed to nodes of sixteen children ([`WideNode`]); leaves become blocks
//!    ([`TriangleBlock`]). Nodes and blocks are stored depth first, so what is visited together is adjacent in memory.
//!
//! The same input gives the same bytes on every machine, at every SIMD level and with any number of threads.
//!
//! Without the feature `raw`, this module has only the sizes of the memory for a [`MeshStore`](super::MeshStore). With
//! it, trees can be built without a scene; semantic versioning does not cover these items.

mod binary;
mod bins;
mod bounds;
mod collapse;
mod cost;
mod cut;
pub(super) mod facets;
#[cfg(feature = "alloc")]
pub(super) mod owned;
pub(super) mod plan;
pub(super) mod quality;
mod refit;
mod sweep;

pub use bounds::Scratch;
#[cfg(feature = "raw")]
pub use facets::fill_facets;
#[cfg(all(feature = "raw", feature = "alloc"))]
pub use owned::Tree;
#[cfg(feature = "raw")]
pub use plan::{Plan, build, plan};
#[cfg(feature = "raw")]
pub use quality::Quality;
#[cfg(feature = "raw")]
pub use refit::refit;

#[cfg(doc)]
use super::tree::{TriangleBlock, WideNode};
use crate::simd::WIDTH;

/// The number of nodes and blocks of a tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TreeSize {
    /// Number of [`WideNode`]s.
    pub nodes: usize,
    /// Number of [`TriangleBlock`]s.
    pub blocks: usize,
}

/// Returns an upper bound on the size of a tree over `triangles` triangles.
///
/// The builder keeps the number of blocks below twice the number of full blocks. All nodes have at least two children
/// (except the root, which can have one), and everything but the root is the child of one node, so there are fewer
/// nodes than blocks. The exact size of the tree of a mesh is usually much smaller.
pub const fn max_size(triangles: usize) -> TreeSize {
    let blocks = if triangles <= WIDTH { triangles.div_ceil(WIDTH) } else { 2 * triangles.div_ceil(WIDTH) };
    TreeSize { nodes: if blocks > 2 { blocks - 1 } else { 1 }, blocks }
}

/// Returns the number of [`Scratch`] elements that the building of a tree needs for `triangles` triangles.
pub const fn scratch_len(triangles: usize) -> usize {
    // A box for each triangle and each node of the binary tree, and for the latter also the eight bytes of `cut`.
    let binary = 2 * max_size(triangles).blocks;
    triangles + binary + binary.div_ceil(4)
}
