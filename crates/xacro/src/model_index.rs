//! [`ModelIndex`]: models by name, wherever they are below a folder.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Folders of models, each under the folder's name, by which `model://NAME` refers to it.
#[derive(Debug, Default)]
pub struct ModelIndex {
    /// In alphabetical order; the first of each name is used.
    folders: BTreeMap<String, Vec<PathBuf>>,
    /// The names that were looked up and are those of several folders.
    chosen: Mutex<BTreeSet<String>>,
}

impl ModelIndex {
    /// Creates the index of these folders. Of folders with the same name, the first in alphabetical order is used.
    pub fn new(folders: impl IntoIterator<Item = PathBuf>) -> Self {
        let folders: BTreeSet<PathBuf> = folders.into_iter().collect();
        let mut index = Self::default();
        for folder in folders {
            if let Some(name) = folder.file_name().and_then(|name| name.to_str()) {
                index.folders.entry(name.to_owned()).or_default().push(folder);
            }
        }
        index
    }

    /// Returns the place of a name such as `crate` or `crate/meshes/board.obj` in the folder of its model.
    pub fn find(&self, name: &str) -> Option<PathBuf> {
        let (model, rest) = name.split_once('/').unwrap_or((name, ""));
        let folders = self.folders.get(model)?;
        if folders.len() > 1 {
            self.chosen.lock().unwrap_or_else(PoisonError::into_inner).insert(model.to_owned());
        }
        let folder = folders.first()?;
        Some(if rest.is_empty() { folder.clone() } else { folder.join(rest) })
    }

    /// Returns the names of all models.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.folders.keys().map(String::as_str)
    }

    /// Returns the names that were looked up and are those of several folders, in alphabetical order, each with its
    /// folders, of which the first was used.
    pub fn choices(&self) -> Vec<(String, Vec<&Path>)> {
        let chosen = self.chosen.lock().unwrap_or_else(PoisonError::into_inner);
        let folders =
            |name: &String| self.folders.get(name).into_iter().flatten().map(PathBuf::as_path).collect();
        chosen.iter().map(|name| (name.clone(), folders(name))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_folder_of_a_name_is_used_and_only_choices_that_were_made_are_told() {
        let folders = ["w/z/crate", "w/a/crate", "w/a/jar", "w/b/jar", "w/shelf", "w/shelf"];
        let index = ModelIndex::new(folders.map(PathBuf::from));
        let found = |name: &str| index.find(name).map(|path| path.display().to_string());
        assert_eq!(found("crate").as_deref(), Some("w/a/crate"));
        assert_eq!(found("crate/meshes/board.obj").as_deref(), Some("w/a/crate/meshes/board.obj"));
        assert_eq!(found("shelf").as_deref(), Some("w/shelf"));
        for name in ["", "/", "..", "a", "crat", "Crate"] {
            assert_eq!(found(name), None, "{name}");
        }
        let choices = index.choices();
        assert_eq!(choices, [("crate".to_owned(), vec![Path::new("w/a/crate"), Path::new("w/z/crate")])]);
        assert_eq!(index.names().collect::<Vec<_>>(), ["crate", "jar", "shelf"]);
    }
}
