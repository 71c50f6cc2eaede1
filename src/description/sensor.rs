//! `<sensor>` as SDF defines it, in SDF links and in URDF's `<gazebo reference>`.

use super::diagnostics::Diagnostics;
use super::model::{LinkIndex, Sensor};
use super::xml::Element;

/// Reads a `<sensor>` with its plugin. A sensor of a type that is not simulated gives none and a warning.
pub fn parse_sensor(sensor: &Element, link: LinkIndex, diagnostics: &mut Diagnostics) -> Option<Sensor> {
    let _ = link;
    diagnostics.error(&sensor.source, "sensors cannot be read yet", "");
    None
}
