//! Resolution of the URIs in a world.

use super::fuel::FuelUri;
use crate::model_index::ModelIndex;
use crate::package::PackagePath;
use std::cell::OnceCell;
use std::path::{Path, PathBuf};

/// Environment variables that name folders of models: Gazebo classic's, then those of its successors.
const MODEL_VARIABLES: [&str; 4] =
    ["GAZEBO_MODEL_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "SDF_PATH"];

/// The folders that are searched.
pub(super) struct Resources<'a> {
    packages: &'a PackagePath,
    /// Folders that contain models, except Belvedere's own, which is the last one searched.
    model_folders: Vec<PathBuf>,
    /// Folders that `file://media/…` may refer to.
    media_folders: Vec<PathBuf>,
    /// Folders exported by packages: models, then media. Searched only if nothing else helps.
    exported: OnceCell<[Vec<PathBuf>; 2]>,
}

/// The result of resolving a URI.
pub(super) enum Resolved {
    /// An existing file or folder, absolute.
    Found(PathBuf),
    /// Nothing was found in these places.
    NotFound(Vec<PathBuf>),
    /// The URI has the scheme of a server, and is no model of Fuel that is on this machine.
    UnknownScheme(String),
}

impl<'a> Resources<'a> {
    /// Collects the folders in order: the user's package folders, Gazebo's variables, the world file's folder and the `models`
    /// beside it (for a model file the folder above it), Gazebo's download folder. The packages' index of models and
    /// Belvedere's own follow.
    pub(super) fn new(packages: &'a PackagePath, world_file: &Path) -> Self {
        let variable = |name: &str| -> Vec<PathBuf> {
            std::env::var_os(name)
                .map(|value| {
                    std::env::split_paths(&value).filter(|path| !path.as_os_str().is_empty()).collect()
                })
                .unwrap_or_default()
        };
        let ours = packages.fallback();
        let user = packages.folders().filter(|folder| Some(*folder) != ours).map(Path::to_path_buf);
        let world_folder = world_file.parent().unwrap_or(Path::new(""));
        let beside =
            [world_folder.to_path_buf(), world_folder.join("models"), world_folder.join("../models")];
        // For a model's own file, the folder that contains the model: its URIs begin with the model's name.
        let around = world_folder.join("model.config").exists().then(|| world_folder.join(".."));
        let downloads = std::env::home_dir().map(|home| home.join(".gazebo/models"));
        let model_folders = user
            .chain(MODEL_VARIABLES.iter().flat_map(|name| variable(name)))
            .chain(beside)
            .chain(around)
            .chain(downloads)
            .collect();
        Self {
            packages,
            model_folders,
            media_folders: variable("GAZEBO_RESOURCE_PATH"),
            exported: OnceCell::new(),
        }
    }

    /// Resolves a URI; `folder` is the folder of the file that contains it.
    pub(super) fn resolve(&self, uri: &str, folder: &Path) -> Resolved {
        let candidates: Vec<PathBuf> = match uri.split_once("://") {
            Some(("package", rest)) => {
                let (package, relative) = rest.split_once('/').unwrap_or((rest, ""));
                match self.packages.find_file(package, relative) {
                    Some(found) => vec![found.path],
                    None => self.packages.folders().map(|packages| packages.join(rest)).collect(),
                }
            }
            Some(("file", rest)) => {
                let mut candidates = vec![folder.join(rest)];
                candidates.extend(self.media_folders.iter().map(|media| media.join(rest)));
                candidates
            }
            Some((scheme @ ("https" | "http" | "fuel"), rest)) => {
                let Some(fuel) = FuelUri::parse(rest) else {
                    return Resolved::UnknownScheme(scheme.to_owned());
                };
                // A copy among the models has only the folder's name.
                let place = if fuel.file.is_empty() {
                    fuel.name.clone()
                } else {
                    format!("{}/{}", fuel.name, fuel.file)
                };
                let among_models = |place: String| self.in_models(&place).find(|place| place.exists());
                let found = fuel.downloaded().or_else(|| among_models(place));
                let found = found.or_else(|| among_models(fuel.classic_place()?));
                return match found {
                    Some(found) => Resolved::Found(std::path::absolute(&found).unwrap_or(found)),
                    None => Resolved::UnknownScheme(scheme.to_owned()),
                };
            }
            // model://, and as in gz-sim any other scheme, such as a misspelt models://.
            Some((_, rest)) => {
                let rest = rest.trim_start_matches('/');
                // The index of models is only asked for what is in no folder before it.
                match self.in_models(rest).find(|place| place.exists()) {
                    Some(found) => vec![found],
                    None => self.in_models(rest).collect(),
                }
            }
            None => vec![folder.join(uri)],
        };
        let found = candidates.iter().find(|candidate| candidate.exists()).cloned();
        let found = found.or_else(|| self.among_models(uri)).or_else(|| self.exported(uri));
        let found = found.or_else(|| self.in_package(uri));
        match found.or_else(|| in_own_package(uri, folder)) {
            Some(found) => Resolved::Found(std::path::absolute(&found).unwrap_or(found)),
            None => Resolved::NotFound(candidates),
        }
    }

