//! Capsules along z: a cylinder and a ball at each end.

use super::{LocalRays, commit, cylinder, sphere};
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
        |lane| {
            cylinder::inside(rays, lane, radius, half_length)
                .hull(sphere::inside(rays, lane, radius, half_length))
                .hull(sphere::inside(rays, lane, radius, -half_length))
        },
    );
}
