//! Balls around the origin.

use super::Inside;
use super::surface::{Surface, around};
use glam::DVec3;

#[inline(always)]
pub(crate) fn inside(origin: [f64; 3], direction: [f64; 3], radius: f64) -> Inside {
    Inside::ball(origin, direction, radius)
}

#[inline(always)]
pub(crate) fn surface<const TEXTURED: bool>(point: DVec3, radius: f64) -> Surface {
    around::<TEXTURED>(point, point / radius, [-radius, radius])
}
