//! The documentation of each field of a configuration states the field's default.

use belvedere_sensors::Pose;
use belvedere_sensors::camera::{CameraConfig, Edges, PixelFormat};
use belvedere_sensors::depth::{DepthCameraConfig, OutOfRange};
use belvedere_sensors::device::depth_model::{DepthModel, DepthNoise, Window};
use belvedere_sensors::device::{AutoExposureConfig, DeviceConfig, Exposure, Tone, Vignetting};
use belvedere_sensors::imu::ImuConfig;
use belvedere_sensors::lidar::{Beams, LidarConfig, Sweep};
use belvedere_sensors::noise::{GaussianNoise, GaussianNoiseConfig, InstrumentConfig};
use belvedere_sensors::optics::PinholeGrid;
use belvedere_sensors::scanner::{
    Beam, Crosstalk, Halo, Intensity, Pattern, Returns, ScannerConfig, Weather,
};
use belvedere_sensors::scene::{
    InstanceConfig, LightConfig, LightKind, MaterialConfig, MaterialId, Pbr, Shape, TextureAlpha,
    TextureMode, visibility,
};
use belvedere_sensors::trace::{Faces, TooNear};

/// Returns the fields of a struct in a source file, each with its documentation in one line, without the markup of
/// links and code.
fn fields<'a>(source: &'a str, name: &str) -> Vec<(&'a str, String)> {
    let begin = source.find(&format!("pub struct {name}")).expect("the struct is in this file");
    let body = &source[begin..][..source[begin..].find("\n}\n").expect("it ends")];
    let (mut fields, mut doc) = (Vec::new(), String::new());
    for line in body.lines().skip(1).map(str::trim) {
        if let Some(text) = line.strip_prefix("///") {
            doc += text;
        } else if let Some((field, _)) = line.strip_prefix("pub ").and_then(|line| line.split_once(':')) {
            let plain = doc.replace(['`', '\\'], "");
            fields.push((field, plain));
            doc.clear();
        }
    }
    fields
}

/// Compares the documentation with the values: each row is a field, its default as documented, and the same as a value.
/// Fields in the first list have no default.
macro_rules! check {
    ($name:ident in $file:literal, $config:expr, given [$($given:literal),*]; $($field:ident: $text:literal = $value:expr;)*) => {
        let config = $config;
        let mut rows = vec![$((stringify!($field), $text)),*];
        $(assert!(config.$field == $value, "{}::{} is {:?}", stringify!($name), stringify!($field), config.$field);)*
        for (field, doc) in fields(include_str!(concat!("../../src/", $file)), stringify!($name)) {
            if [$($given),*].contains(&field) {
                continue;
            }
            let row = rows.iter().position(|(name, _)| *name == field);
            let row = row.unwrap_or_else(|| panic!("{}::{field} is not tested", stringify!($name)));
            let says = format!("The default is {}", rows.remove(row).1);
            let plain = doc.replace(['[', ']'], "");
            let follows = plain.split_once(&says).map(|(_, rest)| rest.chars().next());
            let ends = matches!(follows, Some(Some('.' | ',' | ' ')));
            assert!(ends, "{}::{field} does not say `{says}`: {doc}", stringify!($name));
        }
        assert!(rows.is_empty(), "{rows:?}");
    };
}

