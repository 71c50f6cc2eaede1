//! Frames that are captured slice by slice: rolling shutters against a closed form, motion blur, and the rules for
//! slices.
#![allow(clippy::large_types_passed_by_value, reason = "configurations made where they are used read better")]

use crate::common::{LIDAR, SIZE, add, camera, camera_of, glowing, pinhole, scenery};
use belvedere_sensors::camera::{Camera, CameraConfig, Mosaic, Picture, PixelFormat};
use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig, DepthFrame, POINT_STEP};
use belvedere_sensors::device::DeviceConfig;
use belvedere_sensors::lidar::{Beams, Lidar, Scan, Sweep};
use belvedere_sensors::noise::{GaussianNoise, GaussianNoiseConfig};
use belvedere_sensors::optics::{Intrinsics, KannalaBrandt, RayTableBuf};
use belvedere_sensors::scene::{Environment, Scene, SceneBuilder, Shape};
use belvedere_sensors::simd::Level;
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Execution, Moment, Pose, SenseError, Sensor, Shutter, Slice};
use glam::DVec3;

fn take<T: Sensor>(
    sensor: &T,
    scene: &Scene<'_>,
    capture: &Capture<'_>,
    execution: Execution,
    output: T::Output<'_>,
) {
    let mut memory = WorkspaceBuf::default();
    memory.execution = execution;
    sensor.sense_in(&mut memory, scene, capture, output).expect("slices as they must be");
}

fn picture_of(
    scene: &Scene<'_>,
    config: CameraConfig<'_>,
    capture: &Capture<'_>,
    execution: Execution,
) -> Vec<u8> {
    let camera = Camera::new(config).unwrap();
    let mut pixels = vec![7; camera.frame_len()];
    take(&camera, scene, capture, execution, Picture::new().colour(&mut pixels));
    pixels
}

/// All outputs of a depth camera.
fn depth_frame(
    scene: &Scene<'_>,
    config: CameraConfig<'_>,
    capture: &Capture<'_>,
) -> (Vec<u32>, Vec<u8>, Vec<u8>) {
    let camera = DepthCamera::new(DepthCameraConfig::new(config).max_depth_m(6.0)).unwrap();
    let (mut metres, mut points) = (vec![7.0; camera.pixels()], vec![7; camera.pixels() * POINT_STEP]);
    let mut colour = vec![7; camera.camera().frame_len()];
    let output = DepthFrame::new().depth_32fc1(&mut metres).points(&mut points).colour(&mut colour);
    take(&camera, scene, capture, Execution::default(), output);
    (metres.into_iter().map(f32::to_bits).collect(), points, colour)
}

/// Slices with this many lines.
fn slices<'a>(lines: u32, height: u32, at: impl Fn(u32) -> Moment<'a>) -> Vec<Slice<'a>> {
    let first = (0..height).step_by(lines as usize);
    first.map(|line| Slice { lines: line..(line + lines).min(height), at: at(line) }).collect()
}

const POSE: [f64; 3] = [-3.2, 0.3, 1.4];

