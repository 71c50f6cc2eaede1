//! The files that a robot names.

use super::{Loader, TEXTURE};
use crate::diagnostics::{Diagnostics, Source};
use crate::file;
use crate::package::{Found, PackagePath};
use crate::xml::{Element, Node};
use percent_encoding::{AsciiSet, CONTROLS, percent_decode_str, utf8_percent_encode};
use std::path::{Path, PathBuf};

/// Characters that must be escaped in the path of a URL.
const NOT_IN_PATHS: &AsciiSet = &CONTROLS
    .add(b' ')
    .add(b'"')
    .add(b'#')
    .add(b'%')
    .add(b'<')
    .add(b'>')
    .add(b'?')
    .add(b'[')
    .add(b'\\')
    .add(b']')
    .add(b'^')
    .add(b'`')
    .add(b'{')
    .add(b'|')
    .add(b'}');

/// The form of a file name.
enum Named<'n> {
    /// `package://PACKAGE/…` and `model://PACKAGE/…`.
    InPackage { package: &'n str, relative: &'n str },
    /// `file:///…`, or a path relative to the file that contains it.
    At(PathBuf),
    /// An unsupported scheme.
    Elsewhere(&'n str),
}

impl<'n> Named<'n> {
    fn of(name: &'n str, named_in: &Element) -> Self {
        match name.split_once("://") {
            Some(("package" | "model", rest)) => {
                let (package, relative) = rest.split_once('/').unwrap_or((rest, ""));
                Self::InPackage { package, relative }
            }
            Some(("file", rest)) => {
                Self::At(percent_decode_str(rest).decode_utf8_lossy().into_owned().into())
            }
            Some((scheme, _)) => Self::Elsewhere(scheme),
            None => Self::At(named_in.source.file.parent().unwrap_or(Path::new("")).join(name)),
        }
    }
}

/// Replaces the names of all meshes and textures of an expanded robot by `file:///` URLs, which ROS finds without our
/// package path and without the robot's source files. Names of missing files are kept, with a warning.
pub(super) fn name_files_absolutely(
    robot: &mut Element,
    packages: &PackagePath,
    diagnostics: &mut Diagnostics,
) {
    let is_named = matches!(robot.name.as_str(), "mesh" | "texture");
    if let Some(name) = robot.attribute("filename").filter(|_| is_named) {
        let path = match Named::of(name, robot) {
            Named::InPackage { package, relative } => {
                packages.find_file(package, relative).map(|found| found.path)
            }
            Named::At(path) => Some(path),
            Named::Elsewhere(_) => None,
        };
        match path.filter(|path| path.is_file()).and_then(|path| file_url(&path)) {
            Some(url) => robot.attributes.iter_mut().filter(|(key, _)| key == "filename").for_each(|(_, value)| {
                value.clone_from(&url);
            }),
            None => diagnostics.warning(
                &robot.source,
                format!("there is no {} '{name}'", robot.name),
                "the name is kept; correct it, or add the folder that holds the package with --package-path or ROS_PACKAGE_PATH",
            ),
        }
    }
    for child in &mut robot.children {
        // Extensions for Gazebo name no files of the robot.
        if let Node::Element(child) = child
            && child.name != "gazebo"
        {
            name_files_absolutely(child, packages, diagnostics);
        }
    }
}

fn file_url(path: &Path) -> Option<String> {
    let path = std::path::absolute(path).ok()?;
    Some(format!("file://{}", utf8_percent_encode(path.to_str()?, NOT_IN_PATHS)))
}

impl Loader<'_> {
    /// Returns the existing file that `name` refers to: `package://PACKAGE/…` and `model://PACKAGE/…` in a package,
    /// `file:///…` as an absolute path, everything else relative to the file that contains `element`. `what` names the
    /// kind of file in errors.
    pub(super) fn file(&mut self, element: &Element, name: &str, what: &str) -> Option<PathBuf> {
        let (path, looked_for) = match Named::of(name, element) {
            Named::InPackage { package, relative } => {
                let found = self.packages.find_file(package, relative);
                if let Some(Found { missing_in: Some(lacking), .. }) = &found {
                    self.diagnostics.note(
                        &element.source,
                        format!("{} has no {relative}: the file of our package is used", lacking.display()),
                        "",
                    );
                }
                let places: Vec<PathBuf> =
                    self.packages.folders().map(|folder| folder.join(package).join(relative)).collect();
                (found.map(|found| found.path), file::list(&places))
            }
            Named::At(path) => {
                let shown = file::list(std::slice::from_ref(&path));
                (Some(path), shown)
            }
            Named::Elsewhere(scheme) => {
                let problem = format!("the {what} '{name}' cannot be fetched: '{scheme}://' is unsupported");
                self.lacking(&element.source, what, problem, "download it and write package://PACKAGE/FILE");
                return None;
            }
        };
        let found = path.filter(|path| path.is_file());
        if found.is_none() {
            self.lacking(
                &element.source,
                what,
                format!("there is no {what} '{name}': looked for {looked_for}"),
                "correct the path, or add the folder that holds the package with --package-path or ROS_PACKAGE_PATH",
            );
        }
        found
    }

    /// Reports a missing file. Without its texture, a surface is still there.
    fn lacking(&mut self, source: &Source, what: &str, problem: String, remedy: &str) {
        if what == TEXTURE {
            let problem = format!("{problem}; the surface is drawn without it");
            self.diagnostics.warning(source, problem, remedy);
        } else {
            self.missing(source, problem, remedy);
        }
    }
}
