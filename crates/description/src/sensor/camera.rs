//! `<camera>`: angle of view, image, clip distances, noise; the lens is in `lens.rs`.

use super::camera_plugin::{CameraTopics, gz_camera};
use super::gz::{gz_topic, is_gz};
use super::lens::Picture;
use super::plugin::extension;
use super::reader::Reader;
use super::ros_version::is_ros2_camera;
use super::{DepthCamera, Kind, Sensor, SensorKind, depth};
use crate::diagnostics::Diagnostics;
use crate::model::{CameraPlugin, CameraSensor, Mosaic, PixelFormat};
use crate::values::{child_bits, child_text};
use crate::xml::Element;

/// The largest width and height of an image, in pixels.
const MAX_IMAGE_SIZE: u32 = 16384;
/// The most samples per pixel that a file may request.
const MAX_ANTI_ALIASING: u32 = 64;

/// Default far clip distance in metres.
const FAR_M: f64 = 100.0;

/// A colour camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    /// The optics and the image.
    pub camera: CameraSensor,
    /// The plugin that publishes it.
    pub plugin: Option<CameraPlugin>,
}

pub(super) const KIND: Kind = Kind {
    types: &["camera", "wideanglecamera", "wide_angle_camera"],
    plugins: &["gazebo_ros_camera"],
    is_extended: true,
    read: |reader, sensor| reader.colour_camera(sensor).map(SensorKind::Camera),
};

