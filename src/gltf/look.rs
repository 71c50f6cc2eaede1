//! [`Looks`]: materials and their textures.

use super::file::File;
use crate::description::image_file;
use crate::description::model::{Material, PbrMaps};
use crate::description::pbr_picture;
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
    pbr_textures: HashMap<PbrMaps, Option<usize>>,
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
            surface["baseColorTexture"] = placed(file, material, texture);
        }
        if let Some(texture) = self.pbr_texture(file, &material.pbr_maps) {
            surface["metallicRoughnessTexture"] = placed(file, material, texture);
        }
        let alpha = if material.alpha < 1.0 || material.texture_alpha != TextureAlpha::Ignored {
            "BLEND"
        } else {
            "OPAQUE"
        };
        let mut written: Value = json!({
            "pbrMetallicRoughness": surface,
            "emissiveFactor": material.emissive.map(|own| linear(own.clamp(0.0, 1.0))),
            "alphaMode": alpha,
        });
        if let Some(path) = &material.emissive_map {
            match self.texture(file, path) {
                Some(texture) => written["emissiveTexture"] = placed(file, material, texture),
                // Without its map, the whole surface would emit light.
                None => written["emissiveFactor"] = json!([0.0, 0.0, 0.0]),
            }
        }
        file.add("materials", written)
    }

    /// Writes the map of roughness and metalness, and returns its index in the file.
    fn pbr_texture(&mut self, file: &mut File, maps: &PbrMaps) -> Option<usize> {
        if let Some(path) = maps.is_one_file() {
            return self.texture(file, path);
        }
        if let Some(known) = self.pbr_textures.get(maps) {
            return *known;
        }
        // What is unusable was reported when the scene was made.
        let texture = pbr_picture::picture(maps, |_, _| {}).and_then(|picture| {
            let mut png = Cursor::new(Vec::new());
            picture.write_to(&mut png, image::ImageFormat::Png).ok()?;
            Some(add_picture(file, "image/png", &png.into_inner()))
        });
        self.pbr_textures.insert(maps.clone(), texture);
        texture
    }

    fn texture(&mut self, file: &mut File, path: &Path) -> Option<usize> {
        if let Some(known) = self.textures.get(path) {
            return *known;
        }
        let texture = picture(path).map(|(kind, bytes)| add_picture(file, kind, &bytes));
        self.textures.insert(path.to_path_buf(), texture);
        texture
    }
}

/// Writes a texture, and returns its index in the file.
fn add_picture(file: &mut File, kind: &str, bytes: &[u8]) -> usize {
    let view = file.bytes(bytes);
    let image = file.add("images", json!({ "bufferView": view, "mimeType": kind }));
    if !file.has("samplers") {
        file.add("samplers", json!({ "wrapS": REPEAT, "wrapT": REPEAT }));
    }
    file.add("textures", json!({ "source": image, "sampler": 0 }))
}

/// Returns a reference to a texture that is repeated as the material says.
fn placed(file: &mut File, material: &Material, texture: usize) -> Value {
    let mut reference = json!({ "index": texture });
    let [u, v] = material.texture_repeat;
    if [u, v] != [1.0, 1.0] {
        // v counts from the top in glTF and from the bottom in our meshes.
        reference["extensions"] =
            json!({ "KHR_texture_transform": { "scale": [u, v], "offset": [0.0, 1.0 - v] } });
        file.uses("KHR_texture_transform");
    }
    reference
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::model::Channel;
    use belvedere_sensors::scene::Pbr;

    #[test]
    fn maps_are_written() {
        let folder = tempfile::tempdir().unwrap();
        let map = |name: &str, red| {
            let path = folder.path().join(name);
            image::RgbImage::from_pixel(2, 1, image::Rgb([red, 1, 2])).save(&path).unwrap();
            path
        };
        let (rough, metal) = (map("r.png", 7), map("m.png", 9));
        let red = |path: &Path| Some(Channel { path: path.into(), channel: 0 });
        let material = Material {
            pbr: Some(Pbr { roughness: 0.5, ..Pbr::default() }),
            pbr_maps: PbrMaps { roughness: red(&rough), metalness: red(&metal) },
            emissive: [1.0; 3],
            emissive_map: Some(rough),
            texture_repeat: [2.0, 1.0],
            ..Material::default()
        };
        let (mut file, mut looks) = (File::default(), Looks::default());
        looks.add(&mut file, &material);
        let gone = Material { emissive_map: Some("gone.png".into()), ..material };
        looks.add(&mut file, &gone);
        let glb = file.finish();
        let len = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
        let (json, data): (Value, _) =
            (serde_json::from_slice(&glb[20..20 + len]).unwrap(), &glb[28 + len..]);
        let (written, dark) = (&json["materials"][0], &json["materials"][1]);
        let picture = |texture: &Value| {
            assert_eq!(texture["extensions"]["KHR_texture_transform"]["scale"], json!([2.0, 1.0]));
            let image = &json["textures"][texture["index"].as_u64().unwrap() as usize]["source"];
            let view = &json["images"][image.as_u64().unwrap() as usize]["bufferView"];
            let view = &json["bufferViews"][view.as_u64().unwrap() as usize];
            let [from, len] =
                ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap_or(0) as usize);
            image::load_from_memory(&data[from..from + len]).unwrap().into_rgb8().get_pixel(1, 0).0
        };
        let surface = &written["pbrMetallicRoughness"];
        assert_eq!(picture(&surface["metallicRoughnessTexture"]), [255, 7, 9]);
        assert_eq!(surface["roughnessFactor"], 0.5);
        assert_eq!(picture(&written["emissiveTexture"]), [7, 1, 2]);
        assert_eq!(
            (&dark["emissiveFactor"], &dark["emissiveTexture"]),
            (&json!([0.0, 0.0, 0.0]), &Value::Null)
        );
    }
}
