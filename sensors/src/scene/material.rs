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
    /// Highlights of lamps: the factor of their [`LightConfig::specular`] where the surface is a mirror between lamp and
    /// sensor. The texture does not change it.
    pub specular: [f32; 3],
    /// How small highlights are: the exponent of Blinn and Phong, 0 up to [`MAX_SHININESS`]. At 0 there are none, as in
    /// Gazebo classic.
    pub shininess: f32,
    /// How much of what is seen is the surface, from 0 to 1; the rest is what lies behind it. See [`TextureAlpha`].
    pub alpha: f32,
    /// What the alpha of the texture means.
    pub texture_alpha: TextureAlpha,
    /// Share of the light of lidars and depth cameras that is reflected as by a mirror, 0 to 1: they see what the mirror shows, at
    /// all the way that the light goes. Cameras do not.
    pub specular_reflectance: f32,
    /// Share of the light of lidars and depth cameras that passes straight through, 0 to 1, and with what is reflected at most
    /// 1; the rest is scattered, as all of it is by other surfaces. Cameras go by [`MaterialConfig::alpha`] instead.
    pub transmittance: f32,
    /// Normals over the surface, taken in by [`SceneBuilder::add_normal_map`](super::SceneBuilder::add_normal_map).
    pub normal_map: Option<TextureId>,
    /// A picture over the surface.
    pub texture: Option<TextureId>,
    /// How often picture and normals repeat along u and v.
    pub texture_repeat: [f32; 2],
}

impl Default for MaterialConfig {
    /// Grey, no texture.
    fn default() -> Self {
        Self {
            diffuse: [0.7; 3],
            ambient: [0.7; 3],
            emissive: [0.0; 3],
            specular: [0.0; 3],
            shininess: 0.0,
            alpha: 1.0,
            texture_alpha: TextureAlpha::Ignored,
            specular_reflectance: 0.0,
            transmittance: 0.0,
            normal_map: None,
            texture: None,
            texture_repeat: [1.0; 2],
        }
    }
}

/// What the alpha of a material's texture means.
///
/// Cameras alone see through surfaces by it, through four of them; a fifth is opaque. Depths, lidars and what is true of a pixel
/// are those of the nearest surface, clear or not, as in Gazebo, but for [`MaterialConfig::transmittance`]. What has an alpha below 1 or a blended texture casts no
/// shadows; what is cut out casts the shadow of the whole.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum TextureAlpha {
    /// Nothing: the texture is opaque.
    #[default]
    Ignored,
    /// What has an alpha below `least`, from 0 to 1, is not there.
    CutOut {
        /// As much is there.
        least: f32,
    },
    /// It is a factor of [`MaterialConfig::alpha`].
    Blended,
}

pub(crate) const ALPHA_IGNORED: u32 = 0;
pub(crate) const ALPHA_CUT_OUT: u32 = 1;
pub(crate) const ALPHA_BLENDED: u32 = 2;

/// Greatest [`MaterialConfig::shininess`].
pub const MAX_SHININESS: f32 = 1e4;

pub(crate) const NO_TEXTURE: u32 = u32::MAX;

/// A material as it lies in a scene's memory.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct Material {
    pub(crate) diffuse: [f32; 3],
    pub(crate) ambient: [f32; 3],
    pub(crate) emissive: [f32; 3],
    pub(crate) specular: [f32; 3],
    pub(crate) shininess: f32,
    pub(crate) alpha: f32,
    pub(crate) texture_alpha: u32,
    pub(crate) least_alpha: f32,
    pub(crate) specular_reflectance: f32,
    pub(crate) transmittance: f32,
    pub(crate) normal_map: u32,
    pub(crate) texture_repeat: [f32; 2],
    pub(crate) texture: u32,
}

impl Material {
    /// Packs a configuration.
    pub fn new(config: &MaterialConfig) -> Self {
        let (texture_alpha, least_alpha) = match config.texture_alpha {
            TextureAlpha::Ignored => (ALPHA_IGNORED, 0.0),
            TextureAlpha::CutOut { least } => (ALPHA_CUT_OUT, least),
            TextureAlpha::Blended => (ALPHA_BLENDED, 0.0),
        };
        Self {
            diffuse: config.diffuse,
            ambient: config.ambient,
            emissive: config.emissive,
            specular: config.specular,
            shininess: config.shininess,
            alpha: config.alpha,
            texture_alpha,
            least_alpha,
            specular_reflectance: config.specular_reflectance,
            transmittance: config.transmittance,
            normal_map: config.normal_map.map_or(NO_TEXTURE, |texture| texture.0),
            texture_repeat: config.texture_repeat,
            texture: config.texture.map_or(NO_TEXTURE, |texture| texture.0),
        }
    }

