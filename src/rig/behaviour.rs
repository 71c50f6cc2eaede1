//! The registry of sensors: what each kind is when it runs. How files write it is in `description/sensor`.

use super::channel::Channel;
use super::report::Say;
use super::{Opening, RigError, Settings};
use crate::description::model::{Sensor, SensorKind};

/// A kind of sensor, as its description makes it. To add one: a row below, and this in a file of its own.
pub(super) trait Behaviour {
    /// What people call it.
    fn name(&self) -> &'static str;

    /// Opens its streams; none if nothing publishes it.
    ///
    /// # Errors
    /// When the sink cannot, or the description cannot be used.
    fn open(&self, sensor: &Sensor, opening: &Opening<'_>) -> Result<Option<Box<dyn Channel>>, RigError>;

    /// What of it can be changed while it runs, at this rate.
    fn settings(&self, rate_hz: f64) -> Settings;

    /// Tells its parameters, but for place and rate.
    fn report(&self, gazebo_compat: bool, say: Say<'_>);
}

/// The kinds, a row each.
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
    }
}
