//! Terrain: heights on a grid, with a tree that is not stored.
//!
//! The grid itself determines the positions of nodes and triangles in x and y. A tree over it therefore only needs to
//! store the range of heights below each node: a pyramid with 4 × 4 children per node, and leaves of 4 × 2 cells with
//! two triangles each. [`HeightGrid::node`] and [`HeightGrid::block`] generate [`WideNode`](super::tree::WideNode)s and
//! [`TriangleBlock`](super::tree::TriangleBlock)s when they are visited, so the traversal for meshes works here too. A
//! corner shared by several triangles has the same bits in all of them, whatever their blocks, so no ray slips through
//! between triangles.
//!
//! Rows are numbered like those of an image, from +y down to −y; columns from −x to +x. Seen from above (+z):
//!
//! ```text
//!  (row, column) ●───────● (row, column + 1)        even triangle: (row, column), (row + 1, column),
//!                │ even ╱│                                         (row, column + 1)
//!                │   ╱   │
//!                │╱  odd │                          odd triangle:  (row + 1, column), (row + 1, column + 1),
//!            ●───────●                                             (row, column + 1)
//! ```
//!
//! parry3d splits its cells in the same way. Triangle 2·cell is the even one of a cell, 2·cell + 1 the odd one, where
//! cell = row · (columns − 1) + column. The outside is above.

mod grid;
mod validate;

pub(crate) use grid::CORNERS;
pub use grid::HeightGrid;

use super::{HeightFieldId, SceneError};
use bytemuck::{Pod, Zeroable};

/// The empty range of heights.
const EMPTY: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];

/// Number of children of a node along each side.
const FAN: u32 = 4;
/// Number of cells of a leaf along a row, and number of rows of cells.
const LEAF_COLUMNS: u32 = 4;
const LEAF_ROWS: u32 = 2;

/// A height field as it is stored in a scene: its dimensions, and the position of its heights.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct HeightField {
    /// Full lengths along x and y.
    size: [f64; 2],
    /// Lengths of a cell along x and y.
    step: [f64; 2],
    /// Number of heights per row, and number of rows.
    columns: u32,
    rows: u32,
    /// Number of levels of nodes; leaves are level 0, the root is the last level.
    levels: u32,
    /// Number of nodes on all levels.
    nodes: u32,
    pub(crate) first_height: u32,
    pub(crate) first_extent: u32,
}

/// Number of leaves along a row, and number of rows of leaves.
const fn leaves(rows: u32, columns: u32) -> [u32; 2] {
    [(columns - 1).div_ceil(LEAF_COLUMNS), (rows - 1).div_ceil(LEAF_ROWS)]
}

/// Number of nodes along x and y on a level above the given leaves.
#[inline(always)]
const fn level_size([x, y]: [u32; 2], level: u32) -> [u32; 2] {
    // In 64 bits, since 4^level may be 2³².
    let shift = 2 * level;
    let round_up = (1_u64 << shift) - 1;
    [((x as u64 + round_up) >> shift) as u32, ((y as u64 + round_up) >> shift) as u32]
}

impl HeightField {
    /// Returns the number of `extents` that [`HeightField::build`] fills for a grid of the given size; 0 for a grid of
    /// fewer than 2 × 2 heights, which cannot be built.
    pub const fn extents_len(rows: u32, columns: u32) -> usize {
        if rows < 2 || columns < 2 {
            return 0;
        }
        let (_, nodes) = Self::count_nodes(rows, columns);
        let [x, y] = leaves(rows, columns);
        (nodes + x as u64 * y as u64) as usize
    }

    /// Number of levels of nodes, and number of nodes.
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
    /// `size` holds the full lengths along x and y in metres, centred on the origin. `heights` holds rows × columns
    /// heights in metres, row by row.
    ///
    /// # Errors
    /// [`SceneError::HeightFieldTooSmall`] for fewer than 2 × 2 heights, [`SceneError::HeightCount`] if the number of
    /// `heights` is not rows × columns, [`SceneError::BadSize`], [`SceneError::BadHeight`] with the index of a height
    /// that is not finite or beyond [`MAX_COORDINATE`](super::MAX_COORDINATE), [`SceneError::BufferTooSmall`],
    /// [`SceneError::TooMany`].
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

    /// Returns the field with its heights and extents starting at the given indices of the scene's slices.
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

    /// Number of rows of heights.
    pub fn rows(&self) -> u32 {
        self.rows
    }

    /// Number of heights per row.
    pub fn columns(&self) -> u32 {
        self.columns
    }

    /// Total number of heights.
    fn heights(&self) -> usize {
        self.rows as usize * self.columns as usize
    }

    /// Full lengths along x and y, in metres.
    pub fn size(&self) -> [f64; 2] {
        self.size
    }

    /// Number of triangles: two per cell.
    pub fn triangles(&self) -> u32 {
        2 * (self.columns - 1) * (self.rows - 1)
    }

    /// Number of leaves of the tree, which [`HeightGrid::block`] generates.
    pub fn blocks(&self) -> u32 {
        let [x, y] = leaves(self.rows, self.columns);
        x * y
    }

    /// The x coordinate of a column of heights. It is computed only here, so all corners on it get the same bits.
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
    /// Returns a height field of the scene, or `None` if there is none with this id.
    pub fn height_field(&self, id: HeightFieldId) -> Option<HeightGrid<'_>> {
        let field = self.height_fields.get(id.0 as usize).filter(|field| field.rows > 0)?;
        Some(HeightGrid::of(field, self.heights, self.extents))
    }
}
