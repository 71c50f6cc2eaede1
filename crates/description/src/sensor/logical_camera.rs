//! Logical cameras: `<logical_camera>`, which names the models in a frustum.

use super::gz::{frame_name, gz_topic};
use super::instrument::InstrumentPlugin;
use super::reader::Reader;
use super::{Kind, SensorKind, ros2};
use crate::values::child_text;
use crate::xml::Element;
use std::f64::consts::PI;

/// A sensor that reports which models are in a frustum, and their poses. It looks along its x.
#[derive(Debug, Clone, PartialEq)]
pub struct LogicalCamera {
    /// Distance of the frustum's front in m.
    pub near_m: f64,
    /// Distance of its back in m.
    pub far_m: f64,
    /// Its full horizontal angle.
    pub horizontal_fov_rad: f64,
    /// Its width divided by its height.
    pub aspect_ratio: f64,
    /// The plugin that publishes it.
    pub plugin: Option<InstrumentPlugin>,
}

pub(super) const KIND: Kind = Kind {
    types: &["logical_camera"],
    plugins: &["gazebo_ros_logical_camera"],
    is_extended: false,
    read: |reader, sensor| Some(SensorKind::Logical(reader.logical_camera(sensor)?.into())),
};

impl Reader<'_> {
    fn logical_camera(&mut self, sensor: &Element) -> Option<LogicalCamera> {
        let element = sensor.child("logical_camera");
        let above = |value: f64| value > 0.0;
        let near = self.checked(element, "near", 0.0, |near| near >= 0.0, "write metres, 0 or more");
        let far = self.checked(element, "far", 1.0, above, "write metres above 0");
        let is_angle = |angle: f64| angle > 0.0 && angle < PI;
        let remedy = "write the full angle in radians, above 0 and below 3.1416";
        let fov = self.checked(element, "horizontal_fov", 1.0, is_angle, remedy);
        let aspect = self.checked(element, "aspect_ratio", 1.0, above, "write width over height, above 0");
        let plugin = self.logical_plugin(sensor);
        let (near_m, far_m) = (near?, far?);
        if near_m >= far_m {
            let what = format!("sensor '{}' has <near> {near_m} and <far> {far_m}", self.sensor);
            let place = Self::place(element, "far", sensor);
            self.diagnostics.error(place, what, "write <near> below <far>, in metres");
            return None;
        }
        Some(LogicalCamera { near_m, far_m, horizontal_fov_rad: fov?, aspect_ratio: aspect?, plugin })
    }

    /// Returns ROS 2's plugin, whose topic is the sensor's, or the names of a sensor without a plugin.
    fn logical_plugin(&mut self, sensor: &Element) -> Option<InstrumentPlugin> {
        let frame_name = frame_name(sensor);
        let Some(plugin) = self.plugin(sensor, &KIND) else {
            return gz_topic(sensor).map(|topic| InstrumentPlugin { topic, frame_name });
        };
        self.left_out(plugin, |name| name == "ros", "remove it, or correct its name");
        let written = child_text(sensor, "topic").filter(|topic| !topic.is_empty());
        let topic = ros2::topic(plugin, written.as_deref().unwrap_or(&self.sensor), &[]);
        Some(InstrumentPlugin { topic, frame_name })
    }
}
