//! Finds ROS packages, like rospack, and files in them.

use super::model_index::ModelIndex;
use super::xml::Element;
use std::collections::{HashMap, HashSet};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

/// The greatest number of folders that one crawl visits: a hundred times those of a large workspace.
const MAX_FOLDERS: usize = 200_000;

/// An ordered list of folders that contain packages: the user's first, a fallback folder last.
///
/// Packages are found like by rospack: anywhere below such a folder, by the `<name>` in their `package.xml`. A folder
/// with the package's name directly inside, or the folder itself, needs no `package.xml`.
#[derive(Debug, Clone)]
pub struct PackagePath {
    user: Vec<Root>,
    fallback: Option<PathBuf>,
    models: Option<Arc<ModelIndex>>,
}

/// A folder that contains packages. It is crawled when a package is requested that is not directly inside.
#[derive(Debug, Clone)]
struct Root {
    folder: PathBuf,
    crawled: Arc<OnceLock<HashMap<String, PathBuf>>>,
}

/// A file found in a package.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Found {
    /// The file or folder.
    pub path: PathBuf,
    /// The user's copy of the package, if it lacks the file, which was then taken from another copy.
    pub missing_in: Option<PathBuf>,
}

impl PackagePath {
    /// Creates a list of the `user` folders in their order, followed by those of `ros_package_path`, the value of the
    /// environment variable `ROS_PACKAGE_PATH`.
    pub fn new(user: impl IntoIterator<Item = PathBuf>, ros_package_path: Option<&OsStr>) -> Self {
        let ros = ros_package_path
            .map(|paths| std::env::split_paths(paths).collect::<Vec<_>>())
            .unwrap_or_default();
        let user = user.into_iter().chain(ros).filter(|path| !path.as_os_str().is_empty());
        let user = user.map(|folder| Root { folder, crawled: Arc::default() }).collect();
        Self { user, fallback: None, models: None }
    }

    /// Adds a folder that is searched after all others, for packages that are included with a program.
    #[must_use]
    pub fn with_fallback(self, folder: impl Into<PathBuf>) -> Self {
        Self { fallback: Some(folder.into()), ..self }
    }

    /// Adds models that `model://` finds by their names wherever they are, after all folders except the fallback.
    #[must_use]
    pub fn with_models(self, models: ModelIndex) -> Self {
        Self { models: Some(models.into()), ..self }
    }

    /// Returns the models that are found wherever they are.
    pub fn models(&self) -> Option<&ModelIndex> {
        self.models.as_deref()
    }

    /// Returns the folder that is searched after all others.
    pub fn fallback(&self) -> Option<&Path> {
        self.fallback.as_deref()
    }

    /// Returns all folders, in the order of search.
    pub fn folders(&self) -> impl Iterator<Item = &Path> {
        self.user.iter().map(|root| root.folder.as_path()).chain(self.fallback())
    }

    /// Returns the first package with this name.
    pub fn find_package(&self, package: &str) -> Option<PathBuf> {
        self.find_packages(package).next()
    }

    /// Returns a file of a package. The user's packages come first; if one of them lacks the file, the fallback's copy
    /// is used.
    pub fn find_file(&self, package: &str, relative: impl AsRef<Path>) -> Option<Found> {
        let mut missing_in = None;
        for package_folder in self.find_packages(package) {
            let path = package_folder.join(relative.as_ref());
            if path.exists() {
                return Some(Found { path, missing_in });
            }
            missing_in.get_or_insert(package_folder);
        }
        None
    }

    /// Returns the packages with this name, at most one per folder.
    fn find_packages(&self, package: &str) -> impl Iterator<Item = PathBuf> {
        let in_user = self.user.iter().filter_map(move |root| root.package(package));
        let in_fallback = self.fallback().and_then(|folder| directly_in(folder, package));
        in_user.chain(in_fallback)
    }

    /// Returns the folders that the user's packages export to Gazebo by the attribute `key` of `<export><gazebo_ros
    /// …>`: `gazebo_model_path` or `gazebo_media_path`.
    pub fn exported(&self, key: &str) -> Vec<PathBuf> {
        let mut folders = Vec::new();
        for root in &self.user {
            let mut packages: Vec<&PathBuf> = root.packages().values().collect();
            packages.sort();
            for package in packages {
                let Ok(manifest) = Element::parse_file(&package.join("package.xml")) else { continue };
                let exports = manifest.elements_named("export").flat_map(Element::elements);
                for paths in exports.filter_map(|export| export.attribute(key)) {
                    let paths = paths.replace("${prefix}", &package.to_string_lossy());
                    folders.extend(std::env::split_paths(&paths).filter(|path| path.is_dir()));
                }
            }
        }
        folders
    }
}

impl Root {
    fn package(&self, package: &str) -> Option<PathBuf> {
        directly_in(&self.folder, package).or_else(|| self.packages().get(package).cloned())
    }

