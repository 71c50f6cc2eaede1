//! The outputs of a depth frame agree with each other, and intensities with the surfaces that were hit.

use crate::common;

use crate::common::{LIDAR, add, add_grey, depth_camera, glowing, look_at, scan};
use belvedere_sensors::camera::{CameraConfig, PixelFormat};
use belvedere_sensors::depth::{DepthCamera, DepthFrame, OutOfRange, POINT_STEP, TooNear};
use belvedere_sensors::device::depth_model::presets;
use belvedere_sensors::noise::{GaussianNoise, GaussianNoiseConfig};
use belvedere_sensors::optics::{
    Intrinsics, KannalaBrandt, Lens, Optics, PinholeGrid, RayTableBuf, SphericalGrid,
};
use belvedere_sensors::scene::{InstanceConfig, SceneBuilder, Shape, visibility};
use belvedere_sensors::trace::{Faces, WorkspaceBuf};
use belvedere_sensors::{Capture, Pose, Sensor};
use glam::DVec3;

struct Frame {
    metres: Vec<f32>,
    millimetres: Vec<u16>,
    colour: Vec<u8>,
    points: Vec<u8>,
}

fn whole_frame(builder: &SceneBuilder, camera: &DepthCamera, pose: Pose) -> Frame {
    let scene = builder.scene();
    let mut frame = Frame {
        metres: vec![0.0; camera.pixels()],
        millimetres: vec![0; camera.pixels()],
        colour: vec![0; camera.camera().frame_len()],
        points: vec![0xAA; camera.pixels() * POINT_STEP],
    };
    let output = DepthFrame::new()
        .depth_32fc1(&mut frame.metres)
        .depth_16uc1(&mut frame.millimetres)
        .colour(&mut frame.colour)
        .points(&mut frame.points);
    let capture = Capture::new(3, builder.moment(pose));
    camera
        .sense(
            &scene,
            &capture,
            &mut WorkspaceBuf::default().lend(camera.workspace_len(&scene, &capture)),
            output,
        )
        .expect("outputs of the right size");
    frame
}

/// A ramp from near to far, in a single colour.
fn ramp(builder: &mut SceneBuilder) {
    let orange = glowing(builder, [1.0, 0.5, 0.25]);
    let floor = Shape::Rectangle { size: [300.0, 40.0] };
    add(builder, floor, Pose::from_translation(DVec3::X * 150.0), orange);
}

#[test]
fn millimetres_are_the_metres_rounded() {
    let mut builder = SceneBuilder::new();
    ramp(&mut builder);
    let camera = DepthCamera::new(depth_camera()).unwrap();
    let frame = whole_frame(&builder, &camera, look_at(DVec3::Z, DVec3::new(30.0, 0.0, 0.0), 0.2));
    let (mut valid, mut beyond) = (0, 0);
    for (&metres, &millimetres) in frame.metres.iter().zip(&frame.millimetres) {
        let rounded = (f64::from(metres) * 1000.0).round();
        if rounded <= 65535.0 {
            // f32 resolves 65 m to 4 µm, so one of the two roundings may differ near the middle between two
            // millimetres.
            assert!((f64::from(millimetres) - f64::from(metres) * 1000.0).abs() < 0.51, "{metres}");
            valid += 1;
        } else {
            assert_eq!(millimetres, 0, "{metres} m does not fit");
            beyond += usize::from(metres.is_finite());
        }
    }
    assert!(valid > 10_000 && beyond > 100, "{valid} valid, {beyond} beyond 65.535 m");
}

#[test]
fn the_cloud_is_the_depth_unprojected() {
    let mut builder = SceneBuilder::new();
    ramp(&mut builder);
    let mut config = depth_camera().min_depth_m(1.0).max_depth_m(20.0);
    config.model = GaussianNoise::of_stddev(0.01).unwrap().into();
    config.camera.noise = GaussianNoise::of_stddev(0.007).unwrap();
    for (format, order) in [(PixelFormat::Rgb8, [0, 1, 2]), (PixelFormat::Bgr8, [2, 1, 0])] {
        config.camera.format = format;
        let camera = DepthCamera::new(config).unwrap();
        let frame = whole_frame(&builder, &camera, look_at(DVec3::Z, DVec3::X * 30.0, 0.2));
        let mut valid = 0;
        for (index, point) in frame.points.chunks_exact(POINT_STEP).enumerate() {
            let word = |at: usize| u32::from_le_bytes(point[at..at + 4].try_into().unwrap());
            let xyz = [0, 4, 8].map(|at| f32::from_bits(word(at)));
            let depth = frame.metres[index];
            if depth.is_finite() {
                let pixel = [(index % 640) as f64, (index / 640) as f64];
                let ray = common::pinhole(camera.camera().config()).lens().unproject(pixel.into()).unwrap();
                let truth = ray / ray.z * f64::from(depth);
                for axis in 0..3 {
                    assert!((f64::from(xyz[axis]) - truth[axis]).abs() < 1e-6 * f64::from(depth));
                }
                valid += 1;
            } else {
                assert!(xyz.iter().all(|x| x.is_nan()), "no point where the depth is {depth}");
            }
            let colour = order.map(|channel| u32::from(frame.colour[3 * index + channel]));
            assert_eq!(word(16), colour[0] << 16 | colour[1] << 8 | colour[2]);
            assert_eq!([12, 20, 24, 28].map(word), [0; 4], "padding is zero");
        }
        assert!(valid > 10_000);
    }
}

