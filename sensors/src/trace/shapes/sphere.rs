//! Balls around the origin.

use super::Inside;

#[inline(always)]
pub(crate) fn inside(origin: [f64; 3], direction: [f64; 3], radius: f64) -> Inside {
    Inside::ball(origin, direction, radius)
}
