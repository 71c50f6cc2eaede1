//! The opacity of each pixel of clear surfaces.

use super::surface::Footprint;
use super::texels::Reading;
use super::{ROWS, Shader, lanes_in, store_where};
use crate::scene::{ALPHA_CUT_OUT, Material, Scene};
use crate::simd::WIDTH;
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16};

impl Shader {
    /// Computes the opacity of the surfaces of a clear material.
    pub(super) fn uncover<S: Simd>(
        &mut self,
        simd: S,
        scene: &Scene<'_>,
        material: &Material,
        footprints: &[Footprint<S>; ROWS],
        lanes: u64,
    ) {
        let Self { sampler, coverage, clear, .. } = self;
        simd.vectorize(
            #[inline(always)]
            || {
                let one = f32x16::splat(simd, 1.0);
                for row in 0..ROWS {
                    let mine = lanes_in(simd, lanes, row);
                    if !mine.any_true() {
                        continue;
                    }
                    let mut alpha = one;
                    if material.has_texture_alpha() {
                        [alpha, ..] = sampler.sample(simd, scene, &footprints[row], mine, Reading::Alpha);
                        if material.texture_alpha == ALPHA_CUT_OUT {
                            alpha = alpha.simd_ge(material.least_alpha).select(one, f32x16::splat(simd, 0.0));
                        }
                    }
                    let alpha = alpha * material.alpha;
                    store_where(simd, mine, alpha, coverage, row);
                    *clear |= (alpha.simd_lt(one) & mine).to_bitmask() << (row * WIDTH);
                }
            },
        );
    }
}
