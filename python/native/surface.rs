//! Surfaces of bodies: colours, highlights and textures from Python arrays.

use crate::data::Data;
use crate::errors::of;
use belvedere_sensors::scene::{
    MaterialConfig, MaterialId, Pbr, SceneError, TextureAlpha, TextureId, TextureMode,
};
use numpy::PyReadonlyArrayDyn;
use pyo3::prelude::*;

/// A surface from Python: colour, emissive, specular, shininess, roughness and metalness, a texture with its width,
/// repetitions of the texture, whether all light is multiplied by it.
pub(crate) type Look<'py> =
    ([f32; 4], [f32; 3], [f32; 3], f32, Option<[f32; 2]>, Option<Picture<'py>>, [f32; 2], bool);

/// A texture from Python.
#[derive(FromPyObject)]
pub(crate) enum Picture<'py> {
    /// The number of a body, whose texture is shared.
    OfBody(usize),
    /// Texels, and the number of columns.
    Texels((PyReadonlyArrayDyn<'py, u8>, u32)),
}

/// A checked surface: a material without its texture, and the texture.
pub(crate) type Surface<'a> = (MaterialConfig, Option<CheckedPicture<'a>>);

/// A texture whose texels are whole.
pub(crate) enum CheckedPicture<'a> {
    /// The number of a body, whose texture is shared.
    OfBody(usize),
    /// Texels, and the number of columns.
    Texels(&'a [[u8; 4]], u32),
}

/// Returns the error about the argument at fault.
pub(crate) fn of_shape(error: SceneError) -> PyErr {
    let argument = match error {
        SceneError::BadScale => "scale",
        SceneError::BadPose => "pose",
        SceneError::BadVertex(_) | SceneError::VertexTooFar(_) => "vertices",
        SceneError::BadTriangle(_) => "faces",
        SceneError::NormalCount | SceneError::BadNormal(_) => "normals",
        SceneError::UvCount | SceneError::BadUv(_) => "uvs",
        SceneError::BadHeight(_) | SceneError::HeightCount | SceneError::HeightFieldTooSmall => "heights",
        SceneError::BadAlpha => "color",
        SceneError::BadShininess => "shininess",
        SceneError::BadPbr => "roughness",
        SceneError::BadTexture => "texture",
        SceneError::BadTextureRepeat => "texture_repeat",
        SceneError::BadLight => "position",
        SceneError::BadFalloff => "falloff",
        _ => "size",
    };
    of(argument, error)
}

/// Checks a surface from Python arrays.
pub(crate) fn surface<'a>(look: &'a Look<'_>) -> PyResult<Surface<'a>> {
    let (color, emissive, specular, shininess, pbr, picture, texture_repeat, is_light) = look;
    let picture = picture.as_ref().map(|picture| match picture {
        Picture::OfBody(body) => Ok::<_, PyErr>(CheckedPicture::OfBody(*body)),
        Picture::Texels((texels, width)) => {
            let texels = texels.as_slice().map_err(|error| of("texture", error))?;
            let texels = bytemuck::try_cast_slice(texels).map_err(|error| of("texture", error))?;
            Ok(CheckedPicture::Texels(texels, *width))
        }
    });
    let [r, g, b, alpha] = *color;
    let material = MaterialConfig {
        diffuse: [r, g, b],
        ambient: [r, g, b],
        emissive: *emissive,
        specular: *specular,
        shininess: *shininess,
        pbr: pbr.map(|[roughness, metalness]| Pbr { roughness, metalness, ..Pbr::default() }),
        alpha,
        texture_alpha: TextureAlpha::Ignored,
        texture_repeat: *texture_repeat,
        texture_mode: if *is_light { TextureMode::Light } else { TextureMode::Reflectance },
        ..Default::default()
    };
    Ok((material, picture.transpose()?))
}

/// Adds a material and its texture, or neither; returns the material with its texture.
pub(crate) fn add_material(
    data: &mut Data,
    (material, picture): &Surface<'_>,
) -> PyResult<(MaterialId, MaterialConfig)> {
    let texture = match picture {
        None => None,
        Some(CheckedPicture::OfBody(body)) => Some(texture_of(data, *body)?),
        Some(CheckedPicture::Texels(texels, width)) => {
            let height = texels.len() / (*width).max(1) as usize;
            Some(data.builder.add_texture(*width, height as u32, texels).map_err(of_shape)?)
        }
    };
    let config = MaterialConfig { texture, ..*material };
    let material = data.builder.add_material(&config).map_err(|error| {
        // This leaves a texture that another body uses.
        texture.map(|texture| data.builder.remove_texture(texture));
        of_shape(error)
    });
    Ok((material?, config))
}

/// Returns the texture with which a body was added.
fn texture_of(data: &Data, body: usize) -> PyResult<TextureId> {
    let origin = data.bodies.get(body).and_then(|body| body.origin.as_deref());
    origin.and_then(|origin| origin.material.texture).ok_or_else(|| {
        of(
            "texture",
            format_args!("body {body} was not added with a texture; an image or a body with one is expected"),
        )
    })
}
