//! Ellipsoids along the axes: the unit ball in a frame that is stretched to it.

use super::Inside;

/// Takes the reciprocals of the radii.
#[inline(always)]
pub(crate) fn inside([x, y, z]: [f64; 3], [dx, dy, dz]: [f64; 3], inverse_radii: [f64; 3]) -> Inside {
    let [a, b, c] = inverse_radii;
    Inside::ball([x * a, y * b, z * c], [dx * a, dy * b, dz * c], 1.0)
}
