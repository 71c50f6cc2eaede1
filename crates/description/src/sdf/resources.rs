//! Resolution of the URIs in a world.

use super::fuel::FuelUri;
use crate::package::PackagePath;
use std::cell::OnceCell;
use std::path::{Path, PathBuf};

/// Environment variables that name folders of models: Gazebo classic's, then those of its successors.
const MODEL_VARIABLES: [&str; 4] =
    ["GAZEBO_MODEL_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "SDF_PATH"];

/// The folders that are searched.
pub(super) struct Resources<'a> {
    packages: &'a PackagePath,
    /// Folders that contain models, Belvedere's own last.
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
    /// beside it (for a model file the folder above it), Gazebo's download folder, Belvedere's own.
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
            .chain(ours.map(Path::to_path_buf))
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
            Some((_, rest)) => self.in_models(rest.trim_start_matches('/')).collect(),
            None => vec![folder.join(uri)],
        };
        let found = candidates.iter().find(|candidate| candidate.exists()).cloned();
        match found.or_else(|| self.among_models(uri)).or_else(|| self.exported(uri)) {
            Some(found) => Resolved::Found(std::path::absolute(&found).unwrap_or(found)),
            None => Resolved::NotFound(candidates),
        }
    }

    /// Returns the paths that a relative name may have among the models.
    fn in_models(&self, name: &str) -> impl Iterator<Item = PathBuf> {
        let is_relative = Path::new(name).is_relative() && !name.is_empty();
        let folders = self.model_folders.iter().filter(move |_| is_relative);
        folders.map(move |models| models.join(name))
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
        let keys = ["gazebo_model_path", "gazebo_media_path"];
        let exported = self.exported.get_or_init(|| keys.map(|key| self.packages.exported(key)));
        exported[kind].iter().map(|folder| folder.join(rest)).find(|place| place.exists())
    }

    /// Returns the names of the models that `model://` can reach, for "did you mean".
    pub(super) fn model_names(&self) -> Vec<String> {
        self.model_folders
            .iter()
            .filter_map(|folder| std::fs::read_dir(folder).ok())
            .flatten()
            .filter_map(|entry| {
                let path = entry.ok()?.path();
                let is_model = path.join("model.config").is_file() || path.join("model.sdf").is_file();
                is_model.then(|| path.file_name()?.to_str().map(str::to_owned))?
            })
            .collect()
    }
}

/// Lists the places that were searched, for an error message.
pub(super) fn list(places: &[PathBuf]) -> String {
    let mut shown: Vec<String> = Vec::new();
    for place in places {
        let text = place.display().to_string();
        if !shown.contains(&text) {
            shown.push(text);
        }
    }
    shown.join(", ")
}
