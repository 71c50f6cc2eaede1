//! Entries other than casts: builds of trees, moving scenes, whole frames, several threads.

use super::clock::Clock;
use super::gate::{Entry, Gate, Unit};
use super::idle;
use crate::scenes::moving::{self, MovingBoxes};
use crate::scenes::{RaySet, Scene, ours, peer};
use crate::tag_room;
use belvedere::world::scene::WorldScene;
use belvedere_sensors::camera::{Camera, CameraConfig, Picture};
use belvedere_sensors::device::presets;
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::simd::Level;
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Execution, Sensor};
use std::hint::black_box;

/// The group of these entries.
const GROUP: &str = "frames";

/// Measures these entries.
pub fn run(gate: &mut Gate<'_>, level: Level) {
    build(gate, level);
    moving_instances(gate, level);
    depth_frame(gate, level, "S1", "depth_S1");
    depth_frame(gate, level, "S3", "depth_S3");
    two_threads(gate, level);
    tag_room_rgb(gate, level);
    device_rgb(gate, level);
}

fn entry<'a>(name: &'a str, peer: &'a str, clock: Clock) -> Entry<'a> {
    Entry { group: GROUP, name, unit: Unit::Time, peer, clock }
}

/// Building a tree from triangles in memory, and refitting it after all vertices moved. A refit is compared with
/// parry3d's refit, because both are limited by memory: compared with a build, which is not, the ratio fell by a sixth
/// whenever the processor's clock rose by a fifth.
fn build(gate: &mut Gate<'_>, level: Level) {
    let [build, refit] = ["build_S3", "refit_S3"].map(|name| gate.options.wants(GROUP, name));
    if !build && !refit {
        return;
    }
    let mesh = Scene::new("S3").mesh;
    if build {
        gate.run(
            entry("build_S3", "parry3d", Clock::Thread),
            (&mut || drop(black_box(ours::Tree::new(&mesh, level))), 1.0),
            (&mut || drop(black_box(peer::Built::new(&mesh))), 1.0),
        );
    }
    if refit {
        let mut ours = ours::Tree::new(&mesh, level);
        let moved: Vec<_> = mesh.vertices.iter().map(|[x, y, z]| [x + 0.01, *y, z + 0.01 * x]).collect();
        let turns = [&mesh.vertices, &moved];
        let mut turn = 0;
        let mut refit = || {
            turn += 1;
            ours.refit(turns[turn % 2], &mesh.triangles, level);
        };
        let mut theirs = peer::Built::new(&mesh);
        let mut their_turn = 0;
        let mut their_refit = || {
            their_turn += 1;
            theirs.refit(turns[their_turn % 2]);
        };
        gate.run(entry("refit_S3", "parry3d", Clock::Thread), (&mut refit, 1.0), (&mut their_refit, 1.0));
    }
}

/// A frame of 500 boxes that have all moved, with only a few rays.
fn moving_instances(gate: &mut Gate<'_>, level: Level) {
    if !gate.options.wants(GROUP, "moving_500") {
        return;
    }
    let mut ours = ours::Moving::new(moving::COUNT, level);
    let mut theirs = peer::Moving::new(moving::COUNT);
    let (mut our_boxes, mut their_boxes) = (MovingBoxes::new(), MovingBoxes::new());
    gate.run(
        entry("moving_500", "parry3d", Clock::Thread),
        (&mut || ours.frame(our_boxes.step()), 1.0),
        (&mut || theirs.frame(their_boxes.step()), 1.0),
    );
}

