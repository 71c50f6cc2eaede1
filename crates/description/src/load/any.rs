//! Loading a world, a robot or an object from a file, a name or a text that may be any of them.

use super::robot::{LoadOptions, is_bare, load_robot, not_found, robot_names};
use super::world::{load_world, world_names};
use crate::diagnostics::Diagnostics;
use crate::file;
use crate::model::{Model, World};
use crate::models::searched;
use crate::xml::Element;
use crate::{sdf, urdf, xacro};
use std::path::Path;

/// The result: a world or a model.
#[derive(Debug, Clone)]
#[allow(clippy::large_enum_variant, reason = "one per program: no collection stores many")]
pub enum Described {
    /// The `<world>` of an SDF file.
    World(World),
    /// A robot from URDF or xacro, or the one `<model>` of an SDF file.
    Model(Model),
}

/// Loads a file, or one of our own worlds and robots by its name. If a robot and a world have the same name, it is the robot.
///
/// # Errors
/// Problems are added to `diagnostics`; do not use what is returned if it has errors.
pub fn load(
    file_or_name: impl AsRef<Path>,
    options: &LoadOptions,
    diagnostics: &mut Diagnostics,
) -> Option<Described> {
    let path = file_or_name.as_ref();
    if is_bare(path) && path.extension().is_none() && !path.is_file() {
        let (robots, worlds) = (robot_names(&options.packages), world_names(&options.packages));
        let names = || robots.iter().chain(&worlds).map(String::as_str);
        if !file::is_there(path) && names().all(|name| path != Path::new(name)) {
            let listed =
                |names: &[String]| if names.is_empty() { "none found".into() } else { names.join(", ") };
            let otherwise = format!(
                "give the path of a .urdf, .xacro, .sdf or .world file, or the name of a robot ({}) or a world ({}), \
                 looked for in {}",
                listed(&robots),
                listed(&worlds),
                searched(&options.packages)
            );
            not_found(path, "robot or world", names(), &otherwise, diagnostics);
            return None;
        }
    }
    if is_world(path, options) {
        load_world(path, &options.packages, options.rules, diagnostics).map(Described::World)
    } else {
        load_robot(path, options, diagnostics).map(Described::Model)
    }
}

/// Reads the text of an SDF, URDF or xacro file. `name` stands for the file in problems; relative names in the text refer
/// to its folder.
///
/// # Errors
/// As [`load`].
pub fn load_text(
    text: &str,
    name: &str,
    options: &LoadOptions,
    diagnostics: &mut Diagnostics,
) -> Option<Described> {
    let path = Path::new(name);
    let LoadOptions { packages, rules, xacro_args } = options;
    let read = Element::parse(text, path).and_then(|root| match root.name.as_str() {
        "robot" => xacro::expand_root(root, path, packages, xacro_args, diagnostics),
        _ => Ok(root),
    });
    match read {
        Ok(root) if root.name == "robot" => {
            urdf::load_urdf(&root, packages, *rules, diagnostics).map(Described::Model)
        }
        Ok(root) if sdf::has_model(&root) && root.child("world").is_none() => {
            sdf::load_model(&root, packages, *rules, diagnostics).map(Described::Model)
        }
        Ok(root) => sdf::load_world(&root, packages, *rules, diagnostics).map(Described::World),
        Err(problem) => {
            diagnostics.add(problem);
            None
        }
    }
}

/// Returns true if it is a world: a file with a world in its first element, or else a name that only worlds have.
pub fn is_world(file_or_name: impl AsRef<Path>, options: &LoadOptions) -> bool {
    let path = file_or_name.as_ref();
    if path.is_file() {
        return match Element::parse_file(path) {
            // An SDF file of one model is a robot, or an object.
            Ok(root) => matches!(root.name.as_str(), "sdf" | "gazebo") && !sdf::has_model(&root),
            Err(_) => path.extension().is_some_and(|extension| extension == "world" || extension == "sdf"),
        };
    }
    let name = path.to_string_lossy();
    let name = name.as_ref();
    let stem = name.strip_suffix(".world").or(name.strip_suffix(".sdf")).unwrap_or(name);
    let has = |names: Vec<String>| names.iter().any(|name| name == stem);
    stem != name || (!has(robot_names(&options.packages)) && has(world_names(&options.packages)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rules;
    use crate::models::package_path;

    fn options() -> LoadOptions {
        LoadOptions {
            packages: package_path([], None),
            rules: Rules::default(),
            xacro_args: vec![("size".into(), "2".into())],
        }
    }

    #[test]
    fn names_of_robots_and_worlds_are_told_apart() {
        for (name, expected) in [
            ("kobuki_nostack_camera", false),
            ("tag_ceiling", true),
            ("playground.world", true),
            ("no_such_thing", false),
            ("no/such.urdf", false),
        ] {
            assert_eq!(is_world(name, &options()), expected, "{name}");
        }
    }

    #[test]
    fn a_name_that_nobody_has_is_told_what_is_near_of_both() {
        for (name, near) in [("playgrond", "playground"), ("kobuki_nostack_camra", "kobuki_nostack_camera")] {
            let mut diagnostics = Diagnostics::default();
            assert!(load(name, &options(), &mut diagnostics).is_none());
            let errors: Vec<String> = diagnostics.errors().map(ToString::to_string).collect();
            let says = format!("{name}: error: no such robot or world; did you mean '{near}'?");
            assert!(errors.len() == 1 && errors[0].starts_with(&says), "{errors:?}");
        }
    }

    #[test]
    fn texts_are_what_their_roots_say() {
        let load = |text: &str| {
            let mut diagnostics = Diagnostics::default();
            let loaded = load_text(text, "text", &options(), &mut diagnostics);
            let errors: Vec<String> = diagnostics.errors().map(ToString::to_string).collect();
            (loaded, errors.join("\n"))
        };
        let (world, errors) = load("<sdf version='1.6'><world name='w'><light name='l'/></world></sdf>");
        assert!(matches!(world, Some(Described::World(world)) if world.name == "w"), "{errors}");
        let (thing, errors) = load("<sdf version='1.6'><model name='m'><link name='l'/></model></sdf>");
        assert!(matches!(thing, Some(Described::Model(model)) if model.name == "m"), "{errors}");
        let (robot, errors) = load(
            "<robot name='r' xmlns:xacro='http://ros.org/wiki/xacro'><link name='b'><visual><geometry>\
             <sphere radius='${2*$(arg size)}'/></geometry></visual></link></robot>",
        );
        assert!(
            matches!(robot, Some(Described::Model(model)) if model.links[0].visuals.len() == 1),
            "{errors}"
        );
        assert!(load("<html/>").1.contains("<html>"));
        assert!(load("nothing").1.contains("text:1"));
    }
}
