//! Measures the cost of a camera device: pictures of an evenly lit wall with and without it, at each SIMD level of this
//! machine.
//!
//! Prints nanoseconds per pixel and channel on one core: the fastest of many frames with a device minus the fastest
//! without, which is the cost of the device alone.
//!
//! ```text
//! $ cargo run --release -p belvedere-sensors --example device_time
//! ```

use belvedere_sensors::camera::{Camera, CameraConfig, Mosaic, Picture, PixelFormat};
use belvedere_sensors::device::{DeviceConfig, Exposure, presets};
use belvedere_sensors::optics::PinholeGrid;
use belvedere_sensors::scene::{InstanceConfig, MaterialConfig, SceneBuilder, Shape};
use belvedere_sensors::simd::{Level, best_level};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Pose, Sensor};
use glam::DVec3;
use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

const SIZE: [u32; 2] = [640, 480];
const FRAMES: u64 = 100;

/// Returns the seconds of the fastest frame.
fn fastest(config: &CameraConfig<'_>, builder: &SceneBuilder, level: Level) -> Result<f64, Box<dyn Error>> {
    let camera = Camera::new(*config)?;
    let scene = builder.scene();
    let mut workspace = WorkspaceBuf::default();
    workspace.execution.level = level;
    let mut pixels = vec![0; camera.frame_len()];
    let mut least = f64::INFINITY;
    for frame in 0..FRAMES {
        let capture = Capture::new(frame, builder.moment(Pose::IDENTITY));
        let started = Instant::now();
        camera.sense_in(&mut workspace, &scene, &capture, Picture::new().colour(black_box(&mut pixels)))?;
        least = least.min(started.elapsed().as_secs_f64());
    }
    Ok(least)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(&MaterialConfig {
        emissive: [0.4; 3],
        diffuse: [0.0; 3],
        ambient: [0.0; 3],
        ..MaterialConfig::default()
    })?;
    builder.add_instance(&InstanceConfig {
        shape: Shape::Box { size: [1.0, 100.0, 100.0] },
        world_from_instance: Pose::from_translation(DVec3::X * 2.5),
        material,
        ..InstanceConfig::default()
    })?;
    let lens = PinholeGrid::from_fov(SIZE[0], SIZE[1], 1.0)?;

    let sensor = presets::machine_vision();
    let dark = sensor.exposure(Exposure { time_s: 0.0, gain: 1.0 });
    let devices: [(&str, DeviceConfig); 4] = [
        ("lit", sensor),
        ("dark", dark),
        ("vignetting and sRGB", presets::raspberry_pi_hq()),
        ("webcam", presets::webcam()),
    ];
    let formats = [
        ("mono16", PixelFormat::Mono16, 1.0),
        ("bayer_rggb8", PixelFormat::Bayer8(Mosaic::Rggb), 1.0),
        ("rgb8", PixelFormat::Rgb8, 3.0),
    ];
    let best = best_level();
    #[cfg(target_arch = "x86_64")]
    let levels = [("avx2", best.as_avx2().map(Level::Avx2)), ("avx512", best.as_avx512().map(Level::Avx512))];
    #[cfg(not(target_arch = "x86_64"))]
    let levels = [("the best", Some(best))];
    for (level_name, level) in levels {
        let Some(level) = level else { continue };
        for (format_name, format, channels) in formats {
            let config = CameraConfig::new(lens).format(format);
            let plain = fastest(&config, &builder, level)?;
            for (name, device) in devices {
                let with = fastest(&config.device(Some(device)), &builder, level)?;
                let samples = f64::from(SIZE[0] * SIZE[1]) * channels;
                println!(
                    "{level_name:7} {format_name:12} {name:20} {:6.2} ns",
                    (with - plain) * 1e9 / samples
                );
            }
        }
    }
    Ok(())
}
