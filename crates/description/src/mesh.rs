//! Triangle meshes from files: STL, Wavefront OBJ, PLY, Collada and glTF.
//!
//! STL, OBJ and PLY are read without conversion: metres, z up. Collada files state their unit and their up axis, and in glTF
//! y is up: see [`UpAxis`].
//!
//! Normals of vertices are read from all formats but STL. Where a vertex has several normals, it becomes several
//! vertices. A file, or a face, without normals is flat; so is every STL file, whose normals belong to triangles, as in
//! Gazebo.

mod collada;
mod faces;
pub(crate) mod gltf;
mod look;
mod normals;
mod obj;
mod part;
mod ply;
mod stl;

use super::diagnostics::{Diagnostics, Source};
use super::encoding::{NotRead, Wide};
use super::file;
use super::model::Mesh;
use glam::{DVec3, Vec3};
pub use look::find_texture;
use look::find_textures;
use part::{Part, Unreadable, append, finish};
use std::collections::{HashMap, hash_map::Entry};
use std::path::Path;
use std::sync::Arc;

/// The supported formats, for error messages.
pub const MESH_FORMATS: &str = "stl, obj, dae (Collada), ply, gltf, glb";

/// How Collada's `<up_axis>` and glTF's axes, of which y is up, are handled.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum UpAxis {
    /// Ignored: coordinates are not converted, as in Gazebo and rviz, for which their models are made.
    #[default]
    Ignored,
    /// Applied: the mesh is rotated so that the file's up is z, as the standards require.
    Applied,
}

/// A part of a file that is used instead of the whole: `<submesh>` of SDF.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Submesh {
    /// Name in the file: a node or a geometry of Collada, a group of OBJ.
    pub name: String,
    /// True if the centre of its bounding box is moved to the origin.
    pub is_centred: bool,
}

/// Loads a mesh and applies `up_axis` and `scale`. `source` is the place in the description that names it.
///
/// If the file has several materials, the one of most triangles is used for all: see [`load_mesh_parts`].
///
/// # Errors
/// Adds one error to `diagnostics` and returns none if the file cannot be read, is damaged, or contains no triangles.
pub fn load_mesh(
    path: &Path,
    scale: DVec3,
    up_axis: UpAxis,
    source: &Source,
    diagnostics: &mut Diagnostics,
) -> Option<Arc<Mesh>> {
    merge_parts(&load_mesh_parts(path, None, scale, up_axis, source, diagnostics)?)
}

