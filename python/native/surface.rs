//! Surfaces of bodies: colours, highlights and textures from Python arrays.

use crate::data::{Data, Origin};
use crate::errors::of;
use belvedere_sensors::scene::{
    CubeTexture, MaterialConfig, MaterialId, Pbr, SceneError, TextureAlpha, TextureId, TextureMode,
};
use numpy::PyReadonlyArrayDyn;
use pyo3::prelude::*;

/// A surface from Python: colour, emissive, specular, shininess, roughness and metalness, a texture, repetitions of the
/// texture, whether all light is multiplied by it, the stretch of a cube texture.
pub(crate) type Look<'py> =
    ([f32; 4], [f32; 3], [f32; 3], f32, Option<[f32; 2]>, Option<Picture<'py>>, [f32; 2], bool, [f32; 3]);

/// A texture from Python.
#[derive(FromPyObject)]
pub(crate) enum Picture<'py> {
    /// The number of a body, whose texture is shared.
    OfBody(usize),
    /// Texels, the number of columns, and whether they are the six faces of a cube.
    Texels((PyReadonlyArrayDyn<'py, u8>, u32, bool)),
}

/// A checked surface: a material without its texture, the texture, and the stretch of a cube texture.
pub(crate) type Surface<'a> = (MaterialConfig, Option<CheckedPicture<'a>>, [f32; 3]);

/// A texture whose texels are whole.
pub(crate) enum CheckedPicture<'a> {
    /// The number of a body, whose texture is shared.
    OfBody(usize),
    /// Texels, the number of columns, and whether they are the six faces of a cube.
    Texels(&'a [[u8; 4]], u32, bool),
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
        SceneError::BadTexture | SceneError::BadCube => "texture",
        SceneError::BadTextureRepeat => "texture_repeat",
        SceneError::BadLight => "position",
        SceneError::BadFalloff => "falloff",
        _ => "size",
    };
    of(argument, error)
}

/// Checks a surface from Python arrays.
pub(crate) fn surface<'a>(look: &'a Look<'_>) -> PyResult<Surface<'a>> {
    let (color, emissive, specular, shininess, pbr, picture, texture_repeat, is_light, stretch) = look;
    let picture = picture.as_ref().map(|picture| match picture {
        Picture::OfBody(body) => Ok::<_, PyErr>(CheckedPicture::OfBody(*body)),
        Picture::Texels((texels, width, is_cube)) => {
            Ok(CheckedPicture::Texels(texels_of("texture", texels)?, *width, *is_cube))
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
    Ok((material, picture.transpose()?, *stretch))
}

/// Returns the texels of an array.
pub(crate) fn texels_of<'a>(
    argument: &str,
    texels: &'a PyReadonlyArrayDyn<'_, u8>,
) -> PyResult<&'a [[u8; 4]]> {
    let texels = texels.as_slice().map_err(|error| of(argument, error))?;
    bytemuck::try_cast_slice(texels).map_err(|error| of(argument, error))
}

/// Adds a material and its texture, or neither; returns the material with its texture.
pub(crate) fn add_material(
    data: &mut Data,
    (material, picture, stretch): &Surface<'_>,
) -> PyResult<(MaterialId, MaterialConfig)> {
    let (texture, is_cube) = match picture {
        None => (None, false),
        Some(CheckedPicture::OfBody(body)) => {
            let (texture, is_cube) = texture_of(data, *body)?;
            (Some(texture), is_cube)
        }
        Some(CheckedPicture::Texels(texels, width, true)) => {
            (Some(data.builder.add_cube_texture(*width, texels).map_err(of_shape)?), true)
        }
        Some(CheckedPicture::Texels(texels, width, false)) => {
            let height = texels.len() / (*width).max(1) as usize;
            (Some(data.builder.add_texture(*width, height as u32, texels).map_err(of_shape)?), false)
        }
    };
    let cube = texture.filter(|_| is_cube).map(|texture| CubeTexture { texture, stretch: *stretch });
    let config = MaterialConfig { texture: texture.filter(|_| !is_cube), cube_texture: cube, ..*material };
    let material = data.builder.add_material(&config).map_err(|error| {
        remove_textures(data, &config);
        of_shape(error)
    });
    Ok((material?, config))
}

/// Removes the textures of a material, unless another one uses them.
pub(crate) fn remove_textures(data: &mut Data, config: &MaterialConfig) {
    for texture in [config.texture, config.cube_texture.map(|cube| cube.texture)].into_iter().flatten() {
        let _ = data.builder.remove_texture(texture);
    }
}

/// Returns the texture with which a body was added, and whether it is a cube.
fn texture_of(data: &Data, body: usize) -> PyResult<(TextureId, bool)> {
    let origin = data.bodies.get(body).and_then(|body| body.origin.as_deref());
    let texture = origin.and_then(|Origin { material, .. }| {
        let cube = material.cube_texture.map(|cube| (cube.texture, true));
        material.texture.map(|texture| (texture, false)).or(cube)
    });
    texture.ok_or_else(|| {
        of(
            "texture",
            format_args!("body {body} was not added with a texture; an image or a body with one is expected"),
        )
    })
}
