//! `<sensor>` as SDF defines it, in SDF links and in URDF's `<gazebo reference>`.
//!
//! A kind of sensor is a file here, with a row in `KINDS`, a variant of [`SensorKind`], and one in `rig` (`rig/behaviour.rs`).
//! Defaults are those of sdf/1.6 and of the plugins of `gazebo_plugins` (ROS Noetic).

mod air_pressure;
mod altimeter;
mod camera;
mod camera_plugin;
mod contact;
mod depth;
mod device;
mod force_torque;
pub(crate) mod gz;
mod imu;
mod imu_profile;
mod instrument;
mod lens;
mod lidar;
mod logical_camera;
mod magnetometer;
mod navsat;
mod noise;
mod plugin;
mod preset;
mod range;
mod reader;
pub(crate) mod ros2;
mod ros_version;
#[cfg(test)]
mod tests;

pub use air_pressure::AirPressure;
pub use altimeter::Altimeter;
pub use camera::Camera;
pub use contact::ContactSensor;
pub(crate) use contact::Known;
pub use depth::DepthCamera;
pub use force_torque::{ForceTorque, MeasureFrame};
pub(crate) use force_torque::{JointMount, is_on_joint, parse_joint_sensor};
pub use imu::{Imu, OrientationReference};
pub use imu_profile::ImuProfile;
pub use instrument::InstrumentPlugin;
pub use lidar::{BeamPhysics, Lidar, PacketProfile, choices};
pub use logical_camera::LogicalCamera;
pub use magnetometer::{Magnetometer, PluginField};
pub use navsat::NavSat;
pub use range::Rangefinder;

use super::diagnostics::{Diagnostics, Source};
use super::model::{LinkIndex, RaySensor};
use super::rules::Rules;
use super::values::child_bool;
use super::xml::Element;
use belvedere_sensors::Pose;
use plugin::plain_name;
use reader::Reader;
use std::collections::HashSet;

/// A sensor on a link, or on a joint.
#[derive(Debug, Clone)]
pub struct Sensor {
    /// Name in the file.
    pub name: String,
    /// The link it is fixed to; of one on a joint, the link in whose axes it measures.
    pub link: LinkIndex,
    /// Pose of the sensor in its link; the sensor looks along its x, z is up.
    pub link_from_sensor: Pose,
    /// `<always_on>`.
    pub always_on: bool,
    /// Rate of the sensor itself in Hz; none means every physics step.
    pub update_rate_hz: Option<f64>,
    /// Rate of the plugin that publishes it, in Hz; none if it has none.
    pub plugin_rate_hz: Option<f64>,
    /// Kind and parameters, with the plugin that publishes it.
    pub kind: SensorKind,
    /// File and line that define it.
    pub source: Source,
}

impl Sensor {
    /// Returns the rate in Hz of images and infos: the lower of the sensor's and its plugin's; none means every
    /// physics step.
    pub fn effective_rate_hz(&self) -> Option<f64> {
        match (self.update_rate_hz, self.plugin_rate_hz) {
            (Some(sensor), Some(plugin)) => Some(sensor.min(plugin)),
            (one, other) => one.or(other),
        }
    }
}

/// The kind of a sensor, with its parameters and the plugin that publishes it.
#[derive(Debug, Clone)]
pub enum SensorKind {
    /// Colour camera.
    Camera(Camera),
    /// Depth camera with a colour camera at the same place.
    Depth(DepthCamera),
    /// Lidar.
    Ray(Lidar),
    /// Sonar or infrared rangefinder.
    Range(Rangefinder),
    /// Inertial measurement unit.
    Imu(Box<Imu>),
    /// Satellite navigation receiver.
    NavSat(Box<NavSat>),
    /// Magnetometer.
    Magnetometer(Box<Magnetometer>),
    /// Altimeter.
    Altimeter(Box<Altimeter>),
    /// Barometer.
    AirPressure(Box<AirPressure>),
    /// Sensor of the force and torque in a joint.
    ForceTorque(Box<ForceTorque>),
    /// Sensor of what touches a link.
    Contact(Box<ContactSensor>),
    /// Sensor of which models are in a frustum.
    Logical(Box<LogicalCamera>),
}

impl SensorKind {
    /// Returns the rays along which it measures, if it does. They start inside it, so it looks through a housing around it.
    pub fn ray(&self) -> Option<&RaySensor> {
        match self {
            Self::Ray(lidar) => Some(&lidar.ray),
            Self::Range(rangefinder) => Some(&rangefinder.ray),
            _ => None,
        }
    }
}

