//! The registry of sensors: the running behaviour of each kind. How files describe them is in `description/sensor`.

use super::channel::Channel;
use super::report::Say;
use super::{Opening, RigError, Settings};
use crate::description::model::{Sensor, SensorKind};

/// The behaviour of a kind of sensor. To add a kind, implement this trait in a new file and add a row below.
pub(super) trait Behaviour {
    /// Returns the kind's name for reports.
    fn name(&self) -> &'static str;

    /// Opens its streams. Returns `None` if the sensor has no plugin that publishes it.
    ///
    /// # Errors
    /// If the sink cannot open a stream, or the description cannot be used.
    fn open(&self, sensor: &Sensor, opening: &Opening<'_>) -> Result<Option<Box<dyn Channel>>, RigError>;

    /// Returns the settings that can be changed while it runs, with this rate.
    fn settings(&self, rate_hz: f64) -> Settings;

    /// Reports its parameters, except pose and rate.
    fn report(&self, gazebo_compat: bool, say: Say<'_>);
}

/// Returns the behaviour of a sensor; each kind has a row here.
pub(super) fn behaviour(sensor: &Sensor) -> &dyn Behaviour {
    match &sensor.kind {
        SensorKind::Camera(camera) => camera,
        SensorKind::Depth(depth) => depth,
        SensorKind::Ray(lidar) => lidar,
        SensorKind::Range(range) => range,
        SensorKind::Imu(imu) => &**imu,
        SensorKind::NavSat(receiver) => &**receiver,
        SensorKind::Magnetometer(magnetometer) => &**magnetometer,
        SensorKind::Altimeter(altimeter) => &**altimeter,
        SensorKind::AirPressure(barometer) => &**barometer,
        SensorKind::ForceTorque(sensor) => &**sensor,
        SensorKind::Contact(sensor) => &**sensor,
        SensorKind::Logical(camera) => &**camera,
    }
}
