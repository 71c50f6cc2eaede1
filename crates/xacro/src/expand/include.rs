//! Other files, taken in where they are named.

use super::super::fault::Fault;
use super::super::scope::{Property, Scope};
use super::{Expander, Output};
use crate::diagnostics::{Problem, Source};
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
        let name = substituted.value.to_string();
        // A relative name counts from the file that it is written in.
        let mut path = PathBuf::from(name.trim());
        if let (true, Some(folder)) = (path.is_relative(), source.file.parent()) {
            path = folder.join(path);
        }
        if !path.is_file() {
            let optional = element.attribute("optional").is_some()
                && self.condition(element, "optional").map_err(|fault| self.problem(fault, source))?;
            if optional {
                return Ok(());
            }
            let fault = match substituted.package_file {
                Some((package, file)) => Fault::new(
                    format!("no file '{file}' in package '{package}', searched in {}", self.folders()),
                    "correct the name, or add the folder that has it with --package-path or ROS_PACKAGE_PATH",
                ),
                None => Fault::new(
                    format!("no file '{}' to include", path.display()),
                    "correct the name; it counts from the folder of the file that includes it",
                ),
            };
            return Err(self.problem(fault, source));
        }
        self.check_cycle(&path, source)?;
        let included = if let Some(parsed) = self.parsed.get(&path) {
            parsed.clone()
        } else {
            self.diagnostics.opened(&path);
            let parsed = Rc::new(Element::parse_file(&path)?);
            self.parsed.insert(path.clone(), parsed.clone());
            parsed
        };
        let namespace = element.attribute("ns").map(|_| self.required(element, "ns")).transpose()?;
        if namespace.is_some() {
            self.scopes.push(Scope::default());
        }
        self.files.push(path);
        let result = self.nodes(&included.children, &included.source, at_top, output);
        self.files.pop();
        result?;
        if let Some(namespace) = namespace {
            self.close_namespace(namespace);
        }
        Ok(())
    }

    /// A file may be included twice, but not by itself.
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
            "take one of these includes out, or put what both files need into a third",
        )
        .into_problem(source))
    }

    /// Evaluates what is still lazy, for its scope goes away, and stores the rest under its name.
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
