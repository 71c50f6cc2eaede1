//! [`Identity`]: everything that determines the bytes of a data set, so that a folder contains the shards of only one
//! plan.

use crate::description::model::{Model, World};
use crate::description::package::PackagePath;
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Everything that determines the bytes of a data set.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(in crate::dataset) struct Identity {
    /// Name and version of this program.
    pub(in crate::dataset) generator: String,
    /// SHA-256 of the plan's text.
    pub(in crate::dataset) plan: String,
    /// SHA-256 of every file that its worlds and its robot need. Names are relative to the plan's folder or that of a
    /// package, so that these folders may be elsewhere on another machine.
    pub(in crate::dataset) files: BTreeMap<String, String>,
}

impl Identity {
    /// Returns the identity of a plan's text and these files.
    pub(super) fn new(text: &str, files: &BTreeSet<PathBuf>, roots: &[PathBuf]) -> Self {
        let mut named = BTreeMap::new();
        for file in files {
            // Missing files have an empty hash.
            let hash = fs::read(file).map(|bytes| hex(&Sha256::digest(bytes))).unwrap_or_default();
            let name = name_of(file, roots);
            // If two files have the same relative name, the second gets its whole path.
            let name = if named.contains_key(&name) { file.to_string_lossy().into_owned() } else { name };
            named.insert(name, hash);
        }
        Self {
            generator: concat!("belvedere ", env!("CARGO_PKG_VERSION")).into(),
            plan: hex(&Sha256::digest(text)),
            files: named,
        }
    }

    /// Returns the files that differ from another identity.
    pub(in crate::dataset) fn changed<'a>(&'a self, other: &'a Self) -> Vec<&'a str> {
        let names: BTreeSet<&String> = self.files.keys().chain(other.files.keys()).collect();
        let differs = |name: &&String| self.files.get(*name) != other.files.get(*name);
        names.into_iter().filter(differs).map(String::as_str).collect()
    }
}

/// Returns the folders to which names of files are relative.
pub(super) fn roots(plan: &Path, packages: &PackagePath) -> Vec<PathBuf> {
    let folder = plan.parent().unwrap_or(Path::new(""));
    [folder].into_iter().chain(packages.folders()).flat_map(spellings).collect()
}

/// Returns the textures of cameras, which are read later than all other files.
pub(super) fn pictures<'a>(
    worlds: &'a [World],
    robot: Option<&'a Model>,
) -> impl Iterator<Item = &'a PathBuf> {
    let models = worlds.iter().flat_map(|world| &world.models).chain(robot);
    let visuals = models.flat_map(|model| &model.links).flat_map(|link| &link.visuals);
    visuals.flat_map(|visual| {
        let material = &visual.material;
        let maps = material.normal_map.iter().chain(&material.emissive_map);
        material.texture.iter().chain(maps).chain(material.pbr_maps.paths())
    })
}

/// Returns a file's name relative to the first of these folders that contains it.
fn name_of(file: &Path, roots: &[PathBuf]) -> String {
    let below = spellings(file)
        .into_iter()
        .find_map(|file| roots.iter().find_map(|root| Some(file.strip_prefix(root).ok()?.to_path_buf())));
    below.unwrap_or_else(|| file.to_path_buf()).to_string_lossy().into_owned()
}

/// Returns an absolute path with and without symbolic links resolved.
fn spellings(path: &Path) -> Vec<PathBuf> {
    let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
    std::path::absolute(path).into_iter().chain(fs::canonicalize(path)).collect()
}

/// Returns bytes as hexadecimal digits.
pub(in crate::dataset) fn hex(bytes: &[u8]) -> String {
    let digit = |value: u8| char::from_digit(u32::from(value), 16).unwrap_or_default();
    bytes.iter().flat_map(|byte| [digit(byte >> 4), digit(byte & 15)]).collect()
}
