//! `<preset>` of our own plugin in a sensor: the device that the sensor is. Gazebo ignores it.

use super::reader::Reader;
use crate::suggestion::did_you_mean_or;
use crate::values::child_text;
use crate::xml::Element;

impl Reader<'_> {
    /// Reads the `<preset>` of our plugin, which must be one of these names; none after an error.
    pub(super) fn preset_name(&mut self, own: &Element, names: &[&'static str]) -> Option<&'static str> {
        let written = child_text(own, "preset").unwrap_or_default();
        if let Some(name) = names.iter().find(|name| **name == written) {
            return Some(name);
        }
        let what = if written.is_empty() {
            format!("the plugin 'belvedere' of sensor '{}' has no <preset>", self.sensor)
        } else {
            format!("{} is '{written}', which does not exist", self.what("preset"))
        };
        let there = format!("choose from {}", names.join(", "));
        let remedy = did_you_mean_or(&written, names.iter().copied(), &there);
        self.diagnostics.error(Self::place(Some(own), "preset", own), what, remedy);
        None
    }
}
