//! The highlights of a tile's lanes, before lamps are added.

use super::{Colours, ROWS, lanes_in, light_of, store_where};
use crate::scene::{ColourSpace, Material};
use crate::simd::{LANES, Lanes};
use fearless_simd::{Simd, SimdBase, f32x16};

/// The highlights of a tile's lanes.
pub(super) struct Gloss {
    /// The lanes with highlights of Blinn and Phong, as one bit each.
    pub(super) lanes: u64,
    /// The lanes with facets. The values below are undefined for lanes in neither.
    pub(super) facets: u64,
    /// For facets, their reflectance seen head-on.
    pub(super) specular: Colours,
    /// For facets, their roughness.
    pub(super) shininess: Lanes<f32>,
    /// For facets, the factor of their highlights; for lanes with [`modulation`](super::modulation), the texture.
    pub(super) factor: Colours,
}

impl Gloss {
    pub(super) const NONE: Self = Self {
        lanes: 0,
        facets: 0,
        specular: [[0.0; LANES]; 3],
        shininess: [0.0; LANES],
        factor: [[0.0; LANES]; 3],
    };

    /// Sets the highlights of lanes to those of a material, by Blinn and Phong.
    #[inline(always)]
    pub(super) fn add<S: Simd>(&mut self, simd: S, material: &Material, lanes: u64, space: ColourSpace) {
        self.lanes |= lanes;
        let colour = light_of(material.specular, space);
        for row in 0..ROWS {
            let mine = lanes_in(simd, lanes, row);
            for channel in 0..3 {
                let specular = f32x16::splat(simd, colour[channel]);
                store_where(simd, mine, specular, &mut self.specular[channel], row);
            }
            let shininess = f32x16::splat(simd, material.shininess);
            store_where(simd, mine, shininess, &mut self.shininess, row);
        }
    }
}
