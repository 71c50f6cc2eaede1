//! [`Spawnable`]: the description of a model as a text that a running simulator adds to its world.

use super::robot::find_robot;
use crate::diagnostics::{Diagnostics, Problem, Severity, Source};
use crate::file;
use crate::package::PackagePath;
use crate::xml::{Element, read_text};
use crate::{urdf, xacro};
use std::path::{Path, PathBuf};

/// File extensions of meshes.
const MESHES: [&str; 11] = ["dae", "fbx", "glb", "gltf", "obj", "ply", "stl", "usd", "usda", "usdc", "usdz"];

/// A model that can be added to a running simulation.
#[derive(Debug, Clone)]
pub struct Spawnable {
    /// The name in the description; it may be empty.
    pub name: String,
    /// URDF without xacro, or SDF.
    pub text: String,
    /// True if the text is not that of the file but what [`expand_robot`](super::expand_robot) makes of it. Its lines are then
    /// not those of the file.
    pub is_expanded: bool,
}

/// Why there is nothing to spawn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NotSpawnable {
    /// It has a format that cannot be spawned.
    Format(Problem),
    /// It does not exist, cannot be read, or cannot be expanded.
    Unreadable(Problem),
}

impl NotSpawnable {
    /// Returns the problem alone.
    pub fn into_problem(self) -> Problem {
        let (Self::Format(problem) | Self::Unreadable(problem)) = self;
        problem
    }
}

impl Spawnable {
    /// Reads a URDF, xacro or SDF file, or a robot of the package path by its name.
    ///
    /// # Errors
    /// The first problem of the file. Warnings are added to `diagnostics`.
    pub fn load(
        file_or_name: impl AsRef<Path>,
        packages: &PackagePath,
        xacro_args: &[(String, String)],
        diagnostics: &mut Diagnostics,
    ) -> Result<Self, NotSpawnable> {
        let path = file_or_name.as_ref();
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        if MESHES.iter().any(|mesh| extension == *mesh) && path.is_file() {
            let remedy = format!(
                "spawn an SDF file with a model whose <visual> and <collision> have <mesh><uri>{}</uri></mesh>",
                path.display()
            );
            return Err(other_format(path, 0, "this is a mesh, without mass or joints".into(), remedy));
        }
        let path = found(path, packages, diagnostics)?;
        let text = read_text(&path).map_err(NotSpawnable::Unreadable)?;
        Self::of_text(text, &path, packages, xacro_args, diagnostics)
    }

    /// Reads the text of a URDF, xacro or SDF file. `path` stands for the file in problems; relative names in the text refer to
    /// its folder.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn of_text(
        text: String,
        path: &Path,
        packages: &PackagePath,
        xacro_args: &[(String, String)],
        diagnostics: &mut Diagnostics,
    ) -> Result<Self, NotSpawnable> {
        let root = Element::parse(&text, path).map_err(NotSpawnable::Unreadable)?;
        let name = |model: Option<&Element>| {
            model.and_then(|model| model.attribute("name")).unwrap_or_default().to_owned()
        };
        match root.name.as_str() {
            "robot" => {}
            "sdf" | "gazebo" => {
                for (name, _) in xacro_args {
                    let remedy = "leave it out: a file of SDF has no arguments";
                    diagnostics.warning(&Source::new(path, 0), xacro::unused_argument(name), remedy);
                }
                return Ok(Self { name: name(root.child("model")), text, is_expanded: false });
            }
            other => {
                let what = format!("the first element is <{other}>");
                let remedy = "spawn URDF (<robot>), xacro, or SDF with one <model>".to_owned();
                return Err(other_format(path, root.source.line, what, remedy));
            }
        }
        let expanded = expand(root.clone(), path, packages, xacro_args, diagnostics)?;
        let is_expanded = expanded != root;
        let text = if is_expanded { expanded.to_string() } else { text };
        Ok(Self { name: name(Some(&expanded)), text, is_expanded })
    }
}

/// Does the same as [`expand_robot`](super::expand_robot): the simulator knows no xacro, and not the folder of the file.
fn expand(
    root: Element,
    path: &Path,
    packages: &PackagePath,
    xacro_args: &[(String, String)],
    diagnostics: &mut Diagnostics,
) -> Result<Element, NotSpawnable> {
    let mut own = Diagnostics::default();
    let expanded = xacro::expand_root(root, path, packages, xacro_args, &mut own);
    let mut robot = expanded.map_err(NotSpawnable::Unreadable)?;
    if urdf::is_robot(&robot, &mut own) {
        urdf::make_plain(&mut robot, packages, &mut own);
        urdf::add_sensor_frames(&mut robot, packages);
    }
    let first = own.errors().next().cloned();
    for problem in own.problems() {
        diagnostics.add(problem.clone());
    }
    first.map_or(Ok(robot), |problem| Err(NotSpawnable::Unreadable(problem)))
}

