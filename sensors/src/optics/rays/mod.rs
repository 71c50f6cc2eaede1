//! The rays of a frame, whatever rule defines their directions.
//!
//! Only the drawing code is compiled for each rule, since its inner loops depend on the directions. Later stages
//! (distances, normals, colours) request the directions of sixteen rays at a time and are compiled once.

mod between;
mod find;
mod pinhole;
mod projection;
mod ray_grid;
mod spherical;
mod table;

pub use pinhole::PinholeGrid;
pub(crate) use pinhole::PinholeRays;
pub(crate) use projection::{Planes, Points, Projection, Rectangles, dot, max, min};
pub(crate) use ray_grid::RayGrid;
pub use spherical::SphericalGrid;
pub(crate) use spherical::{AngleSteps, SphericalRays};
#[cfg(feature = "alloc")]
pub use table::RayTableBuf;
pub(crate) use table::TableRays;
pub use table::{RayTable, TableError};

use crate::simd::WIDTH;
use fearless_simd::{Simd, SimdBase, SimdNarrow, f32x16, f64x8};
use glam::DVec3;

/// The rule that defines the directions of a frame's rays, in the axes of the sensor: x forward, y left, z up.
#[allow(clippy::large_enum_variant, reason = "one a frame: a heap there may not be")]
#[derive(Debug, Clone, Copy)]
pub(crate) enum Rays<'a> {
    /// Length 1 along the optical axis: t is the depth.
    Pinhole(PinholeRays),
    /// Length 1: t is the range.
    Spherical(SphericalRays<'a>),
    /// Length 1: t is the range.
    Table(TableRays<'a>),
}

/// Evaluates an expression for the actual rule.
macro_rules! each {
    ($rays:expr, $rule:ident => $value:expr) => {
        match $rays {
            Rays::Pinhole($rule) => $value,
            Rays::Spherical($rule) => $value,
            Rays::Table($rule) => $value,
        }
    };
}
pub(crate) use each;

impl Rays<'_> {
    #[inline(always)]
    pub(crate) fn ray_grid(&self) -> &RayGrid {
        each!(self, rule => rule.ray_grid())
    }

    /// The exact direction of a ray, in units of t.
    pub(crate) fn direction(&self, column: i32, row: i32) -> DVec3 {
        each!(self, rule => rule.direction(column, row))
    }

    /// Returns true if the ray exists.
    pub(crate) fn has(&self, column: i32, row: i32) -> bool {
        let ray_grid = self.ray_grid();
        let lanes = self.missing((column >> ray_grid.shift_x) as usize, (row >> ray_grid.shift_y) as usize);
        lanes >> ray_grid.lane(column, row) & 1 == 0
    }

    /// The exact directions of the rays of a block, in units of t: all x, all y, all z.
    #[inline(always)]
    pub(crate) fn exact_block(&self, column: usize, row: usize) -> [[f64; WIDTH]; 3] {
        each!(self, rule => rule.exact_block(column, row))
    }

    /// The slopes of the rays of sixteen adjacent pixels in a row: metres to the right and down per metre of depth.
    /// `column` must be a multiple of sixteen. Lanes beyond the end of the row have arbitrary values.
    #[inline(always)]
    pub(crate) fn slopes<S: Simd>(&self, simd: S, column: usize, row: usize) -> [f32x16<S>; 2] {
        match self {
            Self::Pinhole(rule) => rule.slopes(simd, column, row),
            Self::Spherical(rule) => slopes_of(simd, rule.exact_line(simd, column, row)),
            Self::Table(rule) => slopes_of(simd, rule.exact_line(simd, column, row)),
        }
    }

    /// The directions of the rays of a block, in units of t.
    #[inline(always)]
    pub(crate) fn directions<S: Simd>(&self, simd: S, column: usize, row: usize) -> Points<S> {
        match self {
            Self::Pinhole(rule) => {
                let [y, z] = rule.block(simd, column, row);
                [f32x16::splat(simd, 1.0), y, z]
            }
            Self::Spherical(rule) => rule.block(simd, column, row),
            Self::Table(rule) => rule.block(simd, column, row),
        }
    }

    /// The directions of the rays of a block, of length 1.
    #[inline(always)]
    pub(crate) fn unit_directions<S: Simd>(&self, simd: S, column: usize, row: usize) -> Points<S> {
        match self {
            Self::Pinhole(rule) => rule.unit_directions(simd, column, row),
            Self::Spherical(rule) => rule.block(simd, column, row),
            Self::Table(rule) => rule.block(simd, column, row),
        }
    }

    /// Distances in metres along the rays of a block, from 1/t.
    #[inline(always)]
    pub(crate) fn distances<S: Simd>(
        &self,
        simd: S,
        inverse: f32x16<S>,
        column: usize,
        row: usize,
    ) -> f32x16<S> {
        match self {
            Self::Pinhole(rule) => rule.distances(simd, inverse, column, row),
            Self::Spherical(_) | Self::Table(_) => f32x16::splat(simd, 1.0) / inverse,
        }
    }

    /// Depths in metres along the optical axis of the points hit by the rays of a block, from 1/t.
    #[inline(always)]
    pub(crate) fn depths<S: Simd>(
        &self,
        simd: S,
        inverse: f32x16<S>,
        column: usize,
        row: usize,
    ) -> f32x16<S> {
        match self {
            Self::Pinhole(_) => f32x16::splat(simd, 1.0) / inverse,
            Self::Spherical(rule) => rule.block(simd, column, row)[0] / inverse,
            Self::Table(rule) => rule.block(simd, column, row)[0] / inverse,
        }
    }

    /// The lanes of a block without a ray, as one bit each: pixels outside the domain of their lens.
    #[inline(always)]
    pub(crate) fn missing(&self, column: usize, row: usize) -> u16 {
        match self {
            Self::Pinhole(_) | Self::Spherical(_) => 0,
            Self::Table(rule) => rule.missing(column, row),
        }
    }
}

/// The slopes of exact directions, eight lanes at a time.
#[inline(always)]
fn slopes_of<S: Simd>(simd: S, [x, y, z]: [[f64x8<S>; 2]; 3]) -> [f32x16<S>; 2] {
    let zero = f64x8::splat(simd, 0.0);
    [((zero - y[0]) / x[0]).narrow((zero - y[1]) / x[1]), ((zero - z[0]) / x[0]).narrow((zero - z[1]) / x[1])]
}
