//! Materials and lights.

use super::cube::CubeTexture;
use super::pbr::Pbr;
use super::texture::{TextureAlpha, TextureId, TextureMode};
use bytemuck::{Pod, Zeroable};

/// How a surface looks. Colours are RGB in the scene's [`ColourSpace`](super::ColourSpace): by default they are used as
/// given, without gamma, as in Gazebo classic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaterialConfig {
    /// Diffuse reflectance for the light of lamps, multiplied by the texture. The default is 0.7 for each colour.
    pub diffuse: [f32; 3],
    /// Reflectance for ambient light, multiplied by the texture. The default is 0.7 for each colour.
    pub ambient: [f32; 3],
    /// Emitted light. The default is 0 for each colour.
    pub emissive: [f32; 3],
    /// Specular reflectance: factor of a lamp's [`LightConfig::specular`] at the peak of the highlight, where the
    /// surface mirrors the lamp towards the sensor. The texture changes it only in [`TextureMode::Light`]. The default
    /// is 0 for each colour.
    pub specular: [f32; 3],
    /// Sharpness of highlights: the Blinn–Phong exponent, 0 to [`MAX_SHININESS`]. At 0 there are no highlights, as in
    /// Gazebo classic. The default is 0.
    pub shininess: f32,
    /// Physically based reflection of lamps instead of [`MaterialConfig::specular`] and
    /// [`MaterialConfig::shininess`]. The default is `None`.
    pub pbr: Option<Pbr>,
    /// Opacity from 0 to 1; the rest shows what lies behind the surface. See [`TextureAlpha`]. The default is 1.
    pub alpha: f32,
    /// Meaning of the texture's alpha channel. The default is [`TextureAlpha::Ignored`].
    pub texture_alpha: TextureAlpha,
    /// Share of the light of lidars and depth cameras that is reflected specularly, 0 to 1. These sensors see what the
    /// mirror shows, at the length of the whole path of the light. Cameras ignore it. The default is 0.
    pub specular_reflectance: f32,
    /// Share of the light of lidars and depth cameras that passes straight through, 0 to 1. Together with
    /// [`MaterialConfig::specular_reflectance`] it is at most 1; the rest is scattered. Cameras use
    /// [`MaterialConfig::alpha`] instead. The default is 0.
    pub transmittance: f32,
    /// Normal map, added by [`SceneBuilder::add_normal_map`](super::SceneBuilder::add_normal_map). The default is
    /// `None`.
    pub normal_map: Option<TextureId>,
    /// Map of roughness and metalness, added by [`SceneBuilder::add_pbr_map`](super::SceneBuilder::add_pbr_map): its
    /// green is multiplied by [`Pbr::roughness`] and its blue by [`Pbr::metalness`], as in glTF. Without a
    /// [`MaterialConfig::pbr`] it is ignored. The default is `None`.
    pub pbr_map: Option<TextureId>,
    /// Colour texture that is multiplied by [`MaterialConfig::emissive`]. The default is `None`.
    pub emissive_map: Option<TextureId>,
    /// Colour texture. The default is `None`.
    pub texture: Option<TextureId>,
    /// Cube texture on the surface, which is used like [`MaterialConfig::texture`], and multiplied by it if there are
    /// both. Its alpha is ignored. The default is `None`.
    pub cube_texture: Option<CubeTexture>,
    /// What the textures are multiplied by. The default is [`TextureMode::Reflectance`].
    pub texture_mode: TextureMode,
    /// Number of repetitions of the texture and all maps along u and v. The default is 1 along both.
    pub texture_repeat: [f32; 2],
}

impl Default for MaterialConfig {
    /// Grey, without a texture.
    fn default() -> Self {
        Self {
            diffuse: [0.7; 3],
            ambient: [0.7; 3],
            emissive: [0.0; 3],
            specular: [0.0; 3],
            shininess: 0.0,
            pbr: None,
            alpha: 1.0,
            texture_alpha: TextureAlpha::Ignored,
            specular_reflectance: 0.0,
            transmittance: 0.0,
            normal_map: None,
            pbr_map: None,
            emissive_map: None,
            texture: None,
            cube_texture: None,
            texture_mode: TextureMode::Reflectance,
            texture_repeat: [1.0; 2],
        }
    }
}

pub(crate) const ALPHA_IGNORED: u32 = 0;
pub(crate) const ALPHA_CUT_OUT: u32 = 1;
pub(crate) const ALPHA_BLENDED: u32 = 2;

/// Numbers of [`Material::gloss`]: no highlights, those of Blinn and Phong, and those of [`Pbr`].
pub(crate) const GLOSS_NONE: u32 = 0;
pub(crate) const GLOSS_PHONG: u32 = 1;
pub(crate) const GLOSS_PBR: u32 = 2;

/// The greatest [`MaterialConfig::shininess`].
pub const MAX_SHININESS: f32 = 1e4;

pub(crate) const NO_TEXTURE: u32 = u32::MAX;

/// The name of the texture of a material that is a cube.
pub(super) const CUBE_TEXTURE: &str = "cube texture";

