//! Nodes and leaves of a height field's tree, generated when they are visited.

use super::{FAN, HeightField, LEAF_COLUMNS, LEAF_ROWS, leaves, level_size};
use crate::scene::tree::{LEAF, NONE, TriangleBlock, WideNode};
use crate::simd::WIDTH;
use fearless_simd::{Simd, SimdBase, f32x4};

/// Number of heights along a row, and number of rows of heights, in a full leaf.
const WIDE: usize = LEAF_COLUMNS as usize + 1;
const HIGH: usize = LEAF_ROWS as usize + 1;

/// Corners of the even and the odd triangle of a cell, as steps down and to the right from its first height,
/// counter-clockwise seen from above.
const CUT: [[[usize; 2]; 3]; 2] = [[[0, 0], [1, 0], [0, 1]], [[1, 0], [1, 1], [0, 1]]];

/// Indices in [`HeightGrid::vertices`] of the corners of each triangle of a leaf.
pub(crate) const CORNERS: [[usize; WIDTH]; 3] = corners();

const fn corners() -> [[usize; WIDTH]; 3] {
    let mut corners = [[0; WIDTH]; 3];
    let mut lane = 0;
    while lane < WIDTH {
        let (j, i) = (lane / 2 / LEAF_COLUMNS as usize, lane / 2 % LEAF_COLUMNS as usize);
        let mut corner = 0;
        while corner < 3 {
            let [down, right] = CUT[lane % 2][corner];
            corners[corner][lane] = vertex(j + down, i + right);
            corner += 1;
        }
        lane += 1;
    }
    corners
}

/// Index of a vertex in [`HeightGrid::vertices`]: four of each row, then the last of each row.
const fn vertex(row: usize, column: usize) -> usize {
    if column + 1 < WIDE { row * (WIDE - 1) + column } else { HIGH * (WIDE - 1) + row }
}

/// A height field with its data: the tree that is traversed.
#[derive(Debug, Clone, Copy)]
pub struct HeightGrid<'a> {
    pub(super) field: HeightField,
    pub(super) heights: &'a [f32],
    pub(super) extents: &'a [[f32; 2]],
}

impl<'a> HeightGrid<'a> {
    /// Creates the grid of a field from the slices from which it was built; `None` if they are too short.
    pub fn new(field: &HeightField, heights: &'a [f32], extents: &'a [[f32; 2]]) -> Option<Self> {
        let enough = heights.len() >= field.first_height as usize + field.heights()
            && extents.len()
                >= field.first_extent as usize + HeightField::extents_len(field.rows, field.columns);
        enough.then(|| Self::of(field, heights, extents))
    }

    /// Creates the grid of a field from the slices of its scene.
    #[inline(always)]
    pub(crate) fn of(field: &HeightField, heights: &'a [f32], extents: &'a [[f32; 2]]) -> Self {
        Self {
            field: *field,
            heights: &heights[field.first_height as usize..],
            extents: &extents[field.first_extent as usize..],
        }
    }

    /// The height field without its data.
    pub fn field(&self) -> &HeightField {
        &self.field
    }

