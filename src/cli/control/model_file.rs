//! Reads a file that is to be spawned, and explains files of kinds that cannot be spawned.

use crate::cli::error::CliError;
use crate::description::load::robot_names;
use crate::description::models::package_path;
use crate::description::xml::Element;
use std::ffi::OsStr;
use std::io;
use std::path::Path;

/// File extensions of meshes.
const MESHES: [&str; 8] = ["dae", "fbx", "glb", "gltf", "obj", "ply", "stl", "usd"];

/// Reads a URDF file without xacro, or an SDF file.
///
/// # Errors
/// [`CliError::Input`] if the file cannot be read; [`CliError::NotSpawned`] with a remedy if it is a xacro, a mesh, or
/// the name of a robot.
pub(super) fn read(file: &Path) -> Result<String, CliError> {
    let refused = |what: &str, remedy: String| CliError::NotSpawned {
        path: file.to_owned(),
        what: what.into(),
        remedy,
    };
    let shown = file.display();
    let ends_in = file.extension().map(OsStr::to_ascii_lowercase).unwrap_or_default();
    if MESHES.iter().any(|mesh| ends_in == *mesh) && file.is_file() {
        let remedy = format!(
            "spawn an SDF file with a model whose <visual> and <collision> have <mesh><uri>{shown}</uri></mesh>"
        );
        return Err(refused("a mesh, without mass or joints", remedy));
    }
    let text = std::fs::read_to_string(file).map_err(|source| {
        let is_name = source.kind() == io::ErrorKind::NotFound && is_robot_name(file);
        if is_name {
            return refused(
                "the name of a robot",
                format!("spawn its file: belvedere urdf {shown} > {shown}.urdf"),
            );
        }
        CliError::Input { path: file.to_owned(), source }
    })?;
    // The simulator reports everything else that may be wrong with the file.
    let is_xacro = ends_in == "xacro" || Element::parse(&text, file).is_ok_and(|root| has_xacro(&root));
    if is_xacro {
        let remedy = format!("spawn its expansion: belvedere urdf {shown} > robot.urdf");
        return Err(refused("a xacro", remedy));
    }
    Ok(text)
}

fn is_robot_name(file: &Path) -> bool {
    let ros_package_path = std::env::var_os("ROS_PACKAGE_PATH");
    let names = robot_names(&package_path([], ros_package_path.as_deref()));
    names.iter().any(|name| file == Path::new(name))
}

fn has_xacro(element: &Element) -> bool {
    element.name.starts_with("xacro:") || element.elements().any(has_xacro)
}