#[test]
fn the_colour_is_that_of_the_camera_alone() {
    let mut builder = SceneBuilder::new();
    ramp(&mut builder);
    let mut config = depth_camera();
    config.camera.noise = GaussianNoise::of_stddev(0.007).unwrap();
    let pose = look_at(DVec3::Z, DVec3::X * 30.0, 0.2);
    let frame = whole_frame(&builder, &DepthCamera::new(config).unwrap(), pose);
    let alone =
        common::picture_with(&builder, config.camera, pose, 3, belvedere_sensors::Execution::default());
    assert!(frame.colour == alone);
}

/// The requested outputs of a frame, as bytes; the others are not computed.
fn parts_of(builder: &SceneBuilder, camera: &DepthCamera, pose: Pose, wanted: [bool; 5]) -> [Vec<u8>; 5] {
    let pixels = camera.pixels();
    let (mut metres, mut millimetres) = (vec![0.0_f32; pixels], vec![0_u16; pixels]);
    let (mut colour, mut points) = (vec![0; camera.camera().frame_len()], vec![0xAA; pixels * POINT_STEP]);
    let mut xyz = vec![[0.0_f32; 3]; pixels];
    let mut output = DepthFrame::new();
    output.depth_32fc1 = wanted[0].then_some(&mut metres);
    output.depth_16uc1 = wanted[1].then_some(&mut millimetres);
    output.colour = wanted[2].then_some(&mut colour);
    output.points = wanted[3].then_some(&mut points);
    output.xyz = wanted[4].then_some(&mut xyz);
    let (scene, capture) = (builder.scene(), Capture::new(3, builder.moment(pose)));
    let mut workspace = WorkspaceBuf::default();
    let lent = &mut workspace.lend(camera.workspace_len(&scene, &capture));
    camera.sense(&scene, &capture, lent, output).expect("outputs of the right size");
    [
        bytemuck::cast_slice(&metres).to_vec(),
        bytemuck::cast_slice(&millimetres).to_vec(),
        colour,
        points,
        bytemuck::cast_slice(&xyz).to_vec(),
    ]
}

#[test]
fn each_output_alone_is_the_same_as_together_with_the_others() {
    let mut builder = SceneBuilder::new();
    ramp(&mut builder);
    add_grey(&mut builder, Shape::Sphere { radius: 0.5 }, Pose::from_translation(DVec3::X * 4.0));
    let pose = look_at(DVec3::Z, DVec3::X * 5.0, 0.2);
    let noise = GaussianNoise::new(
        GaussianNoiseConfig::default()
            .mean(0.001)
            .stddev(0.01)
            .bias_mean(0.002)
            .bias_stddev(0.001)
            .precision(0.003),
    )
    .unwrap();
    let lens = Intrinsics::from_fov(99, 70, 1.8).unwrap();
    let table = RayTableBuf::from_lens(99, 70, &KannalaBrandt::new(lens, [0.01, 0.0, 0.0, 0.0]).unwrap());
    let table = table.unwrap();
    let sphere = SphericalGrid {
        columns: 99,
        rows: 70,
        first_azimuth_rad: 0.6,
        azimuth_step_rad: -0.012,
        first_elevation_rad: 0.4,
        elevation_step_rad: -0.012,
    };
    let optics: [Optics; 4] = [
        PinholeGrid::from_fov(99, 70, 1.2).unwrap().into(),
        PinholeGrid::from_fov(99, 20, 1.2).unwrap().into(),
        (&table).into(),
        sphere.into(),
    ];
    let kinect = presets::named("kinect_v1").unwrap().model(80.0);
    for (optics, model) in optics.into_iter().flat_map(|optics| [(optics, noise.into()), (optics, kinect)]) {
        let mut config = depth_camera().max_depth_m(20.0).model(model);
        config.camera = CameraConfig::new(optics).noise(noise);
        let camera = DepthCamera::new(config).unwrap();
        let all = parts_of(&builder, &camera, pose, [true; 5]);
        for part in 0..5 {
            let mut wanted = [false; 5];
            wanted[part] = true;
            assert!(
                parts_of(&builder, &camera, pose, wanted)[part] == all[part],
                "part {part} of {optics:?}"
            );
        }
        let mut valid = 0;
        for (xyz, point) in all[4].as_chunks::<12>().0.iter().zip(all[3].as_chunks::<POINT_STEP>().0) {
            assert_eq!(xyz, &point[..12], "{optics:?}");
            valid += usize::from(!f32::from_le_bytes([xyz[8], xyz[9], xyz[10], xyz[11]]).is_nan());
        }
        assert!(valid > 500, "{valid} points of {optics:?}");
    }
}

