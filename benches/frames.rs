//! Whole frames of the tag-ceiling room on one thread; see `benches/README.md`.

#[path = "tag_room/mod.rs"]
mod tag_room;

use belvedere_sensors::camera::{Camera, Picture};
use belvedere_sensors::depth::DepthFrame;
use belvedere_sensors::lidar::{Beams, Lidar, LidarConfig, Scan, TooNear};
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Sensor};
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
                camera
                    .sense(
                        &scene,
                        &capture,
                        &mut workspace.lend(camera.workspace_len(&scene, &capture)),
                        Picture::new().colour(black_box(&mut pixels)),
                    )
                    .expect("outputs of the right size");
            });
        });
    }

    let depth = tag_room::depth_camera();
    let mut depths = vec![0.0_f32; depth.pixels()];
    let capture = Capture::new(0, stage.moment(across()));
    criterion.bench_function("depth/belvedere", |bencher| {
        bencher.iter(|| {
            let output = DepthFrame::new().depth_32fc1(&mut depths);
            depth
                .sense(&scene, &capture, &mut workspace.lend(depth.workspace_len(&scene, &capture)), output)
                .expect("outputs of the right size");
        });
    });
    let shapes = compound(&world);
    criterion.bench_function("depth/parry3d", |bencher| {
        bencher.iter(|| cast_each(&shapes, &depth, &across(), black_box(&mut depths)));
    });

    let lidar = Lidar::new(
        LidarConfig::new(Beams { samples: 360, min_angle_rad: -PI, max_angle_rad: PI })
            .vertical(Beams::ONE)
            .range_min_m(0.1)
            .range_max_m(6.0)
            .too_near(TooNear::Blocks)
            .noise(GaussianNoise::of_stddev(0.01).expect("in range"))
            .seed(1)
            .sensor(1),
    )
    .expect("in range");
    let mut ranges = vec![0.0_f32; lidar.beams()];
    criterion.bench_function("scan/rplidar", |bencher| {
        bencher.iter(|| {
            lidar
                .sense(
                    &scene,
                    &capture,
                    &mut workspace.lend(lidar.workspace_len(&scene, &capture)),
                    Scan::new().ranges(black_box(&mut ranges)),
                )
                .expect("outputs of the right size");
        });
    });
}

criterion_group!(benches, frames);
criterion_main!(benches);
