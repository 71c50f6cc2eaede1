//! Ray directions between the pixels of a grid.

use super::Rays;
use glam::DVec3;

/// A ray, the changes of direction from its left neighbour to it and from it to its right neighbour, and the same along
/// its column.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Neighbours {
    middle: DVec3,
    changes: [[DVec3; 2]; 2],
}

impl Neighbours {
    /// The direction at an offset of at most one pixel each to the right and down, interpolated and of length 1.
    #[inline(always)]
    pub(crate) fn direction(&self, right: f64, down: f64) -> DVec3 {
        let [across, along] = self.changes;
        let across = across[usize::from(right > 0.0)] * right;
        (self.middle + across + along[usize::from(down > 0.0)] * down).normalize()
    }

    /// The change of direction per pixel along the row, and down the column.
    pub(crate) fn steps(&self) -> [DVec3; 2] {
        self.changes.map(|[before, after]| (before + after) * 0.5)
    }
}

impl Rays<'_> {
    /// The neighbourhood of a ray, which must exist.
    pub(crate) fn neighbours(&self, column: i32, row: i32) -> Neighbours {
        let ray_grid = self.ray_grid();
        let middle = self.direction(column, row);
        let at = |column: i32, row: i32| {
            let inside = (0..ray_grid.width).contains(&column) && (0..ray_grid.height).contains(&row);
            (inside && self.has(column, row)).then(|| self.direction(column, row))
        };
        let changes = [[1, 0], [0, 1]].map(|[x, y]| {
            let after = at(column + x, row + y).map(|next| next - middle);
            let before = at(column - x, row - y).map(|last| middle - last);
            // Beyond the edge, directions continue as inside.
            [before.or(after), after.or(before)].map(Option::unwrap_or_default)
        });
        Neighbours { middle, changes }
    }
}