#[test]
fn sizes_that_are_no_multiple_of_a_tile() {
    let mut builder = SceneBuilder::new();
    ramp(&mut builder);
    let pose = look_at(DVec3::Z, DVec3::X * 5.0, 0.2);
    for (width, height) in [(1, 1), (17, 5), (33, 3), (15, 4)] {
        let mut config = depth_camera().out_of_range(OutOfRange::Nan);
        config.camera = common::camera_of([width, height], 1.2);
        let camera = DepthCamera::new(config).unwrap();
        let frame = whole_frame(&builder, &camera, pose);
        for (index, &depth) in frame.metres.iter().enumerate() {
            let (column, row) = (index as u32 % width, index as u32 / width);
            let ray = common::oracle::pixel_ray(&config.camera, &pose, column, row);
            let floor = Shape::Rectangle { size: [300.0, 40.0] };
            let floor_pose = Pose::from_translation(DVec3::X * 150.0);
            let truth = common::oracle::first_hit(&floor, &floor_pose, &ray, 0.02, false);
            assert_eq!(depth.is_nan(), truth.is_none(), "({column}, {row}) of {width} × {height}");
            assert!(truth.is_none_or(|truth| (f64::from(depth) - truth).abs() < 1e-5 * truth));
        }
    }
}

#[test]
fn intensities_are_those_of_the_shapes() {
    let mut builder = SceneBuilder::new();
    let grey = glowing(&mut builder, [0.5; 3]);
    for (y, laser_retro, visibility) in [
        (1.0, 120.5, visibility::COLLISION),
        (-1.0, 2000.0, visibility::COLLISION | visibility::VISUAL),
        (0.0, 7.0, visibility::VISUAL),
    ] {
        let config = InstanceConfig {
            shape: Shape::Box { size: [0.1, 0.5, 0.5] },
            world_from_instance: Pose::from_translation(DVec3::new(2.0, y, 0.0)),
            material: grey,
            visibility,
            laser_retro,
            ..Default::default()
        };
        builder.add_instance(&config).unwrap();
    }
    let (ranges, intensities) = scan(&builder, LIDAR, Pose::IDENTITY);
    for (beam, (range, intensity)) in ranges.iter().zip(&intensities).enumerate() {
        let expected = match (range.is_finite(), beam < 360) {
            (false, _) => 0.0,
            (true, true) => 2000.0,
            (true, false) => 120.5,
        };
        assert_eq!(*intensity, expected, "beam {beam}");
    }
    assert!(ranges[355..365].iter().all(|range| range.is_infinite()), "visuals are nothing to a lidar");
}

#[test]
fn cameras_do_not_see_collision_shapes() {
    let mut builder = SceneBuilder::new();
    add_grey(&mut builder, Shape::Sphere { radius: 0.5 }, Pose::from_translation(DVec3::X * 4.0));
    let grey = glowing(&mut builder, [0.5; 3]);
    let hidden = InstanceConfig {
        shape: Shape::Sphere { radius: 0.5 },
        world_from_instance: Pose::from_translation(DVec3::X * 2.0),
        material: grey,
        visibility: visibility::COLLISION,
        ..Default::default()
    };
    builder.add_instance(&hidden).unwrap();
    let depths = common::depth_image(&builder, depth_camera(), Pose::IDENTITY);
    assert!((depths[240 * 640 + 320] - 3.5).abs() < 1e-4);
}

