//! Sensors without a simulated plugin: they publish as gz-sim's sensors do, under the names that its bridge to ROS uses.

use super::plugin::{absolute, is_ours, plain_name};
use super::{KINDS, Sensor, SensorKind};
use crate::diagnostics::{Problem, Severity};
use crate::values::child_text;
use crate::xml::Element;
use std::collections::HashMap;

/// Prefix of the topics of sensors without a `<topic>`, until their world and model are known. No topic in a file can
/// contain it.
const SCOPE: &str = "/{sensor}";

/// Returns true if a sensor publishes as those of gz-sim do: no plugin publishes it.
pub(super) fn is_gz(sensor: &Element) -> bool {
    let publishes = |plugin: &Element| KINDS.iter().any(|kind| kind.plugins.contains(&plain_name(plugin)));
    sensor.elements_named("plugin").all(|plugin| is_ours(plugin) || !publishes(plugin))
}

/// Returns the absolute topic of such a sensor: its `<topic>`, or gz-sim's name for its type.
pub(super) fn gz_topic(sensor: &Element) -> Option<String> {
    if !is_gz(sensor) {
        return None;
    }
    let written = child_text(sensor, "topic").map(|topic| absolute(&[&topic]));
    written.or_else(|| {
        let end = match sensor.attribute("type")? {
            "camera" | "wideanglecamera" | "wide_angle_camera" => "image",
            "depth" | "depth_camera" => "depth_image",
            "rgbd" | "rgbd_camera" => "",
            "ray" | "gpu_ray" | "lidar" | "gpu_lidar" => "scan",
            "gps" => "navsat",
            "force_torque" => "forcetorque",
            kind => kind,
        };
        Some(absolute(&[SCOPE, end]))
    })
}

/// Returns the frame that its messages name; empty for the sensor's link.
pub(super) fn frame_name(sensor: &Element) -> String {
    let names = ["gz_frame_id", "ignition_frame_id", "frame_id"];
    names.into_iter().find_map(|name| child_text(sensor, name)).unwrap_or_default()
}

/// Names the topics of sensors without a `<topic>` as gz-sim does: `/world/W/model/M/link/L/sensor/S/…`. A nested model
/// `M::N` becomes `M/model/N`. If two sensors have the same name, the second gets different topics and a warning.
///
/// `place` returns `link` or `joint`, and the name of the link or joint that a sensor is on.
pub(crate) fn name_topics<'l>(
    sensors: &mut [Sensor],
    place: impl Fn(&Sensor) -> (&'static str, &'l str),
    model: &str,
    world: &str,
) -> Vec<Problem> {
    let (mut taken, mut problems) = (HashMap::new(), Vec::new());
    for sensor in sensors {
        if !topics(&mut sensor.kind).iter().any(|topic| topic.starts_with(SCOPE)) {
            continue;
        }
        let (kind, name) = place(sensor);
        let (inner, name) = name.rsplit_once("::").unwrap_or(("", name));
        let models = std::iter::once(model).chain(inner.split("::").filter(|name| !name.is_empty()));
        let models = models.map(part).collect::<Vec<_>>().join("/model/");
        let mut scope = format!(
            "/world/{}/model/{models}/{kind}/{}/sensor/{}",
            part(world),
            part(name),
            part(&sensor.name)
        );
        let count = taken.entry(scope.clone()).or_insert(0_u32);
        *count += 1;
        if *count > 1 {
            scope = format!("{scope}/{count}");
            problems.push(Problem {
                severity: Severity::Warning,
                source: sensor.source.clone(),
                what: format!(
                    "sensor '{}' has the same name as another one: its topics begin with {scope}",
                    sensor.name
                ),
                remedy: "give each sensor of a link its own name, or a <topic>".into(),
            });
        }
        for topic in topics(&mut sensor.kind) {
            if let Some(end) = topic.strip_prefix(SCOPE) {
                *topic = format!("{scope}{end}");
            }
        }
    }
    problems
}

/// Converts a name to a part of a topic: characters that a topic cannot contain become underscores.
fn part(name: &str) -> String {
    let part: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).collect();
    if part.is_empty() { "_".into() } else { part }
}

/// Returns the topics of the plugin that publishes a sensor.
fn topics(kind: &mut SensorKind) -> Vec<&mut String> {
    match kind {
        SensorKind::Camera(camera) => camera
            .plugin
            .iter_mut()
            .flat_map(|plugin| [&mut plugin.image_topic, &mut plugin.camera_info_topic])
            .collect(),
        SensorKind::Depth(depth) => depth
            .plugin
            .iter_mut()
            .flat_map(|plugin| {
                [
                    &mut plugin.camera.image_topic,
                    &mut plugin.camera.camera_info_topic,
                    &mut plugin.depth_image_topic,
                    &mut plugin.depth_camera_info_topic,
                    &mut plugin.point_cloud_topic,
                ]
            })
            .collect(),
        SensorKind::Ray(lidar) => lidar
            .plugin
            .iter_mut()
            .flat_map(|plugin| std::iter::once(&mut plugin.topic).chain(&mut plugin.points_topic))
            .collect(),
        SensorKind::Range(range) => range.plugin.iter_mut().map(|plugin| &mut plugin.topic).collect(),
        SensorKind::Imu(imu) => imu.plugin.iter_mut().map(|plugin| &mut plugin.topic).collect(),
        SensorKind::NavSat(receiver) => receiver.plugin.iter_mut().map(|plugin| &mut plugin.topic).collect(),
        SensorKind::Magnetometer(it) => it.plugin.iter_mut().map(|plugin| &mut plugin.topic).collect(),
        SensorKind::Altimeter(it) => it.plugin.iter_mut().map(|plugin| &mut plugin.topic).collect(),
        SensorKind::AirPressure(it) => it.plugin.iter_mut().map(|plugin| &mut plugin.topic).collect(),
        SensorKind::ForceTorque(it) => it.plugin.iter_mut().map(|plugin| &mut plugin.topic).collect(),
        SensorKind::Logical(it) => it.plugin.iter_mut().map(|plugin| &mut plugin.topic).collect(),
        SensorKind::Contact(it) => it.plugin.iter_mut().map(|plugin| &mut plugin.topic).collect(),
    }
}
