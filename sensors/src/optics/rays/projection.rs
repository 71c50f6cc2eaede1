//! Bounds on the part of the grid of rays in which something may be visible.

use super::ray_grid::RayGrid;
use crate::simd::WIDTH;
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x16, i32x16, mask32x16};
use glam::DVec3;

/// Distances below this, in metres, are treated as equal in projections.
pub(crate) const TINY: f32 = 1e-12;

/// Sixteen rectangles of the grid, both ends included. Where a grid closes to a ring, columns may exceed the last one
/// and then wrap to column 0.
pub(crate) struct Rectangles<S: Simd> {
    pub(crate) first_column: i32x16<S>,
    pub(crate) last_column: i32x16<S>,
    pub(crate) first_row: i32x16<S>,
    pub(crate) last_row: i32x16<S>,
    /// The rectangles that contain a ray.
    pub(crate) some: mask32x16<S>,
}

/// Coordinates of sixteen points: all x, all y, all z.
pub(crate) type Points<S> = [f32x16<S>; 3];

/// Sixteen planes through the origin, or plane equations of 1/t: each coefficient for all sixteen.
pub(crate) type Planes<S> = [f32x16<S>; 3];

/// A rule that defines the directions of a grid of rays. The sensor looks along +x; y is left, z is up.
///
/// Every method that returns a direction returns the same bits for the same ray, since two triangles that share an edge
/// may be drawn by different loops.
pub(crate) trait Projection: Copy {
    /// The directions of sixteen rays, as returned by [`Projection::block`].
    type Directions<S: Simd>: Copy;

    /// Precomputed values, the same for all blocks, for converting directions to other axes.
    type Turning;

    /// Whether [`Projection::most_over_strip`] returns useful bounds.
    const HAS_STRIPS: bool = false;

    fn ray_grid(&self) -> &RayGrid;

    /// The same projection, restricted to drawing the rows from the first to the last of `rows`.
    fn with_rows(self, rows: [i32; 2]) -> Self;

    /// The exact direction of a ray, in units of t.
    fn direction(&self, column: i32, row: i32) -> DVec3;

    /// The exact directions of the rays of a block, in units of t: all x, all y, all z.
    fn exact_block(&self, column: usize, row: usize) -> [[f64; WIDTH]; 3];

    /// Precomputes the argument of [`Projection::turned`] from the rows of a matrix that converts the sensor's axes to
    /// others.
    fn turning(&self, rows: &[[f64; 3]; 3]) -> Self::Turning;

    /// The directions of the rays of a block in other axes, in double precision: all x, all y, all z.
    fn turned<S: Simd>(
        &self,
        simd: S,
        turning: &Self::Turning,
        column: usize,
        row: usize,
    ) -> [[f64; WIDTH]; 3];

    /// The directions of the rays of a block.
    fn block<S: Simd>(&self, simd: S, column: usize, row: usize) -> Self::Directions<S>;

    /// The directions of sixteen rays, one for each lane.
    fn rays<S: Simd>(&self, simd: S, columns: i32x16<S>, rows: i32x16<S>) -> Self::Directions<S>;

    /// The direction of one ray in all sixteen lanes.
    fn ray<S: Simd>(&self, simd: S, column: i32, row: i32) -> Self::Directions<S>;

    /// plane · direction, lane by lane.
    fn dot<S: Simd>(plane: &Planes<S>, directions: &Self::Directions<S>) -> f32x16<S>;

    /// An upper bound of 1/t for anything in the boxes.
    fn inverse_of_boxes<S: Simd>(&self, simd: S, low: &Points<S>, high: &Points<S>) -> f32x16<S>;

    /// Rectangles of the rays that may pass through the boxes.
    fn bound_boxes<S: Simd>(&self, simd: S, low: &Points<S>, high: &Points<S>) -> Rectangles<S>;

    /// Rectangles of the rays that may pass through triangles, and an upper bound of 1/t on them.
    fn bound_triangles<S: Simd>(
        &self,
        simd: S,
        corners: &[Points<S>; 3],
        valid: mask32x16<S>,
    ) -> (Rectangles<S>, f32x16<S>);

    /// An upper bound of plane · direction over the rays of each of the sixteen blocks from `column` on.
    fn most_over_blocks<S: Simd>(&self, simd: S, plane: &[f32; 3], column: usize, row: usize) -> f32x16<S>;

    /// Upper bounds of plane · direction for sixteen planes over the rays of one block, which is a single row.
    #[inline(always)]
    fn most_over_strip<S: Simd>(
        &self,
        simd: S,
        _planes: &Planes<S>,
        _column: usize,
        _row: usize,
    ) -> f32x16<S> {
        f32x16::splat(simd, f32::MAX)
    }

    /// Two planes through the origin that enclose all rays of a block that is a strip: plane · direction is positive
    /// for both, by more than the rounding error. `None` if they would not enclose the rays tightly.
    #[inline(always)]
    fn slab(&self, _column: usize, _row: usize) -> Option<[[f32; 3]; 2]> {
        None
    }
}

