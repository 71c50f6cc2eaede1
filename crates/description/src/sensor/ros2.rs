//! Names in plugins of ROS 2: `<ros>` with a namespace and remappings, `<frame_name>`, `<camera_name>`.
//!
//! Names without a leading slash are under the namespace; names with `~/` are also under the plugin's own name.

use super::plugin::{absolute, plain_name};
use crate::values::child_text;
use crate::xml::Element;

/// Returns the absolute topic that a plugin calls `name`, and files may call one of `aliases`, after remapping.
pub(crate) fn topic(plugin: &Element, name: &str, aliases: &[&str]) -> String {
    let ros = plugin.child("ros");
    let namespace = ros.and_then(|ros| child_text(ros, "namespace")).unwrap_or_default();
    let own = plugin.attribute("name").unwrap_or(plain_name(plugin));
    let full = |name: &str| match name.strip_prefix("~/") {
        Some(name) => absolute(&[&namespace, own, name]),
        None if name.starts_with('/') => absolute(&[name]),
        None => absolute(&[&namespace, name]),
    };
    let named: Vec<String> = aliases.iter().chain([&name]).map(|name| full(name)).collect();
    // Before Foxy, a remapping was written as <argument>.
    let rules = ros.iter().flat_map(|ros| ros.elements());
    let rules =
        rules.filter(|rule| matches!(rule.name.as_str(), "remapping" | "argument")).map(Element::text);
    let mut remapped = rules.filter_map(|rule| {
        let (from, to) = rule.split_once(":=")?;
        named.contains(&full(from.trim())).then(|| full(to.trim()))
    });
    remapped.next().unwrap_or_else(|| full(name))
}

/// Returns `<frame_name>`; an empty name means the sensor's link.
pub(super) fn frame_name(plugin: &Element) -> String {
    child_text(plugin, "frame_name").unwrap_or_default()
}
