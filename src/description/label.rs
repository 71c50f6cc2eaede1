//! Classes of things, as gz-sim's system `Label` has them.

use super::Loader;
use crate::description::values::child_number;
use crate::description::xml::Element;

/// Whether a plugin is gz-sim's `Label`, under any of the names that it has had.
pub(super) fn is_label(plugin: &Element) -> bool {
    let names =
        |attribute: &str, name: &str| plugin.attribute(attribute).is_some_and(|value| value.contains(name));
    names("filename", "label-system") || names("name", "systems::Label")
}

impl Loader<'_> {
    /// The label of a visual or a model: of its plugin `Label`, 0 to 255 there and any number here.
    pub(super) fn label(&mut self, element: &Element) -> Option<u32> {
        let plugin = element.elements().find(|child| child.name == "plugin" && is_label(child))?;
        let label = child_number(plugin, "label", self.diagnostics)?;
        if label.fract() == 0.0 && (0.0..=f64::from(i32::MAX)).contains(&label) {
            return Some(label as u32);
        }
        let source = plugin.child("label").map_or(&plugin.source, |child| &child.source);
        self.diagnostics.error(source, format!("<label> is {label}"), "write a whole number, 0 or more");
        None
    }
}
