//! Capsules along z: a cylinder and a ball at each end.

use super::surface::{Surface, around};
use super::{Inside, cylinder, sphere};
use glam::DVec3;

#[inline(always)]
pub(crate) fn inside(origin: [f64; 3], direction: [f64; 3], [radius, half_length]: [f64; 2]) -> Inside {
    let [x, y, z] = origin;
    cylinder::inside(origin, direction, [radius, half_length])
        .hull(sphere::inside([x, y, z - half_length], direction, radius))
        .hull(sphere::inside([x, y, z + half_length], direction, radius))
}

#[inline(always)]
pub(crate) fn surface<const TEXTURED: bool>(point: DVec3, [radius, half_length]: [f64; 2]) -> Surface {
    let above = if point.z > half_length { point.z - half_length } else { 0.0 };
    let below = if point.z < -half_length { point.z + half_length } else { 0.0 };
    let radial = DVec3::new(point.x, point.y, above + below);
    around::<TEXTURED>(point, radial / radius, [-half_length - radius, half_length + radius])
}