    /// Lower and upper corner of the bounding box.
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        let field = &self.field;
        let [low, high] = self.extents[0];
        [
            [field.x_at(0), field.y_at(field.rows - 1), low],
            [field.x_at(field.columns - 1), field.y_at(0), high],
        ]
    }

    /// Generates a node of the tree. The root is node 0. Children are numbered as in the tree of a mesh; leaves are
    /// indices for [`HeightGrid::block`] with [`LEAF`] set.
    ///
    /// # Panics
    /// If no node has this index.
    #[inline(always)]
    pub fn node(&self, node: u32) -> WideNode {
        let field = &self.field;
        let leaves = leaves(field.rows, field.columns);
        // The level, and the index within it: levels are consecutive, starting with the root's.
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

        let shift = 2 * (level - 1);
        let mut x = [0.0; FAN as usize + 1];
        let mut y = [0.0; FAN as usize + 1];
        for edge in 0..=FAN {
            let end = |start: u32, cells: u32, last: u32| {
                ((u64::from(start + edge) << shift) * u64::from(cells)).min(u64::from(last)) as u32
            };
            x[edge as usize] = field.x_at(end(column, LEAF_COLUMNS, field.columns - 1));
            y[edge as usize] = field.y_at(end(row, LEAF_ROWS, field.rows - 1));
        }

        // All sixteen, repeating the last row and column if there are fewer, without branching.
        let mut wide = WideNode { min: [[0.0; WIDTH]; 3], max: [[0.0; WIDTH]; 3], child: [NONE; WIDTH] };
        let flag = if level == 1 { LEAF } else { first_child };
        for j in 0..FAN as usize {
            let row = (row + j as u32).min(children[1] - 1);
            for i in 0..FAN as usize {
                let lane = j * FAN as usize + i;
                let child = row * children[0] + (column + i as u32).min(children[0] - 1);
                let [low, high] = self.extents[(first_child + child) as usize];
                (wide.min[0][lane], wide.max[0][lane]) = (x[i], x[i + 1]);
                (wide.min[1][lane], wide.max[1][lane]) = (y[j + 1], y[j]);
                (wide.min[2][lane], wide.max[2][lane]) = (low, high);
                wide.child[lane] = flag + child;
            }
        }
        let (across, down) = (children[0] - column, children[1] - row);
        if across < FAN || down < FAN {
            trim_node(&mut wide, across.min(FAN) as usize, down.min(FAN) as usize);
        }
        wide
    }

    /// The vertices of a leaf, row by row except for the last column, as indexed by [`CORNERS`]. `None` for a smaller
    /// leaf at the edge.
    #[inline(always)]
    pub(crate) fn vertices<S: Simd>(&self, simd: S, block: u32) -> Option<[[f32; WIDTH]; 3]> {
        let field = &self.field;
        let [blocks_x, _] = leaves(field.rows, field.columns);
        let column = LEAF_COLUMNS * (block % blocks_x);
        let row = LEAF_ROWS * (block / blocks_x);
        if column + LEAF_COLUMNS >= field.columns || row + LEAF_ROWS >= field.rows {
            return None;
        }
        let (mut x, mut y) = ([0.0; WIDE], [0.0; HIGH]);
        for i in 0..WIDE {
            x[i] = field.x_at(column + i as u32);
        }
        for j in 0..HIGH {
            y[j] = field.y_at(row + j as u32);
        }
        let z = [self.line(row, column)?, self.line(row + 1, column)?, self.line(row + 2, column)?];
        let along = x.first_chunk()?;
        let last = [z[0][4], z[1][4], z[2][4], z[2][4]];
        Some([
            join(simd, [along, along, along, &[x[4]; 4]]),
            join(simd, [&[y[0]; 4], &[y[1]; 4], &[y[2]; 4], &[y[0], y[1], y[2], y[2]]]),
            join(simd, [z[0].first_chunk()?, z[1].first_chunk()?, z[2].first_chunk()?, &last]),
        ])
    }

    /// Generates a leaf of the tree: the triangles of 4 × 2 cells.
    ///
    /// # Panics
    /// If the block is not one of [`HeightField::blocks`].
    #[inline(always)]
    pub fn block(&self, block: u32) -> TriangleBlock {
        let field = &self.field;
        let [blocks_x, _] = leaves(field.rows, field.columns);
        let column = LEAF_COLUMNS * (block % blocks_x);
        let row = LEAF_ROWS * (block / blocks_x);

        let mut x = [0.0; WIDE];
        let mut y = [0.0; HIGH];
        let mut z = [[0.0; WIDE]; HIGH];
        for i in 0..WIDE {
            x[i] = field.x_at((column + i as u32).min(field.columns - 1));
        }
        for j in 0..HIGH {
            let row = (row + j as u32).min(field.rows - 1);
            y[j] = field.y_at(row);
            let line = &self.heights[row as usize * field.columns as usize..][..field.columns as usize];
            if let Some(heights) = line[column as usize..].first_chunk() {
                z[j] = *heights;
            } else {
                for i in 0..WIDE {
                    z[j][i] = line[(column as usize + i).min(line.len() - 1)];
                }
            }
        }

        let mut wide = TriangleBlock { corners: [[[0.0; WIDTH]; 3]; 3], triangle: [NONE; WIDTH] };
        let cells = field.columns - 1;
        for corner in 0..3 {
            for lane in 0..WIDTH {
                let (j, i) = (lane / 2 / LEAF_COLUMNS as usize, lane / 2 % LEAF_COLUMNS as usize);
                let [down, right] = CUT[lane % 2][corner];
                wide.corners[corner][0][lane] = x[i + right];
                wide.corners[corner][1][lane] = y[j + down];
                wide.corners[corner][2][lane] = z[j + down][i + right];
            }
        }
        for lane in 0..WIDTH as u32 {
            let cell = (row + lane / 2 / LEAF_COLUMNS) * cells + column + lane / 2 % LEAF_COLUMNS;
            wide.triangle[lane as usize] = 2 * cell + lane % 2;
        }
        let (across, down) = (cells - column, field.rows - 1 - row);
        if across < LEAF_COLUMNS || down < LEAF_ROWS {
            trim_block(&mut wide, across.min(LEAF_COLUMNS) as usize, down.min(LEAF_ROWS) as usize);
        }
        wide
    }

    /// Index of the triangle in a used lane of a leaf.
    ///
    /// # Panics
    /// If the block is not one of [`HeightField::blocks`].
    #[inline(always)]
    pub fn triangle_of(&self, block: u32, lane: u32) -> u32 {
        let [row, column] = self.cell(block, lane);
        2 * (row * (self.field.columns - 1) + column) + lane % 2
    }

    /// Slopes along x and along y of the triangle in a lane of a leaf.
    #[inline(always)]
    pub(crate) fn slopes(&self, block: u32, lane: u32) -> [f32; 2] {
        let [row, column] = self.cell(block, lane);
        // Two of its corners are on one row of heights, and two on one column.
        let [on_row, on_column] = [row + lane % 2, column + lane % 2];
        let along_x = self.height(on_row, column + 1) - self.height(on_row, column);
        let along_y = self.height(row, on_column) - self.height(row + 1, on_column);
        let [x, y] = self.field.step;
        [along_x / x as f32, along_y / y as f32]
    }

    /// Row and column of the cell of the triangle in a lane of a leaf.
    #[inline(always)]
    fn cell(&self, block: u32, lane: u32) -> [u32; 2] {
        let field = &self.field;
        let [blocks_x, _] = leaves(field.rows, field.columns);
        let (column, row) = (LEAF_COLUMNS * (block % blocks_x), LEAF_ROWS * (block / blocks_x));
        // Leaves at the edge may be narrower, and number their lanes by their actual columns.
        let across = LEAF_COLUMNS.min(field.columns - 1 - column);
        [row + lane / 2 / across, column + lane / 2 % across]
    }

    /// Corners of a triangle, bit for bit the same as in its block.
    ///
    /// # Panics
    /// If the triangle is not one of [`HeightField::triangles`].
    #[inline(always)]
    pub fn triangle(&self, triangle: u32) -> [[f32; 3]; 3] {
        let cells = self.field.columns - 1;
        let (row, column) = (triangle / 2 / cells, triangle / 2 % cells);
        let mut corners = [[0.0; 3]; 3];
        for (corner, [down, right]) in corners.iter_mut().zip(CUT[(triangle % 2) as usize]) {
            let (row, column) = (row + down as u32, column + right as u32);
            *corner = [self.field.x_at(column), self.field.y_at(row), self.height(row, column)];
        }
        corners
    }

    /// The heights of one row of a leaf.
    #[inline(always)]
    fn line(&self, row: u32, column: u32) -> Option<&'a [f32; WIDE]> {
        self.heights[row as usize * self.field.columns as usize + column as usize..].first_chunk()
    }

    #[inline(always)]
    fn height(&self, row: u32, column: u32) -> f32 {
        self.heights[row as usize * self.field.columns as usize + column as usize]
    }
}

