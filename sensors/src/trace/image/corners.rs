//! Corners of a leaf's triangles, transformed to another frame.
//!
//! A mesh stores all 48 corners of a leaf. A leaf of a height field has only fifteen vertices: these are transformed at
//! once, and then distributed to the triangles that use them as corners.

use crate::optics::rays::Points;
use crate::scene::CORNERS;
use crate::scene::tree::TriangleBlock;
use crate::simd::WIDTH;
use crate::trace::placed::view::ToSensor;
use fearless_simd::{Simd, SimdBase, f32x16};

/// A frame to which points of an instance can be transformed.
pub(super) trait CornerFrame {
    fn take<S: Simd>(&self, simd: S, points: &[[f32; WIDTH]; 3]) -> Points<S>;
}

/// The corners of a mesh's leaf: all first, all second, all third.
#[inline(always)]
pub(super) fn stored<S: Simd>(simd: S, block: &TriangleBlock, frame: &impl CornerFrame) -> [Points<S>; 3] {
    [
        frame.take(simd, &block.corners[0]),
        frame.take(simd, &block.corners[1]),
        frame.take(simd, &block.corners[2]),
    ]
}

/// The corners of a height field's leaf, from its vertices.
#[inline(always)]
pub(super) fn spread<S: Simd>(
    simd: S,
    vertices: &[[f32; WIDTH]; 3],
    frame: &impl CornerFrame,
) -> [Points<S>; 3] {
    let vertices = frame.take(simd, vertices);
    [
        chosen(simd, &vertices, &CORNERS[0]),
        chosen(simd, &vertices, &CORNERS[1]),
        chosen(simd, &vertices, &CORNERS[2]),
    ]
}

/// Selects sixteen of the points.
#[inline(always)]
fn chosen<S: Simd>(simd: S, points: &Points<S>, which: &[usize; WIDTH]) -> Points<S> {
    let mut taken = *points;
    for axis in 0..3 {
        let (mut from, mut to) = ([0.0; WIDTH], [0.0; WIDTH]);
        points[axis].store_array(&mut from);
        for lane in 0..WIDTH {
            to[lane] = from[which[lane]];
        }
        taken[axis] = f32x16::load_array_ref(simd, &to);
    }
    taken
}

impl CornerFrame for ToSensor {
    #[inline(always)]
    fn take<S: Simd>(&self, simd: S, points: &[[f32; WIDTH]; 3]) -> Points<S> {
        let [x, y, z] = from_origin(simd, points, self);
        let rows = &self.rows;
        [
            (x * rows[0][0] + y * rows[0][1]) + z * rows[0][2],
            (x * rows[1][0] + y * rows[1][1]) + z * rows[1][2],
            (x * rows[2][0] + y * rows[2][1]) + z * rows[2][2],
        ]
    }
}

/// Returns point − origin. The origin is given in two parts, so that no digit is lost for points near it, however far
/// it is from the instance's own origin.
#[inline(always)]
pub(super) fn from_origin<S: Simd>(simd: S, points: &[[f32; WIDTH]; 3], to_sensor: &ToSensor) -> Points<S> {
    let [high, low] = [&to_sensor.origin_high, &to_sensor.origin_low];
    [
        (f32x16::load_array_ref(simd, &points[0]) - high[0]) - low[0],
        (f32x16::load_array_ref(simd, &points[1]) - high[1]) - low[1],
        (f32x16::load_array_ref(simd, &points[2]) - high[2]) - low[2],
    ]
}
