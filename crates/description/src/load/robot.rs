//! Loading of robots: found by file or by name, expanded by xacro, read from URDF.

use crate::diagnostics::{Diagnostics, Source};
use crate::file;
use crate::model::Model;
use crate::models::searched;
use crate::package::PackagePath;
use crate::rules::Rules;
use crate::suggestion::did_you_mean_or;
use crate::xml::Element;
use crate::{sdf, urdf, xacro};
use std::path::{Path, PathBuf};

/// The package whose `robots` folder contains the named robots.
const PACKAGE: &str = "turtlebot_description";

/// The end of the file names of these robots.
const EXTENSION: &str = ".urdf.xacro";

/// The robot of the standard scenario.
const DEFAULT_ROBOT: &str = "kobuki_nostack_camera";

/// Options of [`load_robot`].
#[derive(Debug, Clone)]
pub struct LoadOptions {
    /// Folders in which packages are found.
    pub packages: PackagePath,
    /// Rules for reading files.
    pub rules: Rules,
    /// Values of `$(arg name)` in the robot's xacro, as (name, value).
    pub xacro_args: Vec<(String, String)>,
}

/// Parses a xacro argument in the form of roslaunch: `name:=value`.
///
/// # Errors
/// A text that shows the expected form.
pub fn xacro_argument(text: &str) -> Result<(String, String), String> {
    match text.split_once(":=") {
        Some((name, value)) if !name.is_empty() && !name.contains(char::is_whitespace) => {
            Ok((name.to_owned(), value.to_owned()))
        }
        _ => Err("an argument of the robot's xacro is written name:=value".into()),
    }
}

/// Returns the robot that is loaded by default, as in the articles: `TURTLEBOT_BASE`, `TURTLEBOT_STACKS` and
/// `TURTLEBOT_3D_SENSOR` choose `BASE_STACKS_SENSOR`; unset ones default to `kobuki`, `nostack`, `camera`.
pub fn default_robot_name() -> String {
    chosen_name(|variable| std::env::var(variable).ok())
}

fn chosen_name(variable: impl Fn(&str) -> Option<String>) -> String {
    let variables = ["TURTLEBOT_BASE", "TURTLEBOT_STACKS", "TURTLEBOT_3D_SENSOR"];
    let parts: Vec<String> = variables
        .iter()
        .zip(DEFAULT_ROBOT.split('_'))
        .map(|(name, default)| {
            variable(name).filter(|value| !value.is_empty()).unwrap_or_else(|| default.to_owned())
        })
        .collect();
    parts.join("_")
}

/// Loads a robot from a URDF or xacro file, from an SDF file of one model, or by name.
///
/// A name has no path separator: `kobuki_nostack_camera` is `robots/kobuki_nostack_camera.urdf.xacro` of a
/// `turtlebot_description` package on the package path, the user's first.
///
/// # Errors
/// Problems are added to `diagnostics`. None is returned if there is no robot at all; a robot that is
/// returned while `diagnostics` has errors can be shown but must not be run.
pub fn load_robot(
    file_or_name: impl AsRef<Path>,
    options: &LoadOptions,
    diagnostics: &mut Diagnostics,
) -> Option<Model> {
    let path = find_robot(file_or_name.as_ref(), ".urdf, .xacro or .sdf", &options.packages, diagnostics)?;
    // A world is no robot, and this says so.
    if path.extension().is_some_and(|extension| extension == "sdf" || extension == "world") {
        return load_sdf(&path, options, diagnostics);
    }
    match xacro::expand(&path, &options.packages, &options.xacro_args, diagnostics) {
        Ok(robot) => urdf::load_urdf(&robot, &options.packages, options.rules, diagnostics),
        Err(problem) => {
            diagnostics.add(problem);
            None
        }
    }
}

/// Loads a robot from an SDF file of one model.
fn load_sdf(path: &Path, options: &LoadOptions, diagnostics: &mut Diagnostics) -> Option<Model> {
    diagnostics.opened(path);
    for (name, _) in &options.xacro_args {
        let remedy = "leave it out: a file of SDF has no arguments";
        diagnostics.warning(&Source::new(path, 0), xacro::unused_argument(name), remedy);
    }
    match Element::parse_file(path) {
        Ok(root) => sdf::load_model(&root, &options.packages, options.rules, diagnostics),
        Err(problem) => {
            diagnostics.add(problem);
            None
        }
    }
}

/// Expands a robot as [`load_robot`] does and returns it as one plain URDF that ROS's programs can read: without xacro, with
/// absolute names of meshes and textures, and with each material defined once. Elements for Gazebo are kept. Links are added
/// for the [`sensor_frames`](crate::sensor_frames::sensor_frames).
///
/// # Errors
/// Problems are added to `diagnostics`. None is returned if the file cannot be expanded; whether its content is a valid
/// robot is not checked.
pub fn expand_robot(
    file_or_name: impl AsRef<Path>,
    packages: &PackagePath,
    xacro_args: &[(String, String)],
    diagnostics: &mut Diagnostics,
) -> Option<Element> {
    let path = find_robot(file_or_name.as_ref(), ".urdf or .xacro", packages, diagnostics)?;
    if path.extension().is_some_and(|extension| extension == "sdf") {
        let remedy = "name a .urdf or .xacro file; `belvedere run` and `belvedere check` read this one";
        diagnostics.error(
            &Source::new(path, 0),
            "this is a file of SDF, and no URDF can be made of it",
            remedy,
        );
        return None;
    }
    match xacro::expand(&path, packages, xacro_args, diagnostics) {
        Ok(mut robot) => {
            if !urdf::is_robot(&robot, diagnostics) {
                return None;
            }
            urdf::make_plain(&mut robot, packages, diagnostics);
            urdf::add_sensor_frames(&mut robot, packages);
            Some(robot)
        }
        Err(problem) => {
            diagnostics.add(problem);
            None
        }
    }
}

