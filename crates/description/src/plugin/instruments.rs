//! Instruments as plugins of a model: Team Hector's receiver, magnetometer and barometer, `RotorS`'s barometer.

use super::parameters::Parameters;
use crate::model::{
    AirPressure, Altimeter, InstrumentPlugin, Magnetometer, NavSat, PluginField, Sensor, SensorKind,
};
use belvedere_sensors::Pose;
use belvedere_sensors::noise::InstrumentConfig;
use glam::DVec3;

/// Reads `libhector_gazebo_ros_gps.so`. Its headings are a compass's: 0 has the world's x to the north, 90 to the east.
pub(super) fn gps(given: &mut Parameters<'_>) -> Option<Sensor> {
    let (position, velocity) = (given.hector_noise::<3>(""), given.hector_noise::<3>("velocity"));
    let is_of_world = given.flag(&["useWorldSphericalCoordinates"], false);
    let is_latitude = |value: f64| (-90.0..=90.0).contains(&value);
    let latitude = given.number(&["referenceLatitude"], 49.9, is_latitude, "write degrees from -90 to 90");
    let [longitude, heading, altitude] =
        [("referenceLongitude", 8.9), ("referenceHeading", 0.0), ("referenceAltitude", 0.0)]
            .map(|(name, default)| given.number(&[name], default, |_| true, ""));
    let rate_hz = given.rate(&["updateRate"], 4.0);
    let velocity_topic = given.topic(&["velocityTopicName"], "fix_velocity");
    let topic = given.topic(&["topicName"], "fix");
    let frame_name = given.text(&["frameId"]).unwrap_or_else(|| "/world".into());
    let link = given.link(&["bodyName"], "base_link");
    let x_from_east = (90.0 - heading?).to_radians();
    let origin = [latitude?, longitude?, altitude?, x_from_east];
    let receiver = NavSat {
        position: position?,
        velocity: velocity?,
        origin: (!is_of_world).then_some(origin),
        plugin: Some(InstrumentPlugin { topic, frame_name }),
        velocity_topic: Some(velocity_topic),
    };
    Some(given.sensor(link, Pose::IDENTITY, rate_hz?, SensorKind::NavSat(receiver.into())))
}

/// Reads `libhector_gazebo_ros_magnetic.so`, which has its own field, of length 1 by default.
pub(super) fn magnetic(given: &mut Parameters<'_>) -> Option<Sensor> {
    let axes = given.hector_noise::<3>("");
    let magnitude = given.not_negative(&["magnitude"], 1.0);
    let [heading, declination, inclination] =
        [("referenceHeading", 0.0), ("declination", 0.0), ("inclination", 60.0)]
            .map(|(name, default)| Some(given.number(&[name], default, |_| true, "")?.to_radians()));
    let is_field = given.flag(&["useMagneticFieldMsgs"], false);
    let rate_hz = given.rate(&["updateRate"], 0.0);
    let topic = given.topic(&["topicName"], "magnetic");
    let frame_name = given.text(&["frameId"]).unwrap_or_default();
    let link = given.link(&["bodyName"], "base_link");
    let (from_x, inclination) = (heading? - declination?, inclination?);
    let across = magnitude? * libm::cos(inclination);
    let in_world = DVec3::new(
        across * libm::cos(from_x),
        across * libm::sin(from_x),
        -magnitude? * libm::sin(inclination),
    );
    let magnetometer = Magnetometer {
        axes: axes?,
        field: Some(PluginField { in_world, is_vector: !is_field }),
        plugin: Some(InstrumentPlugin { topic, frame_name }),
    };
    Some(given.sensor(link, Pose::IDENTITY, rate_hz?, SensorKind::Magnetometer(magnetometer.into())))
}

/// Reads `libhector_gazebo_ros_baro.so`, which publishes a height computed from the pressure.
pub(super) fn baro(given: &mut Parameters<'_>) -> Option<Sensor> {
    let position = given.hector_noise::<1>("");
    let rate_hz = given.rate(&["updateRate"], 0.0);
    let topic = given.topic(&["topicName"], "pressure_height");
    let frame_name = given.text(&["frameId"]).unwrap_or_default();
    let link = given.link(&["bodyName"], "base_link");
    let altimeter = Altimeter {
        position: position?,
        velocity: InstrumentConfig::default(),
        reference_m: Some(0.0),
        plugin: Some(InstrumentPlugin { topic, frame_name }),
    };
    Some(given.sensor(link, Pose::IDENTITY, rate_hz?, SensorKind::Altimeter(altimeter.into())))
}

/// Reads `librotors_gazebo_pressure_plugin.so`.
pub(super) fn pressure(given: &mut Parameters<'_>) -> Option<Sensor> {
    let variance = given.not_negative(&["pressureVariance"], 0.0);
    let is_height = |height: f64| (-10_000.0..=80_000.0).contains(&height);
    let remedy = "write metres above sea level, from -10000 to 80000";
    let reference = given.number(&["referenceAltitude"], 500.0, is_height, remedy);
    let topic = given.topic(&["pressureTopic"], "air_pressure");
    let link = given.link(&["linkName"], "base_link");
    let barometer = AirPressure {
        pressure: InstrumentConfig::default().stddev([libm::sqrt(variance?)]),
        reference_altitude_m: reference?,
        plugin: Some(InstrumentPlugin { topic, frame_name: String::new() }),
    };
    Some(given.sensor(link, Pose::IDENTITY, None, SensorKind::AirPressure(barometer.into())))
}
