//! Frames that are more than the depth of one moment: with ground truth, with a rolling shutter, and small ones.

use super::clock::Clock;
use super::gate::{Entry, Gate, Unit};
use belvedere_sensors::camera::{Camera, CameraConfig, Picture};
use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig, DepthFrame};
use belvedere_sensors::optics::PinholeGrid;
use belvedere_sensors::scene::{InstanceConfig, LightConfig, LightKind, MaterialConfig, SceneBuilder, Shape};
use belvedere_sensors::simd::Level;
use belvedere_sensors::trace::{Faces, Truth, WorkspaceBuf};
use belvedere_sensors::{Capture, Execution, Moment, Pose, Sensor, Slice};
use glam::DVec3;
use std::hint::black_box;

const GROUP: &str = "frames";

/// Measures these entries.
pub fn run(gate: &mut Gate<'_>, level: Level) {
    let entry = |name, peer| Entry { group: GROUP, name, unit: Unit::Time, peer, clock: Clock::Thread };
    if gate.options.wants(GROUP, "truth") {
        let stage = stage(30);
        let sides = [true, false].map(|all| truth_frames(&stage, all, level));
        let [mut all, mut depth] = sides;
        gate.run(entry("truth", "depth alone"), (&mut all, 1.0), (&mut depth, 1.0));
    }
    if gate.options.wants(GROUP, "rolling_shutter") {
        let stage = stage(30);
        let sides = [true, false].map(|rolling| pictures(&stage, rolling, level));
        let [mut rolling, mut global] = sides;
        gate.run(entry("rolling_shutter", "all rows at once"), (&mut rolling, 1.0), (&mut global, 1.0));
    }
    if gate.options.wants(GROUP, "depth_64x64") {
        let stage = stage(40);
        // One image has as many rays as 75 small ones, so the ratio shows the cost of a small image apart from its
        // rays.
        let sides =
            [[64, 64], [640, 480]].map(|size| DepthCameraConfig::new(camera(size)).faces(Faces::Front));
        let [mut small, mut large] = sides.map(|config| depths(&stage, &config, level));
        let mut many = || (0..75).for_each(|_| small());
        gate.run(entry("depth_64x64", "as many rays in one"), (&mut many, 1.0), (&mut large, 1.0));
    }
}

/// A ground, a lamp, and bodies of several kinds at two times: at the timestamp, and one frame earlier.
pub(super) struct Stage {
    pub(super) builder: SceneBuilder,
    pub(super) before: Vec<Pose>,
}

pub(super) fn stage(bodies: u32) -> Stage {
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(&MaterialConfig::default()).expect("a plain material");
    let mut add = |shape, world_from_instance| {
        let config = InstanceConfig { shape, world_from_instance, material, ..InstanceConfig::default() };
        builder.add_instance(&config).expect("our own instance");
    };
    add(Shape::Rectangle { size: [40.0; 2] }, Pose::IDENTITY);
    for body in 0..bodies {
        let i = f64::from(body);
        let at = DVec3::new(2.0 + (i * 0.618).fract() * 8.0, ((i * 0.414).fract() - 0.5) * 8.0, 0.4);
        let shape = match body % 3 {
            0 => Shape::Box { size: [0.6, 0.5, 0.8] },
            1 => Shape::Cylinder { radius: 0.3, length: 0.8 },
            _ => Shape::Sphere { radius: 0.4 },
        };
        add(shape, Pose::from_xyz_rpy(at, DVec3::new(0.0, 0.0, i)));
    }
    let lamp = LightConfig {
        kind: LightKind::Point { position: [3.0, 1.0, 6.0] },
        diffuse: [1.0; 3],
        cast_shadows: true,
        ..Default::default()
    };
    builder.add_light(&lamp).expect("our own lamp");
    let shift = Pose::from_translation(DVec3::new(0.02, -0.01, 0.0));
    let before = builder.poses().iter().map(|pose| shift * *pose).collect();
    Stage { builder, before }
}

