//! Common parts of instruments: a topic, a frame, and a noise for each quantity.

use super::Kind;
use super::gz::{frame_name, gz_topic};
use super::noise::instrument;
use super::reader::Reader;
use super::ros2;
use crate::model::Noise;
use crate::xml::Element;
use belvedere_sensors::noise::InstrumentConfig;

/// The plugin that publishes an instrument.
#[derive(Debug, Clone, PartialEq)]
pub struct InstrumentPlugin {
    /// Topic. Without a leading slash, it is under the model's namespace, or under its name if it has no namespace.
    pub topic: String,
    /// The frame that messages name; empty for the sensor's link.
    pub frame_name: String,
}

impl Reader<'_> {
    /// Returns the plugin that publishes an instrument: its plugin of ROS 2, or one made from its `<topic>`.
    pub(super) fn instrument_plugin(&mut self, sensor: &Element, kind: &Kind) -> Option<InstrumentPlugin> {
        if let Some(plugin) = self.plugin(sensor, kind) {
            return Some(ros2_names(plugin));
        }
        gz_topic(sensor).map(|topic| InstrumentPlugin { topic, frame_name: frame_name(sensor) })
    }

    /// Reads the instrument of one quantity from the `<noise>` in the child element `name`.
    pub(super) fn quantity(&mut self, parent: Option<&Element>, name: &str) -> Option<InstrumentConfig<1>> {
        Some(instrument([self.noise_in(parent, name)?]))
    }

    /// Reads the `<noise>` in the child element `name`.
    pub(super) fn noise_in(&mut self, parent: Option<&Element>, name: &str) -> Option<Noise> {
        match parent.and_then(|parent| parent.child(name)) {
            Some(element) => self.drifting_noise(element),
            None => Some(Noise::default()),
        }
    }
}

/// Returns the topic and frame of a plugin of ROS 2. The topic is `~/out`, under the plugin's name, unless it is remapped.
pub(super) fn ros2_names(plugin: &Element) -> InstrumentPlugin {
    InstrumentPlugin { topic: ros2::topic(plugin, "~/out", &[]), frame_name: ros2::frame_name(plugin) }
}
