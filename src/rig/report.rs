//! A sensor with all its parameters after defaults and plugins, for people.

use super::behaviour::behaviour;
use crate::description::model::{Model, Noise, Sensor};
use crate::description::text::{number, pose};

/// Takes what is told: what it is, and its value.
pub(super) type Say<'a> = &'a mut dyn FnMut(&str, String);

/// What is told of a sensor, in lines: everything that it will do.
pub fn sensor_report(model: &Model, sensor: &Sensor, gazebo_compat: bool) -> Vec<String> {
    let kind = behaviour(sensor);
    let mut lines = vec![format!("{} {} ({})", kind.name(), sensor.name, sensor.source)];
    let mut say = |what: &str, value: String| lines.push(format!("  {what:12} {value}"));
    let link = &model.links[sensor.link].name;
    say("link", format!("{link} {}", pose(&sensor.link_from_sensor)));
    say("rate", rate(sensor));
    kind.report(gazebo_compat, &mut say);
    lines
}

/// What is said of a sensor that nothing publishes.
pub(super) fn without_topics(say: Say<'_>) {
    say("topics", "none: it has no plugin that is simulated".into());
}

fn rate(sensor: &Sensor) -> String {
    let Some(effective) = sensor.effective_rate_hz() else { return "every step of physics".into() };
    match sensor.update_rate_hz {
        Some(own) if own > effective => {
            format!("{} Hz (the sensor's own {} Hz, limited by its plugin)", number(effective), number(own))
        }
        _ => format!("{} Hz", number(effective)),
    }
}

/// Of a value in this unit.
pub(super) fn noise(noise: &Noise, unit: &str) -> String {
    if *noise == Noise::default() {
        return "none".into();
    }
    let mut parts =
        vec![format!("gaussian, mean {}, stddev {} {unit}", number(noise.mean), number(noise.stddev))];
    if noise.bias_mean != 0.0 || noise.bias_stddev != 0.0 {
        let (mean, stddev) = (number(noise.bias_mean), number(noise.bias_stddev));
        parts.push(format!("bias mean {mean}, bias stddev {stddev}"));
    }
    if noise.precision > 0.0 {
        parts.push(format!("rounded to {}", number(noise.precision)));
    }
    parts.join(", ")
}
