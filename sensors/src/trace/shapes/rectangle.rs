//! Rectangles in z = 0, outside towards +z.

use super::{Inside, plane};

/// Takes half the edges. The rectangle has no volume: see [`Inside`].
#[inline(always)]
pub(crate) fn inside(origin: [f64; 3], direction: [f64; 3], half: [f64; 2]) -> Inside {
    // A parallel ray has an infinite t or NaN, and so has x or y; the plane refuses it in any case.
    let t = -origin[2] / direction[2];
    let (x, y) = (origin[0] + t * direction[0], origin[1] + t * direction[1]);
    plane::inside(origin, direction, ()).when(x.abs() <= half[0] && y.abs() <= half[1])
}