#[test]
fn sensors_document_their_defaults() {
    let camera = CameraConfig::new(PinholeGrid::from_fov(8, 6, 1.0).unwrap());
    check! {
        CameraConfig in "sensor/camera/config.rs", camera, given ["optics"];
        format: "PixelFormat::Rgb8" = PixelFormat::Rgb8;
        near_m: "0.02" = 0.02;
        far_m: "300" = 300.0;
        faces: "Faces::Front" = Faces::Front;
        visibility: "visibility::VISUAL" = visibility::VISUAL;
        exposure: "1" = 1.0;
        edges: "Edges::Sharp" = Edges::Sharp;
        noise: "GaussianNoise::NONE" = GaussianNoise::NONE;
        device: "None" = None;
        seed: "0" = 0;
        sensor: "0" = 0;
    }
    check! {
        DepthCameraConfig in "sensor/depth/config.rs", DepthCameraConfig::new(camera), given ["camera"];
        faces: "Faces::Both" = Faces::Both;
        min_depth_m: "0" = 0.0;
        max_depth_m: "infinity" = f64::INFINITY;
        out_of_range: "OutOfRange::Infinite" = OutOfRange::Infinite;
        too_near: "TooNear::Blocks" = TooNear::Blocks;
        model: "DepthModel::new" = DepthModel::new();
    }
    check! {
        LidarConfig in "sensor/lidar/config.rs", LidarConfig::new(Beams::turn(360)), given ["horizontal"];
        vertical: "Beams::ONE" = Beams::ONE;
        range_min_m: "0" = 0.0;
        range_max_m: "30" = 30.0;
        too_near: "TooNear::Blocks" = TooNear::Blocks;
        visibility: "visibility::COLLISION" = visibility::COLLISION;
        faces: "Faces::Both" = Faces::Both;
        sweep: "Sweep::Columns" = Sweep::Columns;
        noise: "GaussianNoise::NONE" = GaussianNoise::NONE;
        seed: "0" = 0;
        sensor: "0" = 0;
    }
    check! {
        ScannerConfig in "sensor/scanner/config.rs", ScannerConfig::new(Pattern::Table(&[])), given ["pattern"];
        frame_time_ns: "100,000,000" = 100_000_000;
        range_min_m: "0" = 0.0;
        range_max_m: "100" = 100.0;
        visibility: "visibility::COLLISION" = visibility::COLLISION;
        faces: "Faces::Both" = Faces::Both;
        noise: "GaussianNoise::NONE" = GaussianNoise::NONE;
        spreads: "an empty list" = [];
        beam: "Beam::RAY" = Beam::RAY;
        halo: "Halo::NONE" = Halo::NONE;
        crosstalk: "Crosstalk::NONE" = Crosstalk::NONE;
        pulse_m: "1" = 1.0;
        returns: "Returns::Strongest" = Returns::Strongest;
        intensity: "Intensity::Retro" = Intensity::Retro;
        receiver: "None" = None;
        weather: "Weather::CLEAR" = Weather::CLEAR;
        seed: "0" = 0;
        sensor: "0" = 0;
    }
}

