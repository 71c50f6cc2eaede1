//! The limits of what a scene accepts: one set of checks for the builder and for data read from bytes.
//!
//! Lengths stay between 1e-12 m and 1e12 m, so that no product of several of them overflows, neither in double nor in
//! single precision.

use super::SceneError;
use super::material::{ALPHA_BLENDED, CUBE_TEXTURE, GLOSS_PBR, NO_TEXTURE};
use super::vertices::MAX_COORDINATE;
use super::{Air, FogLaw, Light, MAX_FALLOFF, MAX_SHININESS, Material, Sky, Texture, TextureId};
use crate::pose::Pose;

const MOST: f64 = MAX_COORDINATE as f64;

/// A rejected value: the builder's error, and the field and value for errors about bytes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Refusal {
    pub(crate) error: SceneError,
    pub(crate) field: &'static str,
    pub(crate) value: f64,
}

impl From<Refusal> for SceneError {
    fn from(refusal: Refusal) -> Self {
        refusal.error
    }
}

/// Checks that all values hold, and otherwise names the first one that does not.
fn all(
    values: impl IntoIterator<Item = f64>,
    holds: impl Fn(f64) -> bool,
    field: &'static str,
    error: SceneError,
) -> Result<(), Refusal> {
    match values.into_iter().find(|&value| !holds(value)) {
        Some(value) => Err(Refusal { error, field, value }),
        None => Ok(()),
    }
}

/// Returns true if a coordinate is within ±1e12 m; false for NaN.
fn in_space(value: f64) -> bool {
    value.abs() <= MOST
}

fn up_to(most: f32) -> impl Fn(f64) -> bool {
    move |value| (0.0..=f64::from(most)).contains(&value)
}

fn is_length(value: f64) -> bool {
    (1.0 / MOST..=MOST).contains(&value)
}

/// Checks a unit vector or quaternion, given the square of its length.
fn is_unit(square: f64) -> bool {
    (square - 1.0).abs() <= 1e-6
}

pub(crate) fn uv(index: usize, uv: [f32; 2]) -> Result<(), Refusal> {
    all(uv.map(f64::from), in_space, "uv", SceneError::BadUv(index))
}

/// Checks the texture coordinates of a mesh: none, or one per vertex.
pub(crate) fn uvs(uvs: &[[f32; 2]], vertices: usize) -> Result<(), SceneError> {
    if !uvs.is_empty() && uvs.len() != vertices {
        return Err(SceneError::UvCount);
    }
    for (index, &own) in uvs.iter().enumerate() {
        uv(index, own)?;
    }
    Ok(())
}

/// Checks the normals that are given for a mesh: none, or one per vertex, each of any length but 0.
pub(crate) fn normals(normals: &[[f32; 3]], vertices: usize) -> Result<(), SceneError> {
    if !normals.is_empty() && normals.len() != vertices {
        return Err(SceneError::NormalCount);
    }
    let good = |normal: &[f32; 3]| normal.iter().all(|x| x.is_finite()) && *normal != [0.0; 3];
    match normals.iter().position(|normal| !good(normal)) {
        Some(index) => Err(SceneError::BadNormal(index)),
        None => Ok(()),
    }
}

/// Checks the square of the length of a stored normal.
pub(crate) fn stored_normal(index: usize, normal: [f32; 3]) -> Result<(), Refusal> {
    let square = normal.iter().map(|&value| f64::from(value) * f64::from(value)).sum::<f64>();
    all([square], is_unit, "squared length of the normal", SceneError::BadNormal(index))
}