/// The methods of [`Projection`] for a rule that stores its grid in `ray_grid`, and the rows to draw in `rows`.
macro_rules! of_rows {
    () => {
        #[inline(always)]
        fn ray_grid(&self) -> &RayGrid {
            &self.ray_grid
        }

        #[inline(always)]
        fn with_rows(self, rows: [i32; 2]) -> Self {
            Self { rows, ..self }
        }
    };
}
pub(super) use of_rows;

/// The methods of [`Projection`] for a rule whose directions have three coordinates and length 1.
macro_rules! of_length_one {
    () => {
        type Directions<S: Simd> = [f32x16<S>; 3];
        type Turning = [[f64; 3]; 3];

        #[inline(always)]
        fn turning(&self, rows: &[[f64; 3]; 3]) -> Self::Turning {
            *rows
        }

        #[inline(always)]
        fn turned<S: Simd>(
            &self,
            simd: S,
            rows: &Self::Turning,
            column: usize,
            row: usize,
        ) -> [[f64; WIDTH]; 3] {
            let [x, y, z] = self.exact(simd, column, row);
            let mut turned = [[0.0; WIDTH]; 3];
            for axis in 0..3 {
                let [a, b, c] = rows[axis];
                for half in 0..2 {
                    let along = (x[half] * a + y[half] * b) + z[half] * c;
                    along.store_slice(&mut turned[axis][half * 8..][..8]);
                }
            }
            turned
        }

        #[inline(always)]
        fn dot<S: Simd>(plane: &Planes<S>, directions: &Self::Directions<S>) -> f32x16<S> {
            dot(plane, directions)
        }

        #[inline(always)]
        fn inverse_of_boxes<S: Simd>(&self, simd: S, low: &Points<S>, high: &Points<S>) -> f32x16<S> {
            inverse_distance(simd, low, high)
        }
    };
}
pub(super) use of_length_one;

/// Lower and upper bounds of three points, for each coordinate.
#[inline(always)]
pub(crate) fn bounds_of<S: Simd>(corners: &[Points<S>; 3]) -> (Points<S>, Points<S>) {
    let [a, b, c] = corners;
    let low = [min(min(a[0], b[0]), c[0]), min(min(a[1], b[1]), c[1]), min(min(a[2], b[2]), c[2])];
    let high = [max(max(a[0], b[0]), c[0]), max(max(a[1], b[1]), c[1]), max(max(a[2], b[2]), c[2])];
    (low, high)
}

/// The distance of 0 from an interval; 0 inside.
#[inline(always)]
pub(crate) fn outside<S: Simd>(low: f32x16<S>, high: f32x16<S>) -> f32x16<S> {
    max(max(low, -high), f32x16::splat(low.simd, 0.0))
}

/// The inverse of the distance of boxes, slightly enlarged: an upper bound of 1/t for directions of length 1.
#[inline(always)]
pub(crate) fn inverse_distance<S: Simd>(simd: S, low: &Points<S>, high: &Points<S>) -> f32x16<S> {
    let [x, y, z] = [outside(low[0], high[0]), outside(low[1], high[1]), outside(low[2], high[2])];
    let distance = ((x * x + y * y) + z * z).sqrt();
    f32x16::splat(simd, 1.0001) / max(distance, f32x16::splat(simd, TINY))
}

/// plane · direction in three dimensions.
#[inline(always)]
pub(crate) fn dot<S: Simd>(plane: &Planes<S>, direction: &Points<S>) -> f32x16<S> {
    (plane[0] * direction[0] + plane[1] * direction[1]) + plane[2] * direction[2]
}

/// The minimum. Arguments are never NaN, for which SIMD levels differ.
#[inline(always)]
pub(crate) fn min<S: Simd>(a: f32x16<S>, b: f32x16<S>) -> f32x16<S> {
    a.simd.min_f32x16(a, b)
}

/// The maximum. Arguments are never NaN.
#[inline(always)]
pub(crate) fn max<S: Simd>(a: f32x16<S>, b: f32x16<S>) -> f32x16<S> {
    a.simd.max_f32x16(a, b)
}

/// The first and last integer from `least` to `most` in the intervals widened by `margin`; first > last if there are
/// none.
#[inline(always)]
pub(crate) fn whole<S: Simd>(
    simd: S,
    [first, last]: [f32x16<S>; 2],
    margin: f32,
    [least, most]: [i32; 2],
) -> [i32x16<S>; 2] {
    let (least, most) = (f32x16::splat(simd, least as f32), f32x16::splat(simd, most as f32));
    let first = simd.ceil_f32x16(min(max(first - margin, least), most + 1.0));
    let last = simd.floor_f32x16(max(min(last + margin, most), least - 1.0));
    [simd.cvt_i32_f32x16(first), simd.cvt_i32_f32x16(last)]
}