impl Reader<'_> {
    fn colour_camera(&mut self, sensor: &Element) -> Option<Camera> {
        let is_wide_angle = sensor.attribute("type").is_some_and(|kind| kind.starts_with("wide"));
        let own = extension(sensor);
        if let Some(own) = own {
            let remedy = "remove it: the plugin of belvedere in a camera has preset";
            self.left_out(own, |name| name == "preset", remedy);
        }
        let camera = self.camera(sensor, FAR_M, is_wide_angle, own)?;
        let plugin = self.plugin(sensor, &KIND).and_then(|element| {
            if is_ros2_camera(element) {
                return self.ros2_camera(element);
            }
            let topics = CameraTopics { image: "image_raw", info: "camera_info" };
            let plugin = self.camera_plugin(element, &topics);
            self.not_simulated_by_plugin(element);
            let plugin = plugin?;
            self.compare_lenses(element, &plugin, &camera.lens);
            Some(plugin)
        });
        let plugin = plugin.or_else(|| Some(gz_camera(sensor, gz_topic(sensor)?)));
        Some(Camera { camera, plugin })
    }

    /// Reads the `<camera>` of a sensor. `far_m` is the default far clip distance, `device` our plugin that names the
    /// device.
    pub(super) fn camera(
        &mut self,
        sensor: &Element,
        far_m: f64,
        is_wide_angle: bool,
        device: Option<&Element>,
    ) -> Option<CameraSensor> {
        let camera = sensor.child("camera");
        let image = camera.and_then(|camera| camera.child("image"));
        let clip = camera.and_then(|camera| camera.child("clip"));

        let width = self.truncated(image, "width", 320, MAX_IMAGE_SIZE);
        let height = self.truncated(image, "height", 240, MAX_IMAGE_SIZE);
        let format = self.format(image, depth::KIND.has_type(sensor));
        let anti_aliasing = self.anti_aliasing(image);
        let distances = self.clip(clip, sensor, far_m);
        let noise = self.noise(camera);
        let device = self.device(camera, device);
        let visibility_mask = match camera.filter(|camera| camera.child("visibility_mask").is_some()) {
            Some(camera) => child_bits(camera, "visibility_mask", self.diagnostics),
            None => Some(u32::MAX),
        };
        self.not_simulated_by_sensor(sensor);
        self.not_simulated(camera, is_gz(sensor));
        let (width, height) = (width?, height?);
        let lens = self.lens(camera, &Picture { width, height, is_wide_angle });
        if anti_aliasing.is_some_and(|samples| samples > 1)
            && device.flatten().is_some_and(|device| !device.is_of_one_moment())
        {
            let what = format!(
                "{} is left out: images with a rolling shutter or motion blur are not anti-aliased",
                self.what("anti_aliasing")
            );
            let remedy =
                "remove it, or write <readout_time_s>0</readout_time_s> and no <motion_blur_samples>";
            self.diagnostics.warning(Self::place(image, "anti_aliasing", sensor), what, remedy);
        }
        let (near_m, far_m) = distances?;
        let (lens, horizontal_fov_rad) = lens?;
        Some(CameraSensor {
            horizontal_fov_rad,
            width,
            height,
            format: format?,
            anti_aliasing: anti_aliasing?,
            near_m,
            far_m,
            visibility_mask: visibility_mask?,
            noise: noise?,
            lens,
            device: device?,
        })
    }

    /// Reads the samples per pixel. By default there is no anti-aliasing, as in Gazebo classic.
    fn anti_aliasing(&mut self, image: Option<&Element>) -> Option<u32> {
        let is_valid =
            |value: f64| value.fract() == 0.0 && (0.0..=f64::from(MAX_ANTI_ALIASING)).contains(&value);
        let remedy = format!("write a whole number from 0 to {MAX_ANTI_ALIASING}");
        self.checked(image, "anti_aliasing", 0.0, is_valid, &remedy).map(|value| value as u32)
    }

    fn format(&mut self, image: Option<&Element>, measures_depth: bool) -> Option<PixelFormat> {
        let Some(text) = image.and_then(|image| child_text(image, "format")) else {
            return Some(PixelFormat::Rgb8);
        };
        match text.as_str() {
            "R8G8B8" | "RGB_INT8" | "RGB8" => Some(PixelFormat::Rgb8),
            "B8G8R8" | "BGR_INT8" | "BGR8" => Some(PixelFormat::Bgr8),
            "L8" | "L_INT8" | "MONO8" => Some(PixelFormat::Mono8),
            "L16" | "L_INT16" | "L_UINT16" | "MONO16" => Some(PixelFormat::Mono16),
            "R8G8B8A8" | "RGBA_INT8" => Some(PixelFormat::Rgba8),
            text if mosaic(text).is_some() => mosaic(text),
            // Depths are always floats; the colours of a depth camera are always bytes.
            "R_FLOAT32" | "R_FLOAT16" if measures_depth => Some(PixelFormat::Rgb8),
            _ => {
                let what = self.what("format");
                if let Some(child) = image.and_then(|image| image.child("format")) {
                    self.diagnostics.warning(
                        &child.source,
                        format!("{what} is '{text}', which no colour camera sends: R8G8B8 is sent, as in Gazebo"),
                        "write R8G8B8, B8G8R8, R8G8B8A8, L8, L16, or BAYER_ with RGGB, BGGR, GBRG or GRBG and 8 or 16",
                    );
                }
                Some(PixelFormat::Rgb8)
            }
        }
    }

    fn clip(&mut self, clip: Option<&Element>, sensor: &Element, far_m: f64) -> Option<(f64, f64)> {
        let above_zero = |distance: f64| distance > 0.0;
        let remedy = "write a distance in metres above 0";
        let near = self.checked(clip, "near", 0.1, above_zero, remedy);
        let far = self.checked(clip, "far", far_m, above_zero, remedy);
        let (near, far) = (near?, far?);
        if near < far {
            return Some((near, far));
        }
        self.diagnostics.error(
            Self::place(clip, "near", sensor),
            format!("{} is {near} and <far> is {far}", self.what("near")),
            "write <near> below <far>",
        );
        None
    }

    /// Adds a warning for each element next to the `<camera>` that would have an effect in Gazebo and has none here.
    /// `<visualize>` is not one: there is no window to show images in.
    fn not_simulated_by_sensor(&mut self, sensor: &Element) {
        let is_gz = is_gz(sensor);
        for child in sensor.elements() {
            let remedy = match child.name.as_str() {
                "topic" | "frame_id" | "gz_frame_id" | "ignition_frame_id" if is_gz => continue,
                "camera" | "pose" | "update_rate" | "always_on" | "visualize" | "plugin" => continue,
                "enable_metrics" if matches!(child.text().as_str(), "false" | "0") => continue,
                "enable_metrics" => "remove it, and measure with `belvedere hz`",
                "topic" => "write <imageTopicName> in the plugin",
                "frame_id" | "gz_frame_id" | "ignition_frame_id" => "write <frameName> in the plugin",
                _ => "remove it: a camera sensor has pose, update_rate, always_on, camera and plugin",
            };
            let what = format!("{} is not simulated and is left out", self.what(&child.name));
            self.diagnostics.warning(&child.source, what, remedy);
        }
    }

    /// Adds a warning for each element that would have an effect in Gazebo and has none here.
    fn not_simulated(&mut self, camera: Option<&Element>, is_gz: bool) {
        let Some(camera) = camera else { return };
        for child in camera.elements() {
            let text = child.text();
            let remedy = match child.name.as_str() {
                "horizontal_fov" | "image" | "clip" | "noise" | "distortion" | "lens" | "device"
                | "visibility_mask" => continue,
                "save" => match child.attribute("enabled").unwrap_or_default() {
                    "true" | "1" => "remove it, and keep pictures with `belvedere snapshot`",
                    _ => continue,
                },
                "camera_info_topic" | "optical_frame_id" if is_gz => continue,
                "triggered" if text == "false" || text == "0" => continue,
                "pose" if text.split_whitespace().all(|number| number.parse() == Ok(0.0)) => continue,
                "triggered" | "trigger_topic" => "remove it: pictures are sent at <update_rate>",
                "pose" => "write it in <sensor>, where it applies to all that the sensor measures",
                "depth_camera" => "write <clip> in <camera>, and the limits of the depth in the plugin",
                "camera_info_topic" => "write <cameraInfoTopicName> in the plugin",
                "optical_frame_id" => "write <frameName> in the plugin",
                _ => {
                    "remove it: a camera has horizontal_fov, image, clip, noise, distortion, lens and device"
                }
            };
            let what = format!("{} is not simulated and is left out", self.what(&child.name));
            self.diagnostics.warning(&child.source, what, remedy);
        }
        let parts: [(&str, &[&str]); 2] =
            [("image", &["width", "height", "format", "anti_aliasing"]), ("clip", &["near", "far"])];
        for (name, read) in parts {
            if let Some(part) = camera.child(name) {
                let remedy = format!("remove it: <{name}> has {}", read.join(", "));
                self.left_out(part, |name| read.contains(&name), &remedy);
            }
        }
    }
}

