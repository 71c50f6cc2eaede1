//! Rays between those of a grid.

use super::{Rays, SphericalGrid, TableFan};
use crate::optics::{Intrinsics, Optics};
use crate::simd::sin_cos;
use glam::DVec3;

/// Gives directions between those of a grid, in the axes of the sensor and in units of t: of a pinhole in closed form,
/// of other lenses by interpolation between neighbours.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Between<'a> {
    Pinhole(Intrinsics),
    Spherical(SphericalGrid),
    Table(Rays<'a>),
}

/// A ray, and how directions change from the last one of its row to it and from it to the next; then the same down its
/// column.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Neighbours {
    middle: DVec3,
    changes: [[DVec3; 2]; 2],
}

impl Neighbours {
    /// The direction so many pixels to the right and down, at most one each; of length 1.
    #[inline(always)]
    pub(crate) fn direction(&self, right: f64, down: f64) -> DVec3 {
        let [across, along] = self.changes;
        let across = across[usize::from(right > 0.0)] * right;
        (self.middle + across + along[usize::from(down > 0.0)] * down).normalize()
    }

    /// How directions change per pixel along the row, and down the column.
    pub(crate) fn steps(&self) -> [DVec3; 2] {
        self.changes.map(|[before, after]| (before + after) * 0.5)
    }
}

impl<'a> Between<'a> {
    pub(crate) fn new(optics: &Optics<'a>) -> Self {
        match optics {
            Optics::Pinhole(grid) => Self::Pinhole(grid.intrinsics()),
            Optics::Spherical(grid) => Self::Spherical(*grid),
            Optics::Table(table) => Self::Table(Rays::Table(TableFan::new(table))),
        }
    }

    /// The intrinsics of a pinhole.
    #[inline(always)]
    pub(crate) fn pinhole(&self) -> Option<&Intrinsics> {
        match self {
            Self::Pinhole(lens) => Some(lens),
            Self::Spherical(_) | Self::Table(_) => None,
        }
    }

    /// The neighbourhood of a ray that there is.
    pub(crate) fn neighbours(&self, column: i32, row: i32) -> Neighbours {
        let middle = self.direction(column, row).unwrap_or(DVec3::X);
        let changes = [[1, 0], [0, 1]].map(|[x, y]| {
            let after = self.direction(column + x, row + y).map(|next| next - middle);
            let before = self.direction(column - x, row - y).map(|last| middle - last);
            // Beyond the edge it goes on as within.
            [before.or(after), after.or(before)].map(Option::unwrap_or_default)
        });
        Neighbours { middle, changes }
    }

    fn direction(&self, column: i32, row: i32) -> Option<DVec3> {
        match self {
            Self::Pinhole(lens) => {
                let left = (lens.cx - f64::from(column)) / lens.fx;
                Some(DVec3::new(1.0, left, (lens.cy - f64::from(row)) / lens.fy))
            }
            Self::Spherical(grid) => {
                let (sin, cos) = sin_cos(grid.first_azimuth_rad + grid.azimuth_step_rad * f64::from(column));
                let (up, level) =
                    sin_cos(grid.first_elevation_rad + grid.elevation_step_rad * f64::from(row));
                Some(DVec3::new(cos * level, sin * level, up))
            }
            Self::Table(rays) => {
                let fan = rays.fan();
                let inside = (0..fan.width).contains(&column) && (0..fan.height).contains(&row);
                (inside && rays.has(column, row)).then(|| rays.direction(column, row))
            }
        }
    }
}
