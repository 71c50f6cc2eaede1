//! Where files are found: ROS packages, Gazebo models, and our own `models/` behind them.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// An ordered list of folders that contain packages: the user's first, ours last.
#[derive(Debug, Clone)]
pub struct PackagePath {
    user: Vec<PathBuf>,
    ours: PathBuf,
}

/// A file found in a package.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Found {
    /// The file or folder.
    pub path: PathBuf,
    /// Set to the user's copy of the package when that lacks the file and ours was taken instead.
    pub missing_in: Option<PathBuf>,
}

impl PackagePath {
    /// `user` folders in order (from `--package-path`), then those of `ROS_PACKAGE_PATH`, then our own.
    pub fn new(user: impl IntoIterator<Item = PathBuf>, ros_package_path: Option<&OsStr>) -> Self {
        let ros = ros_package_path
            .map(|paths| std::env::split_paths(paths).collect::<Vec<_>>())
            .unwrap_or_default();
        let user = user.into_iter().chain(ros).filter(|path| !path.as_os_str().is_empty()).collect();
        Self { user, ours: models_folder() }
    }

    /// Our own `models/` folder.
    pub fn ours(&self) -> &Path {
        &self.ours
    }

    /// Every folder, in the order of search.
    pub fn folders(&self) -> impl Iterator<Item = &Path> {
        self.user.iter().map(PathBuf::as_path).chain([self.ours.as_path()])
    }

    /// The first folder that holds the package: a folder of that name, directly inside or the folder itself.
    pub fn find_package(&self, package: &str) -> Option<PathBuf> {
        self.folders().find_map(|folder| package_in(folder, package))
    }

    /// A file of a package. The user's packages come first; one that lacks the file does not hide ours.
    pub fn find_file(&self, package: &str, relative: impl AsRef<Path>) -> Option<Found> {
        let mut missing_in = None;
        for folder in self.folders() {
            let Some(package_folder) = package_in(folder, package) else { continue };
            let path = package_folder.join(relative.as_ref());
            if path.exists() {
                return Some(Found { path, missing_in });
            }
            missing_in.get_or_insert(package_folder);
        }
        None
    }
}

fn package_in(folder: &Path, package: &str) -> Option<PathBuf> {
    let inside = folder.join(package);
    if inside.is_dir() {
        return Some(inside);
    }
    (folder.file_name() == Some(OsStr::new(package)) && folder.is_dir()).then(|| folder.to_path_buf())
}

/// Our models: `BELVEDERE_MODELS`, else `share/belvedere/models` of an installation, else the source tree.
fn models_folder() -> PathBuf {
    if let Some(folder) = std::env::var_os("BELVEDERE_MODELS") {
        return folder.into();
    }
    let installed = std::env::current_exe()
        .ok()
        .and_then(|exe| Some(exe.parent()?.parent()?.join("share/belvedere/models")))
        .filter(|folder| folder.is_dir());
    installed.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("models"))
}
