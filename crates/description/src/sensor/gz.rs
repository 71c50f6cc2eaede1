//! Sensors of gz-sim: they have a `<topic>` and no plugin, and publish under the names that gz-sim's bridge to ROS sees.

use super::plugin::{absolute, is_ours};
use crate::values::child_text;
use crate::xml::Element;

/// Whether a sensor publishes as those of gz-sim do: no plugin but ours.
pub(super) fn is_gz(sensor: &Element) -> bool {
    sensor.elements_named("plugin").all(is_ours) && child_text(sensor, "topic").is_some()
}

/// The absolute topic of such a sensor.
pub(super) fn gz_topic(sensor: &Element) -> Option<String> {
    Some(absolute(&[&child_text(sensor, "topic")?]))
}

/// The frame that its messages name; the sensor's link if this is empty.
pub(super) fn frame_name(sensor: &Element) -> String {
    let names = ["gz_frame_id", "ignition_frame_id", "frame_id"];
    names.into_iter().find_map(|name| child_text(sensor, name)).unwrap_or_default()
}
