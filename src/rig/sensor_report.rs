//! Describes a sensor with all its parameters after defaults and plugins, for people.

use super::behaviour::behaviour;
use crate::description::model::{Model, Sensor, SensorKind};
use crate::description::text::{number, pose};

/// Describes everything that a sensor will do, except for its streams, in lines of text.
pub fn sensor_report(model: &Model, sensor: &Sensor, gazebo_compat: bool) -> Vec<String> {
    let kind = behaviour(sensor);
    let mut lines = vec![format!("{} {} ({})", kind.name(), sensor.name, sensor.source)];
    let mut say = |what: &str, value: String| lines.push(format!("  {what:12} {value}"));
    let link = &model.links[sensor.link].name;
    say("link", format!("{link} {}", pose(&sensor.link_from_sensor)));
    if let SensorKind::ForceTorque(it) = &sensor.kind {
        say("joint", model.joints[it.joint].name.clone());
    }
    if let SensorKind::Contact(it) = &sensor.kind {
        for (link, collision) in &it.collisions {
            say("watches", model.collision_name(*link, *collision));
        }
    }
    say("rate", rate(sensor));
    kind.report(gazebo_compat, &mut say);
    lines
}

fn rate(sensor: &Sensor) -> String {
    let Some(effective) = sensor.effective_rate_hz() else { return "one frame per physics step".into() };
    match sensor.update_rate_hz {
        Some(own) if own > effective => {
            format!("{} Hz (the sensor's own {} Hz, limited by its plugin)", number(effective), number(own))
        }
        _ => format!("{} Hz", number(effective)),
    }
}