    /// Returns the paths that a relative name may have among the models.
    fn in_models(&self, name: &str) -> impl Iterator<Item = PathBuf> {
        let is_relative = Path::new(name).is_relative() && !name.is_empty();
        let folders = self.model_folders.iter().map(move |models| models.join(name));
        let indexed = self.packages.models().into_iter().filter_map(move |index| self.indexed(index, name));
        let ours = self.packages.fallback().map(move |ours| ours.join(name));
        folders.chain(indexed).chain(ours).filter(move |_| is_relative)
    }

    /// Returns the paths of a name among the models that are found wherever they are. What a package exports to Gazebo
    /// comes first, because the package means it.
    fn indexed(&self, index: &ModelIndex, name: &str) -> Option<PathBuf> {
        let exported = self.exported_folders()[0].iter().map(|folder| folder.join(name));
        exported.into_iter().find(|place| place.exists()).or_else(|| index.find(name))
    }

    /// As in libsdformat, a name that is not found in its own folder is looked for among the models.
    fn among_models(&self, uri: &str) -> Option<PathBuf> {
        let name = uri.strip_prefix("file://").unwrap_or(uri);
        self.in_models(name).find(|place| place.exists())
    }

    /// Resolves a URI in the folders that the user's packages export to Gazebo.
    fn exported(&self, uri: &str) -> Option<PathBuf> {
        let (kind, rest) = match uri.split_once("://")? {
            ("model", rest) => (0, rest),
            ("file", rest) => (1, rest),
            _ => return None,
        };
        self.exported_folders()[kind].iter().map(|folder| folder.join(rest)).find(|place| place.exists())
    }

    /// Resolves `model://PACKAGE/PATH` in the user's packages, wherever they are. In gz-sim, `GZ_SIM_RESOURCE_PATH` has the
    /// folder into which packages are installed, so that their names are those of models.
    fn in_package(&self, uri: &str) -> Option<PathBuf> {
        let (package, path) = uri.strip_prefix("model://")?.split_once('/')?;
        let is_name = !package.is_empty() && Path::new(path).is_relative();
        Some(self.packages.find_file(package, path).filter(|_| is_name)?.path)
    }

    fn exported_folders(&self) -> &[Vec<PathBuf>; 2] {
        let keys = ["gazebo_model_path", "gazebo_media_path"];
        self.exported.get_or_init(|| keys.map(|key| self.packages.exported(key)))
    }

    /// Returns the names of the models that `model://` can reach, for "did you mean".
    pub(super) fn model_names(&self) -> Vec<String> {
        let folders = self.model_folders.iter().map(PathBuf::as_path).chain(self.packages.fallback());
        let indexed = self.packages.models().into_iter().flat_map(ModelIndex::names).map(str::to_owned);
        folders
            .filter_map(|folder| std::fs::read_dir(folder).ok())
            .flatten()
            .filter_map(|entry| {
                let path = entry.ok()?.path();
                let is_model = path.join("model.config").is_file() || path.join("model.sdf").is_file();
                is_model.then(|| path.file_name()?.to_str().map(str::to_owned))?
            })
            .chain(indexed)
            .collect()
    }
}

/// Resolves `model://PATH` in the package that holds the folder of the file: packages for gz-sim add their own root to
/// `GZ_SIM_RESOURCE_PATH` by a hook.
fn in_own_package(uri: &str, folder: &Path) -> Option<PathBuf> {
    let path =
        uri.strip_prefix("model://").filter(|path| !path.is_empty() && Path::new(path).is_relative())?;
    let folder = std::path::absolute(folder).ok()?;
    let root = folder.ancestors().find(|folder| folder.join("package.xml").is_file())?;
    Some(root.join(path)).filter(|place| place.exists())
}
