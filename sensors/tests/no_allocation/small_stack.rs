//! Everything that senses, casts or builds runs on a thread with 64 KiB of stack, at every SIMD level.
//!
//! A call that needs more ends the whole program, and the system's message contains the name of the thread, which is
//! the name of the call.

use crate::common::casts::levels;
use crate::common::{LIDAR, add, camera_of, scenery, spot};
use belvedere_sensors::camera::{Camera, CameraConfig, Edges, Picture};
use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig, DepthFrame, POINT_STEP};
use belvedere_sensors::device::DeviceConfig;
use belvedere_sensors::device::depth_model::presets as depth_presets;
use belvedere_sensors::lidar::{Beams, Lidar, Scan};
use belvedere_sensors::noise::{GaussianNoise, GaussianNoiseConfig};
use belvedere_sensors::optics::{Intrinsics, KannalaBrandt, Optics, PinholeGrid, RayTableBuf};
use belvedere_sensors::scanner::{
    Beam, Crosstalk, Echoes, Halo, Intensity, Receiver, Returns, Scanner, ScannerConfig, Weather, presets,
};
use belvedere_sensors::scene::visibility::VISUAL;
use belvedere_sensors::scene::{
    InstanceConfig, LightConfig, MaterialConfig, Pbr, Scene, SceneBuilder, Shape, TextureAlpha, TextureMode,
    build,
};
use belvedere_sensors::trace::rays::{
    MeshTree, Rays, cast_mesh, cast_rays, occluded_by_mesh, occluded_rays, workspace_len,
};
use belvedere_sensors::trace::{
    Faces, Hits, Landmark, Sighting, Truth, WorkspaceBuf, cast_grid, grid_workspace_len,
    landmarks_workspace_len, see_landmarks,
};
use belvedere_sensors::{Capture, Execution, Keyframe, Moment, Pose, Sensor, Shutter, Slice};
use glam::DVec3;
use std::thread;

/// The size of a thread's stack in bytes. The operating system and the standard library use about 5 kB of it.
const STACK: usize = 64 * 1024;
/// The size of the pictures in pixels.
const SIZE: [u32; 2] = [80, 60];

/// Runs a call on a thread with a small stack.
fn run(name: &str, call: impl FnOnce() + Send) {
    thread::scope(|scope| {
        let builder = thread::Builder::new().name(name.into()).stack_size(STACK);
        builder.spawn_scoped(scope, call).unwrap().join().unwrap();
    });
}

/// Runs `work` for each SIMD level of the machine.
fn at_each_level(work: impl Fn(&str, Execution)) {
    for (name, level) in levels() {
        let Some(level) = level else { continue };
        work(name, Execution::at(level));
    }
}

/// Takes a frame of a sensor on a thread with a small stack.
fn sense<S: Sensor + Sync>(
    name: &str,
    sensor: &S,
    (builder, capture, execution): (&SceneBuilder, &Capture<'_>, Execution),
    output: S::Output<'_>,
) where
    for<'a> S::Output<'a>: Send,
{
    let (scene, mut memory) = (builder.scene(), WorkspaceBuf::default());
    memory.execution = execution;
    let mut workspace = memory.lend(sensor.workspace_len(&scene, capture));
    run(name, || sensor.sense(&scene, capture, &mut workspace, output).unwrap());
}

/// Corners and triangles of a ball.
fn ball() -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let (around, down) = (48, 32);
    let corner = |index: u32| {
        let turn = f64::from(index % around) / f64::from(around) * core::f64::consts::TAU;
        let tilt = f64::from(index / around) / f64::from(down - 1) * core::f64::consts::PI;
        [tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), tilt.cos()].map(|value| 0.5 * value as f32)
    };
    let triangles = (0..around * (down - 1)).flat_map(|index| {
        let beside = index - index % around + (index + 1) % around;
        [[index, index + around, beside], [beside, index + around, beside + around]]
    });
    ((0..around * down).map(corner).collect(), triangles.collect())
}

