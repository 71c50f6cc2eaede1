//! Loading of a single model from a text, for adding it to a running world, and of a world from a text, as in a recording.

use crate::diagnostics::Diagnostics;
use crate::model::{Model, World};
use crate::package::PackagePath;
use crate::rules::Rules;
use crate::xml::Element;
use crate::{sdf, urdf};
use std::path::Path;

/// Reads a model from the text of a URDF (`<robot>`, xacro already expanded) or SDF file (`<sdf>` with one `<model>`).
/// `name` stands for the file in problems.
///
/// For an SDF model, [`Model::world_from_model`] is its own `<pose>`; for a URDF model it is the identity.
///
/// # Errors
/// Problems are added to `diagnostics`; do not use a model that is returned if it has errors.
pub fn load_model_text(
    text: &str,
    name: &str,
    packages: &PackagePath,
    rules: Rules,
    diagnostics: &mut Diagnostics,
) -> Option<Model> {
    match Element::parse(text, Path::new(name)) {
        Ok(root) if root.name == "robot" => urdf::load_urdf(&root, packages, rules, diagnostics),
        Ok(root) => sdf::load_model(&root, packages, rules, diagnostics),
        Err(problem) => {
            diagnostics.add(problem);
            None
        }
    }
}

/// Reads the first world of the text of an SDF file. `name` stands for the file in problems, and relative paths in the world
/// refer to its folder.
///
/// # Errors
/// As [`load_model_text`].
pub fn load_world_text(
    text: &str,
    name: &str,
    packages: &PackagePath,
    rules: Rules,
    diagnostics: &mut Diagnostics,
) -> Option<World> {
    match Element::parse(text, Path::new(name)) {
        Ok(root) => sdf::load_world(&root, packages, rules, diagnostics),
        Err(problem) => {
            diagnostics.add(problem);
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::package_path;

    fn load(text: &str) -> (Option<Model>, String) {
        let mut diagnostics = Diagnostics::default();
        let model =
            load_model_text(text, "crate", &package_path([], None), Rules::default(), &mut diagnostics);
        let errors: Vec<String> = diagnostics.errors().map(ToString::to_string).collect();
        (model, errors.join("\n"))
    }

    #[test]
    fn urdf_and_sdf_are_told_apart() {
        let (urdf, errors) = load("<robot name='u'><link name='base'/></robot>");
        assert_eq!((urdf.unwrap().name.as_str(), errors.as_str()), ("u", ""));
        let (sdf, errors) = load(
            "<sdf version='1.6'><model name='s'><pose>1 2 3 0 0 0</pose><static>true</static><link name='l'/></model></sdf>",
        );
        let sdf = sdf.unwrap();
        assert_eq!((sdf.name.as_str(), sdf.is_static, errors.as_str()), ("s", true, ""));
        assert_eq!(sdf.world_from_model.translation().to_array(), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn what_is_no_model_is_named() {
        assert!(load("<robot name='u'>").1.starts_with("crate:1: error: broken XML"));
        assert!(load("<html/>").1.contains("<html>"));
        assert!(load("<sdf version='1.6'><world name='w'/></sdf>").1.contains("give the world with --world"));
        assert!(load("<sdf version='1.6'/>").1.contains("0 <model> elements"));
        assert!(load("").1.contains("broken XML"));
    }
}
