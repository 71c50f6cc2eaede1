//! Surfaces and light.

use super::texture::TextureId;
use bytemuck::{Pod, Zeroable};

/// How a surface looks. Colours are RGB, used as the files give them: no gamma, as Gazebo classic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaterialConfig {
    /// Reflected light of lamps, times the texture.
    pub diffuse: [f32; 3],
    /// Reflected ambient light, times the texture.
    pub ambient: [f32; 3],
    /// Own light.
    pub emissive: [f32; 3],
    /// A picture over the surface.
    pub texture: Option<TextureId>,
    /// How often the picture repeats along u and v.
    pub texture_repeat: [f32; 2],
}

impl Default for MaterialConfig {
    /// Grey, no texture.
    fn default() -> Self {
        Self {
            diffuse: [0.7; 3],
            ambient: [0.7; 3],
            emissive: [0.0; 3],
            texture: None,
            texture_repeat: [1.0; 2],
        }
    }
}

pub(crate) const NO_TEXTURE: u32 = u32::MAX;

/// A material as it lies in a scene's memory.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct Material {
    pub(crate) diffuse: [f32; 3],
    pub(crate) ambient: [f32; 3],
    pub(crate) emissive: [f32; 3],
    pub(crate) texture_repeat: [f32; 2],
    pub(crate) texture: u32,
}

impl Material {
    /// Packs a configuration.
    pub fn new(config: &MaterialConfig) -> Self {
        Self {
            diffuse: config.diffuse,
            ambient: config.ambient,
            emissive: config.emissive,
            texture_repeat: config.texture_repeat,
            texture: config.texture.map_or(NO_TEXTURE, |texture| texture.0),
        }
    }
}

/// A lamp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// From `position` (world, metres) to all sides.
    Point {
        /// World, metres.
        position: [f64; 3],
    },
    /// Parallel light that travels along `direction` (world, any length but 0).
    Directional {
        /// World.
        direction: [f64; 3],
    },
    /// A cone of light.
    Spot {
        /// World, metres.
        position: [f64; 3],
        /// Axis along which the light travels; world, any length but 0.
        direction: [f64; 3],
        /// Cosine of half the angle inside which it has its full brightness.
        cos_inner: f32,
        /// Cosine of half the angle outside which it has none.
        cos_outer: f32,
    },
}

/// Index of a lamp in its scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct LightId(pub u32);

/// A lamp and what it gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightConfig {
    /// Where.
    pub kind: LightKind,
    /// Colour times brightness.
    pub diffuse: [f32; 3],
    /// Metres beyond which it gives nothing; may be infinite.
    pub range_m: f32,
    /// Brightness at distance d is min(1, 1 / (a\[0\] + a\[1\]·d + a\[2\]·d²)). Not used for directional light.
    pub attenuation: [f32; 3],
    /// Whether things in the way cast shadows.
    pub cast_shadows: bool,
}

/// How the light of a lamp spreads: a [`LightKind`] without its numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    /// To all sides.
    Point,
    /// Parallel.
    Directional,
    /// In a cone.
    Spot,
}

impl Form {
    /// The form that a number stands for, if it is one.
    #[inline(always)]
    pub(crate) const fn from_number(number: u32) -> Option<Self> {
        Some(match number {
            0 => Self::Point,
            1 => Self::Directional,
            2 => Self::Spot,
            _ => return None,
        })
    }

    /// The number that stands for it.
    const fn number(self) -> u32 {
        match self {
            Self::Point => 0,
            Self::Directional => 1,
            Self::Spot => 2,
        }
    }
}

/// A lamp as it lies in a scene's memory.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct Light {
    pub(crate) position: [f64; 3],
    pub(crate) direction: [f64; 3],
    pub(crate) diffuse: [f32; 3],
    pub(crate) attenuation: [f32; 3],
    pub(crate) range_m: f32,
    pub(crate) cos_inner: f32,
    pub(crate) cos_outer: f32,
    /// The number of its [`Form`].
    pub(super) form: u32,
    pub(crate) cast_shadows: u32,
    pub(crate) reserved: u32,
}

impl Light {
    /// Packs a configuration; directions are normalised, (0, 0, 0) becomes (0, 0, −1).
    pub fn new(config: &LightConfig) -> Self {
        let unit = |v: [f64; 3]| glam::DVec3::from_array(v).normalize_or(glam::DVec3::NEG_Z).to_array();
        let (form, position, direction, cos_inner, cos_outer) = match config.kind {
            LightKind::Point { position } => (Form::Point, position, [0.0, 0.0, -1.0], 1.0, 1.0),
            LightKind::Directional { direction } => (Form::Directional, [0.0; 3], unit(direction), 1.0, 1.0),
            LightKind::Spot { position, direction, cos_inner, cos_outer } => {
                (Form::Spot, position, unit(direction), cos_inner, cos_outer)
            }
        };
        Self {
            position,
            direction,
            diffuse: config.diffuse,
            attenuation: config.attenuation,
            range_m: config.range_m,
            cos_inner,
            cos_outer,
            form: form.number(),
            cast_shadows: config.cast_shadows.into(),
            reserved: 0,
        }
    }
}

impl Light {
    /// How its light spreads. The number was checked where it came in; of another, to all sides.
    #[inline(always)]
    pub(crate) fn form(&self) -> Form {
        Form::from_number(self.form).unwrap_or(Form::Point)
    }
}

/// Light from everywhere, and what is seen where nothing is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Environment {
    /// RGB in [0, 1].
    pub ambient: [f32; 3],
    /// RGB in [0, 1].
    pub background: [f32; 3],
}

impl Environment {
    /// Gazebo's: ambient 0.4, background 0.7.
    pub const GAZEBO: Self = Self { ambient: [0.4; 3], background: [0.7; 3] };
}

impl Default for Environment {
    /// [`Environment::GAZEBO`].
    fn default() -> Self {
        Self::GAZEBO
    }
}