pub(super) fn sensor(turn: f64) -> Pose {
    Pose::from_xyz_rpy(DVec3::new(0.0, 0.0, 1.2), DVec3::new(0.0, 0.15, turn))
}

fn camera(size: [u32; 2]) -> CameraConfig<'static> {
    CameraConfig::new(PinholeGrid::from_fov(size[0], size[1], 1.2).expect("in range"))
}

/// Renders depths and, with `all`, normals, instances, classes and backward flow.
///
/// The channels of 320 × 240 pixels are 2.5 MB and stay in the last-level cache. Those of 640 × 480 pixels do not: their
/// ratio depends on the speed of the memory, and was 0.29 to 0.33 in six runs on one machine at AVX-512.
fn truth_frames(stage: &Stage, all: bool, level: Level) -> impl FnMut() + use<'_> {
    let [width, height] = [320, 240];
    let camera = Camera::new(camera([width, height])).expect("in range");
    let rays = (width * height) as usize;
    let mut workspace = WorkspaceBuf::default();
    workspace.execution = Execution::at(level);
    let (mut depth, mut normal) = (vec![0.0; rays], vec![[0.0; 3]; rays]);
    let (mut instance, mut class, mut flow) = (vec![0; rays], vec![0; rays], vec![[0.0; 2]; rays]);
    move || {
        let scene = stage.builder.scene();
        let before = Moment { world_from_sensor: sensor(0.01), world_from_instance: &stage.before };
        let capture = Capture::new(0, stage.builder.moment(sensor(0.0))).before(before);
        let mut truth = Truth::new().depth(black_box(&mut depth));
        if all {
            truth = truth.normal(&mut normal).instance(&mut instance).class(&mut class).flow_back(&mut flow);
        }
        camera
            .sense_in(&mut workspace, &scene, &capture, Picture::new().truth(truth))
            .expect("outputs of the right size");
    }
}

/// Renders images, with `rolling` with a moment for each row.
fn pictures(stage: &Stage, rolling: bool, level: Level) -> impl FnMut() + use<'_> {
    let camera = Camera::new(camera([640, 480])).expect("in range");
    let mut workspace = WorkspaceBuf::default();
    workspace.execution = Execution::at(level);
    let mut pixels = vec![0; camera.frame_len()];
    let moments: Vec<(Pose, Vec<Pose>)> = (0..480)
        .map(|row| {
            let share = f64::from(row) / 480.0;
            let poses = stage.builder.poses().iter().zip(&stage.before);
            (sensor(0.01 * share), poses.map(|(now, before)| now.interpolate(before, share)).collect())
        })
        .collect();
    move || {
        let scene = stage.builder.scene();
        let slices: Vec<_> = moments
            .iter()
            .zip(0..)
            .map(|((world_from_sensor, poses), row)| Slice {
                lines: row..row + 1,
                at: Moment { world_from_sensor: *world_from_sensor, world_from_instance: poses },
            })
            .collect();
        let capture = if rolling {
            Capture::new(0, slices.as_slice())
        } else {
            Capture::new(0, stage.builder.moment(sensor(0.0)))
        };
        camera
            .sense_in(&mut workspace, &scene, &capture, Picture::new().colour(black_box(&mut pixels)))
            .expect("outputs of the right size");
    }
}

/// Renders depth frames of a camera.
pub fn depths<'a>(
    stage: &'a Stage,
    config: &DepthCameraConfig<'static>,
    level: Level,
) -> impl FnMut() + use<'a> {
    let camera = DepthCamera::new(*config).expect("in range");
    let mut workspace = WorkspaceBuf::default();
    workspace.execution = Execution::at(level);
    let mut depths = vec![0.0; camera.pixels()];
    move || {
        let scene = stage.builder.scene();
        let capture = Capture::new(0, stage.builder.moment(sensor(0.0)));
        let output = DepthFrame::new().depth_32fc1(black_box(&mut depths));
        camera.sense_in(&mut workspace, &scene, &capture, output).expect("outputs of the right size");
    }
}