/// Returns the file of a robot; none and an error, which names the `formats` that there may be, if there is none.
pub(super) fn find_robot(
    path: &Path,
    formats: &str,
    packages: &PackagePath,
    diagnostics: &mut Diagnostics,
) -> Option<PathBuf> {
    let is_robot_file = path.extension().is_some_and(|extension| {
        ["urdf", "xacro", "xml", "sdf", "world"].iter().any(|known| extension == *known)
    });
    if !is_bare(path) || is_robot_file && file::is_there(path) {
        return Some(path.to_path_buf());
    }
    let name = path.to_string_lossy();
    let name = name.strip_suffix(EXTENSION).unwrap_or(&name);
    if !name.is_empty()
        && let Some(found) = packages.find_file(PACKAGE, format!("robots/{name}{EXTENSION}"))
    {
        return Some(found.path);
    }
    // Whatever it is, reading it says what is wrong with it.
    if file::is_there(path) {
        return Some(path.to_path_buf());
    }
    let names = robot_names(packages);
    let otherwise = format!("give the path of a {formats} file or {}", one_of(&names, packages));
    not_found(path, "robot", names.iter().map(String::as_str), &otherwise, diagnostics);
    None
}

/// Returns true for a name, or a file in the current folder.
pub(super) fn is_bare(file_or_name: &Path) -> bool {
    file_or_name.components().count() == 1 && file_or_name.file_name() == Some(file_or_name.as_os_str())
}

/// Reports that there is no such file, or nothing of that name. A name with an extension is a file.
pub(super) fn not_found<'a>(
    file_or_name: &Path,
    what: &str,
    names: impl IntoIterator<Item = &'a str>,
    otherwise: &str,
    diagnostics: &mut Diagnostics,
) {
    let is_file = file_or_name.extension().is_some();
    let what = if is_file { "no such file".to_owned() } else { format!("no such {what}") };
    let remedy = if is_file {
        otherwise.to_owned()
    } else {
        did_you_mean_or(&file_or_name.to_string_lossy(), names, otherwise)
    };
    diagnostics.error(&Source::new(file_or_name, 0), what, remedy);
}

/// Lists the names and where they were looked for, as the end of a remedy.
pub(super) fn one_of(names: &[String], packages: &PackagePath) -> String {
    let listed = if names.is_empty() { "none found".into() } else { names.join(", ") };
    format!("one of these names: {listed} (looked for in {})", searched(packages))
}

/// Returns the names that [`load_robot`] knows, sorted.
pub fn robot_names(packages: &PackagePath) -> Vec<String> {
    let mut names: Vec<String> = packages
        .folders()
        .map(|folder| if folder.ends_with(PACKAGE) { folder.to_path_buf() } else { folder.join(PACKAGE) })
        .chain(packages.find_package(PACKAGE))
        .filter_map(|package| std::fs::read_dir(package.join("robots")).ok())
        .flatten()
        .filter_map(|entry| entry.ok()?.file_name().to_str()?.strip_suffix(EXTENSION).map(str::to_owned))
        .collect();
    names.sort();
    names.dedup();
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::package_path;
    use std::fs;

    #[test]
    fn the_environment_chooses_as_in_the_articles() {
        assert_eq!(chosen_name(|_| None), "kobuki_nostack_camera");
        let stacked = |name: &str| match name {
            "TURTLEBOT_STACKS" => Some("hexagons".into()),
            "TURTLEBOT_3D_SENSOR" => Some("KinectHokuyo".into()),
            _ => None,
        };
        assert_eq!(chosen_name(stacked), "kobuki_hexagons_KinectHokuyo");
    }

    #[test]
    fn robots_are_found_by_name_and_by_path() {
        let folder = tempfile::tempdir().unwrap();
        let robots = folder.path().join("turtlebot_description/robots");
        fs::create_dir_all(&robots).unwrap();
        let file = robots.join("mine.urdf.xacro");
        fs::write(&file, "<robot name='m'><link name=\"${'a' + 'b'}\"/></robot>").unwrap();
        let options = LoadOptions {
            packages: package_path([folder.path().to_path_buf()], None),
            rules: Rules::default(),
            xacro_args: Vec::new(),
        };
        let mut diagnostics = Diagnostics::default();
        for name in ["mine", "mine.urdf.xacro", file.to_str().unwrap()] {
            let robot = load_robot(name, &options, &mut diagnostics).unwrap();
            assert_eq!((robot.name.as_str(), robot.links[0].name.as_str()), ("m", "ab"));
        }
        assert!(diagnostics.problems().is_empty());
        assert!(load_robot("nine", &options, &mut diagnostics).is_none());
        let problem = diagnostics.problems()[0].to_string();
        assert!(problem.starts_with("nine: error: no such robot; did you mean 'mine'?"), "{problem}");
    }

    #[test]
    fn a_path_without_a_file_is_one_error() {
        let options =
            LoadOptions { packages: package_path([], None), rules: Rules::default(), xacro_args: Vec::new() };
        for path in ["no/such/robot.urdf", "no_such.urdf"] {
            let mut diagnostics = Diagnostics::default();
            assert!(load_robot(path, &options, &mut diagnostics).is_none());
            assert_eq!(diagnostics.problems().len(), 1, "{path}");
        }
    }
}
