//! Conversion of a row of a tile between the view and the axes of an instance.

use super::tile::Tile;
use crate::simd::{Lanes, WIDTH, load_row};
use crate::trace::placed::view::Placed;
use fearless_simd::{Simd, SimdBase, f32x16};
use glam::DVec3;

/// Multiplies vectors by the inverse transpose of an instance, and by a factor.
#[inline(always)]
pub(super) fn to_view<S: Simd>(
    simd: S,
    placed: &Placed,
    [x, y, z]: &[[f32; WIDTH]; 3],
    by: f32,
) -> [f32x16<S>; 3] {
    let mut turned = [f32x16::splat(simd, 0.0); 3];
    for axis in 0..3 {
        let [a, b, c] = [0, 1, 2].map(|row| placed.inverse[row][axis] as f32 * by);
        turned[axis] = (load(simd, x) * a + load(simd, y) * b) + load(simd, z) * c;
    }
    turned
}

/// The points of a row, in the axes of an instance.
#[inline(always)]
pub(super) fn local_points(placed: &Placed, tile: &Tile, row: usize) -> [[f64; WIDTH]; 3] {
    let [px, py, pz] = tile.point.each_ref().map(|axis| &axis.as_chunks::<WIDTH>().0[row]);
    let [tx, ty, tz] = placed.translation;
    let mut points = [[0.0; WIDTH]; 3];
    for axis in 0..3 {
        let [x, y, z] = placed.inverse[axis];
        for lane in 0..WIDTH {
            points[axis][lane] = x * (f64::from(px[lane]) - tx)
                + y * (f64::from(py[lane]) - ty)
                + z * (f64::from(pz[lane]) - tz);
        }
    }
    points
}

#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, values: &[f32; WIDTH]) -> f32x16<S> {
    f32x16::load_array_ref(simd, values)
}

/// Converts vectors of a row from the view to the axes of an instance.
#[inline(always)]
pub(super) fn to_instance<S: Simd>(
    simd: S,
    placed: &Placed,
    [x, y, z]: &[Lanes<f32>; 3],
    row: usize,
) -> [f32x16<S>; 3] {
    let mut turned = [f32x16::splat(simd, 0.0); 3];
    for axis in 0..3 {
        let [a, b, c] = DVec3::from_array(placed.inverse[axis]).as_vec3().to_array();
        turned[axis] = (load_row(simd, x, row) * a + load_row(simd, y, row) * b) + load_row(simd, z, row) * c;
    }
    turned
}
