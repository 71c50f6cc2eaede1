//! `<plugin>`: the names under which a sensor's messages go out, and what they say.

use super::reader::Reader;
use crate::description::model::{
    CameraPlugin, DepthCameraPlugin, LaserPlugin, Lens, LensModel, Plugin, Radiation, RangePlugin, RaySensor,
    SensorKind,
};
use crate::description::values::{child_bool, child_text};
use crate::description::xml::Element;

/// The plugins that are understood, for messages.
const SUPPORTED: &str = "libgazebo_ros_camera.so, libgazebo_ros_openni_kinect.so, libgazebo_ros_laser.so, \
    libgazebo_ros_block_laser.so and libgazebo_ros_velodyne_laser.so (also as gpu_laser), and libgazebo_ros_range.so";

/// What all camera plugins are told, without the coefficients of the distortion.
const CAMERA_PARAMETERS: [&str; 12] = [
    "robotNamespace",
    "cameraName",
    "imageTopicName",
    "cameraInfoTopicName",
    "frameName",
    "updateRate",
    "hackBaseline",
    "autoDistortion",
    "CxPrime",
    "Cx",
    "Cy",
    "focalLength",
];
/// What the Kinect's is told besides.
const DEPTH_PARAMETERS: [&str; 6] = [
    "depthImageTopicName",
    "depthImageCameraInfoTopicName",
    "pointCloudTopicName",
    "pointCloudCutoff",
    "pointCloudCutoffMax",
    "useDepth16UC1MM",
];
/// What many files tell them, and no plugin reads.
const READ_BY_NOBODY: [&str; 2] = ["alwaysOn", "baseline"];
/// Coefficients of the distortion, behind `distortion`, or in small letters behind `distortion_`.
const COEFFICIENTS: [&str; 5] = ["K1", "K2", "K3", "T1", "T2"];

/// The defaults of `<imageTopicName>` and `<cameraInfoTopicName>`.
struct CameraTopics {
    image: &'static str,
    info: &'static str,
}

