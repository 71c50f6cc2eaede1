//! `<plugin filename="belvedere"><preset>NAME</preset></plugin>` of a sensor, which is ours, and which Gazebo goes on
//! without: the device that it is.

use super::Kind;
use super::reader::Reader;
use crate::description::values::{child_text, nearest};
use crate::description::xml::Element;

/// The `filename` of our plugin.
const FILE: &str = "belvedere";

/// Whether a plugin is ours.
pub(super) fn is_ours(plugin: &Element) -> bool {
    plugin.attribute("filename") == Some(FILE)
}

impl Reader<'_> {
    /// The name of the preset that a sensor asks for; the inner none means that it asks for none.
    #[expect(clippy::option_option, reason = "outer: readable; inner: there")]
    pub(super) fn sensor_preset(&mut self, sensor: &Element, kind: &Kind) -> Option<Option<&'static str>> {
        let Some(plugin) = sensor.elements_named("plugin").find(|plugin| is_ours(plugin)) else {
            return Some(None);
        };
        self.left_out(plugin, |name| name == "preset", "take it out: the plugin of belvedere has preset");
        let written = child_text(plugin, "preset").unwrap_or_default();
        if let Some(name) = kind.presets.iter().find(|name| **name == written) {
            return Some(Some(name));
        }
        let what = if written.is_empty() {
            format!("the plugin '{FILE}' of sensor '{}' has no <preset>", self.sensor)
        } else {
            format!("{} is '{written}', which is none", self.what("preset"))
        };
        let near = nearest(&written, kind.presets.iter().copied());
        let meant = near.map_or(String::new(), |near| format!("did you mean {near}? "));
        let remedy = format!("{meant}there are {}", kind.presets.join(", "));
        self.diagnostics.error(Self::place(Some(plugin), "preset", plugin), what, remedy);
        None
    }
}
