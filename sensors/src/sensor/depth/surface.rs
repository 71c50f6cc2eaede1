//! What may be one surface.

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16};

/// Where two depths, each with its cosine of incidence, may be of one surface, that is seen so many radians apart: by as much
/// as that a depth changes at most by (1 + tan θ) of itself per radian, in a view of less than 90°, and half as much again.
#[inline(always)]
pub(super) fn is_same_surface<S: Simd>(
    simd: S,
    own: [f32x16<S>; 2],
    other: [f32x16<S>; 2],
    apart: f32x16<S>,
) -> mask32x16<S> {
    let (one, zero) = (f32x16::splat(simd, 1.0), f32x16::splat(simd, 0.0));
    let change = (own[0] - other[0]).abs();
    let most = own[0] * apart * 1.5;
    let same = change.simd_le(most) | own[0].simd_eq(other[0]);
    if same.all_true() {
        return same;
    }
    let cosine = own[1].max(other[1]);
    let sine = (one - cosine * cosine).max(zero).sqrt();
    // Multiplied by the cosine, which may be 0.
    same | (change * cosine).simd_le(most * (sine + cosine))
}
