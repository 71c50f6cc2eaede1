//! The files of a folder that `check --all` checks, and the models that they can name.

use crate::description::xacro::Element;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// The contents of a folder and those below it.
#[derive(Default)]
pub(super) struct Found {
    /// The files whose names are those of robots, models or worlds, in alphabetical order.
    pub(super) files: Vec<PathBuf>,
    /// The folders of models, which have a `model.config` or a `model.sdf`.
    pub(super) models: HashSet<PathBuf>,
}

/// Searches a folder and those below it. Hidden folders are skipped, and so are symbolic links to a folder that was
/// already visited.
pub(super) fn search(folder: &Path) -> std::io::Result<Found> {
    let mut found = Found::default();
    let mut seen = HashSet::new();
    let mut open = vec![folder.to_path_buf()];
    let mut is_first = true;
    while let Some(folder) = open.pop() {
        let entries = match std::fs::read_dir(&folder) {
            Ok(entries) => entries,
            Err(error) if is_first => return Err(error),
            Err(error) => {
                tracing::warn!(folder = %folder.display(), %error, "a folder cannot be read and is left out");
                continue;
            }
        };
        is_first = false;
        if !folder.canonicalize().is_ok_and(|real| seen.insert(real)) {
            continue;
        }
        let mut inside = Vec::new();
        for entry in entries.filter_map(Result::ok) {
            let (path, name) = (entry.path(), entry.file_name());
            let is_hidden = name.as_encoded_bytes().starts_with(b".");
            if path.is_dir() {
                inside.extend((!is_hidden).then_some(path));
                continue;
            }
            if name == "model.config" || name == "model.sdf" {
                found.models.insert(folder.clone());
            }
            if is_description(&path) {
                found.files.push(path);
            }
        }
        // In this order, so that of two links to a folder the same one is followed on every machine.
        inside.sort();
        open.extend(inside.into_iter().rev());
    }
    found.files.sort();
    Ok(found)
}

fn is_description(path: &Path) -> bool {
    let is_known = path.extension().is_some_and(|extension| {
        ["urdf", "xacro", "sdf", "world"].iter().any(|known| extension.eq_ignore_ascii_case(known))
    });
    // A model.config is listed only if it has an error: the file that it names is listed itself.
    is_known || path.file_name().is_some_and(|name| name == "model.config") && config_error(path).is_some()
}

/// Returns the error of a model.config, if it has one. The files that it names are checked on their own.
pub(super) fn config_error(path: &Path) -> Option<String> {
    let root = match Element::parse_file(path) {
        Ok(root) => root,
        Err(problem) => return Some(problem.to_string()),
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    let named: Vec<String> = root.elements_named("sdf").map(Element::text).collect();
    // A folder of meshes for other models names no file.
    if named.is_empty() || named.iter().any(|name| folder.join(name.trim()).is_file()) {
        return None;
    }
    let (place, named) = (root.source, named.join(", "));
    Some(format!(
        "{place}: error: <sdf> names {named}, which is not in its folder; correct the name of the file"
    ))
}
