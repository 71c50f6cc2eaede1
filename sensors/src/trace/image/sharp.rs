//! What single precision does not see sharply enough, in double precision.
//!
//! Corners in the sensor's frame are rounded by a share of their distance. That matters where the triangle's plane
//! passes the sensor much nearer than its corners lie, and where a triangle is so thin that its normal is a small
//! difference of large products: its planes are made again from the corners as they are stored. And a ray that runs
//! nearly along a plane meets it at an 1/t that is a small difference itself: of such rays 1/t is worked out from
//! directions in double precision. Both are rare, and found out by set-up and loops of [`super::triangles`].

use super::projection::Projection;
use crate::scene::tree::{TriangleBlock, WIDTH};
use crate::trace::view::{Placed, View};
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, mask32x16};
use glam::{DMat3, DVec3};

/// (Distance of the farthest corner from the sensor / that of the plane)² from which on a triangle is blurred. Below,
/// no ray meets it at less than the angle of [`GRAZING_SQUARED`].
pub(super) const BLURRED_SQUARED: f32 = 700.0;
/// (1 / sine of the angle between ray and plane)² from which on 1/t is worked out in double precision: 1.8°.
pub(super) const GRAZING_SQUARED: f32 = 1000.0;
/// The same as [`BLURRED_SQUARED`] of an edge and its own ends. So much more that both triangles of such an edge are
/// blurred, and give it the same plane: no ray slips between them.
const BLURRED_EDGE_SQUARED: f64 = 1600.0;

/// Where the triangles of a leaf come from.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) view: &'a View<'a>,
    pub(super) placed: &'a Placed,
    pub(super) block: &'a TriangleBlock,
}

/// Planes of sixteen triangles.
pub(super) struct PlaneArrays {
    /// Through the origin and the edges, positive inside.
    pub(super) edges: [[[f32; WIDTH]; 3]; 3],
    /// Of 1/t.
    pub(super) inverse: [[f32; WIDTH]; 3],
    /// Lanes whose triangles have the sensor behind them, and in front.
    pub(super) behind: u64,
    pub(super) front: u64,
}

impl Source<'_> {
    /// Corners from the sensor, in the axes of the instance.
    fn corners(&self, lane: usize) -> [DVec3; 3] {
        let origin = DVec3::from_array(self.placed.origin_in_instance);
        let corner =
            |[x, y, z]: &[[f32; WIDTH]; 3]| DVec3::new(x[lane].into(), y[lane].into(), z[lane].into());
        self.block.corners.each_ref().map(|axes| corner(axes) - origin)
    }

    /// Plane of 1/t of a triangle, in the sensor's axes.
    fn inverse(&self, lane: usize) -> DVec3 {
        let [a, b, c] = self.corners(lane);
        let normal = (b - a).cross(c - a);
        let volume = normal.dot(a);
        let [x, y, z] = self.view.rows_from_sensor(self.placed).map(DVec3::from_array);
        (x * normal.x + y * normal.y + z * normal.z) / volume
    }

    /// Makes the planes of the triangles in `lanes` again.
    #[cold]
    #[inline(never)]
    pub(super) fn sharpen(&self, mut lanes: u64, planes: &mut PlaneArrays) {
        let sensor_from_instance = self.view.sensor_from_world * DMat3::from_cols_array_2d(&self.placed.axes);
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize & (WIDTH - 1);
            let bit = 1 << lane;
            lanes &= lanes - 1;
            let [a, b, c] = self.corners(lane).map(|corner| sensor_from_instance * corner);
            let normal = (b - a).cross(c - a);
            let volume = normal.dot(a);
            let (was_behind, behind) = (planes.behind & bit != 0, volume > 0.0);
            planes.behind = planes.behind & !bit | if behind { bit } else { 0 };
            planes.front = planes.front & !bit | if volume < 0.0 { bit } else { 0 };
            let sign = if behind { 1.0 } else { -1.0 };
            let inverse = self.inverse(lane);
            for axis in 0..3 {
                planes.inverse[axis][lane] = inverse[axis] as f32;
            }
            for (plane, [p, q]) in planes.edges.iter_mut().zip([[b, c], [c, a], [a, b]]) {
                let sharp = (p + q).cross((q - p) * sign);
                // 2 |p × q| is twice the edge's length by the distance of its line, which need not be near the edge
                // itself unless that is long.
                let (far, length) = (p.length_squared().max(q.length_squared()), (q - p).length_squared());
                let is_blurred =
                    length > 0.25 * far && far * length * 4.0 > sharp.length_squared() * BLURRED_EDGE_SQUARED;
                for axis in 0..3 {
                    let value = &mut plane[axis][lane];
                    *value = match (is_blurred, was_behind == behind) {
                        (true, _) => sharp[axis] as f32,
                        (false, true) => *value,
                        (false, false) => -*value,
                    };
                }
            }
        }
    }

    /// 1/t of the lanes in `grazing`, each of a triangle of its own and along the direction that is given for it.
    #[inline(always)]
    pub(super) fn sharpen_lanes<S: Simd>(
        &self,
        simd: S,
        grazing: mask32x16<S>,
        inverse: f32x16<S>,
        direction: impl Fn(usize) -> DVec3,
    ) -> f32x16<S> {
        let mut values = [0.0; WIDTH];
        inverse.store_array(&mut values);
        let mut lanes = grazing.to_bitmask();
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize & (WIDTH - 1);
            lanes &= lanes - 1;
            self.sharpen_ray(lane, direction(lane), &mut values[lane]);
        }
        f32x16::load_array_ref(simd, &values)
    }

    #[cold]
    #[inline(never)]
    fn sharpen_ray(&self, lane: usize, direction: DVec3, inverse: &mut f32) {
        let sharp = self.inverse(lane).dot(direction);
        // A ray along the plane has no better answer.
        if sharp > 0.0 {
            *inverse = sharp as f32;
        }
    }
}

