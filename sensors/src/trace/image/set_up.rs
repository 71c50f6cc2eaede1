//! The planes of sixteen triangles.
//!
//! With corners relative to the origin, the plane through the origin and the edge from A to B has the normal (A + B) ×
//! (B − A) = 2 A × B. In this form it changes only its sign if A and B are swapped: two triangles with a common edge
//! decide alike, and no ray slips between them. A ray is inside if all three edge planes are on the same side as the
//! triangle, and there 1/t = n·d / n·a.

use super::leaf::{Leaf, Rules};
use super::sharp::{BLURRED_SQUARED, PlaneArrays, THIN_SQUARED};
use super::target::GRAZING;
use crate::optics::rays::{Planes, Points, max};
use crate::simd::WIDTH;
use crate::trace::packet::Faces;
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, mask32x16, u32x16};

const LANE_NUMBERS: [u32; WIDTH] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

/// Sixteen triangles, prepared for the tests.
#[derive(Clone, Copy)]
pub(super) struct Setup<S: Simd> {
    /// Edge planes, positive inside.
    pub(super) edges: [Planes<S>; 3],
    /// The plane of 1/t.
    pub(super) inverse: Planes<S>,
    /// The triangles to be drawn.
    pub(super) valid: mask32x16<S>,
    /// The triangles whose planes are not exact enough and must first be recomputed; see `sharp`.
    pub(super) blurred: mask32x16<S>,
    /// The triangles that have the sensor behind them, and those that have it in front.
    sides: [mask32x16<S>; 2],
    pub(super) slots: u32x16<S>,
}

impl<S: Simd> Setup<S> {
    /// Stores the planes, triangle by triangle.
    #[inline(always)]
    pub(super) fn spill(&self) -> PlaneArrays {
        let mut planes = PlaneArrays {
            edges: [[[0.0; WIDTH]; 3]; 3],
            inverse: [[0.0; WIDTH]; 3],
            sides: [self.sides[0].to_bitmask(), self.sides[1].to_bitmask()],
        };
        for axis in 0..3 {
            for edge in 0..3 {
                self.edges[edge][axis].store_array(&mut planes.edges[edge][axis]);
            }
            self.inverse[axis].store_array(&mut planes.inverse[axis]);
        }
        planes
    }
}

#[inline(always)]
fn cross<S: Simd>(a: &Points<S>, b: &Points<S>) -> Points<S> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
fn sub<S: Simd>(a: &Points<S>, b: &Points<S>) -> Points<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn scale<S: Simd>(a: &Points<S>, by: f32x16<S>) -> Points<S> {
    [a[0] * by, a[1] * by, a[2] * by]
}

#[inline(always)]
fn square<S: Simd>(a: &Points<S>) -> f32x16<S> {
    (a[0] * a[0] + a[1] * a[1]) + a[2] * a[2]
}

/// The plane through the origin and the edge from a to b, times `sign`.
#[inline(always)]
fn edge<S: Simd>(a: &Points<S>, b: &Points<S>, sign: f32x16<S>) -> Planes<S> {
    let sum = [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
    cross(&sum, &scale(&sub(b, a), sign))
}

/// Planes of sixteen triangles.
#[derive(Clone, Copy)]
struct TrianglePlane<S: Simd> {
    /// Six times the volume of the tetrahedron of triangle and sensor; positive if the sensor is behind.
    volume: f32x16<S>,
    /// The plane of 1/t.
    inverse: Planes<S>,
    /// The triangles that are not thin, so that the rounding of their normals does not matter.
    fat: mask32x16<S>,
}

impl<S: Simd> TrianglePlane<S> {
    /// Computes the plane of triangles with corner `a` and two sides. The squares of these sides and of the longest
    /// side are given.
    #[inline(always)]
    fn new(a: &Points<S>, [p, q]: [&Points<S>; 2], squares: [f32x16<S>; 2], extent: f32x16<S>) -> Self {
        let normal = cross(p, q);
        let volume = (a[0] * normal[0] + a[1] * normal[1]) + a[2] * normal[2];
        let per_volume = f32x16::splat(volume.simd, 1.0) / volume;
        let lost = (squares[0] * per_volume) * (squares[1] * per_volume) * extent;
        let fat = lost.simd_le(f32x16::splat(volume.simd, THIN_SQUARED));
        Self { volume, inverse: scale(&normal, per_volume), fat }
    }
}

#[inline(always)]
pub(super) fn set_up<S: Simd>(simd: S, leaf: &Leaf<'_, S>, rules: Rules) -> Setup<S> {
    let [a, b, c] = leaf.corners;
    let (ab, ac) = (sub(b, a), sub(c, a));
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    let squares = [square(&ab), square(&ac)];
    let mut extent = max(squares[0], squares[1]);
    let mut plane = TrianglePlane::new(a, [&ab, &ac], squares, extent);
    let is_solid = extent.simd_gt(zero);
    if (is_solid & !plane.fat).any_true() {
        // The two shorter sides lose fewer digits, unless all three are long compared with the triangle's height.
        let bc = sub(c, b);
        let [ab_squared, ac_squared] = squares;
        let bc_squared = square(&bc);
        let ab_is_longest = ab_squared.simd_gt(ac_squared) & ab_squared.simd_gt(bc_squared);
        let bc_is_longest = bc_squared.simd_ge(ab_squared) & bc_squared.simd_gt(ac_squared);
        let mut sides = [ab, bc];
        for axis in 0..3 {
            sides[0][axis] = ab_is_longest.select(ac[axis], ab[axis]);
            sides[1][axis] = bc_is_longest.select(ac[axis], bc[axis]);
        }
        let squares =
            [ab_is_longest.select(ac_squared, ab_squared), bc_is_longest.select(ac_squared, bc_squared)];
        extent = max(extent, bc_squared);
        plane = TrianglePlane::new(a, [&sides[0], &sides[1]], squares, extent);
    }
    let TrianglePlane { volume, inverse, fat } = plane;
    let sides = [volume.simd_gt(zero), volume.simd_lt(zero)];
    let sign = sides[0].select(one, -one);
    // 1/|inverse| is the distance of the plane. If a corner is much farther away, rays may graze the triangle; if it is
    // large too, its plane is not exact. Nor is that of a triangle so thin that its normal consists mostly of rounding
    // errors.
    let away = square(a);
    let steep = ((away + extent) * square(&inverse)).simd_le(f32x16::splat(simd, BLURRED_SQUARED));
    let small = (extent * 4.0).simd_lt(away);
    // Comparisons with 0/0 are false, and so are those for triangles without extent.
    let blurred = is_solid & !(fat & (steep | small));
    let slots = u32x16::load_array_ref(simd, &LANE_NUMBERS) + leaf.first_slot;
    let slots = steep.select(slots, slots | u32x16::splat(simd, GRAZING));
    Setup {
        edges: [edge(b, c, sign), edge(c, a, sign), edge(a, b, sign)],
        inverse,
        valid: facing(rules, sides) & !blurred,
        blurred,
        sides,
        slots,
    }
}

/// The triangles that are seen from a side that counts. A triangle that is seen edge-on covers nothing.
#[inline(always)]
pub(super) fn facing<S: Simd>(rules: Rules, [behind, front]: [mask32x16<S>; 2]) -> mask32x16<S> {
    match (rules.faces, rules.mirrored) {
        (Faces::Both, _) => behind | front,
        (Faces::Front, false) => front,
        (Faces::Front, true) => behind,
    }
}
