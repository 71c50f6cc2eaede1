//! What cameras see between and behind surfaces: fog and the sky.

use super::texture::TextureId;

/// What cameras see between and behind surfaces. Depths, lidars and ground truth do not depend on it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Air {
    /// Fog in front of surfaces. The default is `None`.
    pub fog: Option<Fog>,
    /// The sky, instead of the [background](super::Environment::background). The default is `None`.
    pub sky: Option<Sky>,
}

/// Fog in front of surfaces, as in Ogre: at depth d, a share s(d) of a surface's light arrives, and the rest of a pixel
/// is the colour of the fog. The background and the sky have no fog.
///
/// The depth is that along the optical axis for a pinhole camera, and that along the ray for other cameras.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fog {
    /// The colour, RGB in the scene's [`ColourSpace`](super::ColourSpace).
    pub colour: [f32; 3],
    /// How fog grows with the depth.
    pub law: FogLaw,
}

/// How fog grows with the depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FogLaw {
    /// s = (end − d) / (end − start), limited to 0 and 1.
    Linear {
        /// The depth in metres at which fog begins.
        start_m: f32,
        /// The greater depth in metres beyond which only fog is seen.
        end_m: f32,
    },
    /// s = exp(−density · d).
    Exponential {
        /// The density in 1/m, 0 or more.
        density_per_m: f32,
    },
    /// s = exp(−(density · d)²).
    ExponentialSquared {
        /// The density in 1/m, 0 or more.
        density_per_m: f32,
    },
}

/// The sky, which depends only on the direction of a ray in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sky {
    /// A clear sky: with s = 1 − (1 − sin elevation)², it is horizon + (zenith − horizon) · s above the horizon, and
    /// horizon below it.
    Clear {
        /// The colour above, RGB in the scene's [`ColourSpace`](super::ColourSpace).
        zenith: [f32; 3],
        /// The colour at the horizon and below.
        horizon: [f32; 3],
    },
    /// A cube texture, added by [`SceneBuilder::add_cube_texture`](super::SceneBuilder::add_cube_texture). The y axis
    /// of the cube points up, and its z axis to −y of the world: the direction (x, y, z) shows what is at (x, z, −y).
    Cube(TextureId),
}

impl Sky {
    /// A blue sky that is pale at the horizon.
    pub const DAY: Self = Self::Clear { zenith: [0.25, 0.45, 0.75], horizon: [0.8, 0.87, 0.95] };
}

/// [`Air`] as bytes.
#[cfg(feature = "alloc")]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct PackedAir {
    /// 0 for none, 1, 2 and 3 for the laws in their order.
    fog: u32,
    fog_colour: [f32; 3],
    fog_law: [f32; 2],
    /// 0 for none, 1 for a clear sky, 2 for a cube texture.
    sky: u32,
    zenith: [f32; 3],
    horizon: [f32; 3],
    sky_texture: u32,
    reserved: [u32; 2],
}

#[cfg(feature = "alloc")]
impl PackedAir {
    pub(super) fn new(air: &Air) -> Self {
        let (fog, fog_law) = match air.fog.map(|fog| fog.law) {
            None => (0, [0.0; 2]),
            Some(FogLaw::Linear { start_m, end_m }) => (1, [start_m, end_m]),
            Some(FogLaw::Exponential { density_per_m }) => (2, [density_per_m, 0.0]),
            Some(FogLaw::ExponentialSquared { density_per_m }) => (3, [density_per_m, 0.0]),
        };
        let (sky, [zenith, horizon], sky_texture) = match air.sky {
            None => (0, [[0.0; 3]; 2], 0),
            Some(Sky::Clear { zenith, horizon }) => (1, [zenith, horizon], 0),
            Some(Sky::Cube(texture)) => (2, [[0.0; 3]; 2], texture.0),
        };
        let fog_colour = air.fog.map_or([0.0; 3], |fog| fog.colour);
        Self { fog, fog_colour, fog_law, sky, zenith, horizon, sky_texture, reserved: [0; 2] }
    }

    /// The air; unknown numbers count as none.
    pub(super) fn air(&self) -> Air {
        let [first, second] = self.fog_law;
        let law = match self.fog {
            1 => Some(FogLaw::Linear { start_m: first, end_m: second }),
            2 => Some(FogLaw::Exponential { density_per_m: first }),
            3 => Some(FogLaw::ExponentialSquared { density_per_m: first }),
            _ => None,
        };
        let sky = match self.sky {
            1 => Some(Sky::Clear { zenith: self.zenith, horizon: self.horizon }),
            2 => Some(Sky::Cube(TextureId(self.sky_texture))),
            _ => None,
        };
        Air { fog: law.map(|law| Fog { colour: self.fog_colour, law }), sky }
    }
}
