//! Checks that the parts of a model or world have different names, and names that are allowed.

use super::model::ParsedModel;
use super::{Loader, Version, name_of};
use crate::diagnostics::Source;
use crate::xml::Element;
use std::collections::HashMap;

/// Returns true if libsdformat reserves the name.
fn is_reserved(name: &str) -> bool {
    name == "world" || name.len() >= 4 && name.starts_with("__") && name.ends_with("__")
}

impl Loader<'_> {
    /// Checks that no name of a file is reserved, and that none contains `::`, which from SDF 1.8 on stands between the
    /// names of a model and of its part.
    pub(super) fn check_every_name(&mut self, root: &Element, version: Version) {
        if version < (1, 7) {
            return;
        }
        let mut left = vec![root];
        while let Some(parent) = left.pop() {
            // What a plugin contains is its own affair.
            for child in parent.elements().filter(|child| child.name != "plugin" && !child.name.contains(':'))
            {
                let name = child.attribute("name").unwrap_or_default();
                let kind = child.name.as_str();
                if matches!(kind, "world" | "model" | "visual" | "collision" | "sensor" | "light") {
                    self.check_reserved(kind, name, &child.source);
                }
                if name.contains("::") && version >= (1, 8) {
                    let what = format!("the {} is called '{name}', and no name may contain ::", child.name);
                    self.diagnostics.error(&child.source, what, "rename it");
                }
                left.push(child);
            }
        }
    }

    /// Adds an error if the name is reserved, and returns true.
    fn check_reserved(&mut self, kind: &str, name: &str, source: &Source) -> bool {
        if is_reserved(name) {
            let what = format!("the {kind} is called '{name}', which SDF keeps for frames of its own");
            self.diagnostics.error(source, what, "rename it");
        }
        is_reserved(name)
    }

    /// Checks the names of links, joints, frames and models of one parent. From SDF 1.7 on they must differ, because a frame
    /// is referred to by its name alone.
    pub(super) fn check_names(&mut self, parent: &Element, models: &[ParsedModel], version: Version) {
        if version < (1, 7) {
            return;
        }
        let mut seen: HashMap<String, (&str, Source)> = models
            .iter()
            .filter(|inner| !inner.is_merged)
            .map(|inner| (inner.model.name.clone(), ("model", inner.model.source.clone())))
            .collect();
        for model in models.iter().map(|inner| &inner.model) {
            self.check_reserved("model", &model.name, &model.source);
        }
        for child in parent.elements() {
            let kind = child.name.as_str();
            let name = name_of(child);
            if kind == "frame" && name.is_empty() {
                self.diagnostics.error(&child.source, "<frame> has no name", "write <frame name=\"…\">");
            }
            if !matches!(kind, "link" | "joint" | "frame") || name.is_empty() {
                continue;
            }
            if self.check_reserved(kind, &name, &child.source) {
                continue;
            }
            match seen.get(&name) {
                // Two links or joints of the same name are reported by `own_name`.
                Some((other, _)) if *other == kind && kind != "frame" => {}
                Some((other, place)) => {
                    let other = if *other == kind { "another frame".into() } else { format!("a {other}") };
                    let what = format!("the {kind} '{name}' has the name of {other} here (at {place})");
                    self.diagnostics.error(
                        &child.source,
                        what,
                        "rename one: links, joints, frames and models in one place need different names",
                    );
                }
                None => {
                    seen.insert(name, (kind, child.source.clone()));
                }
            }
        }
    }
}
