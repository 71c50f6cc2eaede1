//! Checks that the parts of a model or world have different names.

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
        for child in parent.elements() {
            let kind = child.name.as_str();
            let name = name_of(child);
            if !matches!(kind, "link" | "joint" | "frame") || name.is_empty() {
                continue;
            }
            if is_reserved(&name) {
                let what = format!("the {kind} is called '{name}', which SDF keeps for frames of its own");
                self.diagnostics.error(&child.source, what, "rename it");
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
