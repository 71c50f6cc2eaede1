//! URDF with Gazebo's extensions: converts an expanded `<robot>` to a [`Model`].
//!
//! | file | reads |
//! |---|---|
//! | `link` | `<link>`: mass, visuals, collisions |
//! | `joint` | `<joint>` |
//! | `tree` | the tree of links and joints, and the poses in it |
//! | `geometry`, `material` | shapes and their looks |
//! | `collisions` | the names that Gazebo gives collisions, and the collisions of contact sensors |
//! | `files` | resolution of `package://` and other file names |
//! | `plain` | rewrites a robot for stricter parsers |
//! | `gazebo` | `<gazebo>`: sensors, and properties that Gazebo overrides |
//!
//! `<transmission>` and other elements without any effect here are ignored silently.

mod collisions;
mod files;
mod gazebo;
mod geometry;
mod joint;
mod link;
mod material;
mod plain;
#[cfg(test)]
mod tests;
mod tree;

pub(super) use plain::{add_sensor_frames, make_plain};

use super::concave::warn_of_hulls;
use super::diagnostics::{Diagnostics, Source};
use super::elements;
use super::housing;
use super::model::{JointIndex, LinkIndex, Material, Mesh, Model};
use super::package::PackagePath;
use super::rules::Rules;
use super::xml::Element;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// The word for the image of a surface in problems.
const TEXTURE: &str = "texture";

/// Meshes already read, by file and scale: wheels share theirs.
type MeshCache = HashMap<(PathBuf, [u64; 3]), Option<Vec<Arc<Mesh>>>>;

/// State of one load.
struct Loader<'a> {
    packages: &'a PackagePath,
    rules: Rules,
    diagnostics: &'a mut Diagnostics,
    /// Materials with a name, wherever in the file they are defined.
    materials: HashMap<String, Material>,
    meshes: MeshCache,
    /// The links and the joints by their names.
    link_names: HashMap<String, LinkIndex>,
    joint_names: HashMap<String, JointIndex>,
}

/// Reads a robot that xacro has expanded. Problems are added to `diagnostics`; none is returned if
/// links and joints do not form a tree.
pub(super) fn load_urdf(
    robot: &Element,
    packages: &PackagePath,
    rules: Rules,
    diagnostics: &mut Diagnostics,
) -> Option<Model> {
    if !is_robot(robot, diagnostics) {
        return None;
    }
    let mut loader = Loader {
        packages,
        rules,
        diagnostics,
        materials: HashMap::new(),
        meshes: HashMap::new(),
        link_names: HashMap::new(),
        joint_names: HashMap::new(),
    };
    loader.define_materials(robot);
    let mut model = Model::empty(robot.attribute("name").unwrap_or("robot").to_owned(), robot.source.clone());
    loader.links(robot, &mut model);
    loader.joints(robot, &mut model);
    let is_tree = loader.build_tree(robot, &mut model);
    loader.extensions(robot, &mut model);
    loader.compare_elements(robot);
    if is_tree {
        loader.name_collisions(robot, &mut model);
        housing::report(&model, rules.gazebo_compat, loader.diagnostics);
        warn_of_hulls([&model], loader.diagnostics);
    }
    is_tree.then_some(model)
}

/// Returns true if the file is a robot's, and adds an error otherwise.
pub(super) fn is_robot(root: &Element, diagnostics: &mut Diagnostics) -> bool {
    if root.name != "robot" {
        let remedy = if root.name == "sdf" && root.child("model").is_some() {
            "give the file a name that ends with .sdf"
        } else {
            "a robot file begins with <robot>; a world is given with --world"
        };
        diagnostics.error(&root.source, format!("the outermost element is <{}>", root.name), remedy);
    }
    root.name == "robot"
}

impl Loader<'_> {
    /// Reports a missing file: an error, or a warning with `--gazebo-compat` or `--skip-missing`.
    fn missing(&mut self, source: &Source, what: impl Into<String>, remedy: impl Into<String>) {
        if self.rules.gazebo_compat || self.rules.skip_missing {
            self.diagnostics.warning(source, what, remedy);
        } else {
            self.diagnostics.error(source, what, remedy);
        }
    }

    /// Reports what is not simulated or unknown.
    fn compare_elements(&mut self, robot: &Element) {
        let extensions = robot.elements_named("gazebo").map(|extension| {
            let reference = extension.attribute("reference").filter(|name| !name.is_empty());
            let context = match reference {
                None => "gazebo_robot",
                Some(name) if self.link_names.contains_key(name) => "gazebo_link",
                Some(_) => "gazebo_joint",
            };
            (extension, context)
        });
        elements::report(std::iter::once((robot, "urdf_robot")).chain(extensions), self.diagnostics);
    }

    /// Returns the name of a link or joint; an error if it has none or its name is taken.
    fn unique_name<'s>(
        &mut self,
        element: &Element,
        taken: impl FnOnce(&Self, &str) -> Option<&'s Source>,
    ) -> Option<String> {
        let kind = &element.name;
        let Some(name) = element.attribute("name").filter(|name| !name.is_empty()) else {
            self.diagnostics.error(
                &element.source,
                format!("<{kind}> has no name"),
                format!("write <{kind} name=\"…\">"),
            );
            return None;
        };
        if let Some(first) = taken(self, name) {
            self.diagnostics.error(
                &element.source,
                format!("two {kind}s are called '{name}' (the first at {first})"),
                "rename one, or call the macro that makes it only once",
            );
            return None;
        }
        Some(name.to_owned())
    }
}