/// A kind of sensor in files.
struct Kind {
    /// The types of its `<sensor>`, of Gazebo classic and of gz-sim.
    types: &'static [&'static str],
    /// The plugins that publish it, without `lib` and `.so`, the usual one first.
    plugins: &'static [&'static str],
    /// True if `<plugin filename="belvedere">` has more parameters for it, our extension.
    is_extended: bool,
    /// Reads its parameters and the chosen plugin; none after an error.
    read: fn(&mut Reader<'_>, &Element) -> Option<SensorKind>,
}

impl Kind {
    /// Returns true if a `<sensor>` has one of its types.
    fn has_type(&self, sensor: &Element) -> bool {
        self.types.contains(&sensor.attribute("type").unwrap_or_default())
    }
}

/// All kinds. If several have the same type, the plugin decides; without one it is the first.
static KINDS: [Kind; 12] = [
    camera::KIND,
    depth::KIND,
    lidar::KIND,
    range::KIND,
    imu::KIND,
    navsat::KIND,
    magnetometer::KIND,
    altimeter::KIND,
    air_pressure::KIND,
    force_torque::KIND,
    contact::KIND,
    logical_camera::KIND,
];

/// Reads a `<sensor>` with its plugin. A sensor of an unsupported type gives none and a warning; a sensor
/// with wrong values gives none and an error for each. `link_from_sensor` is its `<pose>`.
pub fn parse_sensor(
    sensor: &Element,
    link: LinkIndex,
    link_from_sensor: Pose,
    rules: Rules,
    diagnostics: &mut Diagnostics,
) -> Option<Sensor> {
    let name = named(sensor, diagnostics)?;
    let Some(kind) = kind_of(sensor) else {
        let written = sensor.attribute("type").unwrap_or_default();
        let what = if written.is_empty() { "no type".into() } else { format!("the type '{written}'") };
        let types = each_once(KINDS.iter().flat_map(|kind| kind.types).copied());
        diagnostics.warning(
            &sensor.source,
            format!("the sensor '{name}' has {what}, which is not simulated: it is left out"),
            format!("use one of these types: {}", types.join(", ")),
        );
        return None;
    };
    if is_on_joint(sensor) {
        let what =
            format!("the sensor '{name}' of type 'force_torque' is on a link: it is left out, as in Gazebo");
        diagnostics.warning(&sensor.source, what, "put it on a joint");
        return None;
    }
    read_sensor(sensor, kind, link, link_from_sensor, rules, diagnostics)
}

/// Reads a `<sensor>` of a known kind.
fn read_sensor(
    sensor: &Element,
    kind: &Kind,
    link: LinkIndex,
    link_from_sensor: Pose,
    rules: Rules,
    diagnostics: &mut Diagnostics,
) -> Option<Sensor> {
    let name = named(sensor, diagnostics)?;
    let mut reader = Reader { sensor: name.clone(), plugin_rate_hz: None, rules, diagnostics };
    let read = (kind.read)(&mut reader, sensor);
    let update_rate_hz = reader.rate(sensor, "update_rate");
    let plugin_rate_hz = reader.plugin_rate_hz;
    let mut read = Sensor {
        name,
        link,
        link_from_sensor,
        always_on: child_bool(sensor, "always_on", diagnostics).unwrap_or(false),
        update_rate_hz: update_rate_hz?,
        plugin_rate_hz,
        kind: read?,
        source: sensor.source.clone(),
    };
    camera::warn_of_long_readout(&read, sensor, diagnostics);
    lidar::turn(&mut read, sensor, diagnostics)?;
    Some(read)
}

/// Returns the name of a `<sensor>`; none and an error if it has none.
fn named(sensor: &Element, diagnostics: &mut Diagnostics) -> Option<String> {
    let name = sensor.attribute("name").filter(|name| !name.is_empty());
    if name.is_none() {
        diagnostics.error(&sensor.source, "<sensor> has no name", "write <sensor name=\"…\" type=\"…\">");
    }
    name.map(str::to_owned)
}

/// Returns the words in their order, without repetitions.
fn each_once(words: impl Iterator<Item = &'static str>) -> Vec<&'static str> {
    let mut seen = HashSet::new();
    words.filter(|word| seen.insert(*word)).collect()
}

/// Returns the kind that has the type of a `<sensor>`.
fn kind_of(sensor: &Element) -> Option<&'static Kind> {
    let has_type = || KINDS.iter().filter(|kind| kind.has_type(sensor));
    let has_plugin = |kind: &&Kind| {
        let mut plugins = sensor.elements_named("plugin");
        plugins.any(|plugin| kind.plugins.contains(&plain_name(plugin)))
    };
    has_type().find(has_plugin).or_else(|| has_type().next())
}