    /// Whether lamps make highlights on it.
    pub(crate) fn is_glossy(&self) -> bool {
        self.shininess > 0.0 && self.specular != [0.0; 3]
    }

    /// Whether the texture's alpha counts.
    pub(crate) fn has_texture_alpha(&self) -> bool {
        self.texture != NO_TEXTURE && self.texture_alpha != ALPHA_IGNORED
    }

    /// Whether anything may be seen through it.
    pub(crate) fn is_clear(&self) -> bool {
        self.alpha < 1.0 || self.has_texture_alpha()
    }

    /// Whether lidars and depth cameras see anything by way of it.
    pub(crate) fn is_mirror_or_pane(&self) -> bool {
        self.specular_reflectance > 0.0 || self.transmittance > 0.0
    }

    /// Whether it stands in the way of light.
    pub(crate) fn casts_shadows(&self) -> bool {
        self.alpha >= 1.0 && !(self.has_texture_alpha() && self.texture_alpha == ALPHA_BLENDED)
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
        /// Between the two, the brightness is `(cos − cos_outer) / (cos_inner − cos_outer)` to this power, 0 up to
        /// [`MAX_FALLOFF`]: 1 is linear, 0 full brightness up to the outer angle.
        falloff: f32,
    },
}

/// Index of a lamp in its scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct LightId(pub u32);

/// Greatest falloff of a [`LightKind::Spot`].
pub const MAX_FALLOFF: f32 = 1e4;

/// A lamp and what it gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightConfig {
    /// Where.
    pub kind: LightKind,
    /// Colour times brightness.
    pub diffuse: [f32; 3],
    /// The same of its highlights on what is [glossy](MaterialConfig::specular).
    pub specular: [f32; 3],
    /// Metres beyond which it gives nothing; may be infinite.
    pub range_m: f32,
    /// Brightness at distance d is min(1, 1 / (a\[0\] + a\[1\]·d + a\[2\]·d²)). Not used for directional light.
    pub attenuation: [f32; 3],
    /// Whether things in the way cast shadows.
    pub cast_shadows: bool,
}

impl Default for LightConfig {
    /// A white point of light at the world's origin that reaches any distance undiminished, without highlights or shadows.
    fn default() -> Self {
        Self {
            kind: LightKind::Point { position: [0.0; 3] },
            diffuse: [1.0; 3],
            specular: [0.0; 3],
            range_m: f32::INFINITY,
            attenuation: [1.0, 0.0, 0.0],
            cast_shadows: false,
        }
    }
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
    pub(crate) specular: [f32; 3],
    pub(crate) attenuation: [f32; 3],
    pub(crate) range_m: f32,
    pub(crate) cos_inner: f32,
    pub(crate) cos_outer: f32,
    pub(crate) falloff: f32,
    /// The number of its [`Form`].
    pub(super) form: u32,
    pub(crate) cast_shadows: u32,
    pub(crate) reserved: u32,
}

impl Light {
    /// Packs a configuration; directions are normalised, (0, 0, 0) becomes (0, 0, −1).
    pub fn new(config: &LightConfig) -> Self {
        let unit = |v: [f64; 3]| glam::DVec3::from_array(v).normalize_or(glam::DVec3::NEG_Z).to_array();
        let (form, position, direction, [cos_inner, cos_outer, falloff]) = match config.kind {
            LightKind::Point { position } => (Form::Point, position, [0.0, 0.0, -1.0], [1.0; 3]),
            LightKind::Directional { direction } => (Form::Directional, [0.0; 3], unit(direction), [1.0; 3]),
            LightKind::Spot { position, direction, cos_inner, cos_outer, falloff } => {
                (Form::Spot, position, unit(direction), [cos_inner, cos_outer, falloff])
            }
        };
        Self {
            position,
            direction,
            diffuse: config.diffuse,
            specular: config.specular,
            attenuation: config.attenuation,
            range_m: config.range_m,
            cos_inner,
            cos_outer,
            falloff,
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
