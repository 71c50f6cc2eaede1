//! Split planes for a set of boxes: the surface area heuristic over bins of their centres.
//!
//! Wald, "On fast construction of SAH-based bounding volume hierarchies" (2007), with the size of a side measured in
//! *blocks* of sixteen triangles, since a ray pays per block.

use super::bounds::{Scratch, centre};
use super::cost::{Cheapest, Points, Power, lengths};
use crate::simd::WIDTH;
use fearless_simd::{Simd, SimdBase, f32x4, f32x8, u32x16};

/// Number of bins on each axis: one per vector lane.
const BINS: usize = WIDTH;

/// 2²³: adding it rounds a small f32 to an integer in the low bits.
const ROUND: f32 = 8_388_608.0;

/// A plane between two bins, and the boxes of both sides.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cut {
    pub(super) plane: Plane,
    pub(super) left_count: usize,
    pub(super) left: Scratch,
    pub(super) right: Scratch,
}

/// A split plane, which decides the side of a box.
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
    fn is_left(&self, item: &Scratch) -> bool {
        let centre = item.lanes[self.axis] - item.lanes[self.axis + 4];
        let x = (centre - self.origin) * self.scale - 0.5;
        let x = if x < 0.0 { 0.0 } else { x };
        x + ROUND <= self.last
    }

    /// Moves the items on the left to the front, without branching on the side of an item. Returns the bounds of the
    /// centres of both sides.
    #[inline(always)]
    pub(super) fn partition<S: Simd>(&self, simd: S, items: &mut [Scratch]) -> [Scratch; 2] {
        let zero = f32x4::splat(simd, 0.0);
        let mut left_centres = f32x8::splat(simd, f32::INFINITY);
        let mut right_centres = left_centres;
        let mut left = 0;
        for i in 0..items.len() {
            let item = items[i];
            let is_left = self.is_left(&item);
            let centre = centre(simd, f32x8::from_slice(simd, &item.lanes));
            let centre = simd.combine_f32x4(centre, zero - centre);
            // ∞ for the side to which the item does not belong, 0 for the other.
            let infinity = f32::INFINITY.to_bits();
            let mask = u32::from(is_left).wrapping_neg();
            left_centres = left_centres.min(centre + f32::from_bits(infinity & !mask));
            right_centres = right_centres.min(centre + f32::from_bits(infinity & mask));
            items[i] = items[left];
            items[left] = item;
            left += usize::from(is_left);
        }
        [Scratch { lanes: left_centres.into() }, Scratch { lanes: right_centres.into() }]
    }
}

/// Number of blocks that `count` triangles need.
#[inline(always)]
pub(super) fn blocks(count: usize) -> usize {
    count.div_ceil(WIDTH)
}

/// The cheapest cut of `items` whose sides fit into `budget` blocks, or `None`. `centres` are the bounds of the items'
/// [`centre`]s.
#[inline(always)]
pub(super) fn find_cut<S: Simd>(
    simd: S,
    power: Power,
    items: &[Scratch],
    centres: &Scratch,
    budget: usize,
) -> Option<Cut> {
    // The scales from centres to bins. On an axis without extent, or with one too short to divide by,
    // all items go into the first bin.
    let c = &centres.lanes;
    let origin = [c[0], c[1], c[2], 0.0];
    let mut scale = [0.0; 4];
    for axis in 0..3 {
        let extent = 0.0 - (c[axis] + c[axis + 4]);
        let s = BINS as f32 * 0.9999 / extent;
        scale[axis] = if s.is_finite() { s } else { 0.0 };
    }

    let Bins { bounds: bins, counts } = Bins::of(simd, items, &origin, &scale);

    // Compare the cuts of each axis, identified by the last bin on the left.
    let mut best = Cheapest::below(f32::INFINITY);
    let mut left_counts = [[0; BINS]; 3];
    let empty = f32x8::splat(simd, f32::INFINITY);
    for axis in 0..3 {
        if scale[axis] == 0.0 {
            continue;
        }
        let at = |bin: usize| f32x8::from_slice(simd, &bins[axis][bin].lanes);
        let (mut left, mut right) = (Points::ZERO, Points::ZERO);
        let (mut low, mut high) = (empty, empty);
        let mut left_count = 0;
        for bin in 0..BINS {
            low = low.min(at(bin));
            left.0[bin] = lengths(simd, low);
            left_count += counts[axis][bin];
            left_counts[axis][bin] = left_count;
            right.0[BINS - 1 - bin] = lengths(simd, high);
            high = high.min(at(BINS - 1 - bin));
        }
        let left_count = u32x16::from_slice(simd, &left_counts[axis]);
        let right_count = u32x16::splat(simd, items.len() as u32) - left_count;
        let costs = left.areas(simd) * power.weights(simd, left_count)
            + right.areas(simd) * power.weights(simd, right_count);
        best.compare(simd, (axis, 0), costs, left_count, items.len(), budget);
    }

    // The boxes of both sides of the best cut.
    let Cheapest { axis, cut, .. } = best.found()?;
    let union = |bins: &[Scratch]| {
        let mut all = empty;
        for bin in bins {
            all = all.min(f32x8::from_slice(simd, &bin.lanes));
        }
        Scratch { lanes: all.into() }
    };
    Some(Cut {
        plane: Plane { axis, origin: origin[axis], scale: scale[axis], last: cut as f32 + ROUND },
        left_count: left_counts[axis][cut] as usize,
        left: union(&bins[axis][..=cut]),
        right: union(&bins[axis][cut + 1..]),
    })
}

