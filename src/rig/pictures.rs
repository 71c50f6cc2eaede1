//! The metadata of images in camera and depth streams: names, encodings, intrinsics.

use crate::description::model::{
    AngleFunction, AngleMap, CameraPlugin, CameraSensor, LensIntrinsics, LensModel, LensProjection, Mosaic,
    Noise, PixelFormat,
};
use belvedere_bridge::payload::CameraInfo;
use belvedere_bridge::{DistortionModel, Encoding, Intrinsics, Text, TextError};
use belvedere_sensors::ParameterError;
use belvedere_sensors::noise::{GaussianNoise, GaussianNoiseConfig};
use bytemuck::Zeroable;

/// Returns the noise of a description.
///
/// # Errors
/// If a parameter is out of range.
pub fn noise(noise: &Noise) -> Result<GaussianNoise, ParameterError> {
    GaussianNoise::new(
        GaussianNoiseConfig::default()
            .mean(noise.mean as f32)
            .stddev(noise.stddev as f32)
            .bias_mean(noise.bias_mean as f32)
            .bias_stddev(noise.bias_stddev as f32)
            .precision(noise.precision as f32),
    )
}

/// Returns the encoding of a pixel layout.
pub fn encoding(format: PixelFormat) -> Encoding {
    match format {
        PixelFormat::Rgb8 => Encoding::Rgb8,
        PixelFormat::Bgr8 => Encoding::Bgr8,
        PixelFormat::Mono8 => Encoding::Mono8,
        PixelFormat::Rgba8 => Encoding::Rgba8,
        PixelFormat::Mono16 => Encoding::Mono16,
        PixelFormat::Bayer8(Mosaic::Rggb) => Encoding::BayerRggb8,
        PixelFormat::Bayer8(Mosaic::Bggr) => Encoding::BayerBggr8,
        PixelFormat::Bayer8(Mosaic::Gbrg) => Encoding::BayerGbrg8,
        PixelFormat::Bayer8(Mosaic::Grbg) => Encoding::BayerGrbg8,
        PixelFormat::Bayer16(Mosaic::Rggb) => Encoding::BayerRggb16,
        PixelFormat::Bayer16(Mosaic::Bggr) => Encoding::BayerBggr16,
        PixelFormat::Bayer16(Mosaic::Gbrg) => Encoding::BayerGbrg16,
        PixelFormat::Bayer16(Mosaic::Grbg) => Encoding::BayerGrbg16,
    }
}

/// The geometry that a camera reports, which may differ from its actual one, as Gazebo's does.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The matrix K.
    pub lens: LensIntrinsics,
    /// The matrix P.
    pub projection: LensProjection,
    /// The lens's model.
    pub model: DistortionModel,
    /// Its parameters.
    pub parameters: Vec<f64>,
}

impl Calibration {
    /// Returns the calibration of a camera. The principal point is the plugin's if it has one, else that of the lens,
    /// or with `gazebo_compat` Gazebo's, which is a pixel farther right and down. The model is that of the lens, unless
    /// the plugin has coefficients. With `gazebo_compat` the coefficients are always the plugin's, if the plugin
    /// supports the lens.
    pub fn of(camera: &CameraSensor, plugin: &CameraPlugin, gazebo_compat: bool) -> Self {
        let shift = if gazebo_compat { 1.0 } else { 0.0 };
        let mut lens = camera.lens.intrinsics;
        let (mut model, mut parameters, scale) = named(&camera.lens.model);
        let is_pinhole = matches!(camera.lens.model, LensModel::Pinhole | LensModel::BrownConrady { .. });
        let [k1, k2, k3, t1, t2] = plugin.distortion;
        let has_coefficients = plugin.distortion != [0.0; 5] || gazebo_compat;
        if is_pinhole && has_coefficients && !plugin.auto_distortion {
            (model, parameters) = (DistortionModel::PlumbBob, vec![k1, k2, t1, t2, k3]);
        }
        lens.cx = plugin.principal_point[0].unwrap_or(lens.cx + shift);
        lens.cy = plugin.principal_point[1].unwrap_or(lens.cy + shift);
        if let Some(focal) = plugin.focal_length {
            (lens.fx, lens.fy) = (focal, focal);
        }
        let projection = camera.lens.projection.unwrap_or(LensProjection {
            fx: lens.fx * scale,
            fy: lens.fy * scale,
            cx: lens.cx,
            cy: lens.cy,
            // + 0.0 turns −0, from a baseline of 0, into 0.
            tx: -(lens.fx * scale) * plugin.hack_baseline_m + 0.0,
            ty: 0.0,
        });
        Self { lens, projection, model, parameters }
    }

