//! How plugins of ROS 2 are told names: `<ros>` with a namespace and remappings, `<frame_name>`, `<camera_name>`.
//!
//! Names without a slash before them lie under the namespace, those with `~/` under the plugin's own name as well.

use super::plugin::{absolute, plain_name};
use crate::values::child_text;
use crate::xml::Element;

/// What only plugins of ROS 2 are told.
const MARKS: [&str; 4] = ["ros", "frame_name", "camera_name", "output_type"];

/// Whether a plugin is written for ROS 2.
pub(super) fn is_ros2(plugin: &Element) -> bool {
    MARKS.iter().any(|mark| plugin.child(mark).is_some())
}

/// The absolute topic that a plugin calls `name`, and files may call one of `aliases`, remapped if they say so.
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
    // Before Foxy, a remapping was an <argument>.
    let rules = ros.iter().flat_map(|ros| ros.elements());
    let rules =
        rules.filter(|rule| matches!(rule.name.as_str(), "remapping" | "argument")).map(Element::text);
    let mut remapped = rules.filter_map(|rule| {
        let (from, to) = rule.split_once(":=")?;
        named.contains(&full(from.trim())).then(|| full(to.trim()))
    });
    remapped.next().unwrap_or_else(|| full(name))
}

/// `<frame_name>`; the sensor's link if this is empty.
pub(super) fn frame_name(plugin: &Element) -> String {
    child_text(plugin, "frame_name").unwrap_or_default()
}
