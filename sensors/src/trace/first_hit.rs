//! What the rays of a packet hit first, in double precision: for the few rays that are traced after a picture.

use super::any_hit::{Search, intersect_instance};
use super::packet::{Faces, Packet, PacketBounds};
use super::shapes::LocalRays;
use super::view::{MAX_DEPTH, View};
use crate::scene::tree::{LEAF, WideNode};
use crate::simd::WIDTH;
use core::borrow::Borrow;
use fearless_simd::Simd;

/// Entries of the stack that a walk of so deep a tree needs.
pub(crate) const fn stack_len(depth: usize) -> usize {
    (WIDTH - 1) * depth + 2
}

/// Finds the first hit of each ray from the frame's origin. [`Packet::hit`] is then its slot, as the
/// [`Resolver`](super::resolve::Resolver) knows it; `local` is room to work in.
#[inline(always)]
pub(crate) fn first_hits<S: Simd>(
    simd: S,
    view: &View<'_>,
    packet: &mut Packet,
    local: &mut LocalRays,
    faces: Faces,
) {
    let bounds = PacketBounds::new(&packet.origin, &packet.direction, packet);
    walk_to_nearest::<S, _, { stack_len(MAX_DEPTH) }>(
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

/// Visits the leaves that the packet may meet before what it has hit, the nearer ones first.
#[inline(always)]
pub(super) fn walk_to_nearest<S: Simd, N: Borrow<WideNode>, const STACK: usize>(
    simd: S,
    node: impl Fn(u32) -> N,
    bounds: &PacketBounds,
    packet: &mut Packet,
    mut visit: impl FnMut(u32, &mut Packet),
) {
    // What waits, and the least t at which some ray meets it.
    let mut stack = [(0_u32, 0.0_f32); STACK];
    let mut waiting = 1;
    let mut farthest = packet.farthest();
    while waiting > 0 {
        waiting -= 1;
        let (child, near) = stack[waiting];
        if near > farthest {
            continue;
        }
        if child & LEAF != 0 {
            visit(child & !LEAF, packet);
            farthest = packet.farthest();
            continue;
        }
        let node = node(child);
        let node = node.borrow();
        let mut near = [0.0; WIDTH];
        let mut lanes = bounds.enter_at(simd, node, farthest, &mut near);
        let first = waiting;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize & (WIDTH - 1);
            lanes &= lanes - 1;
            let mut place = waiting;
            while place > first && stack[place - 1].1 < near[lane] {
                stack[place] = stack[place - 1];
                place -= 1;
            }
            stack[place] = (node.child[lane], near[lane]);
            waiting += 1;
        }
    }
}