    /// Returns the intrinsics for a frame's header.
    pub fn intrinsics(&self, near_m: f64, far_m: f64) -> Intrinsics {
        let LensIntrinsics { fx, fy, cx, cy, skew } = self.lens;
        let mut intrinsics = Intrinsics {
            fx,
            fy,
            cx,
            cy,
            skew,
            near: near_m as f32,
            far: far_m as f32,
            tx: self.projection.tx as f32,
            ..Intrinsics::default()
        };
        intrinsics.set_distortion(self.model, &self.parameters);
        intrinsics
    }

    /// Returns the `sensor_msgs/CameraInfo`.
    ///
    /// # Errors
    /// None in practice, because the model's name fits.
    pub fn camera_info(&self, width: u32, height: u32) -> Result<CameraInfo, TextError> {
        let LensIntrinsics { fx, fy, cx, cy, skew } = self.lens;
        let p = &self.projection;
        let block = self.intrinsics(0.0, 0.0);
        Ok(CameraInfo {
            width,
            height,
            distortion_model: Text::new(self.model.as_str())?,
            d: block.distortion,
            d_len: block.distortion_len.into(),
            k: [fx, skew, cx, 0.0, fy, cy, 0.0, 0.0, 1.0],
            r: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
            p: [p.fx, 0.0, p.cx, p.tx, 0.0, p.fy, p.cy, p.ty, 0.0, 0.0, 1.0, 0.0],
            ..CameraInfo::zeroed()
        })
    }
}

