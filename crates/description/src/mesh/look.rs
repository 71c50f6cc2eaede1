//! The materials that a mesh file assigns to its triangles, and the pictures that it names.

use super::Part;
use super::gltf::picture;
use crate::diagnostics::{Diagnostics, Source};
use crate::model::Material;
use belvedere_sensors::scene::{MAX_SHININESS, TextureAlpha};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// The material of a file, as far as it is given.
#[derive(Debug, Default, Clone)]
pub(super) struct Look {
    pub(super) diffuse: Option<[f32; 3]>,
    pub(super) emissive: Option<[f32; 3]>,
    pub(super) specular: Option<[f32; 3]>,
    pub(super) shininess: Option<f32>,
    pub(super) alpha: Option<f32>,
    pub(super) texture_alpha: TextureAlpha,
    pub(super) texture: Option<PathBuf>,
}

impl Look {
    /// Creates a material; `None` if there is neither a colour nor a texture.
    ///
    /// Exporters leave the ambient colour black or inconsistent with the diffuse one, so the diffuse colour is used for
    /// both. Values out of range are clamped.
    pub(super) fn material(self) -> Option<Material> {
        let diffuse = self.diffuse.or(self.texture.is_some().then_some([1.0; 3]))?;
        let within = |value: f32, most: f32| if value.is_nan() { 0.0 } else { value.clamp(0.0, most) };
        Some(Material {
            diffuse,
            ambient: diffuse,
            emissive: self.emissive.unwrap_or([0.0; 3]),
            specular: self.specular.unwrap_or([0.0; 3]),
            shininess: within(self.shininess.unwrap_or(0.0), MAX_SHININESS),
            alpha: within(self.alpha.unwrap_or(1.0), 1.0),
            texture_alpha: self.texture_alpha,
            texture: self.texture,
            ..Material::default()
        })
    }
}

/// Returns the file of a picture that a mesh in `folder` names: in this folder, or in the `materials/textures` of its
/// model, where Gazebo searches too. Folders of the machine on which the mesh was made are ignored.
pub fn find_texture(name: &str, folder: &Path) -> Option<PathBuf> {
    let name = name.replace('\\', "/");
    let file = name.rsplit('/').next().filter(|file| !file.is_empty())?;
    let model = folder.ancestors().take(4).map(|above| above.join("materials/textures"));
    let places: Vec<PathBuf> = std::iter::once(folder.to_path_buf()).chain(model).collect();
    let found = |name: &str| places.iter().map(|place| place.join(name)).find(|path| path.is_file());
    found(&name).or_else(|| found(file))
}

/// Finds the pictures that the parts of a mesh name. A part without its picture is drawn in its colour, as in Gazebo.
pub(super) fn find_textures(parts: &mut [Part], path: &Path, source: &Source, diagnostics: &mut Diagnostics) {
    // Each picture is searched only once, because a file may have a part for every face.
    let mut known: HashMap<PathBuf, Option<PathBuf>> = HashMap::new();
    for material in parts.iter_mut().filter_map(|part| part.material.as_mut()) {
        if let Some(texture) = material.texture.take() {
            let found = known.entry(texture);
            let find = |name: &PathBuf| locate(name, path, source, diagnostics);
            material.texture.clone_from(found.or_insert_with_key(find));
        }
    }
}

/// Returns the file of a picture that the mesh at `path` names, or `None` after a warning.
fn locate(texture: &Path, path: &Path, source: &Source, diagnostics: &mut Diagnostics) -> Option<PathBuf> {
    if picture::is_embedded(texture) {
        return Some(texture.to_path_buf());
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let name = texture.to_string_lossy();
    let is_remote = name.starts_with("http://") || name.starts_with("https://");
    if !is_remote && let Some(found) = find_texture(&name, folder) {
        return Some(found);
    }
    let named = format!("which the mesh {} names", path.display());
    let (what, remedy) = if is_remote {
        let what = format!(
            "the texture {name}, {named}, is remote, and files are not fetched: it is drawn in one colour"
        );
        (what, "download it, and name the file in the mesh")
    } else {
        let what = format!("there is no texture {name}, {named}: it is drawn in one colour");
        (what, "put it beside the mesh, or into materials/textures of its model")
    };
    diagnostics.warning(source, what, remedy);
    None
}