#[test]
fn slices_at_one_moment_give_the_frame_of_that_moment() {
    let mut builder = SceneBuilder::new();
    scenery(&mut builder);
    let scene = builder.scene();
    let pose = Pose::from_xyz_rpy(DVec3::from_array(POSE), DVec3::new(0.1, 0.2, -0.05));
    let moment = builder.moment(pose);
    // Odd sizes, and so near that some surfaces are within the near clip distance.
    let config = camera_of([133, 95], 1.2).near_m(2.0);
    let once = Capture::new(3, moment);
    let (picture, depths) =
        (picture_of(&scene, config, &once, Execution::default()), depth_frame(&scene, config, &once));
    for lines in [1, 2, 3, 4, 7, 32, 95] {
        let slices = slices(lines, 95, |_| moment);
        let sliced = Capture::new(3, slices.as_slice());
        assert!(
            picture == picture_of(&scene, config, &sliced, Execution::default()),
            "slices of {lines} lines"
        );
        assert!(depths == depth_frame(&scene, config, &sliced), "slices of {lines} lines");
    }
    // Noise depends on the pixel, and so do the colours of a mosaic and the patterns of a device.
    let noise = GaussianNoise::of_stddev(0.01).unwrap();
    let device = DeviceConfig::default().prnu(0.02).dsnu_e(2.0).read_noise_e(0.1);
    let bayer = config.device(Some(device)).format(PixelFormat::Bayer8(Mosaic::Gbrg));
    let rows = slices(1, 95, |_| moment);
    let rolling = Capture::new(3, rows.as_slice());
    for config in [config.noise(noise), bayer, config.format(PixelFormat::Bayer16(Mosaic::Grbg))] {
        let picture = picture_of(&scene, config, &once, Execution::default());
        assert!(picture == picture_of(&scene, config, &rolling, Execution::default()), "{:?}", config.format);
    }
    // The mean of equal values is the same value.
    let twice = [Slice { lines: 0..95, at: moment }, Slice { lines: 0..95, at: moment }];
    assert!(picture == picture_of(&scene, config, &Capture::new(3, &twice[..]), Execution::default()));

    let lens = Intrinsics { fx: 40.0, fy: 40.0, cx: 66.0, cy: 47.0, skew: 0.0 };
    let table = RayTableBuf::from_lens(133, 95, &KannalaBrandt::new(lens, [0.0; 4]).unwrap()).unwrap();
    let config = CameraConfig::new(&table);
    let slices_of_four = slices(4, 95, |_| moment);
    let sliced = Capture::new(3, slices_of_four.as_slice());
    assert!(
        picture_of(&scene, config, &once, Execution::default())
            == picture_of(&scene, config, &sliced, Execution::default())
    );

    let lidar = Lidar::new(
        LIDAR.vertical(Beams { samples: 40, min_angle_rad: -0.4, max_angle_rad: 0.3 }).sweep(Sweep::Rows),
    )
    .unwrap();
    let scan = |capture: &Capture<'_>| {
        let mut values = [vec![7.0_f32; lidar.beams()], vec![7.0; lidar.beams()]];
        let [ranges, intensities] = &mut values;
        let output = Scan::new().ranges(ranges).intensities(intensities);
        take(&lidar, &scene, capture, Execution::default(), output);
        values.map(|values| values.into_iter().map(f32::to_bits).collect::<Vec<_>>())
    };
    let lines = slices(1, 40, |_| moment);
    assert!(scan(&once) == scan(&Capture::new(3, lines.as_slice())));
}

