//! Measures the cost of depth camera models: frames of a room with each model, compared with Gaussian noise alone.
//!
//! For each SIMD level of this machine, prints the milliseconds of a frame of 640 × 480 pixels on one core, the fastest
//! of many, and its ratio to Gaussian noise alone. With the name of a model as argument, it takes ten frames of it at
//! AVX2 and prints nothing, so that a profiler can count instructions.
//!
//! ```text
//! $ cargo run --release -p belvedere-sensors --example depth_time
//! ```

use belvedere_sensors::camera::CameraConfig;
use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig, DepthFrame};
use belvedere_sensors::device::depth_model::{DepthModel, presets, published};
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::optics::PinholeGrid;
use belvedere_sensors::scene::{InstanceConfig, MaterialConfig, SceneBuilder, Shape};
use belvedere_sensors::simd::{Level, best_level};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Pose, Sensor};
use glam::DVec3;
use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

const FRAMES: u64 = 60;

/// Takes this many frames and returns the seconds of the fastest.
fn fastest(
    model: DepthModel,
    builder: &SceneBuilder,
    level: Level,
    frames: u64,
) -> Result<f64, Box<dyn Error>> {
    let camera = CameraConfig::new(PinholeGrid::from_fov(640, 480, 1.0)?);
    let camera = DepthCamera::new(DepthCameraConfig::new(camera).model(model))?;
    let scene = builder.scene();
    let mut workspace = WorkspaceBuf::default();
    workspace.execution.level = level;
    let mut depths = vec![0.0; camera.pixels()];
    let mut least = f64::INFINITY;
    for frame in 0..frames {
        let capture = Capture::new(frame, builder.moment(Pose::from_translation(DVec3::Z)));
        let started = Instant::now();
        camera.sense_in(
            &mut workspace,
            &scene,
            &capture,
            DepthFrame::new().depth_32fc1(black_box(&mut depths)),
        )?;
        least = least.min(started.elapsed().as_secs_f64());
    }
    Ok(least)
}

/// A room with boxes, balls and cylinders.
fn room() -> Result<SceneBuilder, Box<dyn Error>> {
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(&MaterialConfig::default())?;
    let mut add = |shape, position: DVec3| {
        let world_from_instance = Pose::from_translation(position);
        builder.add_instance(&InstanceConfig { shape, world_from_instance, material, ..Default::default() })
    };
    add(Shape::Box { size: [12.0, 8.0, 0.1] }, DVec3::Z * -0.05)?;
    add(Shape::Box { size: [0.1, 8.0, 3.0] }, DVec3::new(5.0, 0.0, 1.5))?;
    add(Shape::Box { size: [12.0, 0.1, 3.0] }, DVec3::new(0.0, 2.5, 1.5))?;
    for index in 0..24 {
        let i = f64::from(index);
        let position = DVec3::new((i * 0.618).fract() * 3.0 + 1.5, (i * 0.414).fract() * 4.0 - 2.0, 0.3);
        let shapes = [
            Shape::Box { size: [0.3, 0.4, 0.6] },
            Shape::Sphere { radius: 0.3 },
            Shape::Cylinder { radius: 0.2, length: 0.6 },
        ];
        add(shapes[index as usize % 3], position)?;
    }
    Ok(builder)
}

fn main() -> Result<(), Box<dyn Error>> {
    let builder = room()?;
    let gaussian = DepthModel::from(GaussianNoise::of_stddev(0.01)?);
    let kinect = |name| presets::named(name).map_or(gaussian, |preset| preset.model(580.0));
    let mut without_shadow = kinect("kinect_v1");
    without_shadow.second_eye = None;
    let models = [
        ("none", DepthModel::new()),
        ("gaussian", gaussian),
        ("axial", published::fankhauser()),
        ("nguyen", published::nguyen()),
        ("kinect_v1 without shadow", without_shadow),
        ("kinect_v1", kinect("kinect_v1")),
        ("redwood", published::redwood()),
        ("icl_nuim", published::icl_nuim()),
        ("d435", kinect("d435")),
        ("kinect_v2", kinect("kinect_v2")),
    ];
    let best = best_level();
    #[cfg(target_arch = "x86_64")]
    let levels = [("avx2", best.as_avx2().map(Level::Avx2)), ("avx512", best.as_avx512().map(Level::Avx512))];
    #[cfg(not(target_arch = "x86_64"))]
    let levels = [("the best", Some(best))];
    if let Some(wanted) = std::env::args().nth(1) {
        let model =
            models.iter().find(|(name, _)| *name == wanted).ok_or("there is no model with this name")?;
        fastest(model.1, &builder, levels[0].1.unwrap_or(best), 10)?;
        return Ok(());
    }
    for (level_name, level) in levels {
        let Some(level) = level else { continue };
        let beside = fastest(gaussian, &builder, level, FRAMES)?;
        for (name, model) in models {
            let seconds = fastest(model, &builder, level, FRAMES)?;
            println!("{level_name:7} {name:24} {:6.2} ms {:5.2} ×", seconds * 1e3, seconds / beside);
        }
    }
    Ok(())
}
