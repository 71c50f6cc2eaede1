//! Instructions, counted by callgrind. The counts have no noise, so even a few per cent more are real. See
//! `benches/README.md`.
//!
//! Valgrind runs AVX2 at most, so the level is forced to it: the counts are those of the AVX2 kernels.

#![allow(missing_docs, reason = "the macros of gungraun write items of their own")]
#![allow(unreachable_pub, reason = "the modules of a program, which exports nothing")]

#[allow(dead_code, reason = "the gate writes them")]
mod budgets;
mod scenes;
mod tag_room;

use belvedere::world::scene::WorldScene;
use belvedere_sensors::camera::{Camera, Picture};
use belvedere_sensors::noise::{Stream, fill_standard_normal};
use belvedere_sensors::simd::{Level, best_level};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Execution, Sensor};
use gungraun::{
    Callgrind, CallgrindMetrics, EventKind, LibraryBenchmarkConfig, OutputFormat, library_benchmark,
    library_benchmark_group, main,
};
use scenes::fine::FineMeshes;
use scenes::ours::{Built, Caster, Tree, Wanted};
use scenes::{Mesh, RaySet, Scene, level};
use std::hint::black_box;

/// The level whose counts are recorded.
const LEVEL: &str = "avx2";
/// The tolerance above the record, in per cent.
const TOLERANCE_PERCENT: u64 = 5;

fn simd() -> Level {
    level::named(LEVEL).unwrap_or_else(best_level)
}

/// Compares a benchmark with its record, on machines that have the level.
fn limit(name: &str) -> LibraryBenchmarkConfig {
    let mut callgrind = Callgrind::with_args(["--cache-sim=no"]);
    callgrind.format([CallgrindMetrics::SingleEvent(EventKind::Ir)]);
    let budgets = budgets::Budgets::read().unwrap_or_else(|message| panic!("{message}"));
    if let (Some(recorded), Some(_)) = (budgets.instructions.get(name), level::named(LEVEL)) {
        callgrind.hard_limits([(EventKind::Ir, recorded + recorded * TOLERANCE_PERCENT / 100)]);
    }
    let mut config = LibraryBenchmarkConfig::default();
    config.tool(callgrind).output_format(OutputFormat::default().truncate_description(Some(0)));
    config
}

fn cast(scene: &str, rays: &str) -> (Built, Caster) {
    let scene = Scene::new(scene);
    let rays = RaySet::new(rays, &scene).first(20_000);
    let caster = Caster::new(&rays, Execution::at(simd()), Wanted::All);
    (Built::new(&scene.mesh), caster)
}

fn room_mesh() -> Mesh {
    Scene::new("S1").mesh
}

fn room_camera() -> (Built, Caster) {
    cast("S1", "R1")
}

fn room_rays() -> (Built, Caster) {
    cast("S1", "R5")
}

fn room_ring() -> (Built, Caster) {
    cast("S1", "R2")
}

fn warehouse_ring() -> (Built, Caster) {
    cast("S2", "R2")
}

fn noisy_ball_ring() -> (Built, Caster) {
    cast("S3", "R2")
}

fn zeros() -> Vec<f32> {
    vec![0.0; 16_384]
}

// The tree over the room, 2,112 triangles.
#[library_benchmark(config = limit("build_S1"), setup = room_mesh)]
fn build_s1(mesh: Mesh) -> Tree {
    Tree::new(black_box(&mesh), simd())
}

fn room_tree() -> (Tree, Mesh) {
    let mesh = room_mesh();
    (Tree::new(&mesh, simd()), mesh)
}

// Refitting the same tree.
#[library_benchmark(config = limit("refit_S1"), setup = room_tree)]
fn refit_s1((mut tree, mesh): (Tree, Mesh)) -> (Tree, Mesh) {
    tree.refit(black_box(&mesh.vertices), &mesh.triangles, simd());
    (tree, mesh)
}

