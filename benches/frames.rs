//! Whole frames of the tag-ceiling room on one thread; see `benches/README.md`.

#[path = "tag_room/mod.rs"]
mod tag_room;

use belvedere_sensors::Capture;
use belvedere_sensors::camera::Camera;
use belvedere_sensors::depth::DepthFrame;
use belvedere_sensors::lidar::{Beams, Lidar, LidarConfig, TooNear};
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::trace::WorkspaceBuf;
use criterion::{Criterion, criterion_group, criterion_main};
use std::f64::consts::PI;
use std::hint::black_box;
use tag_room::{across, camera_config, cast_each, compound, room, up};

fn frames(criterion: &mut Criterion) {
    let world = room();
    let scene = tag_room::scene(&world);
    let (stage, scene) = (&scene, scene.scene());
    let mut workspace = WorkspaceBuf::default();

    let camera = Camera::new(camera_config(0.007)).expect("in range");
    let mut pixels = vec![0; camera.frame_len()];
    for (name, world_from_sensor) in [("rgb/ceiling", up()), ("rgb/room", across())] {
        let capture = Capture::new(0, stage.moment(world_from_sensor));
        criterion.bench_function(name, |bencher| {
            bencher.iter(|| {
                camera.sense(
                    &scene,
                    &capture,
                    &mut workspace.lend(&scene, camera.rays()),
                    black_box(&mut pixels),
                );
            });
        });
    }

    let depth = tag_room::depth_camera();
    let mut depths = vec![0.0_f32; depth.pixels()];
    let capture = Capture::new(0, stage.moment(across()));
    criterion.bench_function("depth/belvedere", |bencher| {
        bencher.iter(|| {
            let output = DepthFrame { depth_32fc1: Some(&mut depths), ..DepthFrame::default() };
            depth.sense(&scene, &capture, &mut workspace.lend(&scene, depth.rays()), output);
        });
    });
    let shapes = compound(&world);
    criterion.bench_function("depth/parry3d", |bencher| {
        bencher.iter(|| cast_each(&shapes, &depth, &across(), black_box(&mut depths)));
    });

    let lidar = Lidar::new(LidarConfig {
        horizontal: Beams { samples: 360, min_angle_rad: -PI, max_angle_rad: PI },
        vertical: Beams::ONE,
        range_min_m: 0.1,
        range_max_m: 6.0,
        too_near: TooNear::Blocks,
        noise: GaussianNoise::new(0.0, 0.01, 0.0, 0.0, 0.0).expect("in range"),
        seed: 1,
        sensor: 1,
    })
    .expect("in range");
    let mut ranges = vec![0.0_f32; lidar.beams()];
    criterion.bench_function("scan/rplidar", |bencher| {
        bencher.iter(|| {
            lidar.sense(
                &scene,
                &capture,
                &mut workspace.lend(&scene, lidar.rays()),
                black_box(&mut ranges),
                &mut [],
            );
        });
    });
}

criterion_group!(benches, frames);
criterion_main!(benches);
