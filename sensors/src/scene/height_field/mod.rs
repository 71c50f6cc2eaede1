//! Terrain: heights on a grid, under a tree that is not stored.
//!
//! The grid itself says where nodes and triangles lie in x and y. So all that a tree over it needs in memory is
//! the range of heights below each node: a pyramid with 4 × 4 children to a node, and leaves of 4 × 2 cells, two
//! triangles each. [`HeightGrid::node`] and [`HeightGrid::block`] make [`WideNode`](super::tree::WideNode)s and [`TriangleBlock`](super::tree::TriangleBlock)s of it
//! as they are visited, and what walks the tree of a mesh walks this one. A corner that triangles share has the
//! same bits in all of them, whatever block they are in: nothing slips through.
//!
//! Rows are counted like those of a picture, from +y down to −y; columns from −x to +x. Seen from above (+z):
//!
//! ```text
//!  (row, column) ●───────● (row, column + 1)        even triangle: (row, column), (row + 1, column),
//!                │ even ╱│                                         (row, column + 1)
//!                │   ╱   │
//!                │╱  odd │                          odd triangle:  (row + 1, column), (row + 1, column + 1),
//!            ●───────●                                             (row, column + 1)
//! ```
//!
//! That is how parry3d cuts its cells. Triangle 2·cell is the even one of that cell, 2·cell + 1 the odd one,
//! where cell = row · (columns − 1) + column. The outside is above.

mod grid;
mod validate;

pub(crate) use grid::CORNERS;
pub use grid::HeightGrid;

use super::{HeightFieldId, SceneError};
use bytemuck::{Pod, Zeroable};

/// The range of no heights.
const EMPTY: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];

/// Children of a node along each side.
const FAN: u32 = 4;
/// Cells of a leaf along a row, and rows of cells.
const LEAF_COLUMNS: u32 = 4;
const LEAF_ROWS: u32 = 2;

/// A height field as it lies in a scene's memory: its measures, and where its heights begin.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct HeightField {
    /// Full lengths along x and y.
    size: [f64; 2],
    /// Lengths of a cell.
    step: [f64; 2],
    /// Heights to a row, and rows.
    columns: u32,
    rows: u32,
    /// Levels of nodes; leaves are level 0, the root is the last.
    levels: u32,
    /// Nodes in all of them.
    nodes: u32,
    pub(crate) first_height: u32,
    pub(crate) first_extent: u32,
}

/// Leaves along a row, and rows of leaves.
const fn leaves(rows: u32, columns: u32) -> [u32; 2] {
    [(columns - 1).div_ceil(LEAF_COLUMNS), (rows - 1).div_ceil(LEAF_ROWS)]
}

/// Nodes along x and y of a level above so many leaves.
#[inline(always)]
const fn level_size([x, y]: [u32; 2], level: u32) -> [u32; 2] {
    // In 64 bits: 4^level may be 2³².
    let shift = 2 * level;
    let round_up = (1_u64 << shift) - 1;
    [((x as u64 + round_up) >> shift) as u32, ((y as u64 + round_up) >> shift) as u32]
}

impl HeightField {
    /// How many `extents` [`HeightField::build`] fills for a grid of that size. A grid of fewer than 2 × 2 heights
    /// needs none, as it cannot be built.
    pub const fn extents_len(rows: u32, columns: u32) -> usize {
        if rows < 2 || columns < 2 {
            return 0;
        }
        let (_, nodes) = Self::count_nodes(rows, columns);
        let [x, y] = leaves(rows, columns);
        (nodes + x as u64 * y as u64) as usize
    }

    /// Levels of nodes, and nodes.
    const fn count_nodes(rows: u32, columns: u32) -> (u32, u64) {
        let leaves = leaves(rows, columns);
        let (mut levels, mut nodes) = (0, 0);
        loop {
            levels += 1;
            let [x, y] = level_size(leaves, levels);
            nodes += x as u64 * y as u64;
            if x == 1 && y == 1 {
                return (levels, nodes);
            }
        }
    }