/// Random sizes, slices and overlaps, all at one moment: they give the bytes of that moment, for pictures, depths and
/// scans, on one thread or two.
#[test]
fn any_slices_at_one_moment_give_the_same_bytes() {
    use belvedere_sensors::noise::Stream;
    let mut builder = SceneBuilder::new();
    scenery(&mut builder);
    let scene = builder.scene();
    let at = builder.moment(Pose::from_xyz_rpy(DVec3::from_array(POSE), DVec3::new(0.1, 0.2, -0.05)));
    let stream = Stream { seed: 9, sensor: 0, frame: 0, channel: 0x100 };
    let mut drawn = 0;
    let mut below = |most: u32| {
        drawn += 1;
        stream.word(drawn) % most
    };
    for _ in 0..60 {
        let [width, height] = [1 + below(150), 1 + below(150)];
        let config = camera_of([width, height], 1.2);
        let (mut slices, mut end) = (Vec::new(), 0);
        while end < height {
            let before: u32 = slices.last().map_or(0, |slice: &Slice<'_>| slice.lines.start);
            let start = before + below(end - before + 1);
            end = (end + below(9)).clamp(start + 1, height);
            slices.push(Slice { lines: start..end, at });
        }
        let overlaps = slices.windows(2).any(|pair| pair[1].lines.start < pair[0].lines.end);
        let [once, sliced] = [Capture::new(1, at), Capture::new(1, slices.as_slice())];
        let [of_one, of_many] = [&once, &sliced].map(|capture| depth_frame(&scene, config, capture));
        let place =
            format!("{width} x {height}, {:?}", slices.iter().map(|s| s.lines.clone()).collect::<Vec<_>>());
        assert!(of_one.0 == of_many.0 && of_one.1 == of_many.1, "depths and points: {place}");
        // The mean of three equal numbers may be rounded.
        let apart = of_one.2.iter().zip(&of_many.2).map(|(one, many)| one.abs_diff(*many)).max();
        assert!(apart <= Some(u8::from(overlaps)), "colours: {place}");
    }
}

/// A camera that turns, and one that is carried past a post: the positions of the post's edges in each row.
#[test]
fn a_rolling_shutter_agrees_with_the_closed_form() {
    let mut builder = SceneBuilder::new();
    let white = glowing(&mut builder, [1.0; 3]);
    let (distance, half) = (3.0, 0.2);
    add(
        &mut builder,
        Shape::Box { size: [1e-3, 2.0 * half, 40.0] },
        Pose::from_translation(DVec3::X * (distance + 5e-4)),
        white,
    );
    builder.set_environment(Environment { ambient: [0.0; 3], background: [0.0; 3] });
    let scene = builder.scene();
    let lens = pinhole(&camera()).intrinsics();
    let turning =
        |row: u32| Pose::from_xyz_rpy(DVec3::ZERO, DVec3::new(0.0, 0.0, 4e-4 * f64::from(row) - 0.1));
    let carried = |row: u32| Pose::from_translation(DVec3::Y * (1.3e-3 * f64::from(row) - 0.3));
    for (name, pose) in [("turning", &turning as &dyn Fn(u32) -> Pose), ("carried", &carried)] {
        let rows = slices(1, SIZE[1], |row| builder.moment(pose(row)));
        let pixels = picture_of(&scene, camera(), &Capture::new(0, rows.as_slice()), Execution::default());
        // Over all rows, the least distance of a white pixel centre inside an edge, and of a black one outside.
        let (mut white, mut black) = ([f64::INFINITY; 2], [f64::INFINITY; 2]);
        for row in 0..SIZE[1] {
            let edges = [half, -half].map(|y| {
                let edge = pose(row).inverse().transform_point(DVec3::new(distance, y, 0.0));
                lens.cx - lens.fx * edge.y / edge.x
            });
            for column in 0..SIZE[0] {
                let inside = [f64::from(column) - edges[0], edges[1] - f64::from(column)];
                let is_white = pixels[((row * SIZE[0] + column) * 3) as usize] == 255;
                for (side, &inside) in inside.iter().enumerate() {
                    if is_white {
                        white[side] = white[side].min(inside);
                    } else if inside < 1.0 {
                        black[side] = black[side].min(-inside);
                    }
                }
            }
        }
        println!("{name}: white from {white:?} px inside, black from {black:?} px outside");
        for side in 0..2 {
            assert!(white[side] > -0.05 && white[side] < 0.05, "{name}: {white:?}");
            assert!(black[side] > -0.05 && black[side] < 0.05, "{name}: {black:?}");
        }
    }
}

/// A bright board that moves in front of black, seen at many moments: each pixel is the fraction of the moments at
/// which the board covers its centre.
#[test]
fn blur_is_the_mean_of_its_moments() {
    let mut builder = SceneBuilder::new();
    let white = glowing(&mut builder, [1.0; 3]);
    let (distance, moments) = (4.0, 50);
    add(&mut builder, Shape::Box { size: [0.01, 1.0, 1.0] }, Pose::IDENTITY, white);
    builder.set_environment(Environment { ambient: [0.0; 3], background: [0.0; 3] });
    let scene = builder.scene();
    let config = camera_of([320, 64], 1.2);
    let lens = pinhole(&config).intrinsics();
    let offset = |moment: usize| 0.3 * (moment as f64 / moments as f64) - 0.1;
    let poses: Vec<[Pose; 1]> = (0..moments)
        .map(|moment| [Pose::from_translation(DVec3::new(distance + 0.005, offset(moment), 0.0))])
        .collect();
    let exposed: Vec<_> = poses
        .iter()
        .map(|poses| Moment { world_from_sensor: Pose::IDENTITY, world_from_instance: poses })
        .map(|at| Slice { lines: 0..64, at })
        .collect();
    let capture = Capture::new(0, exposed.as_slice());
    let pixels = picture_of(&scene, config, &capture, Execution::default());
    let (mut ramp, mut close) = (0, 0);
    for column in 0..320_u32 {
        let seen = pixels[((32 * 320 + column) * 3) as usize];
        let covers = |slack: f64| {
            let covered = |moment: &usize| {
                let [right, left] = [-0.5, 0.5].map(|y| lens.cx - lens.fx * (offset(*moment) + y) / distance);
                (left - slack..=right + slack).contains(&f64::from(column))
            };
            (0..moments).filter(covered).count() as f64 / moments as f64 * 255.0
        };
        // An edge may be on either side of a centre that it almost touches.
        let [least, most] = [covers(-1e-3), covers(1e-3)];
        assert!(
            (least - 0.51..=most + 0.51).contains(&f64::from(seen)),
            "column {column}: {seen}, {least} to {most}"
        );
        ramp += u32::from((1..255).contains(&seen));
        close += u32::from(least == most);
    }
    assert!(ramp > 30 && close > 300, "{ramp} columns on the ramps, {close} of 320 certain");
    // Depths are those of the first moment.
    let depths = depth_frame(&scene, config, &capture).0;
    let first = depth_frame(&scene, config, &Capture::new(0, exposed[0].at)).0;
    assert!(depths == first);
}

#[test]
fn threads_and_levels_change_nothing() {
    let mut builder = SceneBuilder::new();
    let moving = scenery(&mut builder);
    let scene = builder.scene();
    let noise = GaussianNoise::new(
        GaussianNoiseConfig::default().mean(0.001).stddev(0.007).bias_mean(0.002).bias_stddev(0.001),
    )
    .unwrap();
    let config = camera_of([333, 245], 1.2).noise(noise);
    // Each row is in three moments: a rolling shutter with motion blur.
    let at: Vec<(Pose, Vec<Pose>)> = (0..247_u32)
        .map(|moment| {
            let turned =
                Pose::from_xyz_rpy(DVec3::from_array(POSE), DVec3::new(0.1, 0.2, 1e-3 * f64::from(moment)));
            let mut poses = builder.poses().to_vec();
            poses[moving.0 as usize] = Pose::from_translation(DVec3::Y * (2e-3 * f64::from(moment)));
            (turned, poses)
        })
        .collect();
    let rows: Vec<_> = (0..247_u32)
        .map(|moment| {
            let (world_from_sensor, poses) = &at[moment as usize];
            let at = Moment { world_from_sensor: *world_from_sensor, world_from_instance: poses };
            Slice { lines: moment.saturating_sub(2)..(moment + 1).min(245), at }
        })
        .collect();
    let capture = Capture::new(5, rows.as_slice());
    let expected = picture_of(&scene, config, &capture, Execution::default());
    let baseline = Execution::at(Level::baseline());
    assert!(expected == picture_of(&scene, config, &capture, baseline));
    #[cfg(feature = "rayon")]
    for threads in 1..=3 {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert!(expected == pool.install(|| picture_of(&scene, config, &capture, Execution::parallel())));
    }
}

#[test]
fn slices_must_cover_the_frame_in_order() {
    let mut builder = SceneBuilder::new();
    scenery(&mut builder);
    let (scene, at) = (builder.scene(), builder.moment(Pose::IDENTITY));
    let camera = Camera::new(camera_of([32, 64], 1.2)).unwrap();
    let lens = Intrinsics { fx: 40.0, fy: 40.0, cx: 16.0, cy: 32.0, skew: 0.0 };
    let table = RayTableBuf::from_lens(32, 64, &KannalaBrandt::new(lens, [0.0; 4]).unwrap()).unwrap();
    let in_blocks = Camera::new(CameraConfig::new(&table)).unwrap();
    let refused = |camera: &Camera<'_>, lines: &[core::ops::Range<u32>]| {
        let slices: Vec<_> = lines.iter().map(|lines| Slice { lines: lines.clone(), at }).collect();
        let capture = Capture::new(0, Shutter::Slices(&slices));
        let mut pixels = vec![9; camera.frame_len()];
        let mut memory = WorkspaceBuf::default();
        let result = camera.sense_in(&mut memory, &scene, &capture, Picture::new().colour(&mut pixels));
        assert!(result.is_ok() || pixels.iter().all(|&byte| byte == 9));
        match result {
            Ok(()) => None,
            Err(SenseError::Slices { slice, .. }) => Some(slice),
            Err(error) => panic!("{error}"),
        }
    };
    for (lines, expected) in [
        (&[0..30, 30..64][..], None),
        (&[0..30, 20..64], None),
        (&[0..30, 31..64], Some(1)),
        (&[0..30, 30..30, 30..64], Some(1)),
        (&[0..30, 30..65], Some(1)),
        (&[0..30, 30..63], Some(2)),
        (&[30..64, 0..30], Some(0)),
        (&[0..64, 0..30], Some(1)),
        (&[], Some(0)),
    ] {
        assert_eq!(refused(&camera, lines), expected, "{lines:?}");
    }
    assert_eq!(refused(&in_blocks, &[0..32, 32..64]), None);
    assert_eq!(refused(&in_blocks, &[0..32, 32..33, 33..64]), Some(1));
}
