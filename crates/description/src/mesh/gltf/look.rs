//! Materials of a glTF: base colour, roughness and metalness, transparency, emission and normals.

use super::container::{Container, unsupported};
use super::means::{Means, roughness_and_metalness};
use super::picture;
use crate::mesh::look::Look;
use crate::model::{Material, PbrMaps};
use belvedere_sensors::scene::{Pbr, TextureAlpha};
use glam::{DVec2, dvec2};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::PathBuf;

/// The material of a primitive, and the placement of its texture.
#[derive(Default)]
pub(super) struct Surface {
    pub(super) material: Option<Material>,
    /// The number of the set of texture coordinates that is used.
    pub(super) uv_set: u64,
    offset: DVec2,
    /// The images of the axes of the texture coordinates; `None` if these are unchanged.
    axes: Option<[DVec2; 2]>,
}

impl Surface {
    /// Converts texture coordinates of the file, with v down, to those of the mesh, with v up.
    pub(super) fn uv(&self, [u, v]: [f64; 2]) -> [f32; 2] {
        let uv = match self.axes {
            Some([right, down]) => right * u + down * v + self.offset,
            None => dvec2(u, v),
        };
        [uv.x as f32, (1.0 - uv.y) as f32]
    }
}

/// Reads a material. Its features that are not drawn are added to `left_out`.
///
/// # Errors
/// A message about what is wrong with it.
pub(super) fn surface(
    container: &Container<'_>,
    index: &Value,
    left_out: &mut BTreeSet<String>,
    means: &mut Means,
) -> Result<Surface, String> {
    if index.is_null() {
        return Ok(Surface::default());
    }
    let material = container.entry("materials", index)?;
    let metal = &material["pbrMetallicRoughness"];
    let gloss = &material["extensions"]["KHR_materials_pbrSpecularGlossiness"];
    let (factor, texture) = if metal.is_null() && !gloss.is_null() {
        (&gloss["diffuseFactor"], &gloss["diffuseTexture"])
    } else {
        (&metal["baseColorFactor"], &metal["baseColorTexture"])
    };
    let [red, green, blue, alpha] = numbers(factor, [1.0; 4]);
    let diffuse = [red, green, blue].map(displayed);
    let maps = [
        (&material["occlusionTexture"], "occlusion maps"),
        (&gloss["specularGlossinessTexture"], "specular-glossiness maps"),
    ];
    left_out.extend(maps.iter().filter(|(map, _)| !map.is_null()).map(|(_, what)| (*what).to_owned()));
    if material["doubleSided"] == true {
        left_out.insert("the insides of double-sided surfaces".into());
    }
    let (alpha, texture_alpha) = match material["alphaMode"].as_str() {
        Some("MASK") => {
            let least = material["alphaCutoff"].as_f64().unwrap_or(0.5) as f32;
            (1.0, TextureAlpha::CutOut { least: least.clamp(0.0, 1.0) })
        }
        Some("BLEND") => (alpha as f32, TextureAlpha::Blended),
        _ => (1.0, TextureAlpha::Ignored),
    };
    let look = Look {
        diffuse: Some(diffuse),
        alpha: Some(alpha),
        texture_alpha,
        texture: image(container, texture, left_out)?,
        ..Look::default()
    };
    let mut surface = Surface { material: look.material(), ..Surface::default() };
    let Some(look) = &mut surface.material else { return Ok(surface) };
    // A surface has only one set of texture coordinates: those of the first texture that there is.
    let (normals, glow) = (&material["normalTexture"], &material["emissiveTexture"]);
    let textures = [texture, normals, &metal["metallicRoughnessTexture"], glow];
    let main = textures.into_iter().find(|texture| !texture.is_null()).unwrap_or(texture);
    look.normal_map = map(container, (normals, main), left_out, "normal maps")?;
    look.emissive_map = map(container, (glow, main), left_out, "emissive maps")?;
    // The factor is multiplied by the map. Without the map, the whole surface would emit light.
    if glow.is_null() || look.emissive_map.is_some() {
        look.emissive = numbers(&material["emissiveFactor"], [0.0; 3]).map(displayed);
    }
    if material["extensions"]["KHR_materials_unlit"].is_null() {
        add_facets(container, material, main, left_out, means, look)?;
    }
    place(main, &mut surface);
    Ok(surface)
}