/// A material as it is stored in a scene.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct Material {
    pub(crate) diffuse: [f32; 3],
    pub(crate) ambient: [f32; 3],
    pub(crate) emissive: [f32; 3],
    /// For [`GLOSS_PBR`], [`Pbr::highlights`].
    pub(crate) specular: [f32; 3],
    pub(crate) shininess: f32,
    /// Whether and how lamps make highlights: [`GLOSS_NONE`], [`GLOSS_PHONG`] or [`GLOSS_PBR`].
    pub(crate) gloss: u32,
    pub(crate) roughness: f32,
    pub(crate) metalness: f32,
    pub(crate) alpha: f32,
    pub(crate) texture_alpha: u32,
    pub(crate) least_alpha: f32,
    pub(crate) specular_reflectance: f32,
    pub(crate) transmittance: f32,
    pub(crate) normal_map: u32,
    /// [`NO_TEXTURE`] unless `gloss` is [`GLOSS_PBR`].
    pub(crate) pbr_map: u32,
    pub(crate) emissive_map: u32,
    pub(crate) texture_repeat: [f32; 2],
    /// The texture if its mode is [`TextureMode::Reflectance`], otherwise [`NO_TEXTURE`].
    pub(crate) texture: u32,
    /// The texture if its mode is [`TextureMode::Light`], otherwise [`NO_TEXTURE`], as for [`GLOSS_PBR`].
    pub(crate) light_texture: u32,
    /// The cube texture, and whether its mode is [`TextureMode::Light`].
    pub(crate) cube_texture: u32,
    pub(crate) cube_by_light: u32,
    pub(crate) cube_stretch: [f32; 3],
}

impl Material {
    /// Packs a configuration.
    pub fn new(config: &MaterialConfig) -> Self {
        let (texture_alpha, least_alpha) = match config.texture_alpha {
            TextureAlpha::Ignored => (ALPHA_IGNORED, 0.0),
            TextureAlpha::CutOut { least } => (ALPHA_CUT_OUT, least),
            TextureAlpha::Blended => (ALPHA_BLENDED, 0.0),
        };
        let gloss = match config.pbr {
            Some(_) => GLOSS_PBR,
            None if config.shininess > 0.0 && config.specular != [0.0; 3] => GLOSS_PHONG,
            None => GLOSS_NONE,
        };
        let pbr = config.pbr.unwrap_or_default();
        let by_light = config.texture_mode == TextureMode::Light && config.pbr.is_none();
        let number = |texture: Option<TextureId>| texture.map_or(NO_TEXTURE, |texture| texture.0);
        Self {
            diffuse: config.diffuse,
            ambient: config.ambient,
            emissive: config.emissive,
            specular: if gloss == GLOSS_PBR { pbr.highlights } else { config.specular },
            shininess: config.shininess,
            gloss,
            roughness: pbr.roughness,
            metalness: pbr.metalness,
            alpha: config.alpha,
            texture_alpha,
            least_alpha,
            specular_reflectance: config.specular_reflectance,
            transmittance: config.transmittance,
            normal_map: number(config.normal_map),
            pbr_map: number(config.pbr_map.filter(|_| gloss == GLOSS_PBR)),
            emissive_map: number(config.emissive_map),
            texture_repeat: config.texture_repeat,
            texture: number(config.texture.filter(|_| !by_light)),
            light_texture: number(config.texture.filter(|_| by_light)),
            cube_texture: number(config.cube_texture.map(|cube| cube.texture)),
            cube_by_light: by_light.into(),
            cube_stretch: config.cube_texture.map_or([1.0; 3], |cube| cube.stretch),
        }
    }

