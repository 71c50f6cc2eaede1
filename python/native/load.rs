//! Worlds and robots from files, names and texts.

use crate::errors::value_error;
use belvedere::description::load::{self, Described, LoadOptions};
use belvedere::description::models::package_path;
use belvedere::description::{Diagnostics, Problem, Rules, Severity};
use pyo3::PyResult;
use std::path::PathBuf;

/// Search paths of packages, and arguments of xacro.
pub(crate) struct Options {
    /// Folders of packages, searched first.
    pub(crate) package_path: Vec<PathBuf>,
    /// The folder of named worlds and robots, if the package contains one.
    pub(crate) models: PathBuf,
    /// Values of `$(arg name)`.
    pub(crate) xacro_args: Vec<(String, String)>,
}

impl Options {
    fn load_options(self) -> LoadOptions {
        let mut packages = package_path(self.package_path, std::env::var_os("ROS_PACKAGE_PATH").as_deref());
        if std::env::var_os("BELVEDERE_MODELS").is_none() && self.models.is_dir() {
            packages = packages.with_fallback(self.models);
        }
        LoadOptions { packages, rules: Rules::default(), xacro_args: self.xacro_args }
    }
}

/// Reads a file, a name, or a text, which begins with `<`. Also returns notes about ignored elements.
///
/// # Errors
/// The lines that the command line prints.
pub(crate) fn load(source: &str, options: Options) -> PyResult<(Described, Vec<String>)> {
    let options = options.load_options();
    let mut diagnostics = Diagnostics::default();
    let read = if source.trim_start().starts_with('<') {
        load::load_text(source, "text", &options, &mut diagnostics)
    } else {
        load::load(source, &options, &mut diagnostics)
    };
    match read {
        Some(read) if !diagnostics.has_errors() => Ok((read, warnings(diagnostics.problems()))),
        _ => Err(value_error(lines(diagnostics.problems(), Severity::Error).join("\n"))),
    }
}

/// Returns the warnings among problems, one line each.
pub(crate) fn warnings(problems: &[Problem]) -> Vec<String> {
    lines(problems, Severity::Warning)
}

fn lines(problems: &[Problem], severity: Severity) -> Vec<String> {
    problems.iter().filter(|problem| problem.severity == severity).map(ToString::to_string).collect()
}
