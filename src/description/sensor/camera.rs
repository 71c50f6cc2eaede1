//! `<camera>`: angle of view, picture, clip distances, noise, distortion.

use super::reader::Reader;
use crate::description::model::{CameraSensor, PixelFormat};
use crate::description::values::child_text;
use crate::description::xml::Element;
use std::f64::consts::PI;

/// Most pixels along a side.
const MAX_IMAGE_SIZE: u32 = 16384;

impl Reader<'_> {
    /// The `<camera>` of a sensor; `far_m` is the far clip distance if none is given.
    pub(super) fn camera(&mut self, sensor: &Element, far_m: f64) -> Option<CameraSensor> {
        let camera = sensor.child("camera");
        let image = camera.and_then(|camera| camera.child("image"));
        let clip = camera.and_then(|camera| camera.child("clip"));

        let horizontal_fov_rad = self.checked(
            camera,
            "horizontal_fov",
            1.047,
            |angle| angle > 0.0 && angle < PI,
            "write the full angle in radians, above 0 and below 3.14159",
        );
        let width = self.count(image, "width", 320, MAX_IMAGE_SIZE);
        let height = self.count(image, "height", 240, MAX_IMAGE_SIZE);
        let format = self.format(image);
        let distances = self.clip(clip, sensor, far_m);
        let noise = self.noise(camera);
        let distortion = self.distortion(camera);
        let (near_m, far_m) = distances?;
        Some(CameraSensor {
            horizontal_fov_rad: horizontal_fov_rad?,
            width: width?,
            height: height?,
            format: format?,
            near_m,
            far_m,
            noise: noise?,
            distortion: distortion?,
        })
    }

    fn format(&mut self, image: Option<&Element>) -> Option<PixelFormat> {
        let Some(text) = image.and_then(|image| child_text(image, "format")) else {
            return Some(PixelFormat::Rgb8);
        };
        match text.as_str() {
            "R8G8B8" | "RGB_INT8" => Some(PixelFormat::Rgb8),
            "B8G8R8" | "BGR_INT8" => Some(PixelFormat::Bgr8),
            "L8" | "L_INT8" => Some(PixelFormat::Mono8),
            _ => {
                let what = self.what("format");
                if let Some(child) = image.and_then(|image| image.child("format")) {
                    self.diagnostics.error(
                        &child.source,
                        format!("{what} is '{text}', which is not simulated"),
                        "write R8G8B8, B8G8R8 or L8",
                    );
                }
                None
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

    fn distortion(&mut self, camera: Option<&Element>) -> Option<[f64; 5]> {
        let element = camera.and_then(|camera| camera.child("distortion"));
        let values = ["k1", "k2", "k3", "p1", "p2"].map(|name| self.number(element, name, 0.0));
        let [k1, k2, k3, p1, p2] = values;
        Some([k1?, k2?, k3?, p1?, p2?])
    }
}
