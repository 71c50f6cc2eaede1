//! Small sets: every cut between two neighbours on an axis is tried, where bins would miss most multiples of
//! sixteen.

use super::bins::{blocks, weight};
use super::bounds::Scratch;
use fearless_simd::{Simd, SimdBase, f32x8};

/// Sets up to this size are swept; sorting is slower than binning.
pub(super) const SWEEP: usize = 64;

/// Sorts `items`, at least 2 and at most [`SWEEP`], along the axis of the cheapest cut that fits in `budget`
/// blocks. How many are on the left, and the boxes of both sides; none if no cut fits.
#[inline(always)]
pub(super) fn sweep<S: Simd>(simd: S, items: &mut [Scratch], budget: usize) -> Option<(usize, [Scratch; 2])> {
    let count = items.len();
    let mut best_cost = f32::INFINITY;
    let mut best_skew = usize::MAX;
    let mut best = None;
    let mut best_order = [0; SWEEP];
    let empty = f32x8::splat(simd, f32::INFINITY);
    for axis in 0..3 {
        // The rank of the centre, then the position: a total order, so the result depends on nothing else.
        let mut order = [0_u64; SWEEP];
        for (position, (slot, item)) in order.iter_mut().zip(&*items).enumerate() {
            let bits = (item.lanes[axis] - item.lanes[axis + 4]).to_bits();
            let rank = if bits >> 31 == 0 { bits | 1 << 31 } else { !bits };
            *slot = u64::from(rank) << 32 | position as u64;
        }
        let order = &mut order[..count];
        order.sort_unstable();
        let at = |i: usize| f32x8::from_slice(simd, &items[order[i] as u32 as usize].lanes);

        let mut right_cost = [0.0; SWEEP];
        let mut joined = empty;
        for i in (1..count).rev() {
            joined = joined.min(at(i));
            right_cost[i] = Scratch { lanes: joined.into() }.area() * weight(count - i);
        }
        let mut joined = empty;
        let mut better = false;
        for left in 1..count {
            joined = joined.min(at(left - 1));
            let cost = Scratch { lanes: joined.into() }.area() * weight(left) + right_cost[left];
            let skew = left.abs_diff(count - left);
            let fits = blocks(left) + blocks(count - left) <= budget;
            if fits && (cost < best_cost || (cost == best_cost && skew < best_skew)) {
                best_cost = cost;
                best_skew = skew;
                best = Some(left);
                better = true;
            }
        }
        if better {
            best_order[..count].copy_from_slice(order);
        }
    }

    let left_count = best?;
    let mut sorted = [Scratch::EMPTY; SWEEP];
    for (slot, key) in sorted.iter_mut().zip(&best_order[..count]) {
        *slot = items[*key as u32 as usize];
    }
    items.copy_from_slice(&sorted[..count]);
    let union = |items: &[Scratch]| {
        let mut all = empty;
        for item in items {
            all = all.min(f32x8::from_slice(simd, &item.lanes));
        }
        Scratch { lanes: all.into() }
    };
    Some((left_count, [union(&items[..left_count]), union(&items[left_count..])]))
}
