//! The costs of cuts, sixteen at a time.

use crate::simd::WIDTH;
use fearless_simd::{Simd, SimdBase, f32x8, f32x16, prelude::*, u32x16};

/// Sixteen times x, y, z and a fourth value.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Points(pub(super) [[f32; 4]; WIDTH]);

impl Points {
    pub(super) const ZERO: Self = Self([[0.0; 4]; WIDTH]);

    /// The columns: all x, all y, all z.
    #[inline(always)]
    pub(super) fn columns<S: Simd>(&self, simd: S) -> [f32x16<S>; 3] {
        let rows: &[[f32; WIDTH]; 4] = bytemuck::cast_ref(&self.0);
        let row = |row: usize| f32x16::from_slice(simd, &rows[row]);
        let (xz, yw) = simd.deinterleave_f32x16(row(0), row(1));
        let (more_xz, more_yw) = simd.deinterleave_f32x16(row(2), row(3));
        let (x, z) = simd.deinterleave_f32x16(xz, more_xz);
        [x, simd.unzip_low_f32x16(yw, more_yw), z]
    }

    /// Half of the surface areas of boxes, whose [`lengths`] are stored.
    #[inline(always)]
    pub(super) fn areas<S: Simd>(&self, simd: S) -> f32x16<S> {
        let [x, y, z] = self.columns(simd);
        x * y + y * z + z * x
    }
}

/// The negated edge lengths of a box; the sign does not change their products.
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

/// The numbers first, first + 1, …
#[inline(always)]
pub(super) fn numbers<S: Simd>(simd: S, first: usize) -> u32x16<S> {
    u32x16::from_slice(simd, &LANES) + first as u32
}

/// Number of blocks that `counts` triangles need.
#[inline(always)]
fn blocks<S: Simd>(counts: u32x16<S>) -> u32x16<S> {
    (counts + (WIDTH as u32 - 1)) >> WIDTH.ilog2()
}

/// The exponent of a set's number of blocks, which weights its surface area.
///
/// The surface area heuristic treats a set as a leaf that is not split any further. But each of its blocks will have
/// only a part of its surface, so an exponent of 1 overrates large sets. Measured at
/// [`Quality::High`](super::quality::Quality::High), a random ray meets 11, 4, 1 and 1 % fewer boxes in a room, a
/// warehouse, a noisy ball and a terrain with ¾ than with 1. With ½ it meets another 12 % fewer in the room but 9 %
/// more in the warehouse, and leaves are emptier.
#[derive(Debug, Clone, Copy)]
pub(super) enum Power {
    Half,
    ThreeQuarters,
    One,
}

impl Power {
    /// Weights of sets with `counts` triangles.
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
    /// Difference in size between the two sides.
    skew: u32,
    pub(super) axis: usize,
    /// Number of the cut among those of the axis.
    pub(super) cut: usize,
}

impl Cheapest {
    /// No cut yet; a cut must cost less than `limit` to be taken.
    pub(super) fn below(limit: f32) -> Self {
        Self { cost: limit, skew: 0, axis: usize::MAX, cut: 0 }
    }

    pub(super) fn found(self) -> Option<Self> {
        (self.axis != usize::MAX).then_some(self)
    }

    /// Takes the cheapest of sixteen cuts of `count` primitives if it is cheaper than the best so far. `first` is the
    /// number of the first cut, `left` the number of primitives on the left of each. Both sides must be non-empty and
    /// fit into `budget` blocks. Among equal costs the more even cut wins, otherwise flat sets would become lists.
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
        // A difference below 0 wraps around, and is not less.
        let in_range = (left - 1).simd_lt(count as u32 - 1);
        let fits = (blocks(left) + blocks(right)).simd_le(budget as u32);
        let costs = (in_range & fits).select(costs, f32x16::splat(simd, f32::INFINITY));
        let least = costs.reduce_min();
        if least > self.cost || least == f32::INFINITY {
            return;
        }
        // Less than 2²⁸, like any number of triangles.
        let skews = left.max(right) - left.min(right);
        let skews = skews << WIDTH.ilog2() | u32x16::from_slice(simd, &LANES);
        let best = costs.simd_eq(least).select(skews, u32x16::splat(simd, u32::MAX)).reduce_min();
        let (skew, lane) = (best >> WIDTH.ilog2(), best as usize % WIDTH);
        if least < self.cost || skew < self.skew {
            *self = Self { cost: least, skew, axis, cut: first + lane };
        }
    }
}