/// Like [`load_mesh`], with a mesh for each material; of `submesh` alone, if one is given.
///
/// # Errors
/// As [`load_mesh`], and if the file has no such part.
pub fn load_mesh_parts(
    path: &Path,
    submesh: Option<&Submesh>,
    scale: DVec3,
    up_axis: UpAxis,
    source: &Source,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Arc<Mesh>>> {
    if !(scale.is_finite() && scale.x * scale.y * scale.z != 0.0) {
        diagnostics.error(
            source,
            format!("the scale of the mesh {} is '{scale}'", path.display()),
            "write three finite numbers other than 0",
        );
        return None;
    }
    diagnostics.opened(path);
    let mut parts = read(path, up_axis, source, diagnostics)?;
    if let Some(submesh) = submesh {
        parts = select(parts, submesh, path, source, diagnostics)?;
    }
    let mut meshes: Vec<Mesh> = Vec::new();
    // The meshes by their materials, which have no hash of their own.
    let mut of_material: HashMap<String, usize> = HashMap::new();
    find_textures(&mut parts, path, source, diagnostics);
    for part in parts {
        let mesh = finish(part, path, scale, source, diagnostics)?;
        if mesh.triangles.is_empty() {
            continue;
        }
        match of_material.entry(format!("{:?}", mesh.material)) {
            Entry::Occupied(other) => append(&mut meshes[*other.get()], &mesh),
            Entry::Vacant(place) => {
                place.insert(meshes.len());
                meshes.push(mesh);
            }
        }
    }
    meshes.iter_mut().for_each(normals::complete);
    if meshes.is_empty() {
        diagnostics.error(
            source,
            format!("the mesh {} holds no triangles", path.display()),
            "export it with its faces",
        );
        return None;
    }
    Some(meshes.into_iter().map(Arc::new).collect())
}

/// Reads a file by its format; none after an error.
fn read(path: &Path, up_axis: UpAxis, source: &Source, diagnostics: &mut Diagnostics) -> Option<Vec<Part>> {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let parse = match extension.to_ascii_lowercase().as_str() {
        "dae" => return collada::load(path, up_axis, diagnostics),
        "stl" => stl::parse,
        "obj" => obj::parse,
        "ply" => ply::parse,
        "gltf" | "glb" => match up_axis {
            UpAxis::Ignored => gltf::parse,
            UpAxis::Applied => gltf::parse_upright,
        },
        _ => {
            diagnostics.error(
                source,
                format!("the mesh {} has an unsupported format", path.display()),
                format!("convert it to one of {MESH_FORMATS}"),
            );
            return None;
        }
    };
    let bytes = match file::read(path) {
        Ok(bytes) => bytes,
        Err(error) => {
            let what = format!("the mesh {} cannot be read: {error}", path.display());
            diagnostics.error(source, what, file::remedy(&error));
            return None;
        }
    };
    if bytes.is_empty() {
        let what = format!("the mesh {} cannot be read: the file is empty", path.display());
        diagnostics.error(source, what, "restore its content, or name another file");
        return None;
    }
    if let Some(wide) = unread_encoding(extension, &bytes) {
        let NotRead { what, remedy } = wide.error(path);
        let what = format!("the mesh {} cannot be read: {what}", path.display());
        diagnostics.error(source, what, remedy);
        return None;
    }
    match parse(&bytes, path, diagnostics) {
        Ok(parts) => Some(parts),
        Err(Unreadable { line, what }) => {
            let place = line.map_or_else(|| source.clone(), |line| Source::new(path, line));
            let what = format!("the mesh {} cannot be read: {what}", path.display());
            diagnostics.error(&place, what, "check the file, or export it again");
            None
        }
    }
}

/// Returns the encoding of a mesh file whose text is in UTF-16 or UTF-32, unless that is read: OBJ files are decoded. In a
/// binary STL, the first bytes may have any value, so an STL counts as text only if it begins with its keyword.
fn unread_encoding(extension: &str, bytes: &[u8]) -> Option<Wide> {
    let mut letters = bytes.iter().filter(|byte| byte.is_ascii_alphabetic()).take(5);
    let is_unread = match extension.to_ascii_lowercase().as_str() {
        "obj" => false,
        "stl" => letters.by_ref().map(u8::to_ascii_lowercase).eq(*b"solid"),
        _ => true,
    };
    Wide::of(bytes).filter(|_| is_unread)
}

/// Returns the parts that a submesh refers to; none after an error.
fn select(
    parts: Vec<Part>,
    submesh: &Submesh,
    path: &Path,
    source: &Source,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Part>> {
    let names = |part: &Part| std::iter::once(&part.name).chain(&part.aliases).cloned().collect::<Vec<_>>();
    let known: Vec<Arc<str>> = parts.iter().flat_map(names).filter(|name| !name.is_empty()).collect();
    let mut chosen: Vec<Part> =
        parts.into_iter().filter(|part| names(part).iter().any(|name| **name == *submesh.name)).collect();
    if chosen.is_empty() {
        let meant = diagnostics.did_you_mean(&submesh.name, known.iter().map(|name| &**name));
        diagnostics.error(
            source,
            format!("the mesh {} has no part '{}'", path.display(), submesh.name),
            meant.unwrap_or_else(|| "correct <submesh>, or remove it for the whole mesh".into()),
        );
        return None;
    }
    if submesh.is_centred {
        let points = || chosen.iter().flat_map(|part| &part.positions).map(|point| Vec3::from(*point));
        let low = points().fold(Vec3::INFINITY, Vec3::min);
        let middle = (low + points().fold(Vec3::NEG_INFINITY, Vec3::max)) * 0.5;
        for point in chosen.iter_mut().flat_map(|part| &mut part.positions) {
            *point = (Vec3::from(*point) - middle).to_array();
        }
    }
    Some(chosen)
}

/// Merges all parts into one mesh, with the material of most triangles.
pub fn merge_parts(parts: &[Arc<Mesh>]) -> Option<Arc<Mesh>> {
    if let [only] = parts {
        return Some(only.clone());
    }
    let largest = parts.iter().max_by_key(|part| part.triangles.len())?;
    let mut merged = Mesh {
        path: largest.path.clone(),
        positions: Vec::new(),
        uvs: Vec::new(),
        normals: Vec::new(),
        triangles: Vec::new(),
        material: largest.material.clone(),
    };
    for part in parts {
        append(&mut merged, part);
    }
    normals::complete(&mut merged);
    Some(Arc::new(merged))
}

#[cfg(test)]
mod tests;