// A camera's 307,200 rays in the room.
#[library_benchmark(config = limit("trace_S1_R1"), setup = room_camera)]
fn trace_s1_r1((built, mut caster): (Built, Caster)) -> (Built, Caster) {
    black_box(caster.cast(black_box(&built)));
    (built, caster)
}

// A planar lidar's 720 rays in the room, between the racks of a warehouse of 100,392 triangles, and beside a ball of
// 997,376.
#[library_benchmark(config = limit("trace_S1_R2"), setup = room_ring)]
fn trace_s1_r2((built, mut caster): (Built, Caster)) -> (Built, Caster) {
    black_box(caster.cast(black_box(&built)));
    (built, caster)
}

#[library_benchmark(config = limit("trace_S2_R2"), setup = warehouse_ring)]
fn trace_s2_r2((built, mut caster): (Built, Caster)) -> (Built, Caster) {
    black_box(caster.cast(black_box(&built)));
    (built, caster)
}

#[library_benchmark(config = limit("trace_S3_R2"), setup = noisy_ball_ring)]
fn trace_s3_r2((built, mut caster): (Built, Caster)) -> (Built, Caster) {
    black_box(caster.cast(black_box(&built)));
    (built, caster)
}

// 20,000 incoherent rays.
#[library_benchmark(config = limit("trace_S1_R5"), setup = room_rays)]
fn trace_s1_r5((built, mut caster): (Built, Caster)) -> (Built, Caster) {
    black_box(caster.cast(black_box(&built)));
    (built, caster)
}

fn fine_view() -> FineMeshes {
    FineMeshes::new(simd())
}

// Depths and colours of 64 × 64 pixels: bodies whose triangles are smaller than a pixel, over a terrain.
#[library_benchmark(config = limit("fine_meshes"), setup = fine_view)]
fn fine_meshes(mut view: FineMeshes) -> FineMeshes {
    black_box(&mut view).sense();
    view
}

// 16,384 normal numbers.
#[library_benchmark(config = limit("noise"), setup = zeros)]
fn noise(mut normals: Vec<f32>) -> Vec<f32> {
    let stream = Stream { seed: 1, sensor: 2, frame: 3, channel: 4 };
    fill_standard_normal(simd(), black_box(&stream), 0, &mut normals);
    normals
}

type RoomView = (WorldScene, Camera<'static>, WorkspaceBuf, Vec<u8>);

fn room_view() -> RoomView {
    let scene = tag_room::scene(&tag_room::room());
    let camera = Camera::new(tag_room::camera_of_height(16, 0.007));
    let camera = camera.expect("in range");
    let mut workspace = WorkspaceBuf::default();
    workspace.execution = Execution::at(simd());
    let capture = Capture::new(0, scene.moment(tag_room::across()));
    let _ = workspace.lend(camera.workspace_len(&scene.scene(), &capture)); // allocates
    let pixels = vec![0; camera.frame_len()];
    (scene, camera, workspace, pixels)
}

// Sixteen rows of the robot's colour image, with textures, shadows and noise.
#[library_benchmark(config = limit("tag_room_rows"), setup = room_view)]
fn tag_room_rows((scene, camera, mut workspace, mut pixels): RoomView) -> RoomView {
    let capture = Capture::new(0, scene.moment(tag_room::across()));
    let lent = &mut workspace.lend(camera.workspace_len(&scene.scene(), &capture));
    camera
        .sense(&scene.scene(), black_box(&capture), lent, Picture::new().colour(&mut pixels))
        .expect("outputs of the right size");
    (scene, camera, workspace, pixels)
}

library_benchmark_group!(
    name = counts,
    benchmarks = [
        build_s1,
        refit_s1,
        trace_s1_r1,
        trace_s1_r2,
        trace_s2_r2,
        trace_s3_r2,
        trace_s1_r5,
        fine_meshes,
        noise,
        tag_room_rows
    ]
);

main!(library_benchmark_groups = counts);
