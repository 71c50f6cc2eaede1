//! Loading of worlds, robots and models in one call, for simple programs: packages are looked for in
//! `ROS_PACKAGE_PATH` and then among our own, warnings are logged, and errors are returned.

use super::robot::{LoadOptions, load_robot};
use super::text::load_model_text;
use super::world::load_world;
use crate::diagnostics::{Diagnostics, Problem, Severity};
use crate::model::{Model, World};
use crate::models::package_path;
use crate::package::PackagePath;
use crate::rules::Rules;
use std::fmt;

/// All errors in a description, one per line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Errors(pub Vec<Problem>);

impl fmt::Display for Errors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines: Vec<String> = self.0.iter().map(ToString::to_string).collect();
        f.write_str(&lines.join("\n"))
    }
}

impl std::error::Error for Errors {}

/// Loads a world from an SDF file, or one of ours by its name.
///
/// ```
/// let world = belvedere_description::load::world("corridor")?;
/// assert_eq!(world.name, "corridor");
/// assert!(belvedere_description::load::world("no_such").unwrap_err().to_string().contains("corridor"));
/// # Ok::<(), belvedere_description::load::Errors>(())
/// ```
///
/// # Errors
/// All errors in the world.
pub fn world(file_or_name: &str) -> Result<World, Errors> {
    finish(|diagnostics| load_world(file_or_name, &packages(), Rules::default(), diagnostics))
}

/// Loads a robot from a URDF or xacro file, or one of ours by its name.
///
/// # Errors
/// All errors in the robot.
pub fn robot(file_or_name: &str) -> Result<Model, Errors> {
    let options = LoadOptions { packages: packages(), rules: Rules::default(), xacro_args: Vec::new() };
    finish(|diagnostics| load_robot(file_or_name, &options, diagnostics))
}

/// Loads a model from the text of a URDF or SDF file.
///
/// # Errors
/// All errors in the model.
pub fn model(text: &str) -> Result<Model, Errors> {
    finish(|diagnostics| load_model_text(text, "text", &packages(), Rules::default(), diagnostics))
}

fn packages() -> PackagePath {
    package_path([], std::env::var_os("ROS_PACKAGE_PATH").as_deref())
}

fn finish<T>(load: impl FnOnce(&mut Diagnostics) -> Option<T>) -> Result<T, Errors> {
    let mut diagnostics = Diagnostics::default();
    let loaded = load(&mut diagnostics);
    for problem in diagnostics.problems().iter().filter(|problem| problem.severity == Severity::Warning) {
        tracing::warn!("{problem}");
    }
    let errors: Vec<Problem> = diagnostics.errors().cloned().collect();
    loaded.filter(|_| errors.is_empty()).ok_or(Errors(errors))
}
