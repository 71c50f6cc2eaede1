//! The description of a model that is to be spawned: a text, or a file or robot that a URI names.

use super::refusal::Refusal;
use crate::description::Diagnostics;
use crate::description::load::{NotSpawnable, Spawnable, robot_names};
use crate::description::models::package_path;
use crate::description::package::PackagePath;
use crate::description::suggestion::did_you_mean_or;
use std::path::{Path, PathBuf};

/// Results of `SpawnEntity`.
const UNSUPPORTED_FORMAT: u8 = 103;
const NO_RESOURCE: u8 = 104;
pub(super) const RESOURCE_PARSE_ERROR: u8 = 106;

/// Extensions of files that are read. A refusal may quote a file, so no other file is read for a program of the network.
const EXTENSIONS: [&str; 4] = ["sdf", "urdf", "xacro", "xml"];

/// Reads the description of a model from a URI or, if that is empty, from a text.
///
/// # Errors
/// A refusal with the code that `SpawnEntity` has for the reason.
pub(super) fn read(uri: &str, text: &str) -> Result<Spawnable, Refusal> {
    let ros_package_path = std::env::var_os("ROS_PACKAGE_PATH");
    let packages = package_path([], ros_package_path.as_deref());
    let mut diagnostics = Diagnostics::default();
    let read = match (uri, text) {
        ("", "") => {
            return Err(Refusal::new(NO_RESOURCE, "both the URI and the text of the resource are empty"));
        }
        ("", text) => {
            let path = Path::new("resource_string");
            Spawnable::of_text(text.to_owned(), path, &packages, &[], &mut diagnostics)
        }
        (uri, _) => {
            let file = file_of(uri, &packages)?;
            check_extension(&file)?;
            Spawnable::load(file, &packages, &[], &mut diagnostics)
        }
    };
    read.map_err(|why| {
        let code = match &why {
            NotSpawnable::Format(_) => UNSUPPORTED_FORMAT,
            NotSpawnable::Unreadable(_) => RESOURCE_PARSE_ERROR,
        };
        Refusal::new(code, why.into_problem().to_string())
    })
}

/// Refuses a file that is not a description by its name.
fn check_extension(file: &Path) -> Result<(), Refusal> {
    let extension = file.extension().unwrap_or_default().to_ascii_lowercase();
    if !file.is_file() || EXTENSIONS.iter().any(|known| extension == *known) {
        return Ok(());
    }
    Err(Refusal::new(
        UNSUPPORTED_FORMAT,
        format!(
            "{} is no description of a model by its name; give a .urdf, .xacro, .sdf or .xml file, which can refer to meshes",
            file.display()
        ),
    ))
}

/// Returns the file that a URI names, or the name of a robot.
fn file_of(uri: &str, packages: &PackagePath) -> Result<PathBuf, Refusal> {
    let path = if let Some(path) = uri.strip_prefix("file://") {
        PathBuf::from(path)
    } else if let Some(rest) = uri.strip_prefix("package://") {
        let found = rest.split_once('/').and_then(|(package, file)| packages.find_file(package, file));
        let found = found.ok_or_else(|| {
            Refusal::not_found(format!("there is no {uri}; packages are looked for in ROS_PACKAGE_PATH"))
        })?;
        found.path
    } else if uri.contains("://") {
        return Err(Refusal::unsupported(format!(
            "the URI {uri} has a scheme that is not supported; give file:///PATH, package://PACKAGE/PATH, a path, or the \
             name of a robot of Belvedere"
        )));
    } else if uri.contains('/') {
        PathBuf::from(uri)
    } else {
        let names = robot_names(packages);
        if !names.iter().any(|name| name == uri) {
            let known = names.iter().map(String::as_str);
            let remedy = did_you_mean_or(uri, known, "belvedere robots lists those that there are");
            return Err(Refusal::not_found(format!("there is no robot '{uri}'; {remedy}")));
        }
        return Ok(PathBuf::from(uri));
    };
    if path.is_file() {
        Ok(path)
    } else {
        Err(Refusal::not_found(format!("there is no file {}", path.display())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resources_are_texts_files_and_robots() {
        let sdf = "<sdf version='1.7'><model name='crate'><link name='l'/></model></sdf>";
        assert_eq!(read("", sdf).unwrap().name, "crate");
        let urdf = "<robot name='r' xmlns:xacro='http://ros.org/wiki/xacro'><link name='${1 + 1}'/></robot>";
        let robot = read("", urdf).unwrap();
        assert!(robot.name == "r" && robot.text.contains("name=\"2\""), "{}", robot.text);
        // The URI has priority.
        let kobuki = read("kobuki_nostack_camera", sdf).unwrap();
        assert!(kobuki.text.contains("<robot") && !kobuki.text.contains("xacro:"));
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("crate.sdf");
        std::fs::write(&file, sdf).unwrap();
        for uri in [format!("file://{}", file.display()), file.display().to_string()] {
            assert_eq!(read(&uri, "").unwrap().name, "crate");
        }
    }

    #[test]
    fn what_cannot_be_spawned_has_its_code() {
        for (uri, text, code, says) in [
            ("", "", NO_RESOURCE, "both"),
            ("", "<robot", RESOURCE_PARSE_ERROR, "resource_string:1"),
            ("", "<mujoco/>", UNSUPPORTED_FORMAT, "<mujoco>"),
            ("", "<robot name='r'><link name='${1/0}'/></robot>", RESOURCE_PARSE_ERROR, "resource_string:1"),
            ("kobuki_nostack_camra", "", 2, "did you mean"),
            ("/no/such.urdf", "", 2, "there is no file"),
            ("package://no_such/robot.urdf", "", 2, "ROS_PACKAGE_PATH"),
            ("https://fuel.gazebosim.org/box", "", 0, "scheme"),
            ("/etc/hostname", "", UNSUPPORTED_FORMAT, "by its name"),
        ] {
            let refusal = read(uri, text).err().unwrap();
            assert_eq!(refusal.code, code, "{refusal:?}");
            assert!(refusal.message.contains(says), "{refusal:?}");
        }
    }
}