#[test]
fn devices_and_instruments_document_their_defaults() {
    check! {
        ImuConfig in "sensor/imu.rs", ImuConfig::default(), given [];
        gyro: "InstrumentConfig::default" = InstrumentConfig::default();
        accelerometer: "InstrumentConfig::default" = InstrumentConfig::default();
    }
    check! {
        InstrumentConfig in "noise/instrument.rs", InstrumentConfig::<2>::default(), given [];
        sensitivity: "the identity" = [[1.0, 0.0], [0.0, 1.0]];
        mean: "0" = [0.0; 2];
        stddev: "0" = [0.0; 2];
        density: "0" = [0.0; 2];
        bias_mean: "0" = [0.0; 2];
        bias_stddev: "0" = [0.0; 2];
        drift: "0" = [0.0; 2];
        drift_time_s: "infinity" = [f64::INFINITY; 2];
        precision: "0" = [0.0; 2];
        limit: "infinity" = f64::INFINITY;
    }
    check! {
        GaussianNoiseConfig in "noise/gaussian.rs", GaussianNoiseConfig::default(), given [];
        mean: "0" = 0.0;
        stddev: "0" = 0.0;
        bias_mean: "0" = 0.0;
        bias_stddev: "0" = 0.0;
        precision: "0" = 0.0;
    }
    check! {
        DeviceConfig in "device/config.rs", DeviceConfig::default(), given [];
        exposure: "10 ms at a gain of 1" = Exposure { time_s: 0.01, gain: 1.0 };
        white_radiance_w_m2_sr: "0.233" = 0.233;
        wavelength_nm: "555" = 555.0;
        f_number: "2.8" = 2.8;
        vignetting: "Vignetting::NONE" = Vignetting::NONE;
        pixel_pitch_um: "5" = 5.0;
        quantum_efficiency: "0.5 for each" = [0.5; 3];
        full_well_e: "16,000" = 16_000.0;
        dark_current_e_per_s: "0" = 0.0;
        read_noise_e: "0" = 0.0;
        converter_noise_dn: "0" = 0.0;
        dsnu_e: "0" = 0.0;
        prnu: "0" = 0.0;
        dn_per_electron: "0.25" = 0.25;
        black_level_dn: "0" = 0.0;
        bits: "12" = 12;
        tone: "Tone::Raw" = Tone::Raw;
    }
    check! {
        AutoExposureConfig in "device/auto_exposure.rs", AutoExposureConfig::default(), given [];
        target: "0.18" = 0.18;
        tolerance: "0.05" = 0.05;
        time_range_s: "20 µs to 33 ms" = [20e-6, 33e-3];
        most_gain: "16" = 16.0;
    }
    check! {
        DepthModel in "device/depth_model/mod.rs", DepthModel::default(), given [];
        second_eye: "None" = None;
        window: "Window::Own" = Window::Own;
        matching: "None" = None;
        noise: "GaussianNoise::NONE" = DepthNoise::Gaussian(GaussianNoise::NONE);
        steps: "None" = None;
    }
}

#[test]
fn scenes_document_their_defaults() {
    check! {
        MaterialConfig in "scene/material.rs", MaterialConfig::default(), given [];
        diffuse: "0.7 for each colour" = [0.7; 3];
        ambient: "0.7 for each colour" = [0.7; 3];
        emissive: "0 for each colour" = [0.0; 3];
        specular: "0 for each colour" = [0.0; 3];
        shininess: "0" = 0.0;
        pbr: "None" = None;
        alpha: "1" = 1.0;
        texture_alpha: "TextureAlpha::Ignored" = TextureAlpha::Ignored;
        specular_reflectance: "0" = 0.0;
        transmittance: "0" = 0.0;
        normal_map: "None" = None;
        pbr_map: "None" = None;
        emissive_map: "None" = None;
        texture: "None" = None;
        cube_texture: "None" = None;
        texture_mode: "TextureMode::Reflectance" = TextureMode::Reflectance;
        texture_repeat: "1 along both" = [1.0; 2];
    }
    check! {
        Pbr in "scene/pbr.rs", Pbr::default(), given [];
        roughness: "1" = 1.0;
        metalness: "0" = 0.0;
        highlights: "1 for each colour" = [1.0; 3];
    }
    check! {
        LightConfig in "scene/material.rs", LightConfig::default(), given [];
        kind: "a LightKind::Point at the world's origin" = LightKind::Point { position: [0.0; 3] };
        diffuse: "1 for each colour" = [1.0; 3];
        specular: "0 for each colour" = [0.0; 3];
        range_m: "infinity" = f32::INFINITY;
        attenuation: "1, 0, 0, without any loss" = [1.0, 0.0, 0.0];
        cast_shadows: "false" = false;
    }
    check! {
        InstanceConfig in "scene/instance.rs", InstanceConfig::default(), given [];
        shape: "a box with edges of 1 m" = Shape::Box { size: [1.0; 3] };
        world_from_instance: "Pose::IDENTITY" = Pose::IDENTITY;
        scale: "1 along each axis" = [1.0; 3];
        material: "0, the scene's first" = MaterialId(0);
        visibility: "both bits of visibility" = visibility::VISUAL | visibility::COLLISION;
        laser_retro: "0" = 0.0;
        class: "0" = 0;
    }
}