/// The scenery with meshes, a height field, maps of all kinds, highlights, clear surfaces and, if `glazed`, mirrors and
/// panes.
fn stage(glazed: bool) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    scenery(&mut builder);
    let (corners, triangles) = ball();
    let uvs: Vec<_> = corners.iter().map(|[x, y, _]| [*x, *y]).collect();
    let texels: Vec<[u8; 4]> = (0..64_u32).map(|i| [i as u8, 128, 255, (i * 4) as u8]).collect();
    let texture = Some(builder.add_texture(8, 8, &texels).unwrap());
    let normal_map = Some(builder.add_normal_map(8, 8, &texels).unwrap());
    let gloss = MaterialConfig { specular: [0.6; 3], shininess: 25.0, ..Default::default() };
    let (specular_reflectance, transmittance) = if glazed { (0.4, 0.5) } else { (0.0, 0.0) };
    let looks = [
        MaterialConfig { texture, normal_map, ..gloss },
        MaterialConfig {
            texture,
            texture_mode: TextureMode::Light,
            texture_alpha: TextureAlpha::Blended,
            alpha: 0.5,
            ..gloss
        },
        MaterialConfig {
            specular_reflectance,
            transmittance,
            pbr: Some(Pbr { roughness: 0.4, ..Default::default() }),
            pbr_map: normal_map,
            emissive: [0.1; 3],
            emissive_map: texture,
            ..gloss
        },
    ];
    let materials = looks.map(|look| builder.add_material(&look).unwrap());
    let mesh = Shape::Mesh(builder.add_mesh(&corners, &uvs, &triangles).unwrap());
    let heights: Vec<f32> = (0..40 * 30).map(|i: u32| (i * 7 % 11) as f32 * 0.02).collect();
    let terrain = Shape::HeightField(builder.add_height_field(40, 30, [9.0, 7.0], &heights).unwrap());
    let shapes = [mesh, Shape::Box { size: [0.1, 0.9, 0.9] }, terrain, Shape::Sphere { radius: 0.4 }];
    for (number, shape) in shapes.into_iter().cycle().take(12).enumerate() {
        let i = number as f64;
        let place = DVec3::new(-1.5 + 0.3 * i, (0.41 * i).fract() * 3.0 - 1.5, 0.8 + 0.05 * i);
        let pose = Pose::from_xyz_rpy(place, DVec3::splat(0.4 * i));
        add(&mut builder, shape, pose, materials[number % 3]);
    }
    let kind = spot([-2.5, 0.5, 2.5], DVec3::new(0.6, 0.0, -0.8), [0.9, 0.7, 1.7]);
    builder.add_light(&LightConfig { kind, specular: [0.9; 3], ..Default::default() }).unwrap();
    builder
}

/// The pose of the sensors.
fn eye() -> Pose {
    Pose::from_xyz_rpy(DVec3::new(-3.2, 0.3, 1.4), DVec3::new(0.1, 0.2, -0.05))
}

fn noise() -> GaussianNoise {
    GaussianNoise::new(GaussianNoiseConfig::default().mean(0.001).stddev(0.007)).unwrap()
}

