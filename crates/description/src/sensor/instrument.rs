//! What instruments have in common: a topic and a frame, and a noise for each quantity.

use super::Kind;
use super::gz::{frame_name, gz_topic};
use super::noise::instrument;
use super::reader::Reader;
use super::ros2;
use crate::model::Noise;
use crate::xml::Element;
use belvedere_sensors::noise::InstrumentConfig;

/// What publishes an instrument.
#[derive(Debug, Clone, PartialEq)]
pub struct InstrumentPlugin {
    /// Topic. Without a slash before it, it is under the model's namespace, or, where there is none, under its name.
    pub topic: String,
    /// The frame that messages name; empty for the sensor's link.
    pub frame_name: String,
}

impl Reader<'_> {
    /// What publishes an instrument: its plugin of ROS 2, or its `<topic>`.
    pub(super) fn instrument_plugin(&mut self, sensor: &Element, kind: &Kind) -> Option<InstrumentPlugin> {
        if let Some(plugin) = self.plugin(sensor, kind) {
            let read = ["ros", "frame_name", "alwaysOn", "updateRate"];
            self.left_out(plugin, |name| read.contains(&name), "take it out, or correct its name");
            return Some(ros2_names(plugin));
        }
        gz_topic(sensor).map(|topic| InstrumentPlugin { topic, frame_name: frame_name(sensor) })
    }

    /// The instrument of one quantity, whose `<noise>` is in the child element of that name.
    pub(super) fn quantity(&mut self, parent: Option<&Element>, name: &str) -> Option<InstrumentConfig<1>> {
        Some(instrument([self.noise_in(parent, name)?]))
    }

    /// The `<noise>` in the child element of that name.
    pub(super) fn noise_in(&mut self, parent: Option<&Element>, name: &str) -> Option<Noise> {
        match parent.and_then(|parent| parent.child(name)) {
            Some(element) => self.drifting_noise(element),
            None => Some(Noise::default()),
        }
    }
}

/// In ROS 2 the topic is `~/out`, under the plugin's name, unless it is remapped.
pub(super) fn ros2_names(plugin: &Element) -> InstrumentPlugin {
    InstrumentPlugin { topic: ros2::topic(plugin, "~/out", &[]), frame_name: ros2::frame_name(plugin) }
}
