//! Magnetometers: `<magnetometer>`, in the `<magnetic_field>` of the world.

use super::instrument::InstrumentPlugin;
use super::noise::instrument;
use super::reader::Reader;
use super::{Kind, SensorKind};
use crate::xml::Element;
use belvedere_sensors::noise::InstrumentConfig;
use glam::DVec3;

/// A three-axis magnetometer.
#[derive(Debug, Clone, PartialEq)]
pub struct Magnetometer {
    /// Errors of its axes, in the unit of the field.
    pub axes: InstrumentConfig<3>,
    /// The field, if the plugin has its own, in the plugin's unit.
    pub field: Option<PluginField>,
    /// The plugin that publishes it.
    pub plugin: Option<InstrumentPlugin>,
}

/// The field that Team Hector's plugin specifies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PluginField {
    /// The field along the world's axes.
    pub in_world: DVec3,
    /// True if it is published as a plain vector, whose unit need not be tesla.
    pub is_vector: bool,
}

pub(super) const KIND: Kind = Kind {
    types: &["magnetometer"],
    plugins: &[],
    is_extended: false,
    read: |reader, sensor| Some(SensorKind::Magnetometer(reader.magnetometer(sensor)?.into())),
};

impl Reader<'_> {
    fn magnetometer(&mut self, sensor: &Element) -> Option<Magnetometer> {
        let element = sensor.child("magnetometer");
        let names = ["x", "y", "z"];
        let [x, y, z] = names.map(|name| self.noise_in(element, name));
        if let Some(element) = element {
            self.left_out(element, |name| names.contains(&name), "remove it: a magnetometer has x, y, z");
        }
        let plugin = self.instrument_plugin(sensor, &KIND);
        Some(Magnetometer { axes: instrument([x?, y?, z?]), field: None, plugin })
    }
}
