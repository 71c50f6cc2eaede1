//! Rectangles in z = 0, outside towards +z.

use super::surface::{Surface, flat};
use super::{Inside, plane};
use glam::DVec3;

/// Takes half the edges. The rectangle has no volume: see [`Inside`].
#[inline(always)]
pub(crate) fn inside(origin: [f64; 3], direction: [f64; 3], half: [f64; 2]) -> Inside {
    // A parallel ray has an infinite t or NaN, and so has x or y; the plane refuses it in any case.
    let t = -origin[2] / direction[2];
    let (x, y) = (origin[0] + t * direction[0], origin[1] + t * direction[1]);
    plane::inside(origin, direction, ()).when(x.abs() <= half[0] && y.abs() <= half[1])
}

#[inline(always)]
pub(crate) fn surface(point: DVec3, half: [f64; 2]) -> Surface {
    flat(DVec3::Z, point, [DVec3::X / (2.0 * half[0]), DVec3::Y / (2.0 * half[1])])
}
