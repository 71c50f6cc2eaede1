//! Inclusion of other files.

use super::super::fault::Fault;
use super::super::scope::{Property, Scope};
use super::wildcards::{is_pattern, matching};
use super::{Expander, Output};
use crate::diagnostics::{Problem, Source};
use crate::functions::printed;
use crate::xml::Element;
use std::path::{Path, PathBuf};
use std::rc::Rc;

impl Expander<'_> {
    pub(super) fn include(
        &mut self,
        element: &Element,
        at_top: bool,
        output: &mut Output,
    ) -> Result<(), Problem> {
        let source = &element.source;
        let text = element.attribute("filename").ok_or_else(|| {
            self.problem(Fault::new("an include without a file", "add filename=\"…\""), source)
        })?;
        let substituted = self
            .substitute(text, self.scopes.len() - 1, source)
            .map_err(|fault| self.problem(fault, source))?;
        let name = printed(&substituted.value).map_err(|fault| self.problem(fault, source))?;
        // As in xacro, a relative name is resolved against the folder of the file that is being expanded. In a macro,
        // this is not the file that contains the text.
        let path = self.beside_file(name.trim());
        let paths = if is_pattern(name.trim()) {
            let found = matching(&path).map_err(|fault| self.problem(fault, source))?;
            if found.is_empty() {
                let what = format!("no file matches '{}'", path.display());
                self.diagnostics.warning(source, what, "correct the pattern, or leave the include out");
            }
            found
        } else if path.is_file() {
            vec![path]
        } else {
            let optional = element.attribute("optional").is_some()
                && self.condition(element, "optional").map_err(|fault| self.problem(fault, source))?;
            if optional {
                return Ok(());
            }
            return Err(self.problem(self.missing(&path, substituted.package_file), source));
        };
        let namespace = element.attribute("ns").map(|_| self.required(element, "ns")).transpose()?;
        if namespace.is_some() {
            self.scopes.push(Scope::default());
        }
        for path in paths {
            self.file(path, source, at_top, output)?;
        }
        if let Some(namespace) = namespace {
            self.close_namespace(namespace);
        }
        Ok(())
    }

    fn missing(&self, path: &Path, package_file: Option<(String, String)>) -> Fault {
        match package_file {
            Some((package, file)) => Fault::new(
                format!("no file '{file}' in package '{package}', searched in {}", self.folders()),
                "correct the name, or add the folder that has it with --package-path or ROS_PACKAGE_PATH",
            ),
            None => Fault::new(
                match crate::file::obstacle(path) {
                    Some(why) => format!("the file '{}' to include cannot be read: {why}", path.display()),
                    None => format!("no file '{}' to include", path.display()),
                },
                "correct the name; it is relative to the folder of the file that is being expanded, also in a macro",
            ),
        }
    }

    /// Expands one file.
    fn file(
        &mut self,
        path: PathBuf,
        source: &Source,
        at_top: bool,
        output: &mut Output,
    ) -> Result<(), Problem> {
        self.check_cycle(&path, source)?;
        let included = if let Some(parsed) = self.parsed.get(&path) {
            parsed.clone()
        } else {
            self.diagnostics.opened(&path);
            let parsed = Rc::new(Element::parse_file(&path)?);
            self.parsed.insert(path.clone(), parsed.clone());
            parsed
        };
        self.files.push(path);
        let result = self.nodes(&included.children, &included.source, at_top, output);
        self.files.pop();
        result
    }

    /// Checks that a file does not include itself, directly or indirectly. Including it twice is allowed.
    fn check_cycle(&self, path: &Path, source: &Source) -> Result<(), Problem> {
        let canonical = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
        let target = canonical(path);
        let Some(start) = self.files.iter().position(|file| canonical(file) == target) else {
            return Ok(());
        };
        let chain: Vec<_> = self.files[start..]
            .iter()
            .map(PathBuf::as_path)
            .chain([path])
            .map(|p| p.display().to_string())
            .collect();
        Err(Fault::new(
            format!("include cycle: {}", chain.join(" → ")),
            "remove one of these includes, or move what both files need into a third file",
        )
        .into_problem(source))
    }

    /// Evaluates the lazy properties of a namespace, whose scope ends, and stores the namespace under its name.
    fn close_namespace(&mut self, name: String) {
        let top = self.scopes.len() - 1;
        let names: Vec<_> = self.scopes[top].properties.keys().cloned().collect();
        for property in names {
            if let Err(fault) = self.property(&property, top) {
                self.scopes[top].properties.insert(property, Property::Broken(fault));
            }
        }
        if let Some(scope) = self.scopes.pop() {
            self.top().namespaces.insert(name, Rc::new(scope));
        }
    }
}
