//! Small sets: tries every cut between two neighbours on an axis, where bins would miss most multiples of sixteen.

use super::bounds::{Scratch, centre};
use super::cost::{Cheapest, Points, Power, lengths, numbers};
use crate::simd::WIDTH;
use fearless_simd::{Simd, SimdBase, f32x8, f32x16, prelude::*, u32x16};

/// Sets up to this size are swept. With 128, leaves are 2 % fuller, but rays do not meet fewer boxes.
pub(super) const SWEEP: usize = 64;

/// Vectors that hold a number for each primitive.
const VECTORS: usize = SWEEP / WIDTH;

/// A number for each primitive.
type Numbers = [[u32; WIDTH]; VECTORS];

/// 2²³: adding it rounds a small f32 to an integer in the low bits.
const ROUND: f32 = 8_388_608.0;

/// Centres are sorted with a resolution of this many steps along an axis.
const STEPS: f32 = 4_194_303.0;

/// Sorts `items`, at most [`SWEEP`], along the axis of the cheapest cut that fits into `budget` blocks and costs less
/// than `limit`. Returns the number of items on the left, or `None` if there is no such cut. `centres` are the bounds
/// of the items' [`centre`]s.
#[inline(always)]
pub(super) fn sweep<S: Simd>(
    simd: S,
    power: Power,
    items: &mut [Scratch],
    centres: &Scratch,
    budget: usize,
    limit: f32,
) -> Option<usize> {
    let count = items.len();
    let vectors = count.div_ceil(WIDTH);

    // Step 1: compute the sort keys.
    let mut points = [Points::ZERO; VECTORS];
    for (i, item) in items.iter().enumerate() {
        points[i / WIDTH].0[i % WIDTH] = centre(simd, f32x8::from_slice(simd, &item.lanes)).into();
    }
    let mut keys: [Numbers; 3] = [[[0; WIDTH]; VECTORS]; 3];
    let mut both_weights = [[f32x16::splat(simd, 0.0); 2]; VECTORS];
    for vector in 0..vectors {
        let positions = numbers(simd, vector * WIDTH);
        let columns = points[vector].columns(simd);
        for axis in 0..3 {
            let extent = 0.0 - (centres.lanes[axis] + centres.lanes[axis + 4]);
            let scale = STEPS / extent;
            let scale = if scale.is_finite() { scale } else { 0.0 };
            // The position on the axis, then the index in the set: a total order, so that the result depends on nothing
            // else.
            let place = (columns[axis] - centres.lanes[axis]) * scale + ROUND;
            let place = place.bitcast::<u32x16<S>>() & (ROUND as u32 - 1);
            ((place << SWEEP.ilog2()) | positions).store_slice(&mut keys[axis][vector]);
        }
        let rest = u32x16::splat(simd, count as u32) - positions;
        both_weights[vector] = [power.weights(simd, positions), power.weights(simd, rest)];
    }

    // Step 2: compare the cuts of each axis, identified by the number of items on the left.
    let mut orders = [[0; SWEEP]; 3];
    let mut best = Cheapest::below(limit);
    let empty = f32x8::splat(simd, f32::INFINITY);
    for axis in 0..3 {
        let order = &mut orders[axis];
        sort(simd, &keys[axis], count, order);
        let at = |place: usize| f32x8::from_slice(simd, &items[order[place] as usize].lanes);
        let (mut left, mut right) = ([Points::ZERO; VECTORS], [Points::ZERO; VECTORS]);
        let (mut low, mut high) = (empty, empty);
        for i in 1..count {
            low = low.min(at(i - 1));
            left[i / WIDTH].0[i % WIDTH] = lengths(simd, low);
            let i = count - i;
            high = high.min(at(i));
            right[i / WIDTH].0[i % WIDTH] = lengths(simd, high);
        }
        for vector in 0..vectors {
            let first = vector * WIDTH;
            let [left_weights, right_weights] = both_weights[vector];
            let costs = left[vector].areas(simd) * left_weights + right[vector].areas(simd) * right_weights;
            best.compare(simd, (axis, first), costs, numbers(simd, first), count, budget);
        }
    }

    let Cheapest { axis, cut, .. } = best.found()?;
    let mut sorted = [Scratch::EMPTY; SWEEP];
    for (slot, &position) in sorted.iter_mut().zip(&orders[axis][..count]) {
        *slot = items[position as usize];
    }
    items.copy_from_slice(&sorted[..count]);
    Some(cut)
}

/// Indices in ascending order of their keys, which are all different. The rank of a key is the number of smaller keys;
/// for so few keys, counting these in vectors is faster than any sort.
#[inline(always)]
fn sort<S: Simd>(simd: S, keys: &Numbers, count: usize, order: &mut [u32; SWEEP]) {
    let (zero, one) = (u32x16::splat(simd, 0), u32x16::splat(simd, 1));
    let mut places: Numbers = [[0; WIDTH]; VECTORS];
    for vector in 0..count.div_ceil(WIDTH) {
        let own = u32x16::from_slice(simd, &keys[vector]);
        let mut lesser = zero;
        for &key in &keys.as_flattened()[..count] {
            lesser += own.simd_gt(key).select(one, zero);
        }
        lesser.store_slice(&mut places[vector]);
    }
    for (position, &place) in places.as_flattened()[..count].iter().enumerate() {
        order[place as usize % SWEEP] = position as u32;
    }
}
