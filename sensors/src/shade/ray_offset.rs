//! Points slightly above the triangles on which they lie.
//!
//! A point of a tile is where its ray hit, in single precision, so it is above or below its triangle by some millionths
//! of its distance. Light that reaches it at a low angle could pass through the triangle or its neighbours. Points on
//! meshes and height fields are therefore projected onto the planes of their triangles in double precision, and then
//! moved above them by the possible error of the neighbours' corners, or below them if their back is seen.

use super::tile::Tile;
use crate::simd::{LANES, Lanes};
use crate::trace::placed::view::{Placed, View};
use fearless_simd::Simd;
use glam::DVec3;

/// Height above the triangle, as a fraction of the distance from the sensor and of the corners' coordinates: four
/// rounding errors of single precision.
const LIFT: f64 = 2.5e-7;

/// Moves those of the `lanes` that lie on triangles above them, or below them for lanes that see the `back`, and
/// returns the lanes that were moved.
#[inline(always)]
pub(super) fn lift<S: Simd>(
    simd: S,
    view: &View<'_>,
    tile: &Tile,
    (lanes, back): (u64, u64),
    points: &mut [Lanes<f64>; 3],
) -> u64 {
    if !view.has_concave {
        return 0;
    }
    let (mut rest, mut lifted) = (lanes, 0);
    while rest != 0 {
        let index = tile.placed[rest.trailing_zeros() as usize % LANES];
        let own = tile.lanes_of(simd, index) & rest;
        rest &= !own;
        if !view.instance(index).kind().is_solid() {
            lift_own(view, tile, index, (own, back), points);
            lifted |= own;
        }
    }
    lifted
}

#[inline(never)]
fn lift_own(
    view: &View<'_>,
    tile: &Tile,
    index: u32,
    (lanes, back): (u64, u64),
    points: &mut [Lanes<f64>; 3],
) {
    let placed = &view.placed[index as usize];
    let mut rest = lanes;
    while rest != 0 {
        let lane = rest.trailing_zeros() as usize % LANES;
        rest &= rest - 1;
        let point = DVec3::from_array([0, 1, 2].map(|axis| points[axis][lane]));
        let side = if back >> lane & 1 != 0 { -1.0 } else { 1.0 };
        let lifted = above(view, placed, tile.local[lane], point, side);
        for axis in 0..3 {
            points[axis][lane] = lifted[axis];
        }
    }
}

fn above(view: &View<'_>, placed: &Placed, local: u32, point: DVec3, side: f64) -> DVec3 {
    let [a, b, c] = view.corners(placed, local);
    let normal = (b - a).cross(c - a);
    let squared = normal.length_squared();
    if squared <= 0.0 {
        return point;
    }
    let axes = placed.axes.map(DVec3::from_array);
    let to_frame = |v: DVec3| axes[0] * v.x + axes[1] * v.y + axes[2] * v.z;
    let beside = placed.vector_in_instance(point - DVec3::from_array(placed.translation)) - a;
    let on_plane = point - to_frame(normal * (beside.dot(normal) / squared));
    // Normals are transformed by the inverse transpose.
    let inverse = placed.inverse.map(DVec3::from_array);
    let normal = inverse[0] * normal.x + inverse[1] * normal.y + inverse[2] * normal.z;
    let coordinates = a.abs().max(b.abs()).max(c.abs());
    let size = axes[0].abs() * coordinates.x + axes[1].abs() * coordinates.y + axes[2].abs() * coordinates.z;
    on_plane + normal.normalize_or_zero() * (side * LIFT * (size.max_element() + point.abs().max_element()))
}
