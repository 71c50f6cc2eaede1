//! `libgazebo_ros_ray_sensor.so`, which publishes lidars in ROS 2.

use crate::model::{CloudLayout, LaserPlugin};
use crate::sensor::reader::Reader;
use crate::sensor::ros2;
use crate::values::child_text;
use crate::xml::Element;

/// The values of its `<output_type>`.
const OUTPUTS: [&str; 4] =
    ["sensor_msgs/LaserScan", "sensor_msgs/PointCloud2", "sensor_msgs/PointCloud", "sensor_msgs/Range"];

impl Reader<'_> {
    /// Reads the plugin: a scan, or a cloud by default.
    pub(super) fn ray_sensor_plugin(&mut self, plugin: &Element) -> Option<LaserPlugin> {
        let output = child_text(plugin, "output_type").unwrap_or_else(|| OUTPUTS[1].into());
        let place = Self::place(Some(plugin), "output_type", plugin);
        let is_cloud = match OUTPUTS.iter().position(|known| *known == output) {
            Some(0) => false,
            Some(1) => true,
            Some(2) => {
                let what =
                    format!("{} is {output}: it is published as {}", self.what("output_type"), OUTPUTS[1]);
                self.diagnostics.warning(place, what, "write sensor_msgs/PointCloud2");
                true
            }
            Some(_) => {
                let what =
                    format!("{} is {output}: it is published as {}", self.what("output_type"), OUTPUTS[0]);
                let remedy = "write sensor_msgs/LaserScan, or publish it by libgazebo_ros_range.so";
                self.diagnostics.warning(place, what, remedy);
                false
            }
            None => {
                let what = format!("{} is {output}", self.what("output_type"));
                self.diagnostics.error(place, what, format!("write one of {}", OUTPUTS.join(", ")));
                return None;
            }
        };
        let min_intensity = self.number(Some(plugin), "min_intensity", f64::NEG_INFINITY)?;
        Some(LaserPlugin {
            topic: ros2::topic(plugin, "~/out", &[]),
            frame_name: ros2::frame_name(plugin),
            cloud: is_cloud.then_some(CloudLayout { is_organized: false, min_intensity }),
            points_topic: None,
        })
    }
}
