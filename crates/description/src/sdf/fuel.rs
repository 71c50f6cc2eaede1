//! Models of Gazebo's library Fuel that its own tools have downloaded: `https://fuel.gazebosim.org/1.0/OWNER/models/NAME`.
//!
//! They are in `~/.gz/fuel` or `~/.ignition/fuel` as `HOST/OWNER/models/NAME/VERSION`, in lower case or as written.
//! Nothing is downloaded here.

use std::path::{Path, PathBuf};

/// Environment variables that name a folder of downloads.
const VARIABLES: [&str; 2] = ["GZ_FUEL_CACHE_PATH", "IGN_FUEL_CACHE_PATH"];

/// Other folders of downloads, in the user's home.
const FOLDERS: [&str; 2] = [".gz/fuel", ".ignition/fuel"];

/// A model, or a file of one, on a server.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct FuelUri {
    host: String,
    owner: String,
    pub(super) name: String,
    /// None for the newest version.
    version: Option<u32>,
    /// Path within the model; empty for the model itself.
    pub(super) file: String,
}

impl FuelUri {
    /// Reads an address with its scheme.
    pub(super) fn of(uri: &str) -> Option<Self> {
        let (scheme, rest) = uri.split_once("://")?;
        Self::parse(rest).filter(|_| matches!(scheme, "https" | "http" | "fuel"))
    }

    /// Reads `HOST[/1.0]/OWNER/models/NAME[/VERSION|tip][/files/FILE]`, the part after `https://`.
    pub(super) fn parse(rest: &str) -> Option<Self> {
        let rest = rest.replace("%20", " ");
        let mut parts = rest.split('/').filter(|part| !part.is_empty());
        let host = parts.next()?.to_owned();
        let mut owner = parts.next()?;
        if owner.starts_with(|digit: char| digit.is_ascii_digit()) {
            owner = parts.next()?;
        }
        parts.next().filter(|kind| kind.eq_ignore_ascii_case("models"))?;
        let name = parts.next()?.to_owned();
        let mut rest: Vec<&str> = parts.collect();
        let version = rest.first().and_then(|version| version.parse().ok());
        if version.is_some() || rest.first() == Some(&"tip") {
            rest.remove(0);
        }
        if rest.first() == Some(&"files") {
            rest.remove(0);
        }
        let is_inside = rest.iter().chain([&name.as_str(), &owner, &host.as_str()]).all(|part| *part != "..");
        is_inside.then(|| Self { owner: owner.to_owned(), version, file: rest.join("/"), host, name })
    }

    /// Returns the path of the model or file if it was downloaded.
    pub(super) fn downloaded(&self) -> Option<PathBuf> {
        let variables = VARIABLES.iter().filter_map(std::env::var_os).map(PathBuf::from);
        let home = std::env::home_dir();
        let folders = home.iter().flat_map(|home| FOLDERS.map(|folder| home.join(folder)));
        variables.chain(folders).find_map(|cache| self.below(&cache))
    }

    /// Returns its path among models made for Gazebo classic, such as Belvedere's own: Fuel's `OpenRobotics/models/Ground
    /// Plane` has the folder `ground_plane` there. None if the owner is not `OpenRobotics`.
    pub(super) fn classic_place(&self) -> Option<String> {
        if !self.owner.eq_ignore_ascii_case("openrobotics") {
            return None;
        }
        let name = self.name.to_lowercase().replace(' ', "_");
        Some(if self.file.is_empty() { name } else { format!("{name}/{}", self.file) })
    }

    /// Finds the model or file in one folder of downloads.
    fn below(&self, cache: &Path) -> Option<PathBuf> {
        let server = named(cache, &self.host)?;
        let model = named(&named(&named(&server, &self.owner)?, "models")?, &self.name)?;
        let versions = std::fs::read_dir(&model)
            .ok()?
            .filter_map(|entry| entry.ok()?.file_name().to_str()?.parse().ok());
        let version: u32 = versions.filter(|found| self.version.is_none_or(|asked| asked == *found)).max()?;
        let model = model.join(version.to_string());
        let path = if self.file.is_empty() { model } else { model.join(&self.file) };
        path.exists().then_some(path)
    }
}

/// Returns the entry of a folder that has this name in upper or lower case.
fn named(folder: &Path, name: &str) -> Option<PathBuf> {
    let mut entries = std::fs::read_dir(folder).ok()?.filter_map(Result::ok);
    let is_it = |found: &str| found.to_lowercase() == name.to_lowercase();
    entries.find(|entry| entry.file_name().to_str().is_some_and(is_it)).map(|entry| entry.path())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn downloads_are_found_by_their_address() {
        let cache = tempfile::tempdir().unwrap();
        for (place, versions) in [
            ("fuel.example.org/openrobotics/models/traffic cone", [2, 10]),
            ("other.org/Me/models/X4 UAV", [1, 3]),
        ] {
            for version in versions {
                let model = cache.path().join(place).join(version.to_string());
                std::fs::create_dir_all(model.join("meshes")).unwrap();
                std::fs::write(model.join("meshes/a.dae"), "").unwrap();
            }
        }
        let find = |uri: &str| {
            let found = FuelUri::parse(uri)?.below(cache.path())?;
            Some(found.strip_prefix(cache.path()).unwrap().to_str().unwrap().to_owned())
        };
        let cone = "fuel.example.org/openrobotics/models/traffic cone";
        for (uri, found) in [
            ("fuel.example.org/1.0/OpenRobotics/models/Traffic%20Cone", format!("{cone}/10")),
            ("fuel.example.org/OpenRobotics/models/Traffic Cone/", format!("{cone}/10")),
            ("fuel.example.org/1.0/openrobotics/models/traffic cone/2", format!("{cone}/2")),
            (
                "fuel.example.org/1.0/OpenRobotics/models/Traffic Cone/tip/files/meshes/a.dae",
                format!("{cone}/10/meshes/a.dae"),
            ),
            (
                "other.org/1.0/me/models/x4 uav/1/files/meshes/a.dae",
                "other.org/Me/models/X4 UAV/1/meshes/a.dae".into(),
            ),
        ] {
            assert_eq!(find(uri), Some(found), "{uri}");
        }
        for uri in [
            "fuel.example.org/1.0/OpenRobotics/models/Traffic Cone/3",
            "fuel.example.org/1.0/OpenRobotics/models/Cone",
            "fuel.example.org/1.0/OpenRobotics/models/Traffic Cone/tip/files/../../../../../x",
            "fuel.example.org/1.0/OpenRobotics/worlds/Traffic Cone",
            "fuel.example.org",
        ] {
            assert_eq!(find(uri), None, "{uri}");
        }
    }
}
