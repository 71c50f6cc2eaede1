//! Measures the cost of wide beams, returns and weather: frames of a VLP-16 that drives among objects, every other of
//! which moves, with an individual time for each firing.
//!
//! For each SIMD level of this machine, prints the share of a core that a lidar at 10 Hz takes, from the fastest of
//! many frames, and its ratio to single rays; and for an OS1-128 the ratio to a scene without motion. With the name of
//! a configuration as argument, it takes ten frames of it at AVX2 and prints nothing, so that a profiler can count
//! instructions.
//!
//! ```text
//! $ cargo run --release -p belvedere-sensors --example beam_time
//! ```

use belvedere_sensors::scanner::{
    Beam, Echoes, Intensity, Receiver, Returns, Scanner, ScannerConfig, Weather, presets,
};
use belvedere_sensors::scene::{InstanceConfig, MaterialConfig, SceneBuilder, Shape};
use belvedere_sensors::simd::{Level, best_level};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Keyframe, Moment, Pose, Sensor};
use glam::DVec3;
use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

const FRAMES: u64 = 40;
/// The duration of a frame at 10 Hz.
const FRAME_S: f64 = 0.1;
/// The number of physics steps in a frame.
const STEPS: u32 = 20;

/// Takes this many frames, during which the sensor and every other object move or nothing does. Returns the seconds of
/// the fastest.
fn fastest(
    config: ScannerConfig<'_>,
    builder: &SceneBuilder,
    level: Level,
    frames: u64,
    moves: bool,
) -> Result<f64, Box<dyn Error>> {
    let scanner = Scanner::new(config)?;
    let times: Vec<_> = (0..=STEPS).map(|step| FRAME_S * f64::from(step) / f64::from(STEPS)).collect();
    let way = |time: f64| Pose::from_xyz_rpy(DVec3::X * time, DVec3::Z * time);
    let place = |time: f64| {
        let places = builder.poses().iter().enumerate();
        places.map(|(index, at)| if index % 2 == 0 { *at } else { *at * way(time) }).collect()
    };
    let places: Vec<Vec<_>> = times.iter().map(|time| place(*time)).collect();
    let keyframes: Vec<_> = times
        .iter()
        .zip(&places)
        .map(|(&time_s, places)| Keyframe {
            time_s,
            at: Moment {
                world_from_sensor: Pose::from_translation(DVec3::Z) * way(time_s),
                world_from_instance: places,
            },
        })
        .collect();
    let scene = builder.scene();
    let mut workspace = WorkspaceBuf::default();
    workspace.execution.level = level;
    let values = scanner.most_firings() * scanner.returns();
    let (mut points, mut intensities) = (vec![[0.0; 3]; values], vec![0.0; values]);
    let mut least = f64::INFINITY;
    for frame in 0..frames {
        let moving = Capture::new(frame, keyframes.as_slice());
        let capture = if moves { moving } else { Capture::new(frame, keyframes[0].at) };
        let output = Echoes::new().points(black_box(&mut points)).intensities(black_box(&mut intensities));
        let started = Instant::now();
        scanner.sense_in(&mut workspace, &scene, &capture, output)?;
        least = least.min(started.elapsed().as_secs_f64());
    }
    Ok(least)
}

/// A hall with boxes, balls, cylinders, and pyramids as meshes.
fn hall() -> Result<SceneBuilder, Box<dyn Error>> {
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(&MaterialConfig::default())?;
    let corners = [[0.4, 0.0, 0.0], [-0.2, 0.3, 0.0], [-0.2, -0.3, 0.0], [0.0, 0.0, 0.9]];
    let mesh = builder.add_mesh(&corners, &[[0.0; 2]; 4], &[[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]])?;
    let mut add = |shape, position: DVec3| {
        let world_from_instance = Pose::from_translation(position);
        builder.add_instance(&InstanceConfig { shape, world_from_instance, material, ..Default::default() })
    };
    // Walls and floor do not move, and neither does every other object.
    for index in 0..24 {
        let i = f64::from(index);
        let walls = [
            (Shape::Box { size: [40.0, 40.0, 0.1] }, DVec3::Z * -0.05),
            (Shape::Box { size: [0.1, 40.0, 6.0] }, DVec3::new(15.0, 0.0, 3.0)),
            (Shape::Box { size: [0.1, 40.0, 6.0] }, DVec3::new(-15.0, 0.0, 3.0)),
            (Shape::Box { size: [40.0, 0.1, 6.0] }, DVec3::new(0.0, 12.0, 3.0)),
            (Shape::Box { size: [40.0, 0.1, 6.0] }, DVec3::new(0.0, -12.0, 3.0)),
        ];
        let position = DVec3::new((i * 0.618).fract() * 20.0 - 10.0, (i * 0.414).fract() * 18.0 - 9.0, 0.6);
        let standing = walls.get(index as usize).copied();
        let (shape, at) = standing.unwrap_or((Shape::Mesh(mesh), position - DVec3::new(0.7, 1.0, 0.3)));
        add(shape, at)?;
        let shapes = [
            Shape::Box { size: [0.5, 0.6, 1.2] },
            Shape::Sphere { radius: 0.5 },
            Shape::Cylinder { radius: 0.3, length: 1.5 },
        ];
        add(shapes[index as usize % 3], position)?;
    }
    Ok(builder)
}

fn main() -> Result<(), Box<dyn Error>> {
    let builder = hall()?;
    let plain = presets::VLP_16.config();
    let beam = Beam { divergence_rad: [3e-3, 1.5e-3], aperture_m: [0.0127, 0.0095], rays: 8 };
    let dual = plain.beam(beam).returns(Returns::Dual);
    let lit = dual.intensity(Intensity::Reflectivity).receiver(Some(Receiver::new(100.0)));
    let weather = Weather { visibility_m: 100.0, rain_mm_per_h: 20.0, snow_mm_per_h: 0.0 };
    let configs = [
        ("single", plain),
        ("dual", dual),
        ("reflectivity", lit),
        ("weather", lit.weather(weather)),
        ("nineteen", lit.beam(Beam { rays: 19, ..beam })),
    ];
    let best = best_level();
    #[cfg(target_arch = "x86_64")]
    let levels = [("avx2", best.as_avx2().map(Level::Avx2)), ("avx512", best.as_avx512().map(Level::Avx512))];
    #[cfg(not(target_arch = "x86_64"))]
    let levels = [("the best", Some(best))];
    if let Some(wanted) = std::env::args().nth(1) {
        let config = configs
            .iter()
            .find(|(name, _)| *name == wanted)
            .ok_or("there is no configuration with this name")?;
        fastest(config.1, &builder, levels[0].1.unwrap_or(best), 10, true)?;
        return Ok(());
    }
    for (level_name, level) in levels {
        let Some(level) = level else { continue };
        let single = fastest(plain, &builder, level, FRAMES, true)?;
        for (name, config) in configs {
            let seconds = fastest(config, &builder, level, FRAMES, true)?;
            let share = 100.0 * seconds / FRAME_S;
            println!("{level_name:7} {name:13} {share:5.1} % of a core {:5.2} ×", seconds / single);
        }
        let ouster = presets::OS1_128.config();
        let [moving, standing] = [true, false].map(|moves| fastest(ouster, &builder, level, FRAMES, moves));
        let (moving, standing) = (moving?, standing?);
        let share = 100.0 * moving / FRAME_S;
        println!(
            "{level_name:7} {:13} {share:5.1} % of a core {:5.2} × standing",
            "os1_128",
            moving / standing
        );
    }
    Ok(())
}
