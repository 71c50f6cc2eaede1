//! Loading of worlds: found by file or by name, read from SDF.

use super::robot::{is_bare, not_found, one_of};
use crate::diagnostics::{Diagnostics, Source};
use crate::file;
use crate::model::World;
use crate::package::PackagePath;
use crate::rules::Rules;
use crate::sdf;
use std::path::{Path, PathBuf};

/// The world of the standard scenario.
const DEFAULT_WORLD: &str = "tag_ceiling";

/// Extensions of world files, in the order in which a name is tried.
const EXTENSIONS: [&str; 2] = ["world", "sdf"];

/// Returns the world that is loaded by default: `TURTLEBOT_GAZEBO_WORLD_FILE` as in the articles, else our
/// tag-ceiling room.
pub fn default_world() -> PathBuf {
    std::env::var_os("TURTLEBOT_GAZEBO_WORLD_FILE")
        .filter(|file| !file.is_empty())
        .map_or_else(|| DEFAULT_WORLD.into(), PathBuf::from)
}

/// Loads a world from an SDF file (1.4 and later), or by name.
///
/// A name has neither a path separator nor an extension: `playground` is `worlds/playground.world` of a
/// `turtlebot_gazebo` package on the package path, else of our own `models/`.
///
/// With `gazebo_compat` or `skip_missing`, missing models, meshes, textures and materials are tolerated as in Gazebo.
/// If a world of the user's that is found by name has missing files, our world of that name is used, with a warning:
/// `turtlebot_gazebo`'s own worlds need Gazebo's model database.
///
/// # Errors
/// Problems are added to `diagnostics`. None is returned if there is no world at all; a world that is
/// returned while `diagnostics` has errors can be shown but must not be run.
pub fn load_world(
    file_or_name: impl AsRef<Path>,
    packages: &PackagePath,
    rules: Rules,
    diagnostics: &mut Diagnostics,
) -> Option<World> {
    let file_or_name = file_or_name.as_ref();
    let path = find_world(file_or_name, packages, diagnostics)?;
    let ours = packages.fallback().zip(path.file_name()).map(|(ours, name)| ours.join("worlds").join(name));
    let is_named = is_bare(file_or_name) && path != file_or_name;
    if is_named
        && let Some(ours) = ours.filter(|ours| *ours != path && ours.is_file())
        && !rules.gazebo_compat
        && lacks_files(&path, packages, rules)
    {
        diagnostics.warning(
            &Source::new(&path, 0),
            "the world names models, meshes or textures that are not found: our own world of its name is used instead",
            "add the folder that has them with --package-path, or give the path of the world's file",
        );
        return sdf::load_world_file(&ours, packages, rules, diagnostics);
    }
    sdf::load_world_file(&path, packages, rules, diagnostics)
}

/// Returns true if the only problem of a world is that files are missing.
fn lacks_files(path: &Path, packages: &PackagePath, rules: Rules) -> bool {
    let has_errors = |skip_missing| {
        let mut diagnostics = Diagnostics::default();
        sdf::load_world_file(path, packages, Rules { skip_missing, ..rules }, &mut diagnostics);
        diagnostics.has_errors()
    };
    has_errors(false) && !has_errors(true)
}

fn find_world(path: &Path, packages: &PackagePath, diagnostics: &mut Diagnostics) -> Option<PathBuf> {
    if !is_bare(path) || file::is_there(path) && path.extension().is_some() {
        return Some(path.to_path_buf());
    }
    // `playground.world` also stands for the name, if there is no such file here.
    let exact = path.extension().is_some().then(|| path.to_path_buf());
    let with = |extension: &str| {
        let mut name = path.as_os_str().to_owned();
        name.push(".");
        name.push(extension);
        PathBuf::from(name)
    };
    let files: Vec<PathBuf> = EXTENSIONS.into_iter().map(with).chain(exact).collect();
    for folder in world_folders(packages) {
        let mut candidates = files.iter().map(|file| folder.join(file));
        if let Some(found) = candidates.find(|candidate| candidate.is_file()) {
            return Some(found);
        }
    }
    // Whatever it is, reading it says what is wrong with it.
    if file::is_there(path) {
        return Some(path.to_path_buf());
    }
    let names = world_names(packages);
    let otherwise = format!("give the path of a world file or {}", one_of(&names, packages));
    not_found(path, "world", names.iter().map(String::as_str), &otherwise, diagnostics);
    None
}

/// Returns the folders in which worlds are looked for by name.
fn world_folders(packages: &PackagePath) -> Vec<PathBuf> {
    packages
        .find_package("turtlebot_gazebo")
        .into_iter()
        .map(|package| package.join("worlds"))
        .chain(packages.fallback().map(|ours| ours.join("worlds")))
        .collect()
}

/// Returns the names that [`load_world`] knows, sorted.
pub fn world_names(packages: &PackagePath) -> Vec<String> {
    let mut names: Vec<String> = world_folders(packages)
        .iter()
        .filter_map(|folder| std::fs::read_dir(folder).ok())
        .flatten()
        .filter_map(|entry| {
            let path = entry.ok()?.path();
            let extension = path.extension()?.to_str()?;
            EXTENSIONS.contains(&extension).then(|| path.file_stem()?.to_str().map(str::to_owned))?
        })
        .collect();
    names.sort();
    names.dedup();
    names
}
