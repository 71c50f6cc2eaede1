//! [`Looks`]: materials and their textures.

use super::file::File;
use crate::description::image_file;
use crate::description::model::Material;
use belvedere_sensors::scene::TextureAlpha;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// glTF's number for a texture that repeats.
const REPEAT: u32 = 10497;

/// The materials that were written, each once.
#[derive(Debug, Default)]
pub(super) struct Looks {
    materials: Vec<(Material, usize)>,
    textures: HashMap<PathBuf, Option<usize>>,
}

impl Looks {
    /// Writes a material, unless it was written already, and returns its index in the file.
    pub(super) fn add(&mut self, file: &mut File, material: &Material) -> usize {
        if let Some((_, known)) = self.materials.iter().find(|(other, _)| other == material) {
            return *known;
        }
        let index = self.write(file, material);
        self.materials.push((material.clone(), index));
        index
    }

    fn write(&mut self, file: &mut File, material: &Material) -> usize {
        let [red, green, blue] = material.diffuse.map(linear);
        let pbr = material.pbr.unwrap_or_default();
        let mut surface = json!({
            "baseColorFactor": [red, green, blue, material.alpha],
            "metallicFactor": pbr.metalness,
            "roughnessFactor": pbr.roughness,
        });
        if let Some(texture) = material.texture.as_deref().and_then(|path| self.texture(file, path)) {
            surface["baseColorTexture"] = json!({ "index": texture });
            let [u, v] = material.texture_repeat;
            if [u, v] != [1.0, 1.0] {
                // v counts from the top in glTF and from the bottom in our meshes.
                surface["baseColorTexture"]["extensions"] =
                    json!({ "KHR_texture_transform": { "scale": [u, v], "offset": [0.0, 1.0 - v] } });
                file.uses("KHR_texture_transform");
            }
        }
        let alpha = if material.alpha < 1.0 || material.texture_alpha != TextureAlpha::Ignored {
            "BLEND"
        } else {
            "OPAQUE"
        };
        let written: Value = json!({
            "pbrMetallicRoughness": surface,
            "emissiveFactor": material.emissive.map(|own| linear(own.clamp(0.0, 1.0))),
            "alphaMode": alpha,
        });
        file.add("materials", written)
    }

    fn texture(&mut self, file: &mut File, path: &Path) -> Option<usize> {
        if let Some(known) = self.textures.get(path) {
            return *known;
        }
        let texture = picture(path).map(|(kind, bytes)| {
            let view = file.bytes(&bytes);
            let image = file.add("images", json!({ "bufferView": view, "mimeType": kind }));
            if !file.has("samplers") {
                file.add("samplers", json!({ "wrapS": REPEAT, "wrapT": REPEAT }));
            }
            file.add("textures", json!({ "source": image, "sampler": 0 }))
        });
        self.textures.insert(path.to_path_buf(), texture);
        texture
    }
}

/// Returns a picture's file unchanged if glTF supports its format, else converted to PNG.
fn picture(path: &Path) -> Option<(&'static str, Vec<u8>)> {
    let bytes = image_file::read(path).ok()?;
    match image::guess_format(&bytes) {
        Ok(image::ImageFormat::Png) => Some(("image/png", bytes)),
        Ok(image::ImageFormat::Jpeg) => Some(("image/jpeg", bytes)),
        // TGA can only be recognized by its name.
        _ => {
            let mut png = Cursor::new(Vec::new());
            image_file::open(path).ok()?.write_to(&mut png, image::ImageFormat::Png).ok()?;
            Some(("image/png", png.into_inner()))
        }
    }
}

/// Converts a displayed (sRGB) colour value to linear light, which glTF uses.
fn linear(share: f32) -> f32 {
    if share <= 0.04045 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) }
}
