//! Boxes: three slabs (Kay & Kajiya 1986).

use super::{Inside, LocalRays, commit};
use crate::trace::packet::{Faces, Packet};

#[inline(always)]
pub(crate) fn intersect(rays: &LocalRays, half: [f64; 3], packet: &mut Packet, faces: Faces, placed: u32) {
    commit(
        packet,
        faces,
        placed,
        #[inline(always)]
        |lane| {
            let slab =
                |axis: usize| Inside::slab(rays.origin[axis][lane], rays.direction[axis][lane], half[axis]);
            Inside::EVERYWHERE.intersection(slab(0)).intersection(slab(1)).intersection(slab(2))
        },
    );
}
