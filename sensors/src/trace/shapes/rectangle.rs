//! Rectangles in z = 0, outside towards +z.

use super::LocalRays;
use crate::simd::LANES;
use crate::trace::packet::{Faces, Packet};

#[inline(always)]
pub(crate) fn intersect(rays: &LocalRays, half: [f64; 3], packet: &mut Packet, faces: Faces, placed: u32) {
    let both = faces == Faces::Both;
    for lane in 0..LANES {
        let down = rays.direction[2][lane];
        // Parallel rays give ±∞ or NaN, which the compares refuse.
        let t = -rays.origin[2][lane] / down;
        let x = rays.origin[0][lane] + t * rays.direction[0][lane];
        let y = rays.origin[1][lane] + t * rays.direction[1][lane];
        let hit = (both || down < 0.0)
            && t >= packet.t_min
            && t < packet.t[lane]
            && x.abs() <= half[0]
            && y.abs() <= half[1];
        packet.t[lane] = if hit { t } else { packet.t[lane] };
        packet.placed[lane] = if hit { placed } else { packet.placed[lane] };
    }
}
