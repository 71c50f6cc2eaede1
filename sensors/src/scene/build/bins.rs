//! Where to cut a set of boxes: the surface area heuristic over bins of their centres.
//!
//! Wald, "On fast construction of SAH-based bounding volume hierarchies" (2007), with the cost of a side in
//! *blocks* of sixteen triangles, as that is what a ray pays for.

use super::bounds::Scratch;
use crate::scene::tree::WIDTH;
use fearless_simd::{Simd, SimdBase, f32x4, f32x8};

/// Bins on each axis.
const BINS: usize = 16;

/// 2²³: adding it rounds a small f32 to a whole number, in the low bits.
const ROUND: f32 = 8_388_608.0;

/// A plane between two bins, and what lies on both sides.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cut {
    pub(super) plane: Plane,
    pub(super) left_count: usize,
    pub(super) left: Scratch,
    pub(super) right: Scratch,
}

/// Which side a box belongs to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    axis: usize,
    origin: f32,
    scale: f32,
    /// The last bin on the left, plus [`ROUND`].
    last: f32,
}

impl Plane {
    #[inline(always)]
    pub(super) fn is_left(&self, item: &Scratch) -> bool {
        let centre = item.lanes[self.axis] - item.lanes[self.axis + 4];
        let x = (centre - self.origin) * self.scale - 0.5;
        let x = if x < 0.0 { 0.0 } else { x };
        x + ROUND <= self.last
    }
}

/// Blocks that `count` triangles need.
#[inline(always)]
pub(super) fn blocks(count: usize) -> usize {
    count.div_ceil(WIDTH)
}

/// The cheapest cut of `items` whose sides fit in `budget` blocks, or none. `centres` are the bounds of
/// [`Scratch::centre`] of all.
#[inline(always)]
pub(super) fn find_cut<S: Simd>(simd: S, items: &[Scratch], centres: &Scratch, budget: usize) -> Option<Cut> {
    // Step 1: scales from centres to bins; an axis without extent, or one too short to divide by, gets all into
    // its first bin.
    let c = &centres.lanes;
    let origin = [c[0], c[1], c[2], 0.0];
    let mut scale = [0.0; 4];
    for axis in 0..3 {
        let extent = 0.0 - (c[axis] + c[axis + 4]);
        let s = BINS as f32 * 0.9999 / extent;
        scale[axis] = if s.is_finite() { s } else { 0.0 };
    }

    // Step 2: into the bins of all three axes at once.
    let mut bins = [[Scratch::EMPTY; BINS]; 3];
    let mut counts = [[0_u32; BINS]; 3];
    let origins = f32x4::from_slice(simd, &origin);
    let scales = f32x4::from_slice(simd, &scale);
    let half = f32x4::splat(simd, 0.5);
    let zero = f32x4::splat(simd, 0.0);
    let round = f32x4::splat(simd, ROUND);
    for item in items {
        let bounds = f32x8::from_slice(simd, &item.lanes);
        let (lower, upper) = simd.split_f32x8(bounds);
        let x = ((lower - upper - origins) * scales - half).max(zero) + round;
        let x: [f32; 4] = x.into();
        for axis in 0..3 {
            let bin = x[axis].to_bits() as usize % BINS;
            let into = &mut bins[axis][bin];
            let joined = f32x8::from_slice(simd, &into.lanes).min(bounds);
            joined.store_slice(&mut into.lanes);
            counts[axis][bin] += 1;
        }
    }

    // Step 3: sweep from both ends.
    let mut best_cost = f32::INFINITY;
    let mut best_skew = usize::MAX;
    let mut best = None;
    for axis in 0..3 {
        if scale[axis] == 0.0 {
            continue;
        }
        let mut right_cost = [0.0; BINS];
        let mut joined = f32x8::splat(simd, f32::INFINITY);
        let mut count = 0;
        for bin in (1..BINS).rev() {
            joined = joined.min(f32x8::from_slice(simd, &bins[axis][bin].lanes));
            count += counts[axis][bin] as usize;
            right_cost[bin] = Scratch { lanes: joined.into() }.area() * blocks(count) as f32;
        }
        let mut joined = f32x8::splat(simd, f32::INFINITY);
        let mut count = 0;
        for bin in 0..BINS - 1 {
            joined = joined.min(f32x8::from_slice(simd, &bins[axis][bin].lanes));
            count += counts[axis][bin] as usize;
            let rest = items.len() - count;
            if count == 0 || rest == 0 || blocks(count) + blocks(rest) > budget {
                continue;
            }
            let cost = Scratch { lanes: joined.into() }.area() * blocks(count) as f32 + right_cost[bin + 1];
            // Among equals the more even one, or flat sets would become lists.
            let skew = count.abs_diff(rest);
            if cost < best_cost || (cost == best_cost && skew < best_skew) {
                best_cost = cost;
                best_skew = skew;
                best = Some((axis, bin, count));
            }
        }
    }

    // Step 4: what lies on both sides of the best.
    let (axis, last, left_count) = best?;
    let union = |bins: &[Scratch]| {
        let mut all = Scratch::EMPTY;
        for bin in bins {
            all.join(bin);
        }
        all
    };
    Some(Cut {
        plane: Plane { axis, origin: origin[axis], scale: scale[axis], last: last as f32 + ROUND },
        left_count,
        left: union(&bins[axis][..=last]),
        right: union(&bins[axis][last + 1..]),
    })
}
