//! Balls around the origin.

use super::Inside;
use super::real::Real;
use super::surface::{Surface, around};
use glam::DVec3;

#[inline(always)]
pub(crate) fn inside(origin: [f64; 3], direction: [f64; 3], radius: f64) -> Inside {
    Inside::ball(origin, direction, radius)
}

#[inline(always)]
pub(crate) fn surface<const TEXTURED: bool>(point: DVec3, radius: f64) -> Surface {
    let normal = DVec3::from_array(normal(point.to_array(), radius));
    around::<TEXTURED>(point, normal, [-radius, radius])
}

#[inline(always)]
pub(crate) fn normal<T: Real>([x, y, z]: [T; 3], radius: T) -> [T; 3] {
    [x / radius, y / radius, z / radius]
}