/// Tracing, noise and encoding of a depth camera, compared with tracing alone.
fn depth_frame(gate: &mut Gate<'_>, level: Level, scene: &str, name: &str) {
    if !gate.options.wants(GROUP, name) {
        return;
    }
    let scene = Scene::new(scene);
    let rays = RaySet::new("R1", &scene);
    let built = ours::Built::new(&scene.mesh);
    let noise = GaussianNoise::of_stddev(0.01).expect("in range");
    let execution = Execution::at(level);
    let mut whole = ours::DepthFrames::new(&rays, noise, execution);
    let mut trace = ours::Caster::new(&rays, execution, ours::Wanted::Distance);
    gate.run(
        entry(name, "its trace alone", Clock::Thread),
        (&mut || whole.sense(&built), 1.0),
        (
            &mut || {
                black_box(trace.cast(&built));
            },
            1.0,
        ),
    );
}

/// The same frame on two threads and on one.
fn two_threads(gate: &mut Gate<'_>, level: Level) {
    if !gate.options.wants(GROUP, "two_threads") {
        return;
    }
    if let Some(why) = idle::lacking() {
        gate.leave_out(GROUP, "two_threads", &why);
        return;
    }
    let scene = Scene::new("S3");
    let rays = RaySet::new("R1", &scene);
    let built = ours::Built::new(&scene.mesh);
    let one = Execution::at(level);
    let both = Execution { parallel: true, ..one };
    let mut one = ours::DepthFrames::new(&rays, GaussianNoise::NONE, one);
    let mut both = ours::DepthFrames::new(&rays, GaussianNoise::NONE, both);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("two threads");
    gate.run(
        entry("two_threads", "one thread", Clock::Wall),
        (&mut || pool.install(|| both.sense(&built)), 1.0),
        (&mut || one.sense(&built), 1.0),
    );
}

/// The robot's colour camera, with textures, shadows and noise, compared with parry3d's depth of the same view.
fn tag_room_rgb(gate: &mut Gate<'_>, level: Level) {
    if !gate.options.wants(GROUP, "tag_room_rgb") {
        return;
    }
    let world = tag_room::room();
    let built = tag_room::scene(&world);
    let scene = built.scene();
    let mut workspace = WorkspaceBuf::default();
    workspace.execution = Execution::at(level);
    let camera = Camera::new(tag_room::camera_config(0.007)).expect("in range");
    let mut pixels = vec![0; camera.frame_len()];
    let capture = Capture::new(0, built.moment(tag_room::across()));

    let mut sense = || {
        camera
            .sense_in(&mut workspace, &scene, &capture, Picture::new().colour(black_box(&mut pixels)))
            .expect("outputs of the right size");
    };

    let shapes = tag_room::compound(&world);
    let depth = tag_room::depth_camera();
    let mut depths = vec![0.0; depth.pixels()];
    gate.run(
        entry("tag_room_rgb", "depth by parry3d", Clock::Thread),
        (&mut sense, 1.0),
        (&mut || tag_room::cast_each(&shapes, &depth, &tag_room::across(), black_box(&mut depths)), 1.0),
    );
}

/// The same image with the device of a webcam, compared with the image without a device.
fn device_rgb(gate: &mut Gate<'_>, level: Level) {
    if !gate.options.wants(GROUP, "device_rgb") {
        return;
    }
    let built = tag_room::scene(&tag_room::room());
    let plain = tag_room::camera_config(0.0);
    gate.run(
        entry("device_rgb", "without a device", Clock::Thread),
        (&mut pictures(&built, &plain.device(Some(presets::webcam())), level), 1.0),
        (&mut pictures(&built, &plain, level), 1.0),
    );
}

/// Renders an image of the room at each call.
fn pictures<'a>(built: &'a WorldScene, config: &CameraConfig<'a>, level: Level) -> impl FnMut() + use<'a> {
    let camera = Camera::new(*config).expect("in range");
    let mut workspace = WorkspaceBuf::default();
    workspace.execution = Execution::at(level);
    let mut pixels = vec![0; camera.frame_len()];
    move || {
        let scene = built.scene();
        let capture = Capture::new(0, built.moment(tag_room::across()));
        camera
            .sense_in(&mut workspace, &scene, &capture, Picture::new().colour(black_box(&mut pixels)))
            .expect("outputs of the right size");
    }
}
