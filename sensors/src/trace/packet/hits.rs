//! Hits of a packet on one instance, in double precision: either any hit, whichever it is, or the first.

use crate::scene::tree::{MAX_DEPTH, TriangleBlock, WideNode};
use crate::scene::{Kind, Triangles};
use crate::simd::{LANES, WIDTH};
use crate::trace::packet::walk::{stack_len, walk, walk_to_nearest};
use crate::trace::packet::{Faces, MISS, Packet, PacketBounds};
use crate::trace::placed::view::{self, Placed, View};
use crate::trace::shapes::{LocalRays, commit, match_solid, triangle};
use core::borrow::Borrow;
use fearless_simd::Simd;
use glam::DVec3;

/// Activates only the lanes whose bits are set, up to `t_max`.
#[inline(always)]
pub(crate) fn activate(packet: &mut Packet, lanes: u64, t_max: f64) {
    packet.hit = [MISS; LANES];
    for lane in 0..LANES {
        packet.t[lane] = if lanes >> lane & 1 != 0 { t_max } else { f64::NEG_INFINITY };
    }
}

#[inline(always)]
pub(crate) fn hit_lanes(packet: &Packet) -> u64 {
    let mut lanes = 0;
    for lane in 0..LANES {
        lanes |= u64::from(packet.hit[lane] != MISS) << lane;
    }
    lanes
}

/// Deactivates the lanes that have hit something.
#[inline(always)]
fn retire_hits(packet: &mut Packet) {
    for lane in 0..LANES {
        packet.t[lane] = if packet.hit[lane] == MISS { packet.t[lane] } else { f64::NEG_INFINITY };
    }
}

/// The kind of hit to search for.
#[derive(Clone, Copy)]
pub(crate) enum Search {
    /// Any hit before this t.
    Any(f32),
    /// The first hit.
    First,
}

#[inline(always)]
pub(crate) fn intersect_instance<S: Simd>(
    simd: S,
    view: &View<'_>,
    index: u32,
    (packet, rays): (&mut Packet, &mut LocalRays),
    (faces, search): (Faces, Search),
) {
    let placed = &view.placed[index as usize];
    take_in(placed, packet, rays);
    match placed.kind() {
        Kind::Solid(solid) => match_solid!(
            solid,
            view.instance(index).size,
            inside => commit(rays, packet, faces, placed.first_slot, inside)
        ),
        Kind::Triangles(kind) => {
            let at = (placed, kind);
            match search {
                Search::Any(t_max) => {
                    walk_triangles::<S, true>(simd, view, at, rays, packet, (faces, t_max));
                }
                Search::First => {
                    walk_triangles::<S, false>(simd, view, at, rays, packet, (faces, f32::INFINITY));
                }
            }
        }
    }
}

/// Transforms the rays of a packet to the frame of an instance.
#[inline(always)]
fn take_in(placed: &Placed, packet: &Packet, rays: &mut LocalRays) {
    for axis in 0..3 {
        let [x, y, z] = placed.inverse[axis];
        let [tx, ty, tz] = placed.translation;
        let origin = |lane: usize| {
            x * (packet.origin[0][lane] - tx)
                + y * (packet.origin[1][lane] - ty)
                + z * (packet.origin[2][lane] - tz)
        };
        if packet.shared_origin {
            rays.origin[axis] = [origin(0); LANES];
        } else {
            for lane in 0..LANES {
                rays.origin[axis][lane] = origin(lane);
            }
        }
        for lane in 0..LANES {
            rays.direction[axis][lane] =
                x * packet.direction[0][lane] + y * packet.direction[1][lane] + z * packet.direction[2][lane];
        }
    }
}

/// Searches for any hit before `t_max`, or for the first. Compiled separately for each, because their stacks differ.
#[inline(never)]
fn walk_triangles<S: Simd, const ANY: bool>(
    simd: S,
    view: &View<'_>,
    (placed, kind): (&Placed, Triangles),
    rays: &LocalRays,
    packet: &mut Packet,
    (faces, t_max): (Faces, f32),
) {
    let faces = match faces {
        Faces::Both => triangle::Side::Both,
        Faces::Front if placed.mirrored == 0 => triangle::Side::Front,
        Faces::Front => triangle::Side::Back,
    };
    simd.vectorize(
        #[inline(always)]
        || {
            let bounds = PacketBounds::new(&rays.origin, &rays.direction, packet);
            match kind {
                Triangles::Mesh => walk_leaves::<S, _, ANY>(
                    simd,
                    #[inline(always)]
                    |node| &view.scene.nodes[(placed.first_node + node) as usize],
                    &bounds,
                    (packet, t_max),
                    #[inline(always)]
                    |leaf, packet| {
                        let block = &view.scene.blocks[(placed.first_block + leaf) as usize];
                        draw(rays, block, packet, faces, placed.first_slot + leaf * WIDTH as u32);
                    },
                ),
                Triangles::HeightField => {
                    let grid = view.height_grid(placed);
                    walk_leaves::<S, _, ANY>(
                        simd,
                        #[inline(always)]
                        |node| grid.node(node),
                        &bounds,
                        (packet, t_max),
                        #[inline(always)]
                        |leaf, packet| {
                            let slot = placed.first_slot + leaf * WIDTH as u32;
                            draw(rays, &grid.block(leaf), packet, faces, slot);
                        },
                    );
                }
            }
        },
    );
}

#[inline(always)]
fn walk_leaves<S: Simd, N: Borrow<WideNode>, const ANY: bool>(
    simd: S,
    node: impl Fn(u32) -> N,
    bounds: &PacketBounds,
    (packet, t_max): (&mut Packet, f32),
    draw: impl Fn(u32, &mut Packet),
) {
    if ANY {
        walk::<S, N, { stack_len(MAX_DEPTH) }>(
            simd,
            node,
            bounds,
            t_max,
            #[inline(always)]
            |leaf| {
                draw(leaf, packet);
                retire_hits(packet);
                packet.is_active()
            },
        );
    } else {
        walk_to_nearest::<S, N, { stack_len(MAX_DEPTH) }>(simd, node, bounds, packet, draw);
    }
}

/// Draws a leaf whose first triangle has the slot `slot`.
#[inline(always)]
fn draw(rays: &LocalRays, block: &TriangleBlock, packet: &mut Packet, faces: triangle::Side, slot: u32) {
    for lane in 0..WIDTH {
        let corners = block
            .corners
            .each_ref()
            .map(|[x, y, z]| DVec3::new(x[lane].into(), y[lane].into(), z[lane].into()));
        triangle::intersect(rays, corners, packet, faces, slot + lane as u32);
    }
}

/// Finds the first hit of each ray from the frame's origin. [`Packet::hit`] is then its slot for the
/// [`Resolver`](crate::trace::hit::resolve::Resolver); `local` is scratch memory.
#[inline(always)]
pub(crate) fn first_hits<S: Simd>(
    simd: S,
    view: &View<'_>,
    packet: &mut Packet,
    local: &mut LocalRays,
    faces: Faces,
) {
    let bounds = PacketBounds::new(&packet.origin, &packet.direction, packet);
    walk_to_nearest::<S, _, { stack_len(view::MAX_DEPTH) }>(
        simd,
        #[inline(always)]
        |node| &view.nodes[node as usize],
        &bounds,
        packet,
        #[inline(always)]
        |index, packet| {
            intersect_instance(simd, view, index, (packet, local), (faces, Search::First));
        },
    );
}