pub(crate) fn material(material: &Material) -> Result<(), Refusal> {
    all(material.texture_repeat.map(f64::from), in_space, "texture repeat", SceneError::BadTextureRepeat)?;
    let stretch = material.cube_stretch.map(f64::from);
    all(stretch, in_space, "stretch of the cube texture", SceneError::BadTextureRepeat)?;
    all([f64::from(material.shininess)], up_to(MAX_SHININESS), "shininess", SceneError::BadShininess)?;
    all(
        [f64::from(material.gloss)],
        up_to(GLOSS_PBR as f32),
        "kind of highlights",
        SceneError::BadShininess,
    )?;
    let pbr = [material.roughness, material.metalness].map(f64::from);
    all(pbr, up_to(1.0), "roughness and metalness", SceneError::BadPbr)?;
    let alphas = [material.alpha, material.least_alpha].map(f64::from);
    all(alphas, up_to(1.0), "alpha", SceneError::BadAlpha)?;
    let [mirrored, passed] = [material.specular_reflectance, material.transmittance].map(f64::from);
    // The sum of two shares in single precision may slightly exceed 1.
    let shares = [mirrored, passed, (mirrored + passed) / (1.0 + 1e-6)];
    all(shares, up_to(1.0), "specular reflectance and transmittance", SceneError::BadShares)?;
    let kind = f64::from(material.texture_alpha);
    all([kind], up_to(ALPHA_BLENDED as f32), "kind of texture alpha", SceneError::BadAlpha)
}

/// Checks the textures of a material, which `find` finds by their indices.
pub(crate) fn textures_of<'t>(
    material: &Material,
    find: impl Fn(u32) -> Option<&'t Texture>,
) -> Result<(), Refusal> {
    for (name, index) in material.textures() {
        if index != NO_TEXTURE {
            texture(name, index, find(index), name == CUBE_TEXTURE)?;
        }
    }
    Ok(())
}

/// Checks the texture of a sky, which `find` finds by its index.
pub(crate) fn texture_of_sky<'t>(
    air: &Air,
    find: impl Fn(u32) -> Option<&'t Texture>,
) -> Result<(), Refusal> {
    match air.sky {
        Some(Sky::Cube(TextureId(index))) => texture("texture of the sky", index, find(index), true),
        Some(Sky::Clear { .. }) | None => Ok(()),
    }
}

/// Checks that a texture exists, and is a cube exactly where one is expected.
fn texture(field: &'static str, index: u32, found: Option<&Texture>, is_cube: bool) -> Result<(), Refusal> {
    let error = match found {
        None => SceneError::NoSuchTexture(index),
        Some(texture) if texture.is_cube() != is_cube => SceneError::WrongTexture(index),
        Some(_) => return Ok(()),
    };
    Err(Refusal { error, field, value: f64::from(index) })
}

pub(crate) fn instance(size: [f64; 3], scale: [f64; 3]) -> Result<(), Refusal> {
    all(size, is_length, "size", SceneError::BadSize)?;
    all(scale, |factor| is_length(factor.abs()), "scale", SceneError::BadScale)
}

pub(crate) fn pose(pose: &Pose) -> Result<(), Refusal> {
    let turn = pose.rotation().length_squared();
    all([turn], is_unit, "squared length of the rotation", SceneError::BadPose)?;
    all(pose.translation().to_array(), in_space, "translation", SceneError::BadPose)
}

pub(crate) fn air(air: &Air) -> Result<(), Refusal> {
    let bad = SceneError::BadAir;
    if let Some(fog) = air.fog {
        all(fog.colour.map(f64::from), in_space, "colour", bad)?;
        match fog.law {
            FogLaw::Linear { start_m, end_m } => {
                all([start_m, end_m].map(f64::from), in_space, "distances", bad)?;
                all([f64::from(end_m - start_m)], |length| length > 0.0, "end of fog after its start", bad)?;
            }
            FogLaw::Exponential { density_per_m } | FogLaw::ExponentialSquared { density_per_m } => {
                all([f64::from(density_per_m)], up_to(MAX_COORDINATE), "density", bad)?;
            }
        }
    }
    let colours = match air.sky {
        Some(Sky::Clear { zenith, horizon }) => [zenith, horizon],
        Some(Sky::Cube(_)) | None => [[0.0; 3]; 2],
    };
    all(colours.as_flattened().iter().copied().map(f64::from), in_space, "colour of the sky", bad)
}

pub(crate) fn light(light: &Light) -> Result<(), Refusal> {
    all(light.position, in_space, "position", SceneError::BadLight)?;
    let length = light.direction.iter().map(|value| value * value).sum::<f64>();
    all([length], is_unit, "squared length of the direction", SceneError::BadLight)?;
    all([f64::from(light.falloff)], up_to(MAX_FALLOFF), "falloff", SceneError::BadFalloff)
}
