//! Triangles with one material, as stored in a file, and their checks and conversion to a mesh.

use super::normals;
use crate::diagnostics::{Diagnostics, Source};
use crate::encoding::Wide;
use crate::model::{Material, Mesh};
use glam::{DMat3, DVec3, Vec3};
use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;

/// Triangles with one material, as stored in a file.
#[derive(Debug, Default)]
pub(super) struct Part {
    /// The name in the file, for error messages.
    pub(super) name: Arc<str>,
    /// Further names in the file. Many parts may have the same long name.
    pub(super) aliases: Vec<Arc<str>>,
    pub(super) positions: Vec<[f32; 3]>,
    /// As many as positions, or none.
    pub(super) uvs: Vec<[f32; 2]>,
    /// As many as positions, or none. [`MISSING`](super::normals::MISSING) stands for vertices without a normal.
    pub(super) normals: Vec<[f32; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) material: Option<Material>,
}

impl Part {
    /// Returns the number of bytes of its own strings, of which many parts may have the same.
    pub(super) fn strings_len(&self) -> usize {
        let texture = self.material.as_ref().and_then(|material| material.texture.as_ref());
        texture.map_or(0, |texture| texture.as_os_str().len()) + size_of_val(&self.aliases[..])
    }
}

/// The reason why a mesh file cannot be read.
pub(super) struct Unreadable {
    /// The line with the error, if the file has lines.
    pub(super) line: Option<u32>,
    pub(super) what: String,
}

impl Unreadable {
    /// Creates an error at a line.
    pub(super) fn at(line: u32, what: impl Into<String>) -> Self {
        Self { line: Some(line), what: what.into() }
    }
}

impl From<String> for Unreadable {
    fn from(what: String) -> Self {
        Self { line: None, what }
    }
}

impl From<&str> for Unreadable {
    fn from(what: &str) -> Self {
        what.to_owned().into()
    }
}

/// Decodes a file as text. Names in an unknown encoding are preserved as far as possible. Exporters on Windows may
/// write UTF-16.
pub(super) fn text(bytes: &[u8]) -> Cow<'_, str> {
    match Wide::of(bytes) {
        Some(wide) => wide.decode(bytes).into(),
        None => String::from_utf8_lossy(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)),
    }
}

/// Appends triangles. If only one of the meshes has texture coordinates, those of the other are zeros. If only one has
/// normals, those of the other are [`MISSING`](normals::MISSING) until [`complete`](normals::complete) has read the whole
/// mesh: once, and not after each part, as the parts may be many.
pub(super) fn append(mesh: &mut Mesh, more: &Mesh) {
    let first = mesh.positions.len() as u32;
    if !more.uvs.is_empty() || !mesh.uvs.is_empty() {
        mesh.uvs.resize(mesh.positions.len(), [0.0; 2]);
        mesh.uvs.extend(&more.uvs);
        mesh.uvs.resize(mesh.positions.len() + more.positions.len(), [0.0; 2]);
    }
    if !more.normals.is_empty() || !mesh.normals.is_empty() {
        mesh.normals.resize(mesh.positions.len(), normals::MISSING);
        mesh.normals.extend(&more.normals);
        mesh.normals.resize(mesh.positions.len() + more.positions.len(), normals::MISSING);
    }
    mesh.positions.extend(&more.positions);
    mesh.triangles.extend(more.triangles.iter().map(|triangle| triangle.map(|index| index + first)));
}

/// Checks all numbers, applies the scale, completes the normals, and removes triangles without area.
pub(super) fn finish(
    part: Part,
    path: &Path,
    scale: DVec3,
    source: &Source,
    diagnostics: &mut Diagnostics,
) -> Option<Mesh> {
    let Part { name, mut positions, mut uvs, normals, mut triangles, material, .. } = part;
    let mut fail = |what: String| {
        let name = if name.is_empty() { String::new() } else { format!(" of '{name}'") };
        diagnostics.error(source, format!("the mesh {}: {what}{name}", path.display()), "export it again");
        None
    };
    for (index, position) in positions.iter_mut().enumerate() {
        *position = (Vec3::from(*position).as_dvec3() * scale).as_vec3().to_array();
        if !position.iter().all(|value| value.is_finite()) {
            return fail(format!("vertex {index} is not finite"));
        }
    }
    if uvs.iter().flatten().any(|value| !value.is_finite()) {
        return fail("a texture coordinate is not finite".into());
    }
    if uvs.len() != positions.len() {
        uvs.clear();
    }
    // Normals are transformed by the inverse transpose.
    let matrix = normals::matrix(DMat3::from_diagonal(scale));
    let normals = normals.iter().map(|normal| normals::turned(&matrix, *normal)).collect();
    if let Some((index, _)) = triangles
        .iter()
        .enumerate()
        .find(|(_, triangle)| triangle.iter().any(|vertex| *vertex as usize >= positions.len()))
    {
        return fail(format!("triangle {index} names a vertex that does not exist"));
    }
    triangles.retain(|triangle| {
        let [a, b, c] = triangle.map(|vertex| Vec3::from(positions[vertex as usize]).as_dvec3());
        (b - a).cross(c - a) != DVec3::ZERO
    });
    // A mirroring scale reverses the winding, which is corrected here.
    if scale.x * scale.y * scale.z < 0.0 {
        for triangle in &mut triangles {
            triangle.swap(1, 2);
        }
    }
    let mut mesh = Mesh { path: path.to_path_buf(), positions, uvs, normals, triangles, material };
    normals::complete(&mut mesh);
    Some(mesh)
}
