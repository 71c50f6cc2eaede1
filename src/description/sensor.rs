//! `<sensor>` as SDF defines it, in SDF links and in URDF's `<gazebo reference>`.
//!
//! Defaults are those of sdf/1.6 and of the plugins of `gazebo_plugins` (ROS Noetic).

mod camera;
mod device;
mod gz;
mod lens;
mod noise;
mod plugin;
mod ray;
mod reader;
#[cfg(test)]
mod tests;

use super::diagnostics::Diagnostics;
use super::model::{LinkIndex, Sensor, SensorKind};
use super::values::{child_bool, child_pose};
use super::xml::Element;
use reader::Reader;

/// Far clip distance in metres of a camera, and of a depth camera, that gives none.
const CAMERA_FAR_M: f64 = 100.0;
const DEPTH_FAR_M: f64 = 10.0;

/// Reads a `<sensor>` with its plugin. A sensor of a type that is not simulated gives none and a warning; one
/// with a wrong value gives none and an error for each.
pub fn parse_sensor(sensor: &Element, link: LinkIndex, diagnostics: &mut Diagnostics) -> Option<Sensor> {
    let name = sensor.attribute("name").unwrap_or_default().to_owned();
    if name.is_empty() {
        diagnostics.error(&sensor.source, "<sensor> has no name", "write <sensor name=\"…\" type=\"…\">");
        return None;
    }
    let mut reader = Reader { sensor: name.clone(), diagnostics };
    let kind = match sensor.attribute("type").unwrap_or_default() {
        "camera" => reader.camera(sensor, CAMERA_FAR_M, false).map(SensorKind::Camera),
        "wideanglecamera" | "wide_angle_camera" => {
            reader.camera(sensor, CAMERA_FAR_M, true).map(SensorKind::Camera)
        }
        "depth" | "depth_camera" | "rgbd" | "rgbd_camera" => {
            reader.camera(sensor, DEPTH_FAR_M, false).map(SensorKind::Depth)
        }
        "ray" | "lidar" => reader.ray(sensor, false).map(SensorKind::Ray),
        "gpu_ray" | "gpu_lidar" => reader.ray(sensor, true).map(SensorKind::Ray),
        other => {
            let what = if other.is_empty() { "no type".into() } else { format!("the type '{other}'") };
            diagnostics.warning(
                &sensor.source,
                format!("the sensor '{name}' has {what}, which is not simulated: it is left out"),
                "these types are: camera, wideanglecamera, depth, ray, gpu_ray and lidar",
            );
            return None;
        }
    };
    let update_rate_hz = reader.rate(sensor, "update_rate");
    let mut kind = kind?;
    let plugin = reader.plugin(sensor, &mut kind);
    let plugin = plugin.or_else(|| gz::gz_plugin(sensor, &kind));
    let read = Sensor {
        name,
        link,
        link_from_sensor: child_pose(sensor, diagnostics),
        always_on: child_bool(sensor, "always_on", diagnostics).unwrap_or(false),
        update_rate_hz: update_rate_hz?,
        kind,
        plugin,
        source: sensor.source.clone(),
    };
    warn_of_long_readout(&read, sensor, diagnostics);
    Some(read)
}

/// A sensor cannot begin with a picture before it has read the one before.
fn warn_of_long_readout(sensor: &Sensor, element: &Element, diagnostics: &mut Diagnostics) {
    let (SensorKind::Camera(camera) | SensorKind::Depth(camera)) = &sensor.kind else { return };
    let (Some(device), Some(rate_hz)) = (camera.device, sensor.effective_rate_hz()) else { return };
    if device.readout_time_s * rate_hz <= 1.0 {
        return;
    }
    let device_element = element.child("camera").and_then(|camera| camera.child("device"));
    let readout = device_element.and_then(|device| device.child("readout_time_s")).or(device_element);
    diagnostics.warning(
        &readout.unwrap_or(element).source,
        format!(
            "<readout_time_s> of sensor '{}' is {} s, longer than the time between pictures at {rate_hz} Hz: no such \
             sensor can be built, and its rows are read while those of the picture before still are",
            sensor.name, device.readout_time_s
        ),
        "write a shorter <readout_time_s>, or a lower <update_rate>",
    );
}
