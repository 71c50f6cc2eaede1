//! Emissive maps: the light that a surface emits, for each pixel.

use super::surface::Footprint;
use super::texels::Reading;
use super::{Colours, ROWS, Shader, lanes_in, light_of, store_where};
use crate::scene::{ColourSpace, Material, Scene};
use crate::simd::load_row;
use fearless_simd::{Simd, SimdMask};

impl Shader {
    /// Turns the light that the lanes emit, which was added as if there were no map, into that of the material's
    /// emissive map. It is not inlined, so that tiles without such a map do not pay for it.
    #[inline(never)]
    pub(super) fn glow<S: Simd>(
        &mut self,
        simd: S,
        scene: &Scene<'_>,
        material: &Material,
        footprints: &[Footprint<S>; ROWS],
        lanes: u64,
        colours: &mut Colours,
    ) {
        let (sampler, emissive) = (&mut self.maps, light_of(material.emissive, scene.colour_space));
        sampler.turn_to(scene, material.emissive_map);
        let is_srgb = scene.colour_space == ColourSpace::Srgb;
        let reading = if is_srgb { Reading::Light } else { Reading::Numbers };
        simd.vectorize(
            #[inline(always)]
            || {
                for row in 0..ROWS {
                    let mine = lanes_in(simd, lanes, row);
                    if !mine.any_true() {
                        continue;
                    }
                    let texel = sampler.sample(simd, scene, &footprints[row], mine, reading);
                    for channel in 0..3 {
                        let whole = load_row(simd, &colours[channel], row);
                        let mapped = whole + (texel[channel] - 1.0) * emissive[channel];
                        store_where(simd, mine, mapped, &mut colours[channel], row);
                    }
                }
            },
        );
    }
}
