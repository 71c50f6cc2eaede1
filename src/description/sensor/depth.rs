//! Depth cameras: a `<camera>` that measures depth, too, and `libgazebo_ros_openni_kinect.so`.

use super::camera_plugin::{CameraTopics, gz_camera};
use super::gz::gz_topic;
use super::plugin::{absolute, topic};
use super::reader::Reader;
use super::{Kind, SensorKind};
use crate::description::model::{CameraSensor, DepthCameraPlugin};
use crate::description::values::child_bool;
use crate::description::xml::Element;

/// Far clip distance in metres if none is given.
const FAR_M: f64 = 10.0;

/// What the Kinect's is told besides.
const DEPTH_PARAMETERS: [&str; 6] = [
    "depthImageTopicName",
    "depthImageCameraInfoTopicName",
    "pointCloudTopicName",
    "pointCloudCutoff",
    "pointCloudCutoffMax",
    "useDepth16UC1MM",
];

/// A depth camera with a colour camera in the same place.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthCamera {
    /// What it sees.
    pub camera: CameraSensor,
    /// What publishes it.
    pub plugin: Option<DepthCameraPlugin>,
}

pub(super) const KIND: Kind = Kind {
    types: &["depth", "depth_camera", "rgbd", "rgbd_camera"],
    plugins: &["gazebo_ros_openni_kinect"],
    is_extended: false,
    read: |reader, sensor| reader.depth_camera(sensor).map(SensorKind::Depth),
};

impl Reader<'_> {
    fn depth_camera(&mut self, sensor: &Element) -> Option<DepthCamera> {
        let camera = self.camera(sensor, FAR_M, false)?;
        let plugin = self.plugin(sensor, &KIND).and_then(|element| {
            let plugin = self.depth_plugin(element)?;
            self.compare_lenses(element, &plugin.camera, &camera.lens);
            Some(plugin)
        });
        let plugin = plugin.or_else(|| Some(gz_depth(sensor, &gz_topic(sensor)?, &camera)));
        Some(DepthCamera { camera, plugin })
    }

    fn depth_plugin(&mut self, plugin: &Element) -> Option<DepthCameraPlugin> {
        let topics = CameraTopics { image: "ir/image_raw", info: "ir/camera_info" };
        let camera = self.camera_plugin(plugin, &topics);
        self.not_simulated_by_plugin(plugin, &DEPTH_PARAMETERS);
        let cutoff = self.checked(
            Some(plugin),
            "pointCloudCutoff",
            0.4,
            |depth| depth >= 0.0,
            "write a depth in metres, 0 or more",
        );
        let cutoff_max = self.checked(
            Some(plugin),
            "pointCloudCutoffMax",
            5.0,
            |depth| depth > 0.0,
            "write a depth in metres above 0",
        );
        let depth_16uc1 = child_bool(plugin, "useDepth16UC1MM", self.diagnostics).unwrap_or(false);
        let (camera, cutoff_m, cutoff_max_m) = (camera?, cutoff?, cutoff_max?);
        if cutoff_m >= cutoff_max_m {
            self.diagnostics.error(
                Self::place(Some(plugin), "pointCloudCutoff", plugin),
                format!(
                    "{} is {cutoff_m} and <pointCloudCutoffMax> is {cutoff_max_m}",
                    self.what("pointCloudCutoff")
                ),
                "write <pointCloudCutoff> below <pointCloudCutoffMax>, which is 5.0 if not given",
            );
            return None;
        }
        let topic = |name: &str, default: &str| topic(plugin, &camera.camera_name, name, default);
        Some(DepthCameraPlugin {
            depth_image_topic: topic("depthImageTopicName", "depth/image_raw"),
            depth_camera_info_topic: topic("depthImageCameraInfoTopicName", "depth/camera_info"),
            point_cloud_topic: topic("pointCloudTopicName", "points"),
            camera,
            cutoff_m,
            cutoff_max_m,
            depth_16uc1,
        })
    }
}

fn gz_depth(sensor: &Element, own: &str, camera: &CameraSensor) -> DepthCameraPlugin {
    let has_colour = sensor.attribute("type").is_some_and(|kind| kind.starts_with("rgbd"));
    let under = |name: &str| absolute(&[own, name]);
    DepthCameraPlugin {
        camera: gz_camera(sensor, under("image")),
        depth_image_topic: if has_colour { under("depth_image") } else { own.to_owned() },
        depth_camera_info_topic: under("depth_camera_info"),
        point_cloud_topic: under("points"),
        cutoff_m: camera.near_m,
        cutoff_max_m: camera.far_m,
        depth_16uc1: false,
    }
}
