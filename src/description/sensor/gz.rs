//! Sensors of gz-sim: they have a `<topic>` and no plugin, and publish under the names that gz-sim's bridge to ROS sees.

use super::plugin::absolute;
use crate::description::model::{CameraPlugin, DepthCameraPlugin, LaserPlugin, Plugin, SensorKind};
use crate::description::values::child_text;
use crate::description::xml::Element;

/// Whether a sensor publishes as those of gz-sim do.
pub(super) fn is_gz(sensor: &Element) -> bool {
    sensor.child("plugin").is_none() && child_text(sensor, "topic").is_some()
}

/// What publishes such a sensor; none if it has no `<topic>`.
pub(super) fn gz_plugin(sensor: &Element, kind: &SensorKind) -> Option<Plugin> {
    let topic = absolute(&[&child_text(sensor, "topic")?]);
    let under = |name: &str| absolute(&[&topic, name]);
    let camera = |image_topic: String| {
        // Beside the picture, if nothing else is written.
        let folder = image_topic.rsplit_once('/').map_or("", |(folder, _)| folder);
        let written = sensor.child("camera").and_then(|camera| child_text(camera, "camera_info_topic"));
        CameraPlugin {
            camera_name: String::new(),
            update_rate_hz: None,
            camera_info_topic: absolute(&match &written {
                Some(topic) => vec![topic.as_str()],
                None => vec![folder, "camera_info"],
            }),
            image_topic,
            frame_name: sensor
                .child("camera")
                .and_then(|camera| child_text(camera, "optical_frame_id"))
                .unwrap_or_else(|| frame_name(sensor)),
            hack_baseline_m: 0.0,
            distortion: [0.0; 5],
            auto_distortion: true,
            principal_point: [None; 2],
            focal_length: None,
        }
    };
    Some(match kind {
        SensorKind::Ray(_) => {
            Plugin::Laser(LaserPlugin { frame_name: frame_name(sensor), update_rate_hz: None, topic })
        }
        SensorKind::Camera(_) => Plugin::Camera(camera(topic)),
        SensorKind::Depth(depth) => {
            let has_colour = sensor.attribute("type").is_some_and(|kind| kind.starts_with("rgbd"));
            Plugin::DepthCamera(DepthCameraPlugin {
                camera: camera(under("image")),
                depth_image_topic: if has_colour { under("depth_image") } else { topic.clone() },
                depth_camera_info_topic: under("depth_camera_info"),
                point_cloud_topic: under("points"),
                cutoff_m: depth.near_m,
                cutoff_max_m: depth.far_m,
                depth_16uc1: false,
            })
        }
    })
}

/// The frame that its messages name; the sensor's link if this is empty.
fn frame_name(sensor: &Element) -> String {
    let names = ["gz_frame_id", "ignition_frame_id", "frame_id"];
    names.into_iter().find_map(|name| child_text(sensor, name)).unwrap_or_default()
}
