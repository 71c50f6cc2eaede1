//! Checks that an untrusted height field can be traversed.

use super::{FAN, HeightField, HeightGrid, LEAF_COLUMNS, LEAF_ROWS, leaves, level_size};
use crate::scene::SceneError;
use crate::scene::vertices::MAX_COORDINATE;

impl HeightField {
    /// Checks a field that comes from an untrusted source, such as a file: that its dimensions are consistent with each
    /// other and with its slices, that every height is valid, and that each node's range of heights is that of its
    /// children.
    ///
    /// # Errors
    /// The errors of [`HeightField::build`], and [`SceneError::BadTree`] with the first node whose range of heights does not
    /// match the field, or with 0 if the dimensions are inconsistent. Nodes are numbered as in [`HeightGrid::node`],
    /// and leaves follow them. A field without errors is traversed without a panic.
    pub fn validate(&self, heights: &[f32], extents: &[[f32; 2]]) -> Result<(), SceneError> {
        if self.rows < 2 || self.columns < 2 {
            return Err(SceneError::HeightFieldTooSmall);
        }
        let short = |buffer, have: usize, first: u32, need: u64| {
            let need = (u64::from(first) + need) as usize;
            if have < need { Err(SceneError::BufferTooSmall { buffer, have, need }) } else { Ok(()) }
        };
        short("heights", heights.len(), self.first_height, u64::from(self.rows) * u64::from(self.columns))?;
        let need = Self::extents_len(self.rows, self.columns);
        short("extents", extents.len(), self.first_extent, need as u64)?;

        let heights = &heights[self.first_height as usize..][..self.heights()];
        let expected = Self::measures(self.rows, self.columns, self.size, heights)?;
        let expected = Self { first_height: self.first_height, first_extent: self.first_extent, ..expected };
        if *self != expected {
            return Err(SceneError::BadTree(0));
        }
        let grid = HeightGrid { field: *self, heights, extents: &extents[self.first_extent as usize..] };
        (0..need as u32)
            .find(|&node| !grid.holds(node))
            .map_or(Ok(()), |bad| Err(SceneError::BadTree(bad as usize)))
    }

    /// The dimensions of a grid whose heights are at the start of the slices.
    pub(super) fn measures(
        rows: u32,
        columns: u32,
        size: [f64; 2],
        heights: &[f32],
    ) -> Result<Self, SceneError> {
        if rows < 2 || columns < 2 {
            return Err(SceneError::HeightFieldTooSmall);
        }
        if u64::from(rows) * u64::from(columns) != heights.len() as u64 {
            return Err(SceneError::HeightCount);
        }
        let in_range = |length: f64| (length as f32) > 0.0 && length <= f64::from(MAX_COORDINATE);
        if !size.iter().all(|length| in_range(*length)) {
            return Err(SceneError::BadSize);
        }
        // NaN fails the comparison as well.
        if let Some(bad) = heights.iter().position(|height| !matches!(height.abs(), 0.0..=MAX_COORDINATE)) {
            return Err(SceneError::BadHeight(bad));
        }
        let (levels, nodes) = Self::count_nodes(rows, columns);
        let [x, y] = leaves(rows, columns);
        // Every triangle has its own slot, in 32 bits together with the leaf flags.
        let slots = u64::from(x) * u64::from(y) * crate::simd::WIDTH as u64;
        if slots > u64::from(u32::MAX) || heights.len() as u64 > u64::from(u32::MAX) {
            return Err(SceneError::TooMany);
        }
        let step = [size[0] / f64::from(columns - 1), size[1] / f64::from(rows - 1)];
        Ok(Self { size, step, columns, rows, levels, nodes: nodes as u32, first_height: 0, first_extent: 0 })
    }
}

impl HeightGrid<'_> {
    /// Returns true if a node's range of heights is exactly that of its descendants.
    fn holds(&self, node: u32) -> bool {
        let field = &self.field;
        let leaves = leaves(field.rows, field.columns);
        let (mut level, mut first) = (field.levels, 0);
        let mut size = [1, 1];
        while node - first >= size[0] * size[1] {
            first += size[0] * size[1];
            level -= 1;
            size = level_size(leaves, level);
        }
        let (column, row) = ((node - first) % size[0], (node - first) / size[0]);
        let [low, high] = self.extents[node as usize];
        let mut seen = super::EMPTY;
        if level == 0 {
            for row in row * LEAF_ROWS..=((row + 1) * LEAF_ROWS).min(field.rows - 1) {
                for column in column * LEAF_COLUMNS..=((column + 1) * LEAF_COLUMNS).min(field.columns - 1) {
                    let height = self.heights[row as usize * field.columns as usize + column as usize];
                    seen = super::join(seen, [height; 2]);
                }
            }
        } else {
            let first_child = first + size[0] * size[1];
            let children = level_size(leaves, level - 1);
            for row in row * FAN..((row + 1) * FAN).min(children[1]) {
                for column in column * FAN..((column + 1) * FAN).min(children[0]) {
                    seen =
                        super::join(seen, self.extents[(first_child + row * children[0] + column) as usize]);
                }
            }
        }
        // Compared as numbers: −0 equals 0.
        [low, high] == seen
    }
}
