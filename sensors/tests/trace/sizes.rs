//! Common sizes of pictures and scans of cameras and lidars, on one thread and more.
#![cfg(feature = "std")]

use crate::common::{LIDAR, add_grey, camera_of};
use belvedere_sensors::camera::{Camera, Picture, PixelFormat};
use belvedere_sensors::lidar::{Beams, Lidar, Scan};
use belvedere_sensors::scene::{SceneBuilder, Shape};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Execution, Pose, Sensor};
use glam::DVec3;

/// Picture sizes of cameras on the market, and those that have failed before.
const PICTURES: [[u32; 2]; 36] = [
    [160, 120],
    [176, 144],
    [320, 180],
    [320, 240],
    [352, 288],
    [424, 240],
    [480, 270],
    [512, 424],
    [640, 360],
    [640, 400],
    [640, 480],
    [672, 376],
    [720, 405],
    [720, 480],
    [720, 576],
    [752, 480],
    [800, 600],
    [808, 608],
    [848, 480],
    [960, 540],
    [1000, 1000],
    [1024, 768],
    [1280, 720],
    [1280, 800],
    [1280, 960],
    [1280, 1024],
    [1296, 972],
    [1440, 1080],
    [1600, 1200],
    [1640, 1232],
    [1920, 1080],
    [1936, 1216],
    [2048, 1536],
    [2448, 2048],
    [2592, 1944],
    [3280, 2464],
];

/// Numbers of beams per line and of lines, of lidars on the market.
const SCANS: [[u32; 2]; 24] = [
    [360, 1],
    [541, 1],
    [640, 1],
    [682, 1],
    [720, 1],
    [726, 1],
    [811, 1],
    [1081, 1],
    [1141, 1],
    [1440, 1],
    [1600, 1],
    [3600, 1],
    [16384, 1],
    [1800, 16],
    [3600, 16],
    [2170, 32],
    [1800, 40],
    [512, 64],
    [1024, 64],
    [2048, 64],
    [1024, 128],
    [2048, 128],
    [1843, 128],
    [1, 16384],
];

/// A ball around the sensor: every ray hits it.
fn ball() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    add_grey(&mut builder, Shape::Sphere { radius: 2.0 }, Pose::IDENTITY);
    add_grey(&mut builder, Shape::Sphere { radius: 0.5 }, Pose::from_translation(DVec3::new(1.2, 0.1, 0.2)));
    builder
}

/// A capture from the origin.
fn capture(builder: &SceneBuilder) -> Capture<'_> {
    Capture::new(0, builder.moment(Pose::IDENTITY))
}

fn ways() -> Vec<Execution> {
    #[cfg(feature = "rayon")]
    return vec![Execution::default(), Execution::parallel()];
    #[cfg(not(feature = "rayon"))]
    return vec![Execution::default()];
}

#[test]
fn pictures_of_common_sizes_are_taken() {
    let builder = ball();
    for [width, height] in PICTURES {
        let camera = Camera::new(camera_of([width, height], 1.2).format(PixelFormat::Mono8)).unwrap();
        let mut pictures = Vec::new();
        for execution in ways() {
            let mut workspace = WorkspaceBuf::default();
            workspace.execution = execution;
            let mut pixels = vec![0; camera.frame_len()];
            let (scene, capture) = (builder.scene(), capture(&builder));
            camera
                .sense(
                    &scene,
                    &capture,
                    &mut workspace.lend(camera.workspace_len(&scene, &capture)),
                    Picture::new().colour(&mut pixels),
                )
                .expect("outputs of the right size");
            pictures.push(pixels);
        }
        let first = &pictures[0];
        assert!(pictures.iter().all(|picture| picture == first), "{width} × {height}: threads change it");
        // The small ball is grey and in the middle.
        assert_eq!(first[((height / 2) * width + width / 2) as usize], 128, "{width} × {height}");
    }
}

#[test]
fn scans_of_common_sizes_are_taken() {
    let builder = ball();
    for [samples, lines] in SCANS {
        let turn = core::f64::consts::TAU;
        let step = turn / f64::from(samples);
        let lidar = Lidar::new(
            LIDAR
                .horizontal(Beams { samples, min_angle_rad: 0.0, max_angle_rad: turn - step })
                .vertical(Beams { samples: lines, min_angle_rad: -0.4, max_angle_rad: 0.4 }),
        )
        .unwrap();
        for execution in ways() {
            let mut workspace = WorkspaceBuf::default();
            workspace.execution = execution;
            let mut ranges = vec![0.0; lidar.beams()];
            let (scene, capture) = (builder.scene(), capture(&builder));
            let mut lent = workspace.lend(lidar.workspace_len(&scene, &capture));
            lidar
                .sense(&scene, &capture, &mut lent, Scan::new().ranges(&mut ranges))
                .expect("outputs of the right size");
            let wrong = ranges.iter().filter(|range| !(0.7..=2.00001).contains(*range)).count();
            assert_eq!(wrong, 0, "{samples} × {lines}: rays out of the ball");
        }
    }
}