/// Adds the roughness and the metalness, with their map.
fn add_facets(
    container: &Container<'_>,
    material: &Value,
    main: &Value,
    left_out: &mut BTreeSet<String>,
    means: &mut Means,
    look: &mut Material,
) -> Result<(), String> {
    let share = |value: &Value| value.as_f64().unwrap_or(1.0).clamp(0.0, 1.0) as f32;
    let metal = &material["pbrMetallicRoughness"];
    let gloss = &material["extensions"]["KHR_materials_pbrSpecularGlossiness"];
    if metal.is_null() && !gloss.is_null() {
        look.pbr = Some(Pbr { roughness: 1.0 - share(&gloss["glossinessFactor"]), ..Pbr::default() });
        return Ok(());
    }
    let both = &metal["metallicRoughnessTexture"];
    let mut factors = [1.0; 2];
    if let Some(path) = map(container, (both, main), left_out, "the patterns of metallic-roughness maps")? {
        look.pbr_maps = PbrMaps::of_gltf(&path);
    } else {
        factors = roughness_and_metalness(container, both, means)?;
    }
    look.pbr = Some(Pbr {
        roughness: factors[0] * share(&metal["roughnessFactor"]),
        metalness: factors[1] * share(&metal["metallicFactor"]),
        ..Pbr::default()
    });
    Ok(())
}

/// Returns the picture of a map, if there is one and it is placed on the surface as the `main` texture is. If it cannot
/// be used, `what` it is, is added to `left_out`.
fn map(
    container: &Container<'_>,
    (map, main): (&Value, &Value),
    left_out: &mut BTreeSet<String>,
    what: &str,
) -> Result<Option<PathBuf>, String> {
    if map.is_null() {
        return Ok(None);
    }
    let set = |texture: &Value| texture["texCoord"].as_u64().unwrap_or(0);
    if set(map) != set(main) || map["extensions"] != main["extensions"] {
        left_out.insert(format!("{what} whose texture coordinates differ from those of the texture"));
        return Ok(None);
    }
    let Some(path) = image(container, map, left_out)? else { return Ok(None) };
    if picture::is_embedded(&path) || path.is_file() {
        return Ok(Some(path));
    }
    left_out.insert(format!("{what} whose pictures are missing"));
    Ok(None)
}

/// Reads the placement of a texture on a surface: the set of coordinates, and `KHR_texture_transform`.
fn place(texture: &Value, surface: &mut Surface) {
    let transform = &texture["extensions"]["KHR_texture_transform"];
    surface.uv_set = transform["texCoord"].as_u64().or(texture["texCoord"].as_u64()).unwrap_or(0);
    if transform.is_null() {
        return;
    }
    let [x, y] = numbers(&transform["scale"], [1.0; 2]);
    let angle = transform["rotation"].as_f64().unwrap_or(0.0);
    // libm instead of the platform's functions, so that the bits are the same on every machine.
    let (sin, cos) = libm::sincos(angle);
    surface.offset = DVec2::from(numbers(&transform["offset"], [0.0; 2]));
    // Counter-clockwise as seen in pictures, where v is down.
    surface.axes = Some([dvec2(cos, -sin) * x, dvec2(sin, cos) * y]);
}

/// Returns the picture of a texture: a file beside the glTF, or a picture inside it.
fn image(
    container: &Container<'_>,
    texture: &Value,
    left_out: &mut BTreeSet<String>,
) -> Result<Option<PathBuf>, String> {
    if texture.is_null() {
        return Ok(None);
    }
    let texture = container.entry("textures", &texture["index"])?;
    let Some(index) = texture["source"].as_u64() else {
        let extension = texture["extensions"].as_object().and_then(|extensions| extensions.keys().next());
        left_out
            .insert(extension.map_or_else(|| "a texture without picture".into(), |name| unsupported(name)));
        return Ok(None);
    };
    let image = container.entry("images", &index.into())?;
    Ok(Some(match image["uri"].as_str() {
        Some(uri) if uri.starts_with("http://") || uri.starts_with("https://") => uri.into(),
        Some(uri) if !uri.starts_with("data:") => container.beside(uri),
        _ => picture::name(container.path, index),
    }))
}

/// Returns the numbers of a list, or `otherwise` if it has another length.
pub(super) fn numbers<const N: usize>(value: &Value, otherwise: [f64; N]) -> [f64; N] {
    let list = value.as_array().filter(|list| list.len() == N);
    list.map_or(otherwise, |list| std::array::from_fn(|at| list[at].as_f64().unwrap_or(otherwise[at])))
}

/// Converts linear light, as used in glTF, to a displayed colour value.
fn displayed(light: f64) -> f32 {
    let light = light.clamp(0.0, 1.0);
    let share =
        if light <= 0.003_130_8 { light * 12.92 } else { 1.055 * libm::pow(light, 1.0 / 2.4) - 0.055 };
    share as f32
}