    /// The names and indices of its textures, which are [`NO_TEXTURE`] for those that it does not have.
    pub(crate) const fn textures(&self) -> [(&'static str, u32); 6] {
        [
            ("texture", self.texture),
            ("texture", self.light_texture),
            ("normal map", self.normal_map),
            ("map of roughness and metalness", self.pbr_map),
            ("emissive map", self.emissive_map),
            (CUBE_TEXTURE, self.cube_texture),
        ]
    }

    /// Returns true if it has any texture with coordinates, which a cube texture has not.
    #[inline(always)]
    pub(crate) const fn is_mapped(&self) -> bool {
        // All bits of `NO_TEXTURE` are set.
        self.texture & self.light_texture & self.normal_map & self.pbr_map & self.emissive_map != NO_TEXTURE
    }

    /// Returns true if the material has a cube texture.
    #[inline(always)]
    pub(crate) const fn has_cube(&self) -> bool {
        self.cube_texture != NO_TEXTURE
    }

    /// Returns true if the material has a texture, of either [`TextureMode`], or a cube texture.
    pub const fn is_textured(&self) -> bool {
        self.has_image() || self.has_cube()
    }

    /// Returns true if the material has a texture that is not a cube.
    const fn has_image(&self) -> bool {
        self.texture & self.light_texture != NO_TEXTURE
    }

    /// Returns true if lamps make highlights on the material.
    pub(crate) fn is_glossy(&self) -> bool {
        self.gloss != GLOSS_NONE
    }

    /// Returns true if the material has a [`Pbr`].
    pub(crate) fn is_pbr(&self) -> bool {
        self.gloss == GLOSS_PBR
    }

    /// Returns true if the texture's alpha is used.
    pub(crate) fn has_texture_alpha(&self) -> bool {
        self.has_image() && self.texture_alpha != ALPHA_IGNORED
    }

    /// Returns true if anything may be seen through the material.
    pub(crate) fn is_clear(&self) -> bool {
        self.alpha < 1.0 || self.has_texture_alpha()
    }

    /// Returns true if lidars and depth cameras see anything by reflection or transmission.
    pub(crate) fn is_mirror_or_pane(&self) -> bool {
        self.specular_reflectance > 0.0 || self.transmittance > 0.0
    }

    /// Returns true if the material blocks light.
    pub(crate) fn casts_shadows(&self) -> bool {
        self.alpha >= 1.0 && !(self.has_texture_alpha() && self.texture_alpha == ALPHA_BLENDED)
    }
}

/// The kind of a lamp: how its light spreads, with positions and directions in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// A point light that shines from `position` in all directions.
    Point {
        /// Position in the world, in metres.
        position: [f64; 3],
    },
    /// Parallel light that travels along `direction`.
    Directional {
        /// Direction in the world, of any length but 0.
        direction: [f64; 3],
    },
    /// A spotlight.
    Spot {
        /// Position in the world, in metres.
        position: [f64; 3],
        /// Axis along which the light travels, in the world, of any length but 0.
        direction: [f64; 3],
        /// Cosine of half the angle of the inner cone, inside which the spot has its full brightness.
        cos_inner: f32,
        /// Cosine of half the angle of the outer cone, outside which the spot gives no light.
        cos_outer: f32,
        /// Exponent, 0 to [`MAX_FALLOFF`], of the brightness between the two cones, `((cos − cos_outer) / (cos_inner −
        /// cos_outer))^falloff`: 1 is linear, 0 is full brightness up to the outer cone.
        falloff: f32,
    },
}

/// Index of a lamp in its scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct LightId(pub u32);

/// The greatest falloff of a [`LightKind::Spot`].
pub const MAX_FALLOFF: f32 = 1e4;

/// The configuration of a lamp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightConfig {
    /// Kind of the lamp, with its position and direction. The default is a [`LightKind::Point`] at the world's origin.
    pub kind: LightKind,
    /// Diffuse light: colour times brightness. The default is 1 for each colour.
    pub diffuse: [f32; 3],
    /// Light that makes highlights on [glossy](MaterialConfig::specular) materials: colour times brightness. The
    /// default is 0 for each colour.
    pub specular: [f32; 3],
    /// Range in metres, beyond which the lamp gives no light; may be infinite. The default is infinity.
    pub range_m: f32,
    /// Brightness at distance d is min(1, 1 / (a\[0\] + a\[1\]·d + a\[2\]·d²)). Not used for directional light. The
    /// default is \[1, 0, 0\], without any loss.
    pub attenuation: [f32; 3],
    /// Whether objects cast shadows in the light of this lamp. The default is `false`.
    pub cast_shadows: bool,
}

impl Default for LightConfig {
    /// A white point light at the world's origin with unlimited range and no attenuation, without highlights or
    /// shadows.
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

/// How the light of a lamp spreads: a [`LightKind`] without its parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    /// In all directions.
    Point,
    /// Parallel light.
    Directional,
    /// In a cone.
    Spot,
}

impl Form {
    /// The form that a number represents, or `None` if there is no such form.
    #[inline(always)]
    pub(crate) const fn from_number(number: u32) -> Option<Self> {
        Some(match number {
            0 => Self::Point,
            1 => Self::Directional,
            2 => Self::Spot,
            _ => return None,
        })
    }

    /// The number that represents the form.
    const fn number(self) -> u32 {
        match self {
            Self::Point => 0,
            Self::Directional => 1,
            Self::Spot => 2,
        }
    }
}

/// A lamp as it is stored in a scene.
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
    /// Packs a configuration. Directions are normalised; (0, 0, 0) becomes (0, 0, −1).
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
    /// How the light spreads. An invalid number, which the checks of a scene reject, counts as a point light.
    #[inline(always)]
    pub(crate) fn form(&self) -> Form {
        Form::from_number(self.form).unwrap_or(Form::Point)
    }
}

/// Ambient light and background.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Environment {
    /// Ambient light, RGB in [0, 1].
    pub ambient: [f32; 3],
    /// Colour of pixels that see nothing, RGB in [0, 1].
    pub background: [f32; 3],
}

impl Environment {
    /// Gazebo's defaults: ambient 0.4, background 0.7.
    pub const GAZEBO: Self = Self { ambient: [0.4; 3], background: [0.7; 3] };
}

impl Default for Environment {
    /// [`Environment::GAZEBO`].
    fn default() -> Self {
        Self::GAZEBO
    }
}
