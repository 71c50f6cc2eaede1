//! What cuts cost, sixteen at a time.

use crate::simd::WIDTH;
use fearless_simd::{Simd, SimdBase, f32x8, f32x16, prelude::*, u32x16};

/// Sixteen times x, y, z and something else.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Points(pub(super) [[f32; 4]; WIDTH]);

impl Points {
    pub(super) const ZERO: Self = Self([[0.0; 4]; WIDTH]);

    /// All x, all y, all z.
    #[inline(always)]
    pub(super) fn columns<S: Simd>(&self, simd: S) -> [f32x16<S>; 3] {
        let rows: &[[f32; WIDTH]; 4] = bytemuck::cast_ref(&self.0);
        let row = |row: usize| f32x16::from_slice(simd, &rows[row]);
        let (xz, yw) = simd.deinterleave_f32x16(row(0), row(1));
        let (more_xz, more_yw) = simd.deinterleave_f32x16(row(2), row(3));
        let (x, z) = simd.deinterleave_f32x16(xz, more_xz);
        [x, simd.unzip_low_f32x16(yw, more_yw), z]
    }

    /// Half of the surfaces of boxes, of their [`lengths`].
    #[inline(always)]
    pub(super) fn areas<S: Simd>(&self, simd: S) -> f32x16<S> {
        let [x, y, z] = self.columns(simd);
        x * y + y * z + z * x
    }
}

/// The lengths of a box, negated: their products do not mind.
#[inline(always)]
pub(super) fn lengths<S: Simd>(simd: S, bounds: f32x8<S>) -> [f32; 4] {
    let (lower, upper) = simd.split_f32x8(bounds);
    (lower + upper).into()
}

const LANES: [u32; WIDTH] = {
    let mut lanes = [0; WIDTH];
    let mut lane = 0;
    while lane < WIDTH {
        lanes[lane] = lane as u32;
        lane += 1;
    }
    lanes
};

/// first, first + 1, …
#[inline(always)]
pub(super) fn numbers<S: Simd>(simd: S, first: usize) -> u32x16<S> {
    u32x16::from_slice(simd, &LANES) + first as u32
}

/// Blocks that so many triangles need.
#[inline(always)]
fn blocks<S: Simd>(counts: u32x16<S>) -> u32x16<S> {
    (counts + (WIDTH as u32 - 1)) >> WIDTH.ilog2()
}

/// What a set counts for beside its surface: its blocks to this power.
///
/// The heuristic takes a set for a leaf that is not cut any more. But its blocks will each have a part of its
/// surface only, so a power of 1 overrates large sets. Measured at [`Quality::High`](super::Quality::High), the boxes
/// that a random ray meets in a room, a warehouse, a noisy ball and a terrain are 11, 4, 1 and 1 % fewer with ¾ than
/// with 1; with ½, 12 % fewer again in the room, but 9 % more in the warehouse, and leaves are emptier.
#[derive(Debug, Clone, Copy)]
pub(super) enum Power {
    Half,
    ThreeQuarters,
    One,
}

impl Power {
    /// Weights of sets of so many triangles.
    #[inline(always)]
    pub(super) fn weights<S: Simd>(self, simd: S, counts: u32x16<S>) -> f32x16<S> {
        let blocks = simd.cvt_f32_u32x16(blocks(counts));
        match self {
            Self::Half => blocks.sqrt(),
            Self::ThreeQuarters => (blocks * blocks.sqrt()).sqrt(),
            Self::One => blocks,
        }
    }
}

/// The cheapest cut of a set so far.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cheapest {
    cost: f32,
    /// By how much the sides differ in size.
    skew: u32,
    pub(super) axis: usize,
    /// Its number among the cuts of the axis.
    pub(super) cut: usize,
}

impl Cheapest {
    /// None so far; what is found must cost less than `limit`.
    pub(super) fn below(limit: f32) -> Self {
        Self { cost: limit, skew: 0, axis: usize::MAX, cut: 0 }
    }

    pub(super) fn found(self) -> Option<Self> {
        (self.axis != usize::MAX).then_some(self)
    }

    /// Takes the cheapest of sixteen cuts of `count` primitives, `first` the number of the first, if it is cheaper
    /// than what was found before. `left`: how many each has on its left. Both sides must have some, and fit in
    /// `budget` blocks. Among equals it is the more even one, or flat sets would become lists.
    #[inline(always)]
    pub(super) fn compare<S: Simd>(
        &mut self,
        simd: S,
        (axis, first): (usize, usize),
        costs: f32x16<S>,
        left: u32x16<S>,
        count: usize,
        budget: usize,
    ) {
        let right = u32x16::splat(simd, count as u32) - left;
        // Below 0 it wraps, and is not less.
        let in_range = (left - 1).simd_lt(count as u32 - 1);
        let fits = (blocks(left) + blocks(right)).simd_le(budget as u32);
        let costs = (in_range & fits).select(costs, f32x16::splat(simd, f32::INFINITY));
        let least = costs.reduce_min();
        if least > self.cost || least == f32::INFINITY {
            return;
        }
        // Less than 2²⁸, as a number of triangles is.
        let skews = left.max(right) - left.min(right);
        let skews = skews << WIDTH.ilog2() | u32x16::from_slice(simd, &LANES);
        let best = costs.simd_eq(least).select(skews, u32x16::splat(simd, u32::MAX)).reduce_min();
        let (skew, lane) = (best >> WIDTH.ilog2(), best as usize % WIDTH);
        if least < self.cost || skew < self.skew {
            *self = Self { cost: least, skew, axis, cut: first + lane };
        }
    }
}
