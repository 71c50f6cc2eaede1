//! What camera and depth streams say about their pictures: names, encodings, intrinsics.

use crate::description::model::{CameraPlugin, CameraSensor, Noise, PixelFormat};
use belvedere_bridge::payload::CameraInfo;
use belvedere_bridge::{Encoding, Intrinsics, Text, TextError};
use belvedere_sensors::camera::{CameraConfig, PixelFormat as Format};
use belvedere_sensors::lens::Pinhole;
use belvedere_sensors::noise::{GaussianNoise, GaussianNoiseError};
use bytemuck::Zeroable;

/// The camera of a description.
///
/// # Errors
/// When the noise is out of range.
pub fn camera_config(
    camera: &CameraSensor,
    seed: u64,
    sensor: u32,
) -> Result<CameraConfig, GaussianNoiseError> {
    Ok(CameraConfig {
        width: camera.width,
        height: camera.height,
        horizontal_fov_rad: camera.horizontal_fov_rad,
        format: match camera.format {
            PixelFormat::Rgb8 => Format::Rgb8,
            PixelFormat::Bgr8 => Format::Bgr8,
            PixelFormat::Mono8 => Format::Mono8,
        },
        near_m: camera.near_m,
        far_m: camera.far_m,
        exposure: 1.0,
        noise: noise(&camera.noise)?,
        seed,
        sensor,
    })
}

/// The noise of a description.
///
/// # Errors
/// When a parameter is out of range.
pub fn noise(noise: &Noise) -> Result<GaussianNoise, GaussianNoiseError> {
    GaussianNoise::new(
        noise.mean as f32,
        noise.stddev as f32,
        noise.bias_mean as f32,
        noise.bias_stddev as f32,
        noise.precision as f32,
    )
}

/// The encoding of a pixel layout.
pub fn encoding(format: PixelFormat) -> Encoding {
    match format {
        PixelFormat::Rgb8 => Encoding::Rgb8,
        PixelFormat::Bgr8 => Encoding::Bgr8,
        PixelFormat::Mono8 => Encoding::Mono8,
    }
}

/// What a camera says of its own geometry; it may differ from what it does, as Gazebo's does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Told {
    /// Focal length in pixels.
    pub focal: f64,
    /// Principal point in pixels.
    pub principal_point: [f64; 2],
    /// k1, k2, t1, t2, k3: the order of `plumb_bob`.
    pub distortion: [f64; 5],
    /// P\[3\] in pixels · metres.
    pub tx: f64,
}

impl Told {
    /// The principal point is that of the picture, ((w−1)/2, (h−1)/2), or with `gazebo_compat` Gazebo's
    /// ((w+1)/2, (h+1)/2), unless the plugin gives one.
    pub fn of(lens: &Pinhole, plugin: &CameraPlugin, gazebo_compat: bool) -> Self {
        let shift = if gazebo_compat { 1.0 } else { 0.0 };
        let focal = plugin.focal_length.unwrap_or(lens.fx);
        let [k1, k2, k3, t1, t2] = plugin.distortion;
        Self {
            focal,
            principal_point: [
                plugin.principal_point[0].unwrap_or(lens.cx + shift),
                plugin.principal_point[1].unwrap_or(lens.cy + shift),
            ],
            distortion: [k1, k2, t1, t2, k3],
            // + 0.0: a baseline of 0 gives 0, not −0.
            tx: -focal * plugin.hack_baseline_m + 0.0,
        }
    }

    /// The block of a frame's header.
    pub fn intrinsics(&self, near_m: f64, far_m: f64) -> Intrinsics {
        let mut distortion = [0.0; 8];
        for (slot, value) in distortion.iter_mut().zip(self.distortion) {
            *slot = value as f32;
        }
        Intrinsics {
            fx: self.focal,
            fy: self.focal,
            cx: self.principal_point[0],
            cy: self.principal_point[1],
            distortion,
            near: near_m as f32,
            far: far_m as f32,
            tx: self.tx as f32,
            distortion_model: Intrinsics::PLUMB_BOB,
        }
    }

    /// `sensor_msgs/CameraInfo`.
    ///
    /// # Errors
    /// Never in practice: the model's name fits.
    pub fn camera_info(&self, width: u32, height: u32) -> Result<CameraInfo, TextError> {
        let (f, [cx, cy]) = (self.focal, self.principal_point);
        let mut info = CameraInfo {
            width,
            height,
            distortion_model: Text::new("plumb_bob")?,
            d_len: 5,
            k: [f, 0.0, cx, 0.0, f, cy, 0.0, 0.0, 1.0],
            r: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
            p: [f, 0.0, cx, self.tx, 0.0, f, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
            ..CameraInfo::zeroed()
        };
        info.d[..5].copy_from_slice(&self.distortion);
        Ok(info)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ceiling_camera_says_what_the_article_works_out() {
        let plugin = CameraPlugin {
            camera_name: "camera1".into(),
            update_rate_hz: Some(30.0),
            image_topic: "/image_raw".into(),
            camera_info_topic: "/camera_info".into(),
            frame_name: "base_camera_link".into(),
            hack_baseline_m: 0.07,
            distortion: [0.0; 5],
            principal_point: [None; 2],
            focal_length: None,
        };
        let lens = Pinhole::from_fov(640, 480, 1.396_263_4);
        let info = Told::of(&lens, &plugin, false).camera_info(640, 480).unwrap();
        assert!((info.k[0] - 381.361_15).abs() < 1e-4 && info.k[4] == info.k[0]);
        assert_eq!([info.k[2], info.k[5]], [319.5, 239.5]);
        assert_eq!(info.p[3], -info.k[0] * 0.07);
        assert_eq!((info.d_len, info.d), (5, [0.0; 8]));
        let gazebo = Told::of(&lens, &plugin, true).camera_info(640, 480).unwrap();
        assert_eq!([gazebo.k[2], gazebo.k[5], gazebo.p[2], gazebo.p[6]], [320.5, 240.5, 320.5, 240.5]);
    }
}
