//! `<plugin>` of a sensor: the plugin that publishes it, and its names.

use super::reader::Reader;
use super::ros_version::is_ros2_camera;
use super::{KINDS, Kind, each_once};
use crate::elements::report_plugin;
use crate::suggestion::nearest;
use crate::topic as topics;
use crate::values::child_text;
use crate::xml::Element;

/// The file name of our own plugin.
const OWN: &str = "belvedere";

impl Reader<'_> {
    /// Returns the first plugin of a sensor that can publish its kind, with warnings for the others.
    pub(super) fn plugin<'e>(&mut self, sensor: &'e Element, kind: &Kind) -> Option<&'e Element> {
        topics::check(sensor, self.diagnostics);
        let mut chosen = None;
        for element in sensor.elements_named("plugin") {
            if kind.is_extended && is_ours(element) {
                continue;
            }
            let file = element.attribute("filename").unwrap_or_default();
            let name = plain_name(element);
            if kind.plugins.contains(&name) {
                if chosen.is_none() {
                    topics::check(element, self.diagnostics);
                    report_plugin(element, context(element), self.diagnostics);
                    chosen = Some(element);
                    continue;
                }
                self.diagnostics.warning(
                    &element.source,
                    format!("sensor '{}' has a second plugin, '{file}', which is left out", self.sensor),
                    "make a second sensor for it",
                );
            } else if KINDS.iter().any(|kind| kind.plugins.contains(&name)) {
                let written = sensor.attribute("type").unwrap_or_default();
                self.diagnostics.error(
                    &element.source,
                    format!(
                        "the plugin '{file}' does not go with sensor '{}' of type {written}",
                        self.sensor
                    ),
                    match kind.plugins.first() {
                        Some(plugin) => format!("use lib{plugin}.so, or change the type of the sensor"),
                        None => "write a <topic> in its place, or change the type of the sensor".into(),
                    },
                );
            } else {
                let names = each_once(KINDS.iter().flat_map(|kind| kind.plugins).copied());
                let near = nearest(name, names.iter().copied());
                // A name unlike all known ones is not a misspelling.
                let near = near.filter(|near| strsim::damerau_levenshtein(name, near) <= near.len() / 4);
                let near = near.map(|near| format!("did you mean lib{near}.so? ")).unwrap_or_default();
                let plugins: Vec<String> = names.iter().map(|name| format!("lib{name}.so")).collect();
                self.diagnostics.warning(
                    &element.source,
                    format!(
                        "the plugin '{file}' of sensor '{}' is not simulated and is left out",
                        self.sensor
                    ),
                    format!("{near}these are: {}", plugins.join(", ")),
                );
            }
        }
        chosen
    }
}

/// Returns the plugin's name in the tables of elements.
fn context(plugin: &Element) -> &str {
    match plain_name(plugin) {
        "gazebo_ros_camera" if is_ros2_camera(plugin) => "gazebo_ros_camera_ros2",
        name => name,
    }
}

/// Returns our own plugin, which holds parameters for which SDF has no elements.
pub(super) fn extension(sensor: &Element) -> Option<&Element> {
    sensor.elements_named("plugin").find(|plugin| is_ours(plugin))
}

/// Returns true if a plugin is our own.
pub(super) fn is_ours(plugin: &Element) -> bool {
    plain_name(plugin) == OWN
}

/// Returns a plugin's file name without folder, `lib` and `.so`, which Gazebo itself adds if they are missing.
pub(super) fn plain_name(plugin: &Element) -> &str {
    let file = plugin.attribute("filename").unwrap_or_default();
    let name = file.rsplit('/').next().unwrap_or(file);
    let name = name.strip_prefix("lib").unwrap_or(name);
    name.strip_suffix(".so").unwrap_or(name)
}

/// Returns the absolute topic in the child element `name`: unchanged if it begins with a slash, else under
/// `<robotNamespace>` and the camera's name.
pub(super) fn topic(plugin: &Element, camera_name: &str, name: &str, default: &str) -> String {
    let topic = child_text(plugin, name).unwrap_or_else(|| default.into());
    if topic.starts_with('/') {
        return topic;
    }
    let namespace = child_text(plugin, "robotNamespace").unwrap_or_default();
    absolute(&[&namespace, camera_name, &topic])
}

/// Joins parts to an absolute topic.
pub(super) fn absolute(parts: &[&str]) -> String {
    let mut absolute = String::new();
    for part in parts {
        let part = part.trim_matches('/');
        if !part.is_empty() {
            absolute.push('/');
            absolute.push_str(part);
        }
    }
    absolute
}