/// One blurred triangle.
pub(super) struct Blurred<'a> {
    source: Source<'a>,
    lane: usize,
    /// (1/t)² below which a ray grazes it.
    limit: f32,
    /// Plane of 1/t, when it has been asked for.
    inverse: Option<DVec3>,
}

impl<'a> Blurred<'a> {
    /// A triangle with that plane of 1/t in single precision.
    #[inline(always)]
    pub(super) fn new<P: Projection>(
        projection: &P,
        source: &Source<'a>,
        lane: usize,
        [x, y, z]: [f32; 3],
    ) -> Self {
        Self {
            source: *source,
            lane,
            limit: grazing_limit(projection) * ((x * x + y * y) + z * z),
            inverse: None,
        }
    }

    /// 1/t of those rays of a block that are inside the triangle and graze it; of the others as it is given.
    #[inline(always)]
    pub(super) fn sharpen_block<S: Simd, P: Projection>(
        &mut self,
        simd: S,
        projection: &P,
        block: [usize; 2],
        inside: mask32x16<S>,
        inverse: f32x16<S>,
    ) -> f32x16<S> {
        let grazing = inside & (inverse * inverse).simd_lt(f32x16::splat(simd, self.limit));
        if !grazing.any_true() {
            return inverse;
        }
        let plane = *self.inverse.get_or_insert_with(|| self.source.inverse(self.lane));
        let sharp = f32x16::load_array_ref(simd, &inverses_of_block(simd, projection, &plane, block));
        // A ray along the plane has no better answer.
        (grazing & sharp.simd_gt(f32x16::splat(simd, 0.0))).select(sharp, inverse)
    }
}

/// What |plane of 1/t|² is multiplied by for the (1/t)² below which a ray grazes.
#[inline(always)]
pub(super) fn grazing_limit<P: Projection>(projection: &P) -> f32 {
    projection.longest_squared() / GRAZING_SQUARED
}

#[inline(never)]
fn inverses_of_block<S: Simd, P: Projection>(
    simd: S,
    projection: &P,
    plane: &DVec3,
    [column, row]: [usize; 2],
) -> [f32; WIDTH] {
    simd.vectorize(
        #[inline(always)]
        || {
            let [x, y, z] = projection.exact_block(column, row);
            let mut inverse = [0.0; WIDTH];
            for lane in 0..WIDTH {
                inverse[lane] = (plane.x * x[lane] + plane.y * y[lane] + plane.z * z[lane]) as f32;
            }
            inverse
        },
    )
}
