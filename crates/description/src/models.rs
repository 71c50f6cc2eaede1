//! Belvedere's own robots, worlds and tags, which are found like any ROS package.

use crate::package::PackagePath;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// The function that was passed to [`carry`].
static CARRIED: OnceLock<fn() -> PathBuf> = OnceLock::new();

/// Returns the package path: the `user` folders in their order, then those of `ros_package_path`, the value of the
/// environment variable `ROS_PACKAGE_PATH`, then Belvedere's own models.
pub fn package_path(
    user: impl IntoIterator<Item = PathBuf>,
    ros_package_path: Option<&OsStr>,
) -> PackagePath {
    PackagePath::new(user, ros_package_path).with_fallback(folder())
}

/// Declares that the program contains the models: `unpack` writes them into a folder and returns it. It is called
/// if there is no other folder of Belvedere's own models. Only the first call in a process has an effect.
pub fn carry(unpack: fn() -> PathBuf) {
    let _ = CARRIED.set(unpack);
}

/// Returns the folder of Belvedere's own models: the first of the [`places`] that exists, or else the one that the program
/// contains. `BELVEDERE_MODELS` always takes precedence.
fn folder() -> PathBuf {
    let places = places();
    if explicit().is_none()
        && !places.iter().any(|folder| folder.is_dir())
        && let Some(unpack) = CARRIED.get()
    {
        return unpack();
    }
    let first = places.iter().find(|folder| folder.is_dir()).or(places.first());
    first.cloned().unwrap_or_default()
}

/// Returns the folder that `BELVEDERE_MODELS` names.
fn explicit() -> Option<PathBuf> {
    std::env::var_os("BELVEDERE_MODELS").map(PathBuf::from)
}

/// Returns the places of Belvedere's own models: `BELVEDERE_MODELS` alone if it is set, or else `share/belvedere/models`
/// of an installation, and the source tree from which this was compiled.
fn places() -> Vec<PathBuf> {
    if let Some(folder) = explicit() {
        return vec![folder];
    }
    let installed = std::env::current_exe()
        .ok()
        .and_then(|exe| Some(exe.parent()?.parent()?.join("share/belvedere/models")));
    // In the repository this is a symbolic link; a published package contains the files.
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("models");
    installed.into_iter().chain([source.canonicalize().unwrap_or(source)]).collect()
}

/// Lists the folders in which packages and Belvedere's own models were looked for, as part of a sentence.
pub(crate) fn searched(packages: &PackagePath) -> String {
    let ours = packages.fallback();
    let is_missing = ours.is_some_and(|folder| !folder.is_dir());
    let user = packages.folders().filter(|folder| Some(*folder) != ours).map(Path::to_path_buf);
    let own = if is_missing { places() } else { ours.map(Path::to_path_buf).into_iter().collect() };
    let folders: Vec<String> = user.chain(own).map(|folder| folder.display().to_string()).collect();
    folders.join(", ")
}
