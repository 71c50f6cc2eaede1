//! Textures that are multiplied by all light of a surface, after it was limited to 1:
//! [`TextureMode::Light`](crate::scene::TextureMode::Light) has the formula.
//!
//! Until [`Modulation::apply`], the colours of such lanes are those of the bare material. The functions are compiled
//! once for each level and never inlined, so that tiles without such textures do not pay for them.

use super::surface::Footprint;
use super::texture::Reading;
use super::{Colours, ROWS, Shader, lanes_in, store_where};
use crate::scene::{ColourSpace, Scene};
use crate::simd::{LANES, load_row, store_row};
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16};

/// The lanes of a tile whose texture is multiplied by all light.
pub(super) struct Modulation {
    /// The lanes, as one bit each. The values below are undefined for the others.
    pub(super) lanes: u64,
    texture: Colours,
    /// The light of the lamps with shadows, each limited to 1.
    passes: Colours,
    /// During the pass of a lamp with shadows, the other light.
    rest: Colours,
}

impl Modulation {
    pub(super) const fn new() -> Self {
        let black = [[0.0; LANES]; 3];
        Self { lanes: 0, texture: black, passes: black, rest: black }
    }

    /// Sets the other light aside before that of a lamp with shadows is added.
    #[inline(never)]
    pub(super) fn begin_pass<S: Simd>(&mut self, simd: S, colours: &mut Colours) {
        self.rest = *colours;
        simd.vectorize(
            #[inline(always)]
            || {
                for row in 0..ROWS {
                    let mine = lanes_in(simd, self.lanes, row);
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
        simd.vectorize(
            #[inline(always)]
            || {
                for row in 0..ROWS {
                    let mine = lanes_in(simd, self.lanes, row);
                    for channel in 0..3 {
                        let passes = load_row(simd, &self.passes[channel], row);
                        let light = at_most_one(simd, load_row(simd, &colours[channel], row));
                        store_row(passes + light, &mut self.passes[channel], row);
                        let rest = load_row(simd, &self.rest[channel], row);
                        store_where(simd, mine, rest, &mut colours[channel], row);
                    }
                }
            },
        );
    }

    /// Turns the light of the lanes into their colours, after all lamps.
    #[inline(never)]
    pub(super) fn apply<S: Simd>(&self, simd: S, colours: &mut Colours) {
        simd.vectorize(
            #[inline(always)]
            || {
                for row in 0..ROWS {
                    let mine = lanes_in(simd, self.lanes, row);
                    for channel in 0..3 {
                        let rest = at_most_one(simd, load_row(simd, &colours[channel], row));
                        let light = rest + load_row(simd, &self.passes[channel], row);
                        let colour = light * load_row(simd, &self.texture[channel], row);
                        store_where(simd, mine, colour, &mut colours[channel], row);
                    }
                }
            },
        );
    }
}

impl Shader {
    /// Reads the texture of lanes, by which [`Modulation::apply`] multiplies their light.
    #[inline(never)]
    pub(super) fn modulate<S: Simd>(
        &mut self,
        simd: S,
        scene: &Scene<'_>,
        texture: u32,
        footprints: &[Footprint<S>; ROWS],
        lanes: u64,
    ) {
        let Self { sampler, modulation, .. } = self;
        modulation.lanes |= lanes;
        sampler.turn_to(scene, texture);
        let reading = if scene.colour_space == ColourSpace::Srgb { Reading::Light } else { Reading::Numbers };
        simd.vectorize(
            #[inline(always)]
            || {
                let black = f32x16::splat(simd, 0.0);
                for row in 0..ROWS {
                    let mine = lanes_in(simd, lanes, row);
                    if !mine.any_true() {
                        continue;
                    }
                    let texture = sampler.sample(simd, scene, &footprints[row], mine, reading);
                    for channel in 0..3 {
                        store_where(simd, mine, texture[channel], &mut modulation.texture[channel], row);
                        store_where(simd, mine, black, &mut modulation.passes[channel], row);
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
