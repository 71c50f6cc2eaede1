//! The elements that the builder sorts: boxes with tags, thirty-two bytes each.

use bytemuck::{Pod, Zeroable};
use fearless_simd::{Simd, f32x4, f32x8};

/// Added to tags so that they are not subnormal as floats, which slows down some processors.
const TAG: u32 = 1 << 23;

/// Added to counts: about 1 as a float, so that sums and differences with a tag are not subnormal either.
const COUNT: u32 = 127 << 23;

/// One unit of the builder's working memory: a box and two tags.
///
/// Lanes 0–2 are the lower corner and lanes 4–6 the *negated* upper corner, so that one eight-lane minimum joins two
/// boxes. Lanes 3 and 7 carry integers as bits, which arithmetic may corrupt. A box never contains −0, so the result of
/// a minimum does not depend on the machine.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C, align(32))]
pub struct Scratch {
    pub(super) lanes: [f32; 8],
}

impl Scratch {
    /// The empty box, neutral when joined.
    pub(super) const EMPTY: Self = Self { lanes: [f32::INFINITY; 8] };

    #[inline(always)]
    pub(super) fn new(min: [f32; 3], max: [f32; 3]) -> Self {
        // 0 + x and 0 − x are never −0.
        let [a, b, c] = min.map(|x| 0.0 + x);
        let [d, e, f] = max.map(|x| 0.0 - x);
        Self { lanes: [a, b, c, 0.0, d, e, f, 0.0] }
    }

    /// Half of the surface area.
    #[inline(always)]
    pub(super) fn area(&self) -> f32 {
        let l = &self.lanes;
        // The lengths are negated; their products are the same.
        let [x, y, z] = [l[0] + l[4], l[1] + l[5], l[2] + l[6]];
        x * y + y * z + z * x
    }

    #[inline(always)]
    pub(super) fn min(&self) -> [f32; 3] {
        [self.lanes[0], self.lanes[1], self.lanes[2]]
    }

    #[inline(always)]
    pub(super) fn max(&self) -> [f32; 3] {
        [0.0 - self.lanes[4], 0.0 - self.lanes[5], 0.0 - self.lanes[6]]
    }

    /// The tag. Of a primitive: its triangle. Of a binary node: the first primitive of a leaf, the right child of an
    /// inner node.
    #[inline(always)]
    pub(super) fn tag(&self) -> u32 {
        self.lanes[3].to_bits().wrapping_sub(TAG)
    }

    /// The number of primitives of a leaf of the binary tree; 0 for an inner node.
    #[inline(always)]
    pub(super) fn count(&self) -> u32 {
        self.lanes[7].to_bits().wrapping_sub(COUNT)
    }

    #[inline(always)]
    pub(super) fn with_tags(mut self, tag: u32, count: u32) -> Self {
        self.lanes[3] = f32::from_bits(tag.wrapping_add(TAG));
        self.lanes[7] = f32::from_bits(count.wrapping_add(COUNT));
        self
    }
}

/// Twice the centre of a box.
#[inline(always)]
pub(super) fn centre<S: Simd>(simd: S, bounds: f32x8<S>) -> f32x4<S> {
    let (lower, upper) = simd.split_f32x8(bounds);
    lower - upper
}

/// The bounding box of three corners.
#[inline(always)]
pub(super) fn bounds_of([a, b, c]: [[f32; 3]; 3]) -> Scratch {
    let min = |i: usize| smaller(smaller(a[i], b[i]), c[i]);
    let max = |i: usize| larger(larger(a[i], b[i]), c[i]);
    Scratch::new([min(0), min(1), min(2)], [max(0), max(1), max(2)])
}

/// The smaller number, in one instruction, unlike `f32::min`.
#[inline(always)]
pub(super) fn smaller(a: f32, b: f32) -> f32 {
    if b < a { b } else { a }
}

#[inline(always)]
pub(super) fn larger(a: f32, b: f32) -> f32 {
    if b > a { b } else { a }
}
