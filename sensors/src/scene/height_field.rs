//! Terrain: heights on a grid, under a tree that is not stored.
//!
//! The grid itself says where nodes and triangles lie in x and y. So all that a tree over it needs in memory is
//! the range of heights below each node: a pyramid with 4 × 4 children to a node, and leaves of 4 × 2 cells, two
//! triangles each. [`HeightGrid::node`] and [`HeightGrid::block`] make [`WideNode`]s and [`TriangleBlock`]s of it
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

use super::build::MAX_COORDINATE;
use super::tree::{LEAF, NONE, TriangleBlock, WIDTH, WideNode};
use super::{HeightFieldId, SceneError};
use bytemuck::{Pod, Zeroable};

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
    /// not finite or beyond [`MAX_COORDINATE`], [`SceneError::BufferTooSmall`], [`SceneError::TooMany`].
    pub fn build(
        rows: u32,
        columns: u32,
        size: [f64; 2],
        heights: &[f32],
        extents: &mut [[f32; 2]],
    ) -> Result<Self, SceneError> {
        if rows < 2 || columns < 2 {
            return Err(SceneError::HeightFieldTooSmall);
        }
        if u64::from(rows) * u64::from(columns) != heights.len() as u64 {
            return Err(SceneError::HeightCount);
        }
        let narrow = |length: f64| (length as f32) > 0.0 && length <= f64::from(MAX_COORDINATE);
        if !size.iter().all(|length| narrow(*length)) {
            return Err(SceneError::BadSize);
        }
        // NaN fails the compare as well.
        if let Some(bad) = heights.iter().position(|height| !matches!(height.abs(), 0.0..=MAX_COORDINATE)) {
            return Err(SceneError::BadHeight(bad));
        }
        let (levels, nodes) = Self::count_nodes(rows, columns);
        let [x, y] = leaves(rows, columns);
        // Every triangle has a slot of its own.
        let slots = u64::from(x) * u64::from(y) * WIDTH as u64;
        if slots > u64::from(u32::MAX) || heights.len() as u64 > u64::from(u32::MAX) {
            return Err(SceneError::TooMany);
        }
        let need = Self::extents_len(rows, columns);
        if extents.len() < need {
            return Err(SceneError::BufferTooSmall { buffer: "extents", have: extents.len(), need });
        }
        let step = [size[0] / f64::from(columns - 1), size[1] / f64::from(rows - 1)];
        let field =
            Self { size, step, columns, rows, levels, nodes: nodes as u32, first_height: 0, first_extent: 0 };
        field.fill(heights, extents);
        Ok(field)
    }

    fn fill(&self, heights: &[f32], extents: &mut [[f32; 2]]) {
        let empty = [f32::INFINITY, f32::NEG_INFINITY];
        let [blocks_x, blocks_y] = leaves(self.rows, self.columns);
        let nodes = self.nodes as usize;
        for y in 0..blocks_y {
            for x in 0..blocks_x {
                let mut extent = empty;
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
            extents[first..first_child].fill(empty);
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

/// A height field and its data: the tree that is walked.
#[derive(Debug, Clone, Copy)]
pub struct HeightGrid<'a> {
    field: HeightField,
    heights: &'a [f32],
    extents: &'a [[f32; 2]],
}

impl<'a> HeightGrid<'a> {
    /// Of a field and the slices that it was built from, or those of the whole scene that it lies in.
    pub fn new(field: &HeightField, heights: &'a [f32], extents: &'a [[f32; 2]]) -> Self {
        Self {
            field: *field,
            heights: &heights[field.first_height as usize..],
            extents: &extents[field.first_extent as usize..],
        }
    }

    /// Its measures.
    pub fn field(&self) -> &HeightField {
        &self.field
    }

    /// Lower and upper corner of the box that holds it.
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        let field = &self.field;
        let [low, high] = self.extents[0];
        [
            [field.x_at(0), field.y_at(field.rows - 1), low],
            [field.x_at(field.columns - 1), field.y_at(0), high],
        ]
    }

    /// A node of the tree. The root is node 0; children are numbered as those of a mesh's tree are, so that
    /// leaves are the indices of [`HeightGrid::block`] with [`LEAF`] set.
    #[inline(always)]
    pub fn node(&self, node: u32) -> WideNode {
        let field = &self.field;
        let leaves = leaves(field.rows, field.columns);
        // Which level, and where in it: levels come one after the other, the root's first.
        let (mut level, mut first) = (field.levels, 0);
        let mut size = [1, 1];
        while node - first >= size[0] * size[1] && level > 1 {
            first += size[0] * size[1];
            level -= 1;
            size = level_size(leaves, level);
        }
        let first_child = first + size[0] * size[1];
        let children = level_size(leaves, level - 1);
        let column = FAN * ((node - first) % size[0]);
        let row = FAN * ((node - first) / size[0]);
        let across = (children[0] - column).min(FAN);
        let down = (children[1] - row).min(FAN);

        let cells = 2 * (level - 1);
        let mut x = [0.0; FAN as usize + 1];
        let mut y = [0.0; FAN as usize + 1];
        for edge in 0..=FAN {
            let end = |start: u32, size: u32, last: u32| {
                ((u64::from(start + edge) << cells) * u64::from(size)).min(u64::from(last)) as u32
            };
            x[edge as usize] = field.x_at(end(column, LEAF_COLUMNS, field.columns - 1));
            y[edge as usize] = field.y_at(end(row, LEAF_ROWS, field.rows - 1));
        }

        let mut wide = WideNode { min: [[0.0; WIDTH]; 3], max: [[0.0; WIDTH]; 3], child: [NONE; WIDTH] };
        let mut lane = 0;
        for j in 0..down as usize {
            let first_in_row = (row + j as u32) * children[0] + column;
            for i in 0..across as usize {
                let child = first_in_row + i as u32;
                let [low, high] = self.extents[(first_child + child) as usize];
                (wide.min[0][lane], wide.max[0][lane]) = (x[i], x[i + 1]);
                (wide.min[1][lane], wide.max[1][lane]) = (y[j + 1], y[j]);
                (wide.min[2][lane], wide.max[2][lane]) = (low, high);
                wide.child[lane] = if level == 1 { LEAF | child } else { first_child + child };
                lane += 1;
            }
        }
        for unused in lane..WIDTH {
            for axis in 0..3 {
                wide.min[axis][unused] = wide.min[axis][lane - 1];
                wide.max[axis][unused] = wide.max[axis][lane - 1];
            }
        }
        wide
    }

    /// A leaf of the tree: the triangles of 4 × 2 cells.
    #[inline(always)]
    pub fn block(&self, block: u32) -> TriangleBlock {
        let field = &self.field;
        let [blocks_x, _] = leaves(field.rows, field.columns);
        let column = LEAF_COLUMNS * (block % blocks_x);
        let row = LEAF_ROWS * (block / blocks_x);
        let across = (field.columns - 1 - column).min(LEAF_COLUMNS) as usize;
        let down = (field.rows - 1 - row).min(LEAF_ROWS) as usize;

        let mut wide = TriangleBlock { corners: [[[0.0; WIDTH]; 3]; 3], triangle: [NONE; WIDTH] };
        let mut lane = 0;
        for j in 0..down {
            let mut left = self.column(row + j as u32, column);
            for i in 0..across {
                let right = self.column(row + j as u32, column + 1 + i as u32);
                let cell = (row + j as u32) * (field.columns - 1) + column + i as u32;
                for (odd, corners) in cut(left, right).into_iter().enumerate() {
                    for corner in 0..3 {
                        for axis in 0..3 {
                            wide.corners[corner][axis][lane] = corners[corner][axis];
                        }
                    }
                    wide.triangle[lane] = 2 * cell + odd as u32;
                    lane += 1;
                }
                left = right;
            }
        }
        for unused in lane..WIDTH {
            for corner in 0..3 {
                for axis in 0..3 {
                    wide.corners[corner][axis][unused] = wide.corners[0][axis][lane - 1];
                }
            }
        }
        wide
    }

    /// Corners of a triangle, bit for bit those of its block.
    #[inline(always)]
    pub fn triangle(&self, triangle: u32) -> [[f32; 3]; 3] {
        let cells = self.field.columns - 1;
        let (row, column) = (triangle / 2 / cells, triangle / 2 % cells);
        cut(self.column(row, column), self.column(row, column + 1))[(triangle % 2) as usize]
    }

    /// The corners of a cell that stand in one column, in rows `row` and `row` + 1.
    #[inline(always)]
    fn column(&self, row: u32, column: u32) -> [[f32; 3]; 2] {
        let field = &self.field;
        [row, row + 1].map(|row| {
            let height = self.heights[row as usize * field.columns as usize + column as usize];
            [field.x_at(column), field.y_at(row), height]
        })
    }
}

/// The two triangles of a cell, counter-clockwise seen from above, from its corners on the left and on the right.
#[inline(always)]
fn cut([up_left, down_left]: [[f32; 3]; 2], [up_right, down_right]: [[f32; 3]; 2]) -> [[[f32; 3]; 3]; 2] {
    [[up_left, down_left, up_right], [down_left, down_right, up_right]]
}

impl super::Scene<'_> {
    /// A height field of the scene; none if it has no such.
    pub fn height_field(&self, id: HeightFieldId) -> Option<HeightGrid<'_>> {
        let field = self.height_fields.get(id.0 as usize)?;
        Some(HeightGrid::new(field, self.heights, self.extents))
    }
}
