//! Barometers: `<air_pressure>`.

use super::instrument::InstrumentPlugin;
use super::reader::Reader;
use super::{Kind, SensorKind};
use crate::xml::Element;
use belvedere_sensors::noise::InstrumentConfig;

/// A barometer in the standard atmosphere.
#[derive(Debug, Clone, PartialEq)]
pub struct AirPressure {
    /// Errors of the pressure in Pa.
    pub pressure: InstrumentConfig<1>,
    /// Height of the world's origin above sea level in m.
    pub reference_altitude_m: f64,
    /// The plugin that publishes it.
    pub plugin: Option<InstrumentPlugin>,
}

pub(super) const KIND: Kind = Kind {
    types: &["air_pressure"],
    plugins: &[],
    is_extended: false,
    read: |reader, sensor| Some(SensorKind::AirPressure(reader.air_pressure(sensor)?.into())),
};

impl Reader<'_> {
    fn air_pressure(&mut self, sensor: &Element) -> Option<AirPressure> {
        let element = sensor.child("air_pressure");
        let is_height = |height: f64| (-10_000.0..=80_000.0).contains(&height);
        let remedy = "write metres above sea level, from -10000 to 80000";
        let reference = self.checked(element, "reference_altitude", 0.0, is_height, remedy);
        let pressure = self.quantity(element, "pressure");
        if let Some(element) = element {
            let names = ["reference_altitude", "pressure"];
            let remedy = "remove it: an air_pressure has reference_altitude, pressure";
            self.left_out(element, |name| names.contains(&name), remedy);
        }
        let plugin = self.instrument_plugin(sensor, &KIND);
        Some(AirPressure { pressure: pressure?, reference_altitude_m: reference?, plugin })
    }
}
