//! Triangle meshes from files.
use super::diagnostics::{Diagnostics, Source};
use super::model::Mesh;
use glam::DVec3;
use std::path::Path;
use std::sync::Arc;

/// The formats that are read, for error messages.
pub const MESH_FORMATS: &str = "stl, dae (Collada), obj";

/// Loads a mesh (STL, Collada, OBJ) and applies `scale`. `source` is where the description asks for it.
pub fn load_mesh(
    path: &Path,
    scale: DVec3,
    source: &Source,
    diagnostics: &mut Diagnostics,
) -> Option<Arc<Mesh>> {
    merge_parts(&load_mesh_parts(path, scale, source, diagnostics)?)
}

/// x
pub fn load_mesh_parts(
    path: &Path,
    _scale: DVec3,
    source: &Source,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Arc<Mesh>>> {
    diagnostics.error(source, format!("mesh {} cannot be loaded yet", path.display()), "");
    None
}
/// x
pub fn merge_parts(parts: &[Arc<Mesh>]) -> Option<Arc<Mesh>> {
    parts.first().cloned()
}
