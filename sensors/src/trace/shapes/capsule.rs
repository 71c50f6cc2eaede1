//! Capsules along z: a cylinder and a ball at each end.

use super::real::Real;
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
    let normal = DVec3::from_array(normal(point.to_array(), [radius, half_length]));
    around::<TEXTURED>(point, normal, [-half_length - radius, half_length + radius])
}

#[inline(always)]
pub(crate) fn normal<T: Real>([x, y, z]: [T; 3], [radius, half_length]: [T; 2]) -> [T; 3] {
    let above = if z > half_length { z - half_length } else { T::ZERO };
    let below = if z < -half_length { z + half_length } else { T::ZERO };
    [x / radius, y / radius, (above + below) / radius]
}
