//! A test whether two depths may belong to one surface.

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16};

/// Returns where two depths, each with its cosine of incidence, may belong to one surface; `apart` is the angle between
/// their rays in radians.
///
/// In a view of less than 90°, the depth of a surface changes at most by (1 + tan θ) times itself per radian. One and a
/// half times that is allowed.
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
    // Both sides are multiplied by the cosine, which may be 0.
    same | (change * cosine).simd_le(most * (sine + cosine))
}