/// Returns the wire format's name and parameters of a lens, and the scale at the image's centre for a focal length of
/// 1.
fn named(model: &LensModel) -> (DistortionModel, Vec<f64>, f64) {
    match model {
        LensModel::Pinhole => (DistortionModel::PlumbBob, vec![0.0; 5], 1.0),
        LensModel::BrownConrady { coefficients } => {
            let is_short = coefficients.len() <= 5;
            let model =
                if is_short { DistortionModel::PlumbBob } else { DistortionModel::RationalPolynomial };
            (model, coefficients.clone(), 1.0)
        }
        LensModel::KannalaBrandt { k } => (DistortionModel::Equidistant, k.to_vec(), 1.0),
        LensModel::Eucm { alpha, beta } => (DistortionModel::Eucm, vec![*alpha, *beta], 1.0),
        LensModel::DoubleSphere { xi, alpha } => {
            (DistortionModel::DoubleSphere, vec![*xi, *alpha], 1.0 / (1.0 + xi))
        }
        LensModel::Mei { xi, k1, k2, p1, p2 } => {
            (DistortionModel::Mei, vec![*xi, *k1, *k2, *p1, *p2], 1.0 / (1.0 + xi))
        }
        LensModel::Equirectangular => (DistortionModel::Equirectangular, Vec::new(), 1.0),
        LensModel::WideAngle { map, cutoff_angle_rad, .. } => match map.function {
            // Models that ROS has a name for; K is the scale at the centre.
            AngleFunction::Identity if map.c3 == 0.0 => (DistortionModel::Equidistant, vec![0.0; 4], 1.0),
            AngleFunction::Tangent if map.c3 == 0.0 && map.c2 == 1.0 => {
                (DistortionModel::PlumbBob, vec![0.0; 5], 1.0)
            }
            function => {
                let function = match function {
                    AngleFunction::Sine => 0.0,
                    AngleFunction::Tangent => 1.0,
                    AngleFunction::Identity => 2.0,
                };
                let AngleMap { c1, c2, c3, focal_px, .. } = *map;
                (DistortionModel::WideAngle, vec![c1, c2, c3, focal_px, function, *cutoff_angle_rad], 1.0)
            }
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::model::Lens;

    fn camera(model: LensModel) -> CameraSensor {
        let f = 381.5;
        let intrinsics = LensIntrinsics { fx: f, fy: f, cx: 319.5, cy: 239.5, skew: 0.0 };
        CameraSensor {
            horizontal_fov_rad: 1.396_263_4,
            width: 640,
            height: 480,
            format: PixelFormat::Rgb8,
            anti_aliasing: 0,
            near_m: 0.1,
            far_m: 100.0,
            visibility_mask: u32::MAX,
            noise: Noise::default(),
            device: None,
            lens: Lens { model, intrinsics, has_own_focal_length: false, projection: None },
        }
    }

    const PLUGIN: CameraPlugin = CameraPlugin {
        camera_name: String::new(),
        image_topic: String::new(),
        camera_info_topic: String::new(),
        frame_name: String::new(),
        hack_baseline_m: 0.07,
        distortion: [0.0; 5],
        auto_distortion: false,
        principal_point: [None; 2],
        focal_length: None,
    };

    #[test]
    fn a_pinhole_is_centred_and_gazebos_a_pixel_off() {
        let pinhole = camera(LensModel::Pinhole);
        let info = Calibration::of(&pinhole, &PLUGIN, false).camera_info(640, 480).unwrap();
        assert_eq!([info.k[0], info.k[4], info.k[2], info.k[5]], [381.5, 381.5, 319.5, 239.5]);
        assert_eq!(info.p[3], -381.5 * 0.07);
        assert_eq!((info.distortion_model.as_str(), info.d_len, info.d), ("plumb_bob", 5, [0.0; 14]));
        let gazebo = Calibration::of(&pinhole, &PLUGIN, true).camera_info(640, 480).unwrap();
        assert_eq!([gazebo.k[2], gazebo.k[5], gazebo.p[2], gazebo.p[6]], [320.5, 240.5, 320.5, 240.5]);
    }

    #[test]
    fn each_model_has_the_name_and_the_parameters_that_ros_reads() {
        let all: Vec<f64> = (1..=14).map(f64::from).collect();
        let brown = |count: usize| LensModel::BrownConrady { coefficients: all[..count].to_vec() };
        let map = |c1, c2, function| LensModel::WideAngle {
            map: AngleMap { c1, c2, c3: 0.0, focal_px: 200.0, function },
            scale_to_hfov: true,
            cutoff_angle_rad: 1.5,
        };
        for (model, name, d, scale) in [
            (brown(5), "plumb_bob", &all[..5], 1.0),
            (brown(8), "rational_polynomial", &all[..8], 1.0),
            (brown(12), "rational_polynomial", &all[..12], 1.0),
            (brown(14), "rational_polynomial", &all[..14], 1.0),
            (LensModel::KannalaBrandt { k: [1.0, 2.0, 3.0, 4.0] }, "equidistant", &all[..4], 1.0),
            (LensModel::Eucm { alpha: 0.5, beta: 1.1 }, "eucm", &[0.5, 1.1], 1.0),
            (LensModel::DoubleSphere { xi: -0.2, alpha: 0.6 }, "double_sphere", &[-0.2, 0.6], 1.25),
            (LensModel::Mei { xi: 1.0, k1: 2.0, k2: 3.0, p1: 4.0, p2: 5.0 }, "mei", &all[..5], 0.5),
            (LensModel::Equirectangular, "equirectangular", &[], 1.0),
            (map(1.0, 1.0, AngleFunction::Identity), "equidistant", &[0.0; 4], 1.0),
            (map(1.0, 1.0, AngleFunction::Tangent), "plumb_bob", &[0.0; 5], 1.0),
            (map(2.0, 2.0, AngleFunction::Sine), "wide_angle", &[2.0, 2.0, 0.0, 200.0, 0.0, 1.5], 1.0),
        ] {
            let calibration = Calibration::of(&camera(model), &PLUGIN, false);
            let info = calibration.camera_info(640, 480).unwrap();
            assert_eq!((info.distortion_model.as_str(), &info.d[..info.d_len as usize]), (name, d));
            assert!((info.p[0] - info.k[0] * scale).abs() < 1e-9, "{name}");
            let header = calibration.intrinsics(0.1, 100.0);
            assert_eq!((header.model().map(DistortionModel::as_str), header.parameters()), (Some(name), d));
        }
    }

    #[test]
    fn the_plugins_coefficients_are_reported_and_gazebos_even_if_they_are_0() {
        let bent = camera(LensModel::BrownConrady { coefficients: vec![0.1, 0.2, 0.3, 0.4, 0.5] });
        let calibrated = |plugin: &CameraPlugin, compat| Calibration::of(&bent, plugin, compat).parameters;
        assert_eq!(calibrated(&PLUGIN, false), [0.1, 0.2, 0.3, 0.4, 0.5]);
        assert_eq!(calibrated(&PLUGIN, true), [0.0; 5]);
        let plugin = CameraPlugin { distortion: [1.0, 2.0, 3.0, 4.0, 5.0], ..PLUGIN };
        assert_eq!(calibrated(&plugin, false), [1.0, 2.0, 4.0, 5.0, 3.0]);
        let auto = CameraPlugin { auto_distortion: true, ..plugin };
        assert_eq!(
            (calibrated(&auto, false), calibrated(&auto, true)),
            (calibrated(&PLUGIN, false), calibrated(&PLUGIN, false))
        );
    }
}
