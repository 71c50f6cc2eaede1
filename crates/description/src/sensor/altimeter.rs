//! Altimeters: `<altimeter>`, the height above the start.

use super::instrument::InstrumentPlugin;
use super::reader::Reader;
use super::{Kind, SensorKind};
use crate::xml::Element;
use belvedere_sensors::noise::InstrumentConfig;

/// An altimeter.
#[derive(Debug, Clone, PartialEq)]
pub struct Altimeter {
    /// Errors of the height in m.
    pub position: InstrumentConfig<1>,
    /// Errors of the vertical velocity in m/s.
    pub velocity: InstrumentConfig<1>,
    /// The height that is subtracted, in m; none for the height at the start.
    pub reference_m: Option<f64>,
    /// The plugin that publishes it.
    pub plugin: Option<InstrumentPlugin>,
}

pub(super) const KIND: Kind = Kind {
    types: &["altimeter"],
    plugins: &[],
    is_extended: false,
    read: |reader, sensor| Some(SensorKind::Altimeter(reader.altimeter(sensor)?.into())),
};

impl Reader<'_> {
    fn altimeter(&mut self, sensor: &Element) -> Option<Altimeter> {
        let element = sensor.child("altimeter");
        let names = ["vertical_position", "vertical_velocity"];
        let [position, velocity] = names.map(|name| self.quantity(element, name));
        if let Some(element) = element {
            let remedy = format!("remove it: an altimeter has {}", names.join(", "));
            self.left_out(element, |name| names.contains(&name), &remedy);
        }
        let plugin = self.instrument_plugin(sensor, &KIND);
        Some(Altimeter { position: position?, velocity: velocity?, reference_m: None, plugin })
    }
}
