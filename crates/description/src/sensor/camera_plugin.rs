//! The plugins that publish the images of cameras and depth cameras: `libgazebo_ros_camera.so`, and the parameters that the
//! Kinect's plugin shares with it.

use super::gz::frame_name;
use super::plugin::{absolute, topic};
use super::reader::Reader;
use super::ros2;
use crate::model::{CameraPlugin, Lens, LensModel};
use crate::values::{child_bool, child_text};
use crate::xml::Element;

/// Names of the distortion coefficients, after `distortion`, or in lower case after `distortion_`.
const COEFFICIENTS: [&str; 5] = ["K1", "K2", "K3", "T1", "T2"];

/// The defaults of `<imageTopicName>` and `<cameraInfoTopicName>`.
pub(super) struct CameraTopics {
    pub(super) image: &'static str,
    pub(super) info: &'static str,
}

impl Reader<'_> {
    /// Reads the camera plugin of ROS 2: names in lower case; rate and coefficients come from the sensor itself.
    pub(super) fn ros2_camera(&mut self, plugin: &Element) -> Option<CameraPlugin> {
        let camera_name = child_text(plugin, "camera_name").unwrap_or_else(|| self.sensor.clone());
        Some(CameraPlugin {
            image_topic: ros2_topic(plugin, &camera_name, "image_raw"),
            camera_info_topic: ros2_topic(plugin, &camera_name, "camera_info"),
            frame_name: ros2::frame_name(plugin),
            camera_name,
            hack_baseline_m: self.number(Some(plugin), "hack_baseline", 0.0)?,
            distortion: [0.0; 5],
            auto_distortion: true,
            principal_point: [None; 2],
            focal_length: None,
        })
    }

    pub(super) fn camera_plugin(&mut self, plugin: &Element, topics: &CameraTopics) -> Option<CameraPlugin> {
        let text = |name: &str| child_text(plugin, name);
        let camera_name = text("cameraName").unwrap_or_default();
        let topic = |name: &str, default: &str| topic(plugin, &camera_name, name, default);
        let image_topic = topic("imageTopicName", topics.image);
        let camera_info_topic = topic("cameraInfoTopicName", topics.info);
        let rate_hz = self.rate(plugin, "updateRate");
        let hack_baseline_m = self.number(Some(plugin), "hackBaseline", 0.0);
        let [k1, k2, k3, t1, t2] = COEFFICIENTS.map(|name| self.distortion_value(plugin, name));
        let [cx_prime, cx, cy] = ["CxPrime", "Cx", "Cy"].map(|name| self.number(Some(plugin), name, 0.0));
        let focal_length = self.not_negative(Some(plugin), "focalLength");
        self.plugin_rate_hz = rate_hz?;
        let given = |value: f64| (value != 0.0).then_some(value);
        Some(CameraPlugin {
            image_topic,
            camera_info_topic,
            frame_name: text("frameName").unwrap_or_default(),
            camera_name,
            hack_baseline_m: hack_baseline_m?,
            distortion: [k1?, k2?, k3?, t1?, t2?],
            auto_distortion: child_bool(plugin, "autoDistortion", self.diagnostics).unwrap_or(false),
            principal_point: [given(cx?).or(given(cx_prime?)), given(cy?)],
            focal_length: given(focal_length?),
        })
    }

    /// Adds a warning if the plugin's coefficients contradict the lens of the `<camera>`.
    pub(super) fn compare_lenses(&mut self, plugin: &Element, parameters: &CameraPlugin, lens: &Lens) {
        let [k1, k2, k3, t1, t2] = parameters.distortion;
        if parameters.distortion == [0.0; 5] || parameters.auto_distortion {
            return;
        }
        let (what, remedy) = match &lens.model {
            LensModel::Pinhole => return,
            LensModel::BrownConrady { coefficients } if *coefficients == [k1, k2, t1, t2, k3] => return,
            LensModel::BrownConrady { .. } if self.rules.gazebo_compat => (
                "apply to camera_info only: the picture has those in <distortion> of the <camera>, as in Gazebo",
                "write the same numbers in both",
            ),
            LensModel::BrownConrady { .. } => (
                "replace those in <distortion> of the <camera>, in camera_info and in the picture",
                "write the same numbers in both: with --gazebo-compat the picture has those of <distortion>",
            ),
            _ => ("are left out: camera_info has the parameters of the <lens>", "remove them"),
        };
        let place = plugin.elements().find(|child| child.name.starts_with("distortion")).unwrap_or(plugin);
        let what = format!("the distortion coefficients in the plugin of sensor '{}' {what}", self.sensor);
        self.diagnostics.warning(&place.source, what, remedy);
    }

    /// Adds a warning for each parameter of a camera plugin that has an effect in Gazebo and none here.
    pub(super) fn not_simulated_by_plugin(&mut self, plugin: &Element) {
        for child in plugin.elements() {
            let name = child.name.as_str();
            let (why, remedy) = match name {
                // Images are not cropped.
                "borderCrop" => match child_bool(plugin, name, self.diagnostics) {
                    Some(true) => (
                        "not simulated: the picture keeps what the lens does not map, in black",
                        "write false, and see how much that is with `belvedere check`",
                    ),
                    Some(false) | None => continue,
                },
                "triggerTopicName" => {
                    ("not simulated and is left out", "remove it: pictures are sent at <updateRate>")
                }
                _ => continue,
            };
            let what = format!("{} is {why}", self.what(name));
            self.diagnostics.warning(&child.source, what, remedy);
        }
    }

    /// Reads `distortionK1`, or `distortion_k1` as the Kinect's files write it.
    fn distortion_value(&mut self, plugin: &Element, name: &str) -> Option<f64> {
        let names = distortion_names(name);
        let written = names.iter().find(|name| plugin.child(name).is_some()).unwrap_or(&names[0]);
        self.number(Some(plugin), written, 0.0)
    }
}

/// Returns the parameters with which gz-sim publishes a camera: unless given, the info topic is next to the image topic.
pub(super) fn gz_camera(sensor: &Element, image_topic: String) -> CameraPlugin {
    let folder = image_topic.rsplit_once('/').map_or("", |(folder, _)| folder);
    let camera = sensor.child("camera");
    let written = camera.and_then(|camera| child_text(camera, "camera_info_topic"));
    CameraPlugin {
        camera_name: String::new(),
        camera_info_topic: match written {
            Some(topic) => absolute(&[&topic]),
            None => absolute(&[folder, "camera_info"]),
        },
        image_topic,
        frame_name: camera
            .and_then(|camera| child_text(camera, "optical_frame_id"))
            .unwrap_or_else(|| frame_name(sensor)),
        hack_baseline_m: 0.0,
        distortion: [0.0; 5],
        auto_distortion: true,
        principal_point: [None; 2],
        focal_length: None,
    }
}

/// Returns a camera's topic in ROS 2. Files write it with or without the camera's name in front.
pub(super) fn ros2_topic(plugin: &Element, camera_name: &str, name: &str) -> String {
    let full = format!("{camera_name}/{name}");
    ros2::topic(plugin, &full, &[name, &format!("~/{name}")])
}

/// Returns the two names that files use for a coefficient.
fn distortion_names(name: &str) -> [String; 2] {
    [format!("distortion{name}"), format!("distortion_{}", name.to_ascii_lowercase())]
}
