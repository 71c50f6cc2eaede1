//! Intersection with triangles, by signed volumes. An edge's volume d·(a × b) has exactly the opposite sign for the two
//! triangles at the edge, so they decide alike and no ray slips between them.

use super::LocalRays;
use crate::simd::LANES;
use crate::trace::packet::Packet;
use glam::DVec3;

/// The sides from which a triangle may be hit; its corners run counter-clockwise seen from the front.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    Front,
    Back,
    Both,
}

/// Tests one triangle, given by its corners in the frame of the rays.
#[inline(always)]
pub(crate) fn intersect(rays: &LocalRays, corners: [DVec3; 3], packet: &mut Packet, side: Side, slot: u32) {
    if packet.shared_origin {
        let origin = DVec3::new(rays.origin[0][0], rays.origin[1][0], rays.origin[2][0]);
        let edges = Edges::seen_from(origin, corners);
        for lane in 0..LANES {
            test(&edges, rays, lane, packet, side, slot);
        }
    } else {
        for lane in 0..LANES {
            let origin = DVec3::new(rays.origin[0][lane], rays.origin[1][lane], rays.origin[2][lane]);
            test(&Edges::seen_from(origin, corners), rays, lane, packet, side, slot);
        }
    }
}

/// The normals of the planes through the origin and each edge, and of the triangle itself.
struct Edges {
    ab: DVec3,
    bc: DVec3,
    ca: DVec3,
    normal: DVec3,
    distance: f64,
}

impl Edges {
    #[inline(always)]
    fn seen_from(origin: DVec3, corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners.map(|corner| corner - origin);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        Self { ab: a.cross(b), bc: b.cross(c), ca: c.cross(a), normal, distance: a.dot(normal) }
    }
}

#[inline(always)]
fn test(edges: &Edges, rays: &LocalRays, lane: usize, packet: &mut Packet, side: Side, slot: u32) {
    let [dx, dy, dz] = [rays.direction[0][lane], rays.direction[1][lane], rays.direction[2][lane]];
    let along = |v: DVec3| dx * v.x + dy * v.y + dz * v.z;
    let (ab, bc, ca) = (along(edges.ab), along(edges.bc), along(edges.ca));
    let front = side != Side::Back && ab <= 0.0 && bc <= 0.0 && ca <= 0.0;
    let back = side != Side::Front && ab >= 0.0 && bc >= 0.0 && ca >= 0.0;
    let t = edges.distance / along(edges.normal);
    let hit = (front || back) && t >= packet.t_min && t < packet.t[lane];
    packet.t[lane] = if hit { t } else { packet.t[lane] };
    packet.hit[lane] = if hit { slot } else { packet.hit[lane] };
}