    /// All packages below the folder, by name.
    fn packages(&self) -> &HashMap<String, PathBuf> {
        self.crawled.get_or_init(|| crawl(&self.folder))
    }
}

/// A folder with the package's name in `folder`, or `folder` itself, unless its `package.xml` gives another name.
fn directly_in(folder: &Path, package: &str) -> Option<PathBuf> {
    let itself = (folder.file_name() == Some(OsStr::new(package))).then(|| folder.to_path_buf());
    let is_it = |place: &PathBuf| place.is_dir() && name_of(place).is_none_or(|name| name == package);
    Some(folder.join(package)).into_iter().chain(itself).find(is_it)
}

/// The name of the package in a folder from its `package.xml`, or `None` without that file.
fn name_of(folder: &Path) -> Option<String> {
    let manifest = folder.join("package.xml");
    if !manifest.is_file() {
        return None;
    }
    let name = Element::parse_file(&manifest).ok().and_then(|root| Some(root.child("name")?.text()));
    name.filter(|name| !name.is_empty()).or_else(|| Some(folder.file_name()?.to_string_lossy().into_owned()))
}

/// The packages below a folder; of packages with the same name, the first in alphabetical order. As in rospack,
/// packages inside packages, in hidden folders and in folders with a `CATKIN_IGNORE` are not found. Links that lead
/// back are not followed.
fn crawl(folder: &Path) -> HashMap<String, PathBuf> {
    let mut packages = HashMap::new();
    let mut seen = HashSet::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(folder) = open.pop() {
        let is_new = folder.canonicalize().is_ok_and(|real| seen.insert(real));
        if !is_new || folder.join("CATKIN_IGNORE").exists() {
            continue;
        }
        if seen.len() > MAX_FOLDERS {
            tracing::warn!("packages are only searched in the first {MAX_FOLDERS} folders");
            break;
        }
        // Packages from before catkin have a manifest.xml, and are named like their folder.
        let old = || folder.join("manifest.xml").is_file().then(|| folder.file_name()).flatten();
        if let Some(name) = name_of(&folder).or_else(|| Some(old()?.to_string_lossy().into_owned())) {
            packages.entry(name).or_insert(folder);
            continue;
        }
        if folder.join("rospack_nosubdirs").exists() {
            continue;
        }
        let entries = std::fs::read_dir(&folder).into_iter().flatten().filter_map(Result::ok);
        let is_hidden =
            |path: &Path| path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."));
        let mut inside: Vec<PathBuf> =
            entries.map(|entry| entry.path()).filter(|path| path.is_dir() && !is_hidden(path)).collect();
        inside.sort();
        open.extend(inside.into_iter().rev());
    }
    packages
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn packages_are_found_as_rospack_finds_them() {
        let folder = tempfile::tempdir().unwrap();
        let at = |path: &str| folder.path().join(path);
        let write = |path: &str, text: &str| {
            fs::create_dir_all(at(path).parent().unwrap()).unwrap();
            fs::write(at(path), text).unwrap();
        };
        let named = |name: &str| format!("<package format='2'><name>{name}</name></package>");
        // Two levels down, under its own name; then a package inside a package, a hidden one, and an ignored one.
        write("src/vendor/robot-repo/description/package.xml", &named("my_description"));
        write("src/vendor/robot-repo/description/test/package.xml", &named("inner"));
        write("src/.cache/hidden/package.xml", &named("hidden"));
        write("src/old/CATKIN_IGNORE", "");
        write("src/old/ignored/package.xml", &named("ignored"));
        write("src/vendor/old_style/manifest.xml", "<package/>");
        write("src/plain/urdf/a.urdf", "");
        write("src/taken/package.xml", &named("other_name"));
        write(
            "src/worlds/package.xml",
            "<package><name>my_worlds</name><export><gazebo_ros gazebo_model_path='${prefix}/models:${prefix}/gone' \
             plugin_path='x'/></export></package>",
        );
        fs::create_dir_all(at("src/worlds/models")).unwrap();
        #[cfg(unix)]
        std::os::unix::fs::symlink(at("src"), at("src/vendor/loop")).unwrap();
        let packages = PackagePath::new([at("src")], None);
        let find = |name: &str| packages.find_package(name);
        assert_eq!(find("my_description"), Some(at("src/vendor/robot-repo/description")));
        assert_eq!(find("old_style"), Some(at("src/vendor/old_style")));
        assert_eq!(find("plain"), Some(at("src/plain")));
        assert_eq!(find("other_name"), Some(at("src/taken")));
        for name in ["inner", "hidden", "ignored", "taken", "description", "loop"] {
            assert_eq!(find(name), None, "{name}");
        }
        write("src/vendor/robot-repo/description/r.xacro", "");
        assert!(packages.find_file("my_description", "r.xacro").is_some());
        assert_eq!(packages.exported("gazebo_model_path"), [at("src/worlds/models")]);
        // The folder of a package itself.
        let packages = PackagePath::new([at("src/vendor/robot-repo/description")], None);
        assert!(packages.find_package("my_description").is_some());
    }
}
