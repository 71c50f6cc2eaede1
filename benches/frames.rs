//! Whole frames of the tag-ceiling room on one thread; see `benches/README.md`.

use belvedere::description::Diagnostics;
use belvedere::description::model::{Geometry, World};
use belvedere::description::package::PackagePath;
use belvedere::description::world::load_world;
use belvedere::world::physics::Physics;
use belvedere::world::scene::WorldScene;
use belvedere_sensors::Pose;
use belvedere_sensors::camera::{Camera, CameraConfig, PixelFormat};
use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig, DepthFrame, OutOfRange};
use belvedere_sensors::lidar::{Beams, Lidar, LidarConfig, TooNear};
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::trace::{Capture, WorkspaceBuf};
use criterion::{Criterion, criterion_group, criterion_main};
use glam::DVec3;
use parry3d::math::Pose as ParryPose;
use parry3d::query::{Ray, RayCast as _};
use parry3d::shape::{Ball, Compound, Cuboid, Cylinder, SharedShape};
use std::f64::consts::{FRAC_PI_2, PI};
use std::hint::black_box;

fn room() -> World {
    let mut diagnostics = Diagnostics::default();
    load_world("tag_ceiling", &PackagePath::new([], None), false, &mut diagnostics)
        .expect("our own world loads")
}

fn camera_config(stddev: f32) -> CameraConfig {
    CameraConfig {
        width: 640,
        height: 480,
        horizontal_fov_rad: 1.396_263_4,
        format: PixelFormat::Rgb8,
        near_m: 0.02,
        far_m: 300.0,
        noise: GaussianNoise::new(0.0, stddev, 0.0, 0.0, 0.0).expect("in range"),
        seed: 1,
        sensor: 0,
    }
}

/// Looks straight up from where the robot's camera is.
fn up() -> Pose {
    Pose::from_xyz_rpy(DVec3::new(0.3, -0.2, 0.36), DVec3::new(0.0, -FRAC_PI_2, 0.0))
}

/// Looks across the room.
fn across() -> Pose {
    Pose::from_xyz_rpy(DVec3::new(-1.5, 0.4, 0.6), DVec3::new(0.0, 0.1, 0.3))
}

fn frames(criterion: &mut Criterion) {
    let world = room();
    let physics = Physics::new(&world, &[]).expect("our own world runs");
    let scene = WorldScene::new(&world, &[], &physics).expect("our own world shows");
    let scene = scene.scene();
    let mut workspace = WorkspaceBuf::default();

    let camera = Camera::new(camera_config(0.007)).expect("in range");
    let mut pixels = vec![0; camera.frame_len()];
    for (name, world_from_sensor) in [("rgb/ceiling", up()), ("rgb/room", across())] {
        let capture = Capture { world_from_sensor, frame: 0 };
        criterion.bench_function(name, |bencher| {
            bencher.iter(|| {
                camera.sense(
                    &scene,
                    &capture,
                    &mut workspace.lend(&scene, camera.rays()),
                    black_box(&mut pixels),
                )
            });
        });
    }

    let depth = DepthCamera::new(DepthCameraConfig {
        camera: camera_config(0.0),
        min_depth_m: 0.1,
        max_depth_m: 20.0,
        out_of_range: OutOfRange::Infinite,
        noise: GaussianNoise::NONE,
    })
    .expect("in range");
    let mut depths = vec![0.0_f32; depth.pixels()];
    let capture = Capture { world_from_sensor: across(), frame: 0 };
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
            )
        });
    });
}

/// What the cameras see, as parry3d has it.
fn compound(world: &World) -> Compound {
    let mut parts = Vec::new();
    for model in &world.models {
        for link in &model.links {
            for visual in &link.visuals {
                let pose = model.world_from_model * link.model_from_link * visual.link_from_visual;
                let (shape, turn) = match visual.geometry {
                    Geometry::Box { size } => {
                        (SharedShape::new(Cuboid::new((size * 0.5).as_vec3())), Pose::IDENTITY)
                    }
                    Geometry::Sphere { radius } => {
                        (SharedShape::new(Ball::new(radius as f32)), Pose::IDENTITY)
                    }
                    // parry's lies along y.
                    Geometry::Cylinder { radius, length } => (
                        SharedShape::new(Cylinder::new(length as f32 * 0.5, radius as f32)),
                        Pose::from_xyz_rpy(DVec3::ZERO, DVec3::new(FRAC_PI_2, 0.0, 0.0)),
                    ),
                    _ => continue,
                };
                let pose = pose * turn;
                parts.push((
                    ParryPose::from_parts(pose.translation().as_vec3(), pose.rotation().as_quat()),
                    shape,
                ));
            }
        }
    }
    Compound::new(parts)
}

fn cast_each(shapes: &Compound, depth: &DepthCamera, world_from_sensor: &Pose, depths: &mut [f32]) {
    let lens = depth.camera().lens();
    let origin = world_from_sensor.translation().as_vec3();
    for (index, depth) in depths.iter_mut().enumerate() {
        let pixel = [index % lens.width as usize, index / lens.width as usize].map(|at| at as f64);
        let optical = lens.unproject(pixel);
        let ray = world_from_sensor.transform_vector(DVec3::new(1.0, -optical.x, -optical.y)).as_vec3();
        *depth = shapes
            .cast_ray(&ParryPose::IDENTITY, &Ray::new(origin, ray), 20.0, true)
            .unwrap_or(f32::INFINITY);
    }
}

criterion_group!(benches, frames);
criterion_main!(benches);
