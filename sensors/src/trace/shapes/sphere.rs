//! Balls: |o + t·d|² = r².

use super::{Inside, LocalRays, commit};
use crate::trace::packet::{Faces, Packet};

#[inline(always)]
pub(crate) fn intersect(rays: &LocalRays, radius: f64, packet: &mut Packet, faces: Faces, placed: u32) {
    commit(
        packet,
        faces,
        placed,
        #[inline(always)]
        |lane| inside(rays, lane, radius, 0.0),
    );
}

/// The ball around (0, 0, `centre_z`).
#[inline(always)]
pub(super) fn inside(rays: &LocalRays, lane: usize, radius: f64, centre_z: f64) -> Inside {
    let [x, y, z] = [rays.origin[0][lane], rays.origin[1][lane], rays.origin[2][lane] - centre_z];
    let [dx, dy, dz] = [rays.direction[0][lane], rays.direction[1][lane], rays.direction[2][lane]];
    Inside::quadric(
        dx * dx + dy * dy + dz * dz,
        x * dx + y * dy + z * dz,
        x * x + y * y + z * z - radius * radius,
    )
}
