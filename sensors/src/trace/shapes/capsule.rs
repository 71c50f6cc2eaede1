//! Capsules along z: a cylinder and a ball at each end.

use super::{Inside, cylinder, sphere};

#[inline(always)]
pub(crate) fn inside(origin: [f64; 3], direction: [f64; 3], [radius, half_length]: [f64; 2]) -> Inside {
    let [x, y, z] = origin;
    cylinder::inside(origin, direction, [radius, half_length])
        .hull(sphere::inside([x, y, z - half_length], direction, radius))
        .hull(sphere::inside([x, y, z + half_length], direction, radius))
}
