//! Closed cylinders along z: an endless cylinder cut by a slab.

use super::{Inside, LocalRays, commit};
use crate::trace::packet::{Faces, Packet};

#[inline(always)]
pub(crate) fn intersect(
    rays: &LocalRays,
    radius: f64,
    half_length: f64,
    packet: &mut Packet,
    faces: Faces,
    placed: u32,
) {
    commit(
        packet,
        faces,
        placed,
        #[inline(always)]
        |lane| inside(rays, lane, radius, half_length),
    );
}

#[inline(always)]
pub(super) fn inside(rays: &LocalRays, lane: usize, radius: f64, half_length: f64) -> Inside {
    let [x, y] = [rays.origin[0][lane], rays.origin[1][lane]];
    let [dx, dy] = [rays.direction[0][lane], rays.direction[1][lane]];
    let dd = dx * dx + dy * dy;
    let oo_rr = x * x + y * y - radius * radius;
    let round = if dd > 0.0 {
        Inside::quadric(dd, x * dx + y * dy, oo_rr)
    } else if oo_rr <= 0.0 {
        // Along the axis: inside for good, or never.
        Inside::EVERYWHERE
    } else {
        Inside::NOWHERE
    };
    round.intersection(Inside::slab(rays.origin[2][lane], rays.direction[2][lane], half_length))
}