/// Returns the file that is meant.
fn found(
    path: &Path,
    packages: &PackagePath,
    diagnostics: &mut Diagnostics,
) -> Result<PathBuf, NotSpawnable> {
    if file::is_there(path) && !path.is_dir() {
        return Ok(path.to_owned());
    }
    let mut own = Diagnostics::default();
    let file = find_robot(path, ".urdf, .xacro or .sdf", packages, &mut own);
    let first = own.errors().next().cloned();
    for problem in own.problems().iter().filter(|problem| problem.severity != Severity::Error) {
        diagnostics.add(problem.clone());
    }
    match (file, first) {
        (Some(file), _) => Ok(file),
        (None, Some(problem)) => Err(NotSpawnable::Unreadable(problem)),
        // It always says why.
        (None, None) => Err(other_format(path, 0, "no such file".into(), "check the path".into())),
    }
}

fn other_format(path: &Path, line: u32, what: String, remedy: String) -> NotSpawnable {
    NotSpawnable::Format(Problem { severity: Severity::Error, source: Source::new(path, line), what, remedy })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::package_path;

    const XACRO: &str = "<robot name='r' xmlns:xacro='http://ros.org/wiki/xacro'>\n<xacro:arg name='n' default='1'/>\n\
                         <link name='l${1 + 1}_$(arg n)'/></robot>";

    fn load(file: impl AsRef<Path>, args: &[(String, String)]) -> Result<Spawnable, NotSpawnable> {
        Spawnable::load(file, &package_path([], None), args, &mut Diagnostics::default())
    }

    #[test]
    fn files_texts_and_names_become_texts_for_the_simulator() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            path
        };
        let sdf = "<sdf version='1.7'>\n<model name='crate'><link name='l'/></model></sdf>";
        let urdf = "<robot name='plain'>\n<link name='l'/></robot>";
        // A file that needs no expansion keeps its text, and so its lines.
        for (file, name, text) in [("crate.sdf", "crate", sdf), ("plain.urdf", "plain", urdf)] {
            let found = load(write(file, text), &[]).unwrap();
            assert_eq!((found.name.as_str(), found.text.as_str(), found.is_expanded), (name, text, false));
        }
        let args = [("n".to_owned(), "7".to_owned())];
        for file in ["robot.urdf.xacro", "robot.urdf"] {
            let robot = load(write(file, XACRO), &args).unwrap();
            assert!(robot.is_expanded && robot.name == "r", "{robot:?}");
            assert!(robot.text.contains("name=\"l2_7\"") && !robot.text.contains("xacro:arg"), "{robot:?}");
        }
        let kobuki = load("kobuki_nostack_camera", &[]).unwrap();
        assert!(kobuki.text.contains("<robot") && !kobuki.text.contains("xacro:"));
        // A mesh beside the file is found by the simulator, which does not know the folder.
        write("m.obj", "v 0 0 0\n");
        let meshed = "<robot name='m'><link name='l'><visual><geometry><mesh filename='m.obj'/></geometry></visual></link>\
                      </robot>";
        let robot = load(write("meshed.urdf", meshed), &[]).unwrap();
        let absolute = folder.path().join("m.obj").display().to_string();
        assert!(robot.is_expanded && robot.text.contains(&absolute), "{robot:?}");
    }

    #[test]
    fn what_cannot_be_spawned_is_refused_with_file_line_and_remedy() {
        let folder = tempfile::tempdir().unwrap();
        for (name, text, is_format, says) in [
            ("m.OBJ", "v 0 0 0", true, "m.OBJ: error: this is a mesh, without mass or joints; spawn an SDF"),
            ("m.xml", "\n<mujoco/>", true, "m.xml:2: error: the first element is <mujoco>; spawn URDF"),
            ("r.urdf", "<robot name='r'>\n<link name='${1/0}'/></robot>", false, "r.urdf:2: error: "),
            ("broken.sdf", "<sdf>", false, "broken.sdf:1: error: "),
        ] {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            let refused = load(&path, &[]).unwrap_err();
            assert_eq!(matches!(refused, NotSpawnable::Format(_)), is_format, "{refused:?}");
            let said = refused.into_problem().to_string();
            assert!(said.contains(says), "{said}");
        }
        for (name, says) in [
            ("no/such.sdf", "no/such.sdf: error: no such file"),
            ("kobuki_nostack_camra", "did you mean 'kobuki_nostack_camera'"),
            (&*"x".repeat(300), "File name too long"),
        ] {
            let said = load(name, &[]).unwrap_err().into_problem().to_string();
            assert!(said.contains(says), "{said}");
        }
    }
}
