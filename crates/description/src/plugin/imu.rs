//! Inertial units as plugins of a model: `libgazebo_ros_imu.so`, `libhector_gazebo_ros_imu.so`,
//! `librotors_gazebo_imu_plugin.so`.

use super::parameters::Parameters;
use crate::model::{Imu, InstrumentPlugin, Sensor, SensorKind};
use belvedere_sensors::imu::{ImuConfig, presets};
use belvedere_sensors::noise::InstrumentConfig;

/// Names of the parameter that names the link.
const BODY: [&str; 2] = ["bodyName", "body_name"];

pub(super) fn imu(given: &mut Parameters<'_>) -> Option<Sensor> {
    let stddev = given.not_negative(&["gaussianNoise", "gaussian_noise"], 0.0);
    let white = stddev.map(|stddev| InstrumentConfig::default().stddev([stddev; 3]));
    let config = white.map(|white| ImuConfig::default().gyro(white).accelerometer(white));
    unit(given, &BODY, config.as_ref())
}

/// Reads Team Hector's plugin, which many robots have. Each triad and the heading has a mean, a drifting bias and white noise.
pub(super) fn hector(given: &mut Parameters<'_>) -> Option<Sensor> {
    let (gyro, accelerometer) = (given.hector_noise("rate"), given.hector_noise("accel"));
    let heading = given.hector_noise("yaw");
    let both = given.not_negative(&["gaussianNoise"], 0.0);
    let config = gyro.zip(accelerometer).map(|(mut gyro, mut accelerometer)| {
        if let Some(both) = both.filter(|both| *both > 0.0) {
            (gyro.stddev, accelerometer.stddev) = ([both; 3], [both; 3]);
        }
        ImuConfig::default().gyro(gyro).accelerometer(accelerometer)
    });
    let mut sensor = unit(given, &BODY, config.as_ref())?;
    if let SensorKind::Imu(unit) = &mut sensor.kind {
        unit.heading = heading?;
    }
    Some(sensor)
}

/// Reads the plugin of the simulator `RotorS`, whose default figures are those of an ADIS16448.
pub(super) fn rotors(given: &mut Parameters<'_>) -> Option<Sensor> {
    let preset = presets::adis16448();
    let gyro = densities(given, "gyroscope", &preset.gyro);
    let accelerometer = densities(given, "accelerometer", &preset.accelerometer);
    let config = gyro
        .zip(accelerometer)
        .map(|(gyro, accelerometer)| ImuConfig::default().gyro(gyro).accelerometer(accelerometer));
    unit(given, &["linkName"], config.as_ref())
}

/// Reads the noise densities of a triad.
fn densities(
    given: &mut Parameters<'_>,
    triad: &str,
    preset: &InstrumentConfig<3>,
) -> Option<InstrumentConfig<3>> {
    let mut figure = |names: &[&str], default: f64| {
        let names: Vec<String> = names.iter().map(|name| format!("{triad}{name}")).collect();
        given.not_negative(&names.iter().map(String::as_str).collect::<Vec<_>>(), default)
    };
    let density = figure(&["NoiseDensity"], preset.density[0]);
    // The plugin reads the gyroscope's with Bias, and files of RotorS write it without.
    let walk = figure(&["BiasRandomWalk", "RandomWalk"], preset.drift[0]);
    let bias = figure(&["TurnOnBiasSigma"], preset.bias_stddev[0]);
    let time_s = given.positive(&[&format!("{triad}BiasCorrelationTime")], preset.drift_time_s[0]);
    let config = InstrumentConfig::default().density([density?; 3]).drift([walk?; 3]);
    Some(config.bias_stddev([bias?; 3]).drift_time_s([time_s?; 3]))
}

fn unit(given: &mut Parameters<'_>, body: &[&str], config: Option<&ImuConfig>) -> Option<Sensor> {
    let link = given.link(body, "base_link");
    let rate_hz = given.rate(&["updateRate", "update_rate"], 0.0);
    let link_from_sensor = given.offset();
    let topic = given.topic(&["topicName", "topic_name", "imuTopic"], "imu");
    let frame_name = given.text(&["frameName", "frame_name", "frameId"]).unwrap_or_default();
    let unit = Imu::of_plugin(config?, InstrumentPlugin { topic, frame_name });
    Some(given.sensor(link, link_from_sensor?, rate_hz?, SensorKind::Imu(unit.into())))
}
