//! Rangefinders: a cone of beams, of which the nearest counts (`libgazebo_ros_range.so`).

use super::plugin::topic;
use super::reader::Reader;
use super::{Kind, SensorKind};
use crate::description::model::{Radiation, RangePlugin, RaySensor};
use crate::description::values::child_text;
use crate::description::xml::Element;

/// A sonar or infrared rangefinder.
#[derive(Debug, Clone, PartialEq)]
pub struct Rangefinder {
    /// The beams that fill its cone.
    pub ray: RaySensor,
    /// What publishes it.
    pub plugin: Option<RangePlugin>,
}

pub(super) const KIND: Kind = Kind {
    types: &["ray", "gpu_ray"],
    plugins: &["gazebo_ros_range"],
    presets: &[],
    read: |reader, sensor| reader.rangefinder(sensor).map(SensorKind::Range),
};

impl Reader<'_> {
    fn rangefinder(&mut self, sensor: &Element) -> Option<Rangefinder> {
        let mut ray = self.ray(sensor)?;
        let plugin = self.plugin(sensor, &KIND).and_then(|plugin| self.range_plugin(plugin, &mut ray));
        Some(Rangefinder { ray, plugin })
    }

    fn range_plugin(&mut self, plugin: &Element, ray: &mut RaySensor) -> Option<RangePlugin> {
        self.add_noise(plugin, ray)?;
        self.plugin_rate_hz = self.rate(plugin, "updateRate")?;
        let is_angle = |angle: f64| (0.0..=std::f64::consts::TAU).contains(&angle);
        Some(RangePlugin {
            topic: topic(plugin, "", "topicName", "/range"),
            frame_name: child_text(plugin, "frameName").unwrap_or_else(|| "/world".into()),
            // Whatever is not the one is the other there.
            radiation: match child_text(plugin, "radiation").as_deref() {
                None | Some("ultrasound") => Radiation::Ultrasound,
                Some(_) => Radiation::Infrared,
            },
            field_of_view_rad: self.checked(
                Some(plugin),
                "fov",
                0.05,
                is_angle,
                "write the full angle in radians, from 0 to 6.2832",
            )?,
        })
    }
}