    /// Checks a grid and fills the `extents` of its tree.
    ///
    /// `size` are the full lengths along x and y in metres, centred on the origin; `heights` are rows × columns
    /// metres, row by row.
    ///
    /// # Errors
    /// [`SceneError::HeightFieldTooSmall`] for fewer than 2 × 2 heights, [`SceneError::HeightCount`] if `heights`
    /// are not rows × columns, [`SceneError::BadSize`], [`SceneError::BadHeight`] with the index of a height that is
    /// not finite or beyond [`MAX_COORDINATE`](super::MAX_COORDINATE), [`SceneError::BufferTooSmall`], [`SceneError::TooMany`].
    pub fn build(
        rows: u32,
        columns: u32,
        size: [f64; 2],
        heights: &[f32],
        extents: &mut [[f32; 2]],
    ) -> Result<Self, SceneError> {
        let field = Self::measures(rows, columns, size, heights)?;
        let need = Self::extents_len(rows, columns);
        if extents.len() < need {
            return Err(SceneError::BufferTooSmall { buffer: "extents", have: extents.len(), need });
        }
        field.fill(heights, extents);
        Ok(field)
    }

    /// The same, where its heights and extents are not the first of the scene's but begin with those.
    #[must_use]
    pub const fn at(self, first_height: u32, first_extent: u32) -> Self {
        Self { first_height, first_extent, ..self }
    }

    fn fill(&self, heights: &[f32], extents: &mut [[f32; 2]]) {
        let [blocks_x, blocks_y] = leaves(self.rows, self.columns);
        let nodes = self.nodes as usize;
        for y in 0..blocks_y {
            for x in 0..blocks_x {
                let mut extent = EMPTY;
                for row in y * LEAF_ROWS..=((y + 1) * LEAF_ROWS).min(self.rows - 1) {
                    let first = row as usize * self.columns as usize;
                    let last = ((x + 1) * LEAF_COLUMNS).min(self.columns - 1) as usize;
                    for &height in &heights[first + (x * LEAF_COLUMNS) as usize..=first + last] {
                        extent = join(extent, [height; 2]);
                    }
                }
                extents[nodes + (y * blocks_x + x) as usize] = extent;
            }
        }
        // From the level above the leaves to the root.
        let mut first_child = nodes;
        for level in 1..=self.levels {
            let [child_x, child_y] = level_size([blocks_x, blocks_y], level - 1);
            let [x, y] = level_size([blocks_x, blocks_y], level);
            let first = first_child - (x * y) as usize;
            extents[first..first_child].fill(EMPTY);
            for child in 0..child_x * child_y {
                let (column, row) = (child % child_x, child / child_x);
                let node = first + ((row / FAN) * x + column / FAN) as usize;
                extents[node] = join(extents[node], extents[first_child + child as usize]);
            }
            first_child = first;
        }
    }

    /// Rows of heights.
    pub fn rows(&self) -> u32 {
        self.rows
    }

    /// Heights to a row.
    pub fn columns(&self) -> u32 {
        self.columns
    }

    /// Heights in all.
    fn heights(&self) -> usize {
        self.rows as usize * self.columns as usize
    }

    /// Full lengths along x and y in metres.
    pub fn size(&self) -> [f64; 2] {
        self.size
    }

    /// Triangles: two a cell.
    pub fn triangles(&self) -> u32 {
        2 * (self.columns - 1) * (self.rows - 1)
    }

    /// Leaves of the tree: what [`HeightGrid::block`] gives.
    pub fn blocks(&self) -> u32 {
        let [x, y] = leaves(self.rows, self.columns);
        x * y
    }

    /// The one place that knows where a column of heights stands: all corners on it get the same bits.
    #[inline(always)]
    fn x_at(&self, column: u32) -> f32 {
        (f64::from(column) * self.step[0] - 0.5 * self.size[0]) as f32
    }

    #[inline(always)]
    fn y_at(&self, row: u32) -> f32 {
        (0.5 * self.size[1] - f64::from(row) * self.step[1]) as f32
    }
}

#[inline(always)]
fn join([low, high]: [f32; 2], [other_low, other_high]: [f32; 2]) -> [f32; 2] {
    [if other_low < low { other_low } else { low }, if other_high > high { other_high } else { high }]
}

impl super::Scene<'_> {
    /// A height field of the scene; none if it has no such.
    pub fn height_field(&self, id: HeightFieldId) -> Option<HeightGrid<'_>> {
        let field = self.height_fields.get(id.0 as usize).filter(|field| field.rows > 0)?;
        Some(HeightGrid::of(field, self.heights, self.extents))
    }
}
