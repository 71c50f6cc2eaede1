//! Traversal of a tree by a packet.

use super::{Packet, PacketBounds};
use crate::scene::tree::{LEAF, WideNode};
use crate::simd::WIDTH;
use core::borrow::Borrow;
use fearless_simd::Simd;

/// The number of stack entries that traversing a tree of this depth needs.
pub(crate) const fn stack_len(depth: usize) -> usize {
    (WIDTH - 1) * depth + 2
}

/// Visits the leaves that the packet may hit before `t_max`, until `visit` returns that no lane is left. A stack of
/// [`stack_len`] entries is enough.
#[inline(always)]
pub(crate) fn walk<S: Simd, N: Borrow<WideNode>, const STACK: usize>(
    simd: S,
    node: impl Fn(u32) -> N,
    bounds: &PacketBounds,
    t_max: f32,
    mut visit: impl FnMut(u32) -> bool,
) {
    let mut stack = [0_u32; STACK];
    let mut waiting = 1;
    while waiting > 0 {
        waiting -= 1;
        let child = stack[waiting];
        if child & LEAF != 0 {
            if !visit(child & !LEAF) {
                return;
            }
            continue;
        }
        let node = node(child);
        let node = node.borrow();
        let mut lanes = bounds.enter(simd, node, t_max);
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize & (WIDTH - 1);
            lanes &= lanes - 1;
            stack[waiting] = node.child[lane];
            waiting += 1;
        }
    }
}

/// Visits the leaves that the packet may hit before its hits so far, the nearer ones first.
#[inline(always)]
pub(crate) fn walk_to_nearest<S: Simd, N: Borrow<WideNode>, const STACK: usize>(
    simd: S,
    node: impl Fn(u32) -> N,
    bounds: &PacketBounds,
    packet: &mut Packet,
    mut visit: impl FnMut(u32, &mut Packet),
) {
    // The waiting children, each with the least t at which any ray may hit it.
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
