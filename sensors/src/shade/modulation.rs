//! Textures that are multiplied by all light of a surface, after it was limited to 1:
//! [`TextureMode::Light`](crate::scene::TextureMode::Light) has the formula.
//!
//! Until [`Shader::apply_textures`], the colours of such lanes are those of the bare material. The functions are
//! compiled once for each level and never inlined, so that tiles without such textures do not pay for them. For the same
//! reason they use memory that is free while lamps are added: the texture is where facets have their factor, and the
//! light that is set aside where normal maps have had their gradients.

use super::surface::Footprint;
use super::texels::Reading;
use super::{Colours, ROWS, Shader, lanes_in, store_where};
use crate::scene::{ColourSpace, Scene};
use crate::simd::{LANES, load_row, store_row};
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16};

/// The index of the gradients where the light of the lamps with shadows is summed, each limited to 1.
const PASSES: usize = 0;
/// The index of those where the other light is, during the pass of a lamp with shadows.
const REST: usize = 1;

impl Shader {
    /// Forgets the passes of the tile before.
    #[inline(never)]
    pub(super) fn begin_passes(&mut self) {
        self.surfaces.gradient[PASSES] = [[0.0; LANES]; 3];
    }

    /// Sets the other light aside before that of a lamp with shadows is added.
    #[inline(never)]
    pub(super) fn begin_pass<S: Simd>(&mut self, simd: S, colours: &mut Colours) {
        self.surfaces.gradient[REST] = *colours;
        simd.vectorize(
            #[inline(always)]
            || {
                for row in 0..ROWS {
                    let mine = lanes_in(simd, self.modulated, row);
                    for channel in colours.iter_mut() {
                        store_where(simd, mine, f32x16::splat(simd, 0.0), channel, row);
                    }
                }
            },
        );
    }

    /// Limits the light of the lamp that was added since [`Self::begin_pass`].
    #[inline(never)]
    pub(super) fn end_pass<S: Simd>(&mut self, simd: S, colours: &mut Colours) {
        let [passes, rest] = &mut self.surfaces.gradient;
        simd.vectorize(
            #[inline(always)]
            || {
                for row in 0..ROWS {
                    let mine = lanes_in(simd, self.modulated, row);
                    for channel in 0..3 {
                        let light = at_most_one(simd, load_row(simd, &colours[channel], row));
                        let sum = load_row(simd, &passes[channel], row) + light;
                        store_row(sum, &mut passes[channel], row);
                        let rest = load_row(simd, &rest[channel], row);
                        store_where(simd, mine, rest, &mut colours[channel], row);
                    }
                }
            },
        );
    }

    /// Turns the light of the lanes into their colours, after all lamps.
    #[inline(never)]
    pub(super) fn apply_textures<S: Simd>(&self, simd: S, colours: &mut Colours) {
        let passes = &self.surfaces.gradient[PASSES];
        simd.vectorize(
            #[inline(always)]
            || {
                for row in 0..ROWS {
                    let mine = lanes_in(simd, self.modulated, row);
                    for channel in 0..3 {
                        let rest = at_most_one(simd, load_row(simd, &colours[channel], row));
                        let light = rest + load_row(simd, &passes[channel], row);
                        let colour = light * load_row(simd, &self.gloss.factor[channel], row);
                        store_where(simd, mine, colour, &mut colours[channel], row);
                    }
                }
            },
        );
    }

    /// Reads the texture of lanes, by which [`Self::apply_textures`] multiplies their light.
    #[inline(never)]
    pub(super) fn modulate<S: Simd>(
        &mut self,
        simd: S,
        scene: &Scene<'_>,
        texture: u32,
        footprints: &[Footprint<S>; ROWS],
        lanes: u64,
    ) {
        let Self { sampler, gloss, .. } = self;
        self.modulated |= lanes;
        sampler.turn_to(scene, texture);
        let reading = if scene.colour_space == ColourSpace::Srgb { Reading::Light } else { Reading::Numbers };
        simd.vectorize(
            #[inline(always)]
            || {
                for row in 0..ROWS {
                    let mine = lanes_in(simd, lanes, row);
                    if !mine.any_true() {
                        continue;
                    }
                    let texture = sampler.sample(simd, scene, &footprints[row], mine, reading);
                    for channel in 0..3 {
                        store_where(simd, mine, texture[channel], &mut gloss.factor[channel], row);
                    }
                }
            },
        );
    }
}

/// The minimum of a value and 1; 1 for NaN.
#[inline(always)]
fn at_most_one<S: Simd>(simd: S, value: f32x16<S>) -> f32x16<S> {
    let one = f32x16::splat(simd, 1.0);
    value.simd_lt(one).select(value, one)
}
