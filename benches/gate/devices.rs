//! Devices compared with simpler ones: moving lidars, wide beams, a stereo depth camera.

use super::clock::Clock;
use super::gate::{Entry, Gate, Unit};
use super::moments::{Stage, depths, sensor, stage};
use belvedere_sensors::camera::CameraConfig;
use belvedere_sensors::depth::DepthCameraConfig;
use belvedere_sensors::device::depth_model::{DepthModel, presets as depth_presets};
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::optics::PinholeGrid;
use belvedere_sensors::scanner::{Beam, Echoes, Returns, Scanner, ScannerConfig, presets};
use belvedere_sensors::simd::Level;
use belvedere_sensors::trace::{Faces, WorkspaceBuf};
use belvedere_sensors::{Capture, Execution, Keyframe, Moment, Pose, Sensor};
use std::hint::black_box;

const GROUP: &str = "frames";
/// A frame at 10 Hz, and the steps of physics in it.
const FRAME_NS: u64 = 100_000_000;
const STEPS: u32 = 20;

/// Measures these entries.
pub fn run(gate: &mut Gate<'_>, level: Level) {
    let entry = |name, peer| Entry { group: GROUP, name, unit: Unit::Time, peer, clock: Clock::Thread };
    let stage = stage(30);
    if gate.options.wants(GROUP, "scan_moving") {
        let ouster = presets::OS1_128.config();
        let sides = [true, false].map(|moves| scans(&stage, ouster, moves, level));
        let [mut moving, mut standing] = sides;
        gate.run(entry("scan_moving", "while all stands"), (&mut moving, 1.0), (&mut standing, 1.0));
    }
    if gate.options.wants(GROUP, "scan_beams") {
        let single = presets::VLP_16.config();
        let beam = Beam { divergence_rad: [3e-3, 1.5e-3], aperture_m: [0.0127, 0.0095], rays: 8 };
        let dual = single.beam(beam).returns(Returns::Dual);
        let [mut dual, mut single] = [dual, single].map(|config| scans(&stage, config, true, level));
        gate.run(entry("scan_beams", "single rays"), (&mut dual, 1.0), (&mut single, 1.0));
    }
    if gate.options.wants(GROUP, "depth_kinect") {
        let gaussian = DepthModel::from(GaussianNoise::of_stddev(0.01).expect("in range"));
        let mut kinect = depth_presets::named("kinect_v1").expect("our own preset").model(580.0);
        // Without its shadow, which takes a second ray per pixel and is not measured here.
        kinect.second_eye = None;
        let camera = CameraConfig::new(PinholeGrid::from_fov(640, 480, 1.0).expect("in range"));
        let sides =
            [kinect, gaussian].map(|model| DepthCameraConfig::new(camera).model(model).faces(Faces::Front));
        let [mut kinect, mut gaussian] = sides.map(|config| depths(&stage, &config, level));
        gate.run(entry("depth_kinect", "Gaussian noise"), (&mut kinect, 1.0), (&mut gaussian, 1.0));
    }
}

/// Frames of a scanner. Either it and all bodies except the ground move, or nothing does.
fn scans<'a>(
    stage: &'a Stage,
    config: ScannerConfig<'static>,
    moves: bool,
    level: Level,
) -> impl FnMut() + use<'a> {
    let scanner = Scanner::new(config).expect("our own preset");
    let way = |step: u32| f64::from(if moves { step } else { 0 }) / f64::from(STEPS);
    let places: Vec<(Pose, Vec<Pose>)> = (0..=STEPS)
        .map(|step| {
            let poses = stage.builder.poses().iter().zip(&stage.before).enumerate();
            let poses = poses.map(|(index, (now, before))| match index {
                0 => *now,
                _ => now.interpolate(before, way(step)),
            });
            (sensor(0.1 * way(step)), poses.collect())
        })
        .collect();
    let mut workspace = WorkspaceBuf::default();
    workspace.execution = Execution::at(level);
    let values = scanner.most_firings() * scanner.returns();
    let (mut points, mut intensities) = (vec![[0.0; 3]; values], vec![0.0; values]);
    move || {
        let keyframes: Vec<_> = (0..)
            .zip(&places)
            .map(|(step, (world_from_sensor, poses))| Keyframe {
                time_s: 1e-9 * FRAME_NS as f64 * f64::from(step) / f64::from(STEPS),
                at: Moment { world_from_sensor: *world_from_sensor, world_from_instance: poses },
            })
            .collect();
        let scene = stage.builder.scene();
        let capture =
            if moves { Capture::new(0, keyframes.as_slice()) } else { Capture::new(0, keyframes[0].at) };
        let output = Echoes::new().points(black_box(&mut points)).intensities(black_box(&mut intensities));
        scanner.sense_in(&mut workspace, &scene, &capture, output).expect("outputs of the right size");
    }
}
