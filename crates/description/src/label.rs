//! Class labels, as in gz-sim's system `Label`.

use super::diagnostics::Diagnostics;
use super::values::child_number;
use super::xml::Element;

/// Returns true if a plugin is gz-sim's `Label`, under any of its former names.
pub(super) fn is_label(plugin: &Element) -> bool {
    let names =
        |attribute: &str, name: &str| plugin.attribute(attribute).is_some_and(|value| value.contains(name));
    names("filename", "label-system") || names("name", "systems::Label")
}

/// Reads the label of an element from its plugin `Label`: 0 to 255 in gz-sim, any number here.
pub(super) fn label(element: &Element, diagnostics: &mut Diagnostics) -> Option<u32> {
    let plugin = element.elements_named("plugin").find(|plugin| is_label(plugin))?;
    let Some(child) = plugin.child("label") else {
        diagnostics.error(
            &plugin.source,
            "the plugin Label has no <label>",
            "write <label>7</label> into it",
        );
        return None;
    };
    let label = child_number(plugin, "label", diagnostics)?;
    if label.fract() == 0.0 && (0.0..=f64::from(i32::MAX)).contains(&label) {
        return Some(label as u32);
    }
    diagnostics.error(&child.source, format!("<label> is {label}"), "write a whole number, 0 or more");
    None
}