impl Reader<'_> {
    /// The first plugin of a sensor that is understood and fits it; warnings for the others. What a plugin does to what
    /// the sensor measures becomes the sensor's.
    pub(super) fn plugin(&mut self, sensor: &Element, kind: &mut SensorKind) -> Option<Plugin> {
        let mut chosen = None;
        for element in sensor.elements_named("plugin") {
            let file = element.attribute("filename").unwrap_or_default();
            // Gazebo itself adds what is missing of `lib….so`.
            let name = file.rsplit('/').next().unwrap_or(file);
            let name = name.strip_prefix("lib").unwrap_or(name);
            let name = name.strip_suffix(".so").unwrap_or(name);
            let fits = match name {
                "gazebo_ros_camera" => matches!(kind, SensorKind::Camera(_)),
                "gazebo_ros_openni_kinect" => matches!(kind, SensorKind::Depth(_)),
                "gazebo_ros_laser"
                | "gazebo_ros_gpu_laser"
                | "gazebo_ros_block_laser"
                | "gazebo_ros_velodyne_laser"
                | "gazebo_ros_velodyne_gpu_laser"
                | "gazebo_ros_range" => matches!(kind, SensorKind::Ray(_)),
                _ => {
                    self.diagnostics.warning(
                        &element.source,
                        format!(
                            "the plugin '{file}' of sensor '{}' is not simulated and left out",
                            self.sensor
                        ),
                        format!("these are: {SUPPORTED}"),
                    );
                    continue;
                }
            };
            if !fits {
                let (wanted, plugin) = match kind {
                    SensorKind::Camera(_) => ("camera", "libgazebo_ros_camera.so"),
                    SensorKind::Depth(_) => ("depth", "libgazebo_ros_openni_kinect.so"),
                    SensorKind::Ray(_) => ("ray", "libgazebo_ros_laser.so"),
                };
                self.diagnostics.error(
                    &element.source,
                    format!("the plugin '{file}' does not go with sensor '{}' of type {wanted}", self.sensor),
                    format!("use {plugin}, or change the type of the sensor"),
                );
            } else if chosen.is_some() {
                self.diagnostics.warning(
                    &element.source,
                    format!("sensor '{}' has a second plugin, '{file}', which is left out", self.sensor),
                    "make a second sensor for it",
                );
            } else {
                chosen = match kind {
                    SensorKind::Camera(camera) => {
                        let topics = CameraTopics { image: "image_raw", info: "camera_info" };
                        let plugin = self.camera_plugin(element, &topics);
                        self.not_simulated_by_plugin(element, &[]);
                        plugin.map(|plugin| {
                            self.compare_lenses(element, &plugin, &camera.lens);
                            Plugin::Camera(plugin)
                        })
                    }
                    SensorKind::Depth(camera) => self.depth_plugin(element).map(|plugin| {
                        self.compare_lenses(element, &plugin.camera, &camera.lens);
                        Plugin::DepthCamera(plugin)
                    }),
                    SensorKind::Ray(ray) => self.ray_plugin(name, element, ray),
                };
            }
        }
        chosen
    }

    fn camera_plugin(&mut self, plugin: &Element, topics: &CameraTopics) -> Option<CameraPlugin> {
        let text = |name: &str| child_text(plugin, name);
        let camera_name = text("cameraName").unwrap_or_default();
        let topic = |name: &str, default: &str| topic(plugin, &camera_name, name, default);
        let image_topic = topic("imageTopicName", topics.image);
        let camera_info_topic = topic("cameraInfoTopicName", topics.info);
        let update_rate_hz = self.rate(plugin, "updateRate");
        let hack_baseline_m = self.number(Some(plugin), "hackBaseline", 0.0);
        let [k1, k2, k3, t1, t2] = COEFFICIENTS.map(|name| self.distortion_value(plugin, name));
        let [cx_prime, cx, cy] = ["CxPrime", "Cx", "Cy"].map(|name| self.number(Some(plugin), name, 0.0));
        let focal_length = self.not_negative(Some(plugin), "focalLength");
        let given = |value: f64| (value != 0.0).then_some(value);
        Some(CameraPlugin {
            image_topic,
            camera_info_topic,
            frame_name: text("frameName").unwrap_or_default(),
            camera_name,
            update_rate_hz: update_rate_hz?,
            hack_baseline_m: hack_baseline_m?,
            distortion: [k1?, k2?, k3?, t1?, t2?],
            auto_distortion: child_bool(plugin, "autoDistortion", self.diagnostics).unwrap_or(false),
            principal_point: [given(cx?).or(given(cx_prime?)), given(cy?)],
            focal_length: given(focal_length?),
        })
    }

    /// A warning where the plugin's coefficients contradict the lens of the `<camera>`.
    fn compare_lenses(&mut self, plugin: &Element, parameters: &CameraPlugin, lens: &Lens) {
        let [k1, k2, k3, t1, t2] = parameters.distortion;
        if parameters.distortion == [0.0; 5] || parameters.auto_distortion {
            return;
        }
        let (what, remedy) = match &lens.model {
            LensModel::Pinhole => return,
            LensModel::BrownConrady { coefficients } if *coefficients == [k1, k2, t1, t2, k3] => return,
            LensModel::BrownConrady { .. } => (
                "hold instead of those in <distortion> of the <camera>, in camera_info and in the picture",
                "write the same numbers in both: with --gazebo-compat the picture has those of <distortion>",
            ),
            _ => ("are left out: camera_info has the parameters of the <lens>", "take them out"),
        };
        let place = plugin.elements().find(|child| child.name.starts_with("distortion")).unwrap_or(plugin);
        let what = format!("the distortion coefficients in the plugin of sensor '{}' {what}", self.sensor);
        self.diagnostics.warning(&place.source, what, remedy);
    }

    /// A warning for each parameter of a camera's plugin that has no effect here and would have one elsewhere.
    fn not_simulated_by_plugin(&mut self, plugin: &Element, of_depth: &[&str]) {
        for child in plugin.elements() {
            let name = child.name.as_str();
            let is_read = CAMERA_PARAMETERS.contains(&name) || of_depth.contains(&name);
            let is_coefficient =
                COEFFICIENTS.iter().any(|known| distortion_names(known).contains(&child.name));
            if is_read || is_coefficient || READ_BY_NOBODY.contains(&name) {
                continue;
            }
            let (why, remedy) = match name {
                // Nothing is cropped here.
                "borderCrop" => match child_bool(plugin, name, self.diagnostics) {
                    Some(true) => (
                        "not simulated: the picture keeps what the lens does not map, in black",
                        "write false, and see how much that is with `belvedere check`",
                    ),
                    Some(false) | None => continue,
                },
                "triggerTopicName" => {
                    ("not simulated and left out", "take it out: pictures are sent at <updateRate>")
                }
                _ => ("not simulated and left out", "take it out, or correct its name"),
            };
            let what = format!("{} is {why}", self.what(name));
            self.diagnostics.warning(&child.source, what, remedy);
        }
    }

    /// `distortionK1`, or `distortion_k1` as the Kinect's files write it.
    fn distortion_value(&mut self, plugin: &Element, name: &str) -> Option<f64> {
        let names = distortion_names(name);
        let written = names.iter().find(|name| plugin.child(name).is_some()).unwrap_or(&names[0]);
        self.number(Some(plugin), written, 0.0)
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

    fn ray_plugin(&mut self, name: &str, plugin: &Element, ray: &mut RaySensor) -> Option<Plugin> {
        // Hokuyo's plugin leaves noise to the sensor.
        if !matches!(name, "gazebo_ros_laser" | "gazebo_ros_gpu_laser") {
            // Both are drawn, each for itself.
            ray.noise.stddev =
                libm::hypot(ray.noise.stddev, self.not_negative(Some(plugin), "gaussianNoise")?);
        }
        if name.starts_with("gazebo_ros_velodyne") {
            ray.range_min_m = ray.range_min_m.max(self.not_negative(Some(plugin), "min_range")?);
            if plugin.child("max_range").is_some() {
                ray.range_max_m = ray.range_max_m.min(self.number(Some(plugin), "max_range", 0.0)?);
            }
            if ray.range_min_m >= ray.range_max_m {
                self.diagnostics.error(
                    Self::place(Some(plugin), "min_range", plugin),
                    format!(
                        "sensor '{}' and its plugin leave the ranges from {} to {} m",
                        self.sensor, ray.range_min_m, ray.range_max_m
                    ),
                    "write <min_range> below <max_range> and below the sensor's own <max>",
                );
                return None;
            }
        }
        if name == "gazebo_ros_range" {
            return self.range_plugin(plugin).map(Plugin::Range);
        }
        self.laser_plugin(plugin).map(Plugin::Laser)
    }

    fn range_plugin(&mut self, plugin: &Element) -> Option<RangePlugin> {
        let is_angle = |angle: f64| (0.0..=std::f64::consts::TAU).contains(&angle);
        Some(RangePlugin {
            topic: topic(plugin, "", "topicName", "/range"),
            frame_name: child_text(plugin, "frameName").unwrap_or_else(|| "/world".into()),
            update_rate_hz: self.rate(plugin, "updateRate")?,
            // Whatever is not the one is the other there.
            radiation: match child_text(plugin, "radiation").as_deref() {
                None | Some("ultrasound") => Radiation::Ultrasound,
                Some(_) => Radiation::Infrared,
            },
            field_of_view_rad: self.checked(
                Some(plugin),
                "fov",
                0.05,
                is_angle,
                "write the full angle in radians, from 0 to 6.2832",
            )?,
        })
    }

    fn laser_plugin(&mut self, plugin: &Element) -> Option<LaserPlugin> {
        Some(LaserPlugin {
            topic: topic(plugin, "", "topicName", "/world"),
            frame_name: child_text(plugin, "frameName").unwrap_or_else(|| "/world".into()),
            update_rate_hz: self.rate(plugin, "updateRate")?,
        })
    }
}

/// The two ways in which files write a coefficient.
fn distortion_names(name: &str) -> [String; 2] {
    [format!("distortion{name}"), format!("distortion_{}", name.to_ascii_lowercase())]
}

/// The absolute topic in the child element `name`: as it stands if it begins with a slash, else under
/// `<robotNamespace>` and the camera's name.
fn topic(plugin: &Element, camera_name: &str, name: &str, default: &str) -> String {
    let topic = child_text(plugin, name).unwrap_or_else(|| default.into());
    if topic.starts_with('/') {
        return topic;
    }
    let namespace = child_text(plugin, "robotNamespace").unwrap_or_default();
    absolute(&[&namespace, camera_name, &topic])
}

/// The absolute topic of these parts.
pub(super) fn absolute(parts: &[&str]) -> String {
    let mut absolute = String::new();
    for part in parts {
        let part = part.trim_matches('/');
        if !part.is_empty() {
            absolute.push('/');
            absolute.push_str(part);
        }
    }
    absolute
}