#[test]
fn noise_does_not_give_depths_out_of_range() {
    // A wall that is nearer than the size of the noise, and one that is less than that nearer than the greatest depth.
    for (wall_m, min, max) in [(0.05, 0.0, 10.0), (0.05, 0.03, 10.0), (1.95, 0.5, 2.0), (0.5, 0.4, 0.6)] {
        let mut builder = SceneBuilder::new();
        let wall = Shape::Rectangle { size: [10.0; 2] };
        let pose = Pose::from_xyz_rpy(DVec3::X * wall_m, DVec3::Y * -core::f64::consts::FRAC_PI_2);
        add_grey(&mut builder, wall, pose);
        for out_of_range in [OutOfRange::Infinite, OutOfRange::Nan] {
            let mut config = depth_camera().min_depth_m(min).max_depth_m(max);
            config.model = GaussianNoise::of_stddev(0.1).unwrap().into();
            config.out_of_range = out_of_range;
            let frame = whole_frame(&builder, &DepthCamera::new(config).unwrap(), Pose::IDENTITY);
            let (mut near, mut far) = (0_u32, 0_u32);
            for (index, &metres) in frame.metres.iter().enumerate() {
                let point = &frame.points[index * POINT_STEP..][..12];
                let z = f32::from_le_bytes(point[8..].try_into().unwrap());
                if metres.is_finite() {
                    assert!(metres > min as f32 && metres < max as f32, "{metres} m, wall at {wall_m} m");
                    assert_eq!(z, metres);
                    continue;
                }
                assert!(z.is_nan() && frame.millimetres[index] == 0, "{metres}");
                assert_eq!(metres.is_nan(), out_of_range == OutOfRange::Nan);
                near += u32::from(metres == f32::NEG_INFINITY);
                far += u32::from(metres == f32::INFINITY);
            }
            // Fractions of a normal distribution, of 307,200 pixels.
            let below = |depth: f64| 0.5 * libm::erfc((wall_m - depth) / (0.1 * core::f64::consts::SQRT_2));
            let pixels = frame.metres.len() as f64;
            if out_of_range == OutOfRange::Infinite {
                let [near, far] = [near, far].map(f64::from);
                assert!((near / pixels - below(min)).abs() < 0.005, "{near} too near");
                assert!((far / pixels - (1.0 - below(max))).abs() < 0.005, "{far} too far");
            }
        }
    }
}

#[test]
fn surfaces_that_are_too_near_block_or_are_seen_through() {
    let wall_m = 2.0;
    let upright = |at: DVec3| Pose::from_xyz_rpy(at, DVec3::Y * -core::f64::consts::FRAC_PI_2);
    let (mut builder, mut bare) = (SceneBuilder::new(), SceneBuilder::new());
    for builder in [&mut builder, &mut bare] {
        let orange = glowing(builder, [1.0, 0.5, 0.25]);
        add(builder, Shape::Rectangle { size: [10.0; 2] }, upright(DVec3::X * wall_m), orange);
    }
    // A plate at 0.3 m that fills the upper left quarter of the picture, and the camera's own housing, out of which it
    // sees.
    let white = glowing(&mut builder, [1.0; 3]);
    let plate = DVec3::new(0.3, 0.5, 0.5);
    add(&mut builder, Shape::Rectangle { size: [1.0; 2] }, upright(plate), white);
    add(&mut builder, Shape::Box { size: [0.1; 3] }, Pose::IDENTITY, white);
    let mut config = depth_camera().max_depth_m(10.0).faces(Faces::Front);
    config.camera.near_m = 0.5;
    for (noise, stddev) in [(false, 0.0), (true, 0.01)] {
        config.model = GaussianNoise::of_stddev(stddev).unwrap().into();
        for (out_of_range, invalid) in
            [(OutOfRange::Infinite, f32::NEG_INFINITY), (OutOfRange::Nan, f32::NAN)]
        {
            config.out_of_range = out_of_range;
            let frame = |builder: &SceneBuilder, too_near| {
                let camera = DepthCamera::new(config.too_near(too_near)).unwrap();
                whole_frame(builder, &camera, Pose::IDENTITY)
            };
            let through = frame(&builder, TooNear::SeenThrough);
            let empty = frame(&bare, TooNear::Blocks);
            assert!(through.metres == empty.metres && through.millimetres == empty.millimetres);
            assert!(through.colour == empty.colour && empty.metres.iter().all(|depth| depth.is_finite()));
            let blocks = frame(&builder, TooNear::Blocks);
            assert!(blocks.colour == empty.colour, "colours keep the clip of a renderer");
            let (width, height) = (common::SIZE[0] as usize, common::SIZE[1] as usize);
            for index in 0..width * height {
                let (column, row) = (index % width, index / width);
                let z = f32::from_le_bytes(blocks.points[index * POINT_STEP + 8..][..4].try_into().unwrap());
                let metres = blocks.metres[index];
                if column < width / 2 && row < height / 2 {
                    assert!(metres.to_bits() == invalid.to_bits() || metres.is_nan() && invalid.is_nan());
                    assert!(blocks.millimetres[index] == 0 && z.is_nan(), "noise {noise}");
                } else {
                    assert_eq!(metres, empty.metres[index], "noise {noise}, pixel ({column}, {row})");
                    assert_eq!(z, metres);
                }
            }
        }
    }
}