/// The boxes and the number of primitives in each bin of each axis.
struct Bins {
    bounds: [[Scratch; BINS]; 3],
    counts: [[u32; BINS]; 3],
}

impl Bins {
    const EMPTY: Self = Self { bounds: [[Scratch::EMPTY; BINS]; 3], counts: [[0; BINS]; 3] };

    /// Sorts boxes into the bins of all three axes at once.
    #[inline(always)]
    fn of<S: Simd>(simd: S, items: &[Scratch], origin: &[f32; 4], scale: &[f32; 4]) -> Self {
        let origins = f32x4::from_slice(simd, origin);
        let scales = f32x4::from_slice(simd, scale);
        let half = f32x4::splat(simd, 0.5);
        let zero = f32x4::splat(simd, 0.0);
        let round = f32x4::splat(simd, ROUND);
        let place = |bounds: f32x8<S>| -> [f32; 4] {
            (((centre(simd, bounds) - origins) * scales - half).max(zero) + round).into()
        };
        // Even and odd boxes have separate bins: neighbours often fall into the same bin, and would wait for each other.
        let mut bins = Self::EMPTY;
        let mut odd_bins = Self::EMPTY;
        let (pairs, last) = items.as_chunks::<2>();
        for [even, odd] in pairs {
            let even = f32x8::from_slice(simd, &even.lanes);
            let odd = f32x8::from_slice(simd, &odd.lanes);
            let (even_place, odd_place) = (place(even), place(odd));
            for axis in 0..3 {
                bins.add(simd, axis, even_place[axis], even);
                odd_bins.add(simd, axis, odd_place[axis], odd);
            }
        }
        for item in last {
            let bounds = f32x8::from_slice(simd, &item.lanes);
            let place = place(bounds);
            for axis in 0..3 {
                bins.add(simd, axis, place[axis], bounds);
            }
        }
        bins.joined(simd, &odd_bins)
    }

    /// `place`: the bin number plus [`ROUND`].
    #[inline(always)]
    fn add<S: Simd>(&mut self, simd: S, axis: usize, place: f32, bounds: f32x8<S>) {
        let bin = place.to_bits() as usize % BINS;
        let into = &mut self.bounds[axis][bin];
        f32x8::from_slice(simd, &into.lanes).min(bounds).store_slice(&mut into.lanes);
        self.counts[axis][bin] += 1;
    }

    #[inline(always)]
    fn joined<S: Simd>(mut self, simd: S, other: &Self) -> Self {
        for axis in 0..3 {
            for bin in 0..BINS {
                self.counts[axis][bin] += other.counts[axis][bin];
                let into = &mut self.bounds[axis][bin];
                let more = f32x8::from_slice(simd, &other.bounds[axis][bin].lanes);
                f32x8::from_slice(simd, &into.lanes).min(more).store_slice(&mut into.lanes);
            }
        }
        self
    }
}
