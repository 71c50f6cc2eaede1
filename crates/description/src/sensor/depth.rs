//! Depth cameras: a `<camera>` that also measures depth, and `libgazebo_ros_openni_kinect.so`.

use super::camera_plugin::{CameraTopics, gz_camera, ros2_topic};
use super::gz::gz_topic;
use super::plugin::{absolute, extension, plain_name, topic};
use super::reader::Reader;
use super::{Kind, SensorKind};
use crate::model::{CameraSensor, DepthCameraPlugin};
use crate::rules::SensorModels;
use crate::values::child_bool;
use crate::xml::Element;
use belvedere_sensors::device::depth_model::presets::{self, DepthPreset};

/// Default far clip distance in metres.
const FAR_M: f64 = 100.0;

/// A depth camera with a colour camera at the same place.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthCamera {
    /// The optics and the image.
    pub camera: CameraSensor,
    /// The plugin that publishes it.
    pub plugin: Option<DepthCameraPlugin>,
    /// The device that it is; without one, depths have no errors.
    pub preset: Option<DepthPreset>,
    /// True if the device's projector is on.
    pub has_projector_on: bool,
}

impl DepthCamera {
    /// Returns the least and greatest valid depth in metres: the plugin's limits, within the device's range.
    pub fn range_m(&self) -> [f64; 2] {
        let [least, most] = self
            .plugin
            .as_ref()
            .map_or([self.camera.near_m, self.camera.far_m], |plugin| [plugin.cutoff_m, plugin.cutoff_max_m]);
        self.preset
            .map_or([least, most], |preset| [least.max(preset.range_m[0]), most.min(preset.range_m[1])])
    }
}

const ROS2_PLUGIN: &str = "gazebo_ros_camera";

pub(super) const KIND: Kind = Kind {
    types: &["depth", "depth_camera", "rgbd", "rgbd_camera"],
    // In ROS 2 the camera plugin publishes all of them.
    plugins: &["gazebo_ros_openni_kinect", ROS2_PLUGIN],
    is_extended: true,
    read: |reader, sensor| reader.depth_camera(sensor).map(SensorKind::Depth),
};

impl Reader<'_> {
    fn depth_camera(&mut self, sensor: &Element) -> Option<DepthCamera> {
        let camera = self.camera(sensor, FAR_M, false, None)?;
        let plugin = self.plugin(sensor, &KIND).and_then(|element| {
            if plain_name(element) == ROS2_PLUGIN {
                return self.ros2_depth(element, &camera);
            }
            let plugin = self.depth_plugin(element)?;
            self.compare_lenses(element, &plugin.camera, &camera.lens);
            Some(plugin)
        });
        let plugin = plugin.or_else(|| Some(gz_depth(sensor, &gz_topic(sensor)?, &camera)));
        let written = match extension(sensor) {
            Some(own) => {
                self.left_out(
                    own,
                    |name| ["preset", "projector"].contains(&name),
                    "remove it: the plugin of belvedere has preset and projector",
                );
                Some(self.preset_name(own, &presets::NAMES)?)
            }
            None => None,
        };
        let preset = written.or_else(|| self.known(sensor, plugin.as_ref()?)).and_then(presets::named);
        let has_projector_on = match (extension(sensor), preset) {
            (Some(own), Some(preset)) => self.projector(own, &preset)?,
            _ => true,
        };
        let depth = DepthCamera { camera, plugin, preset, has_projector_on };
        if let (Some(preset), [least, most]) = (preset, depth.range_m())
            && least >= most
        {
            let [from, to] = preset.range_m;
            self.diagnostics.error(
                &sensor.source,
                format!(
                    "sensor '{}' has no valid depth: a {} measures {from} to {to} m",
                    self.sensor, preset.name
                ),
                "write <pointCloudCutoff> and <pointCloudCutoffMax>, or <clip>, within that",
            );
            return None;
        }
        Some(depth)
    }

    /// Reads the `<projector>` of our plugin: true if it is on. A device that measures with its light cannot do without.
    fn projector(&mut self, own: &Element, preset: &DepthPreset) -> Option<bool> {
        let is_on = child_bool(own, "projector", self.diagnostics).unwrap_or(true);
        let measures_without =
            |preset: &DepthPreset| preset.model(preset.focal_px()).without_projector().is_some();
        if is_on || measures_without(preset) {
            return Some(is_on);
        }
        let others = presets::ALL.iter().filter(|preset| measures_without(preset)).map(|preset| preset.name);
        self.diagnostics.error(
            Self::place(Some(own), "projector", own),
            format!("{} is off, but a {} measures with its light", self.what("projector"), preset.name),
            format!("remove it, or choose one of {}", others.collect::<Vec<_>>().join(", ")),
        );
        None
    }

    /// Returns the device that a sensor is known to be, if real devices are requested: the preset whose name is part of the
    /// sensor's or its camera's name, else the Kinect that the plugin is made for.
    fn known(&self, sensor: &Element, plugin: &DepthCameraPlugin) -> Option<&'static str> {
        if self.rules.sensor_models != SensorModels::Real {
            return None;
        }
        let names = [&self.sensor, &plugin.camera.camera_name].map(|name| name.to_ascii_lowercase());
        let is_named = |preset: &&&str| names.iter().any(|name| name.contains(**preset));
        let has_plugin = sensor.elements_named("plugin").any(|plugin| KIND.plugins[0] == plain_name(plugin));
        presets::NAMES.iter().find(is_named).copied().or(has_plugin.then_some("kinect_v1"))
    }

    fn ros2_depth(&mut self, plugin: &Element, camera: &CameraSensor) -> Option<DepthCameraPlugin> {
        let own = self.ros2_camera(plugin)?;
        let topic = |name: &str| ros2_topic(plugin, &own.camera_name, name);
        let remedy = "write <min_depth> below <max_depth>, in metres";
        let cutoff_m = self.checked(Some(plugin), "min_depth", 0.4, |depth| depth >= 0.0, remedy)?;
        let cutoff_max_m =
            self.checked(Some(plugin), "max_depth", camera.far_m, |depth| depth > cutoff_m, remedy)?;
        Some(DepthCameraPlugin {
            depth_image_topic: topic("depth/image_raw"),
            depth_camera_info_topic: topic("depth/camera_info"),
            point_cloud_topic: topic("points"),
            camera: own,
            cutoff_m,
            cutoff_max_m,
            depth_16uc1: false,
        })
    }

    fn depth_plugin(&mut self, plugin: &Element) -> Option<DepthCameraPlugin> {
        let topics = CameraTopics { image: "ir/image_raw", info: "ir/camera_info" };
        let camera = self.camera_plugin(plugin, &topics);
        self.not_simulated_by_plugin(plugin);
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
        // Its name, and an older one.
        let [now, before] =
            ["useDepth16UC1Format", "useDepth16UC1MM"].map(|name| child_bool(plugin, name, self.diagnostics));
        let depth_16uc1 = now.or(before).unwrap_or(false);
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
