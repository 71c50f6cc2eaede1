//! The robots, worlds and tags that Belvedere brings along, found like any ROS package.

use crate::package::PackagePath;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Lists the `user` folders in their order, then those of `ros_package_path`, which is the value of the environment
/// variable `ROS_PACKAGE_PATH`, then Belvedere's own models.
pub fn package_path(
    user: impl IntoIterator<Item = PathBuf>,
    ros_package_path: Option<&OsStr>,
) -> PackagePath {
    PackagePath::new(user, ros_package_path).with_fallback(folder())
}

/// Returns the folder of Belvedere's own models: `BELVEDERE_MODELS`, or `share/belvedere/models` of an installation, or
/// that of the source tree.
fn folder() -> PathBuf {
    if let Some(folder) = std::env::var_os("BELVEDERE_MODELS") {
        return folder.into();
    }
    let installed = std::env::current_exe()
        .ok()
        .and_then(|exe| Some(exe.parent()?.parent()?.join("share/belvedere/models")))
        .filter(|folder| folder.is_dir());
    installed.unwrap_or_else(|| {
        Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).unwrap_or(Path::new("")).join("models")
    })
}
