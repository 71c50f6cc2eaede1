//! Satellite navigation receivers: `<gps>`, `<navsat>`.

use super::instrument::InstrumentPlugin;
use super::noise::instrument;
use super::reader::Reader;
use super::{Kind, SensorKind};
use crate::xml::Element;
use belvedere_sensors::noise::InstrumentConfig;

/// A satellite navigation receiver.
#[derive(Debug, Clone, PartialEq)]
pub struct NavSat {
    /// Errors of the position along the world's axes in m.
    pub position: InstrumentConfig<3>,
    /// Errors of the velocity along the world's axes in m/s.
    pub velocity: InstrumentConfig<3>,
    /// Origin of the world, if the plugin has its own: latitude and longitude in degrees, height in m, angle from east to the
    /// world's x in rad.
    pub origin: Option<[f64; 4]>,
    /// The plugin that publishes it.
    pub plugin: Option<InstrumentPlugin>,
    /// Topic of the velocity alone, as Team Hector's plugin publishes it: x to the north, y to the west, z up.
    pub velocity_topic: Option<String>,
}

pub(super) const KIND: Kind = Kind {
    types: &["navsat", "gps"],
    plugins: &["gazebo_ros_gps_sensor"],
    is_extended: false,
    read: |reader, sensor| Some(SensorKind::NavSat(reader.navsat(sensor)?.into())),
};

/// The elements of its two quantities.
const PARTS: [&str; 2] = ["position_sensing", "velocity_sensing"];

impl Reader<'_> {
    fn navsat(&mut self, sensor: &Element) -> Option<NavSat> {
        let receiver = sensor.child("navsat").or_else(|| sensor.child("gps"));
        let [position, velocity] = PARTS.map(|name| {
            let part = receiver.and_then(|receiver| receiver.child(name));
            let horizontal = self.noise_in(part, "horizontal")?;
            let vertical = self.noise_in(part, "vertical")?;
            Some(instrument([horizontal, horizontal, vertical]))
        });
        if let Some(receiver) = receiver {
            let remedy = format!("remove it: a receiver has {}", PARTS.join(", "));
            self.left_out(receiver, |name| PARTS.contains(&name), &remedy);
        }
        let plugin = self.instrument_plugin(sensor, &KIND);
        Some(NavSat { position: position?, velocity: velocity?, origin: None, plugin, velocity_topic: None })
    }
}