/// Joins sixteen values as vectors: values that are stored in parts are slow to load as a whole.
#[inline(always)]
fn join<S: Simd>(simd: S, [a, b, c, d]: [&[f32; 4]; 4]) -> [f32; WIDTH] {
    let [a, b] = [f32x4::load_array_ref(simd, a), f32x4::load_array_ref(simd, b)];
    let [c, d] = [f32x4::load_array_ref(simd, c), f32x4::load_array_ref(simd, d)];
    let mut joined = [0.0; WIDTH];
    simd.combine_f32x8(simd.combine_f32x4(a, b), simd.combine_f32x4(c, d)).store_array(&mut joined);
    joined
}

/// Keeps the first columns and rows of children, and marks the lanes after them as unused.
#[cold]
fn trim_node(wide: &mut WideNode, across: usize, down: usize) {
    let used = across * down;
    for lane in 0..WIDTH {
        let kept = lane.min(used - 1);
        let from = kept / across * FAN as usize + kept % across;
        for axis in 0..3 {
            wide.min[axis][lane] = wide.min[axis][from];
            wide.max[axis][lane] = wide.max[axis][from];
        }
        wide.child[lane] = if lane < used { wide.child[from] } else { NONE };
    }
}

/// Trims the cells of a leaf in the same way, two triangles per cell.
#[cold]
fn trim_block(wide: &mut TriangleBlock, across: usize, down: usize) {
    let used = 2 * across * down;
    for lane in 0..used {
        let from = 2 * (lane / 2 / across * LEAF_COLUMNS as usize + lane / 2 % across) + lane % 2;
        for corner in 0..3 {
            for axis in 0..3 {
                wide.corners[corner][axis][lane] = wide.corners[corner][axis][from];
            }
        }
        wide.triangle[lane] = wide.triangle[from];
    }
    for lane in used..WIDTH {
        for corner in 0..3 {
            for axis in 0..3 {
                wide.corners[corner][axis][lane] = wide.corners[0][axis][used - 1];
            }
        }
        wide.triangle[lane] = NONE;
    }
}