/// Returns the Bayer pattern of a name like `BAYER_RGGB8`.
fn mosaic(name: &str) -> Option<PixelFormat> {
    let name = name.strip_prefix("BAYER_")?;
    let (pattern, bits) = name.split_at_checked(4)?;
    let pattern = match pattern {
        "RGGB" => Mosaic::Rggb,
        "BGGR" => Mosaic::Bggr,
        "GBRG" => Mosaic::Gbrg,
        "GRBG" => Mosaic::Grbg,
        _ => return None,
    };
    match bits {
        "8" => Some(PixelFormat::Bayer8(pattern)),
        "16" => Some(PixelFormat::Bayer16(pattern)),
        _ => None,
    }
}

/// Warns if the readout takes longer than the time between images: real sensors read one image after the other.
pub(super) fn warn_of_long_readout(sensor: &Sensor, element: &Element, diagnostics: &mut Diagnostics) {
    let (SensorKind::Camera(Camera { camera, .. }) | SensorKind::Depth(DepthCamera { camera, .. })) =
        &sensor.kind
    else {
        return;
    };
    let (Some(device), Some(rate_hz)) = (camera.device, sensor.effective_rate_hz()) else { return };
    if device.readout_time_s * rate_hz <= 1.0 {
        return;
    }
    let device_element = element.child("camera").and_then(|camera| camera.child("device"));
    let readout = device_element.and_then(|device| device.child("readout_time_s")).or(device_element);
    diagnostics.warning(
        &readout.unwrap_or(element).source,
        format!(
            "<readout_time_s> of sensor '{}' is {} s, longer than the time between pictures at {rate_hz} Hz: no \
             real sensor does this, and its rows are read while those of the previous picture still are",
            sensor.name, device.readout_time_s
        ),
        "write a shorter <readout_time_s>, or a lower <update_rate>",
    );
}
