//! The files that a robot names.

use super::Loader;
use crate::description::xml::Element;
use std::path::{Path, PathBuf};

impl Loader<'_> {
    /// The existing file that `name` means: `package://PACKAGE/…` and `model://PACKAGE/…` in a package,
    /// `file:///…` as it stands, everything else relative to the file that `element` was written in. `what`
    /// names it in errors.
    pub(super) fn file(&mut self, element: &Element, name: &str, what: &str) -> Option<PathBuf> {
        let (path, looked_for) = match name.split_once("://") {
            Some(("package" | "model", rest)) => {
                let (package, relative) = rest.split_once('/').unwrap_or((rest, ""));
                let found = self.packages.find_file(package, relative);
                if let Some(lacking) = found.as_ref().and_then(|found| found.missing_in.as_ref()) {
                    self.diagnostics.note(
                        &element.source,
                        format!("{} has no {relative}: it is taken from our package", lacking.display()),
                        "",
                    );
                }
                let folders: Vec<String> =
                    self.packages.folders().map(|folder| folder.join(rest).display().to_string()).collect();
                (found.map(|found| found.path), folders.join(", "))
            }
            Some(("file", rest)) => (Some(PathBuf::from(rest)), rest.to_owned()),
            Some((scheme, _)) => {
                self.missing(
                    &element.source,
                    format!("the {what} '{name}' cannot be fetched: '{scheme}://' is not read"),
                    "download it and write package://PACKAGE/FILE",
                );
                return None;
            }
            None => {
                let path = element.source.file.parent().unwrap_or(Path::new("")).join(name);
                let shown = path.display().to_string();
                (Some(path), shown)
            }
        };
        let found = path.filter(|path| path.is_file());
        if found.is_none() {
            self.missing(
                &element.source,
                format!("there is no {what} '{name}': looked for {looked_for}"),
                "correct the path, or add the folder that holds the package with --package-path or ROS_PACKAGE_PATH",
            );
        }
        found
    }
}