/// A pinhole's rays and a fisheye's.
fn each_optics(work: impl Fn(Optics<'_>)) {
    let [width, height] = SIZE;
    let intrinsics = Intrinsics { fx: 30.0, fy: 30.0, cx: 39.5, cy: 29.5, skew: 0.0 };
    let lens = KannalaBrandt::new(intrinsics, [0.01, 0.0, 0.0, 0.0]).unwrap();
    let mut table = None;
    run("a table of rays", || table = Some(RayTableBuf::from_lens(width, height, &lens).unwrap()));
    work(PinholeGrid::from_fov(width, height, 1.2).unwrap().into());
    work(table.unwrap().table().into());
}

#[test]
fn cameras() {
    at_each_level(|level, execution| {
        for builder in [stage(false), stage(true)] {
            let at = builder.moment(eye());
            let blurred: Vec<_> = (0..3).map(|_| Slice { lines: 0..SIZE[1], at }).collect();
            let pixels = (SIZE[0] * SIZE[1]) as usize;
            each_optics(|optics| {
                for edges in [Edges::Sharp, Edges::Smooth] {
                    let config = CameraConfig::new(optics).edges(edges).noise(noise());
                    let camera = Camera::new(config.device(Some(DeviceConfig::default()))).unwrap();
                    let mut colour = vec![0; camera.frame_len()];
                    let (mut normal, mut incidence) = (vec![[0.0; 3]; pixels], vec![0.0; pixels]);
                    let mut flow = vec![[0.0; 2]; pixels];
                    let truth = Truth::new().normal(&mut normal).incidence(&mut incidence).flow(&mut flow);
                    let capture = Capture::new(1, at).after(at);
                    let output = Picture::new().colour(&mut colour).truth(truth);
                    sense(&format!("camera {level}"), &camera, (&builder, &capture, execution), output);
                    let capture = Capture::new(1, &blurred[..]);
                    let output = Picture::new().colour(&mut colour);
                    sense(&format!("blur {level}"), &camera, (&builder, &capture, execution), output);
                }
            });
        }
    });
}

#[test]
fn depth_cameras() {
    let camera = camera_of(SIZE, 1.2).noise(noise()).edges(Edges::Smooth);
    let plain = DepthCameraConfig::new(camera);
    let presets =
        depth_presets::ALL.iter().map(|preset| DepthCameraConfig::of_preset(preset).unwrap().camera(camera));
    let configs: Vec<_> = presets.chain([plain, plain.model(noise()).faces(Faces::Front)]).collect();
    at_each_level(|level, execution| {
        for builder in [stage(false), stage(true)] {
            for config in &configs {
                let camera = DepthCamera::new(*config).unwrap();
                let pixels = camera.pixels();
                let (mut metres, mut millimetres) = (vec![0.0; pixels], vec![0; pixels]);
                let (mut colour, mut points) = (vec![0; 3 * pixels], vec![0; POINT_STEP * pixels]);
                let mut normal = vec![[0.0; 3]; pixels];
                let output = DepthFrame::new().depth_32fc1(&mut metres).depth_16uc1(&mut millimetres);
                let output = output.colour(&mut colour).points(&mut points);
                let output = output.truth(Truth::new().normal(&mut normal));
                let capture = Capture::new(1, builder.moment(eye()));
                sense(&format!("depth {level}"), &camera, (&builder, &capture, execution), output);
            }
        }
    });
}

#[test]
fn lidars() {
    let vertical = Beams { samples: 16, min_angle_rad: -0.4, max_angle_rad: 0.3 };
    let lidar = Lidar::new(LIDAR.vertical(vertical).noise(noise()).visibility(u32::MAX)).unwrap();
    at_each_level(|level, execution| {
        for builder in [stage(false), stage(true)] {
            let at = builder.moment(eye());
            let columns: Vec<_> = (0..720).map(|column| Slice { lines: column..column + 1, at }).collect();
            for capture in [Capture::new(1, at), Capture::new(1, &columns[..])] {
                let (mut ranges, mut intensities) = (vec![0.0; lidar.beams()], vec![0.0; lidar.beams()]);
                let mut normal = vec![[0.0; 3]; lidar.beams()];
                let output = Scan::new().ranges(&mut ranges).intensities(&mut intensities);
                let output = output.truth(Truth::new().normal(&mut normal));
                sense(&format!("lidar {level}"), &lidar, (&builder, &capture, execution), output);
            }
        }
    });
}

/// A scanner with all optional features.
fn wide(plain: ScannerConfig<'_>) -> ScannerConfig<'_> {
    plain
        .beam(Beam { divergence_rad: [3e-3, 1.5e-3], aperture_m: [0.0127, 0.0095], rays: 19 })
        .halo(Halo { share: 0.1, radius_rad: 0.01 })
        .returns(Returns::Ranked(5))
        .intensity(Intensity::Reflectivity)
        .receiver(Some(Receiver { resolution_m: 0.09, ..Receiver::new(60.0) }))
        .weather(Weather { visibility_m: 50.0, rain_mm_per_h: 30.0, snow_mm_per_h: 3.0 })
        .crosstalk(Crosstalk { chance: 0.1 })
}

#[test]
fn scanners() {
    let plain = [&presets::VLP_16, &presets::MID_360, &presets::MID_70, &presets::HAP]
        .map(|preset| preset.config().frame_time_ns(5_000_000).visibility(u32::MAX));
    at_each_level(|level, execution| {
        for builder in [stage(false), stage(true)] {
            let there: Vec<_> = builder.poses().iter().map(|at| *at * eye()).collect();
            let keyframes = [(0.0, builder.poses()), (0.05, &there), (0.1, builder.poses())].map(
                |(time_s, world_from_instance)| {
                    let at = Moment { world_from_sensor: eye(), world_from_instance };
                    Keyframe { time_s, at }
                },
            );
            for config in plain.into_iter().chain(plain.map(wide)) {
                let scanner = Scanner::new(config).unwrap();
                for capture in [Capture::new(1, builder.moment(eye())), Capture::new(1, &keyframes[..])] {
                    let values = scanner.most_firings() * scanner.returns();
                    let (mut ranges, mut intensities) = (vec![0.0; values], vec![0.0; values]);
                    let mut points = vec![[0.0; 3]; values];
                    let mut normal = vec![[0.0; 3]; scanner.most_firings()];
                    let output = Echoes::new().ranges(&mut ranges).intensities(&mut intensities);
                    let output = output.points(&mut points).truth(Truth::new().normal(&mut normal));
                    sense(&format!("scanner {level}"), &scanner, (&builder, &capture, execution), output);
                }
            }
        }
    });
}

/// Casts this many rays with all outputs, on a thread with a small stack.
fn hits(name: &str, rays: usize, cast: impl FnOnce(Hits<'_>) + Send) {
    let (mut distance, mut normal, mut barycentrics) =
        (vec![0.0; rays], vec![[0.0; 3]; rays], vec![[0.0; 2]; rays]);
    let (mut instance, mut primitive) = (vec![0; rays], vec![0; rays]);
    let hits = Hits {
        distance: Some(&mut distance),
        normal: Some(&mut normal),
        instance: Some(&mut instance),
        primitive: Some(&mut primitive),
        barycentrics: Some(&mut barycentrics),
    };
    run(name, || cast(hits));
}

#[test]
fn casts() {
    let (corners, triangles) = ball();
    let directions: Vec<_> =
        (0..300).map(|i| [1.0, 0.01 * (i % 17) as f32 - 0.08, 0.01 * (i % 23) as f32 - 0.11]).collect();
    let rays = Rays { origins: &[[-3.0, 0.1, 0.2]], directions: &directions, ranges: None };
    let mut one_mesh = SceneBuilder::new();
    let shape = Shape::Mesh(one_mesh.add_mesh(&corners, &[], &triangles).unwrap());
    let material = one_mesh.add_material(&MaterialConfig::default()).unwrap();
    one_mesh.add_instance(&InstanceConfig { shape, material, ..Default::default() }).unwrap();
    at_each_level(|level, execution| {
        let mut memory = WorkspaceBuf::default();
        memory.execution = execution;
        let tree = build::Tree::build(&corners, &triangles, build::Quality::Fast, execution).unwrap();
        let tree = MeshTree { nodes: &tree.nodes, blocks: &tree.blocks };
        hits(&format!("cast_mesh {level}"), rays.directions.len(), |mut hits| {
            cast_mesh(execution.level, tree, &rays, Faces::Both, &mut hits).unwrap();
        });
        let mut occluded = vec![false; rays.directions.len()];
        run(&format!("occluded_by_mesh {level}"), || {
            occluded_by_mesh(execution.level, tree, &rays, Faces::Both, &mut occluded).unwrap();
        });
        for builder in [&one_mesh, &stage(true)] {
            let (scene, poses) = (builder.scene(), builder.poses());
            let mut workspace = memory.lend(workspace_len(&scene));
            hits(&format!("cast_rays {level}"), rays.directions.len(), |hits| {
                cast_rays(&scene, poses, DVec3::ZERO, &rays, VISUAL, Faces::Both, &mut workspace, hits)
                    .unwrap();
            });
            run(&format!("occluded_rays {level}"), || {
                let (faces, occluded) = (Faces::Both, &mut occluded[..]);
                occluded_rays(&scene, poses, DVec3::ZERO, &rays, VISUAL, faces, &mut workspace, occluded)
                    .unwrap();
            });
            let moment = builder.moment(eye());
            each_optics(|optics| {
                let mut memory = memory.clone();
                let mut workspace = memory.lend(grid_workspace_len(&scene, &optics));
                hits(&format!("cast_grid {level}"), (SIZE[0] * SIZE[1]) as usize, |hits| {
                    let range = [0.0, f64::INFINITY];
                    cast_grid(&scene, &moment, &optics, range, VISUAL, Faces::Both, &mut workspace, hits)
                        .unwrap();
                });
                let mark = |instance| Landmark { instance, point: DVec3::Z, normal: DVec3::ZERO };
                let marks: Vec<_> = (0..poses.len() as u32).map(mark).collect();
                let mut seen = vec![Sighting::NONE; marks.len()];
                let mut workspace = memory.lend(landmarks_workspace_len(&scene, &optics));
                run(&format!("landmarks {level}"), || {
                    let shutter = Shutter::Global(moment);
                    see_landmarks(
                        &scene,
                        &shutter,
                        &optics,
                        [0.1, 9.0].into(),
                        &mut workspace,
                        &marks,
                        &mut seen,
                    )
                    .unwrap();
                });
            });
        }
    });
}

#[test]
fn scenes() {
    let mut bytes = Vec::new();
    run("a scene", || bytes = stage(true).bake());
    run("a baked scene", || assert!(Scene::from_baked(bytemuck::cast_slice(&bytes)).is_ok()));
    let (corners, triangles) = ball();
    // Triangles of decreasing size, which give the deepest tree.
    let deep: Vec<[f32; 3]> = (0..3000)
        .flat_map(|i| {
            let size = 0.97_f32.powi(i);
            [[size, 0.0, 0.0], [size * 1.01, size * 0.01, 0.0], [size, size * 0.01, size * 0.01]]
        })
        .collect();
    let deep_triangles: Vec<[u32; 3]> = (0..3000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    at_each_level(|level, execution| {
        for quality in [build::Quality::Fast, build::Quality::High] {
            for (corners, triangles) in [(&corners, &triangles), (&deep, &deep_triangles)] {
                run(&format!("a tree {level}"), || {
                    let mut tree = build::Tree::build(corners, triangles, quality, execution).unwrap();
                    tree.validate(corners, triangles).unwrap();
                    tree.refit(corners, triangles, execution).unwrap();
                });
            }
        }
    });
}
