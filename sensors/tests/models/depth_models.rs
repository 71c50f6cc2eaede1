//! The measurements of depth camera models on rendered planes, against the papers' own formulas and numbers in f64.

#![allow(clippy::large_types_passed_by_value, reason = "configurations made where they are used read better")]

use crate::common;

use crate::common::planes::{assert_near, narrow, nguyen_m, plane, rms, take};
use crate::common::{add_grey, camera_of, depth_camera, depth_frame, scenery};
use belvedere_sensors::camera::CameraConfig;
use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig, DepthFrame, POINT_STEP};
use belvedere_sensors::device::depth_model::{
    AxialNoise, DepthModel, DisparityNoise, DisparitySteps, LateralNoise, Matching, SecondEye, TimeOfFlight,
    published,
};
use belvedere_sensors::noise::{GaussianNoise, GaussianNoiseConfig};
use belvedere_sensors::optics::PinholeGrid;
use belvedere_sensors::scene::{SceneBuilder, Shape};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Pose, Rule, Sensor, Shutter, Slice};
use core::f64::consts::{FRAC_PI_2, SQRT_2};
use glam::DVec3;

#[test]
fn axial_noise_by_depth_and_incidence() {
    let config = narrow([320, 240]).model(DepthModel::new().noise(published::KINECT_AXIAL));
    let errors = |depth, degrees: f64| {
        let frame = take(&plane(depth, degrees.to_radians()), config, 0);
        rms(frame.depth.iter().zip(&frame.true_depth).map(|(found, truth)| f64::from(found - truth)))
    };
    // The numbers that the formula gives in the paper's ranges.
    for (depth, degrees, expected_mm) in
        [(1.0, 0.0, 1.884), (2.0, 0.0, 6.064), (3.0, 0.0, 14.044), (1.0, 80.0, 8.284)]
    {
        assert_near(errors(depth, degrees) * 1e3, expected_mm, 0.02);
    }
    for depth in [0.6, 0.9, 1.3, 2.0, 3.5, 5.0] {
        for degrees in [0.0, 20.0, 40.0, 58.0, 62.0, 70.0, 80.0] {
            assert_near(errors(depth, degrees), nguyen_m(depth, f64::to_radians(degrees)), 0.02);
        }
    }
}

#[test]
fn axial_noise_of_each_pixel_of_a_wide_picture() {
    // A plane at all angles from 25° to 85°, and the sides of a ball in front of it: the error of each pixel divided by
    // its own σ.
    let mut builder = plane(1.5, 55_f64.to_radians());
    add_grey(
        &mut builder,
        Shape::Sphere { radius: 0.25 },
        Pose::from_translation(DVec3::new(1.0, -0.1, 0.0)),
    );
    let camera = depth_camera().camera(camera_of([640, 480], 1.0));
    let frame = take(&builder, camera.model(DepthModel::new().noise(published::KINECT_AXIAL)), 3);
    let mut by_angle = [(); 9].map(|()| Vec::new());
    for ((found, truth), angle) in frame.depth.iter().zip(&frame.true_depth).zip(&frame.incidence) {
        if found.is_finite() && angle.to_degrees() < 85.0 {
            let sigma = nguyen_m(f64::from(*truth), f64::from(*angle));
            by_angle[angle.to_degrees() as usize / 10].push(f64::from(found - truth) / sigma);
        }
    }
    for errors in by_angle {
        assert!(errors.len() > 1000);
        assert_near(rms(errors.iter().copied()), 1.0, 3.0 / (2.0 * errors.len() as f64).sqrt() + 1e-3);
    }
}

/// The standard deviation, given the fractions of normal numbers that exceed ½, 1½, …: a second moment, from the sum of
/// these fractions, each times its limit.
fn stddev_of_shares(shares: &[f64]) -> f64 {
    let moment = |share: &dyn Fn(f64) -> f64| {
        (0..shares.len()).map(|step| (step as f64 + 0.5) * share(step as f64 + 0.5)).sum::<f64>()
    };
    let measured = moment(&|limit| shares[limit as usize]);
    let (mut least, mut most) = (0.01, 20.0);
    for _ in 0..60 {
        let sigma: f64 = (least + most) * 0.5;
        let expected = moment(&|limit| 0.5 * libm::erfc(limit / (sigma * SQRT_2)));
        if expected < measured { least = sigma } else { most = sigma }
    }
    least
}

#[test]
fn lateral_noise_by_incidence() {
    // A plate that ends in the middle of the picture, in front of one that is parallel to it.
    for (degrees, expected_px) in [(0.0, 0.800), (45.0, 0.835), (60.0, 0.870), (80.0, 1.080)] {
        for upright in [true, false] {
            let angle = f64::to_radians(degrees);
            let mut builder = plane(3.0, angle);
            let (sin, cos) = angle.sin_cos();
            let (middle, size) = if upright {
                // Its edge is the axis about which it is rotated.
                (DVec3::new(1.0, 0.0, 0.0) + DVec3::new(-sin, cos, 0.0) * 0.5, [1.0, 1.0])
            } else {
                (DVec3::new(1.0, 0.0, 0.5), [1.0, 1.0])
            };
            let pose = Pose::from_xyz_rpy(middle, DVec3::new(0.0, -FRAC_PI_2, angle));
            add_grey(&mut builder, Shape::Rectangle { size }, pose);
            let size = if upright { [64, 4000] } else { [4000, 64] };
            // The pixels are so small that one of them does not span the depths of the plates.
            let camera = CameraConfig::new(
                PinholeGrid::from_fov(size[0], size[1], 1e-3 * f64::from(size[0]) / 4000.0).unwrap(),
            );
            let config = depth_camera()
                .camera(camera.seed(5))
                .model(DepthModel::new().window(published::KINECT_LATERAL));
            let mut shares = [0.0; 32];
            for number in 0..2 {
                let depth = depth_frame(&builder, config, Pose::IDENTITY, number);
                for (pixel, depth) in depth.iter().enumerate() {
                    let [x, y] = [pixel % size[0] as usize, pixel / size[0] as usize];
                    let across = if upright { x } else { y };
                    // The plate is to the left, or above.
                    if (*depth < 2.0) != (across < 32) {
                        let off = if across < 32 { 31 - across } else { across - 32 };
                        shares[off] += 1.0 / (2.0 * 2.0 * 4000.0);
                    }
                }
            }
            assert_near(stddev_of_shares(&shares), expected_px, 0.02);
        }
    }
}

/// All outputs of a frame of some scenery.
fn outputs(
    config: DepthCameraConfig<'_>,
    shutter: Shutter<'_>,
    builder: &SceneBuilder,
) -> (Vec<f32>, Vec<u16>, Vec<u8>) {
    let camera = DepthCamera::new(config).unwrap();
    let mut metres = vec![0.0; camera.pixels()];
    let mut millimetres = vec![0; camera.pixels()];
    let mut points = vec![0; camera.pixels() * POINT_STEP];
    let output = DepthFrame::new().depth_32fc1(&mut metres).depth_16uc1(&mut millimetres).points(&mut points);
    let scene = builder.scene();
    let capture = Capture::new(2, shutter);
    let mut memory = WorkspaceBuf::default();
    camera.sense(&scene, &capture, &mut memory.lend(camera.workspace_len(&scene, &capture)), output).unwrap();
    (metres, millimetres, points)
}

#[test]
fn all_outputs_show_the_same_measurement() {
    let mut builder = SceneBuilder::new();
    scenery(&mut builder);
    let eye = Pose::from_xyz_rpy(DVec3::new(-3.2, 0.3, 1.4), DVec3::new(0.1, 0.2, -0.05));
    let moment = || Shutter::Global(builder.moment(eye));
    let plain = depth_camera().camera(camera_of([333, 245], 1.2)).min_depth_m(0.4).max_depth_m(6.0);
    let config = plain.model(published::nguyen());
    let (metres, millimetres, points) = outputs(config, moment(), &builder);
    let (true_metres, _, plain_points) = outputs(plain, moment(), &builder);
    let lens = common::pinhole(&plain.camera).intrinsics();
    let mut valid = 0;
    for (pixel, (metres, millimetres)) in metres.iter().zip(&millimetres).enumerate() {
        let point = &points[pixel * POINT_STEP..][..POINT_STEP];
        let read = |at: usize| f32::from_le_bytes(point[at..at + 4].try_into().unwrap());
        assert_eq!(point[12..], plain_points[pixel * POINT_STEP + 12..][..POINT_STEP - 12], "colours");
        if metres.is_finite() {
            valid += 1;
            assert!((0.4..6.0).contains(metres));
            assert!((f64::from(*millimetres) - f64::from(*metres) * 1000.0).abs() < 0.501);
            let slopes =
                [((pixel % 333) as f64 - lens.cx) / lens.fx, ((pixel / 333) as f64 - lens.cy) / lens.fy];
            for (at, slope) in [(0, slopes[0]), (4, slopes[1]), (8, 1.0)] {
                assert!((f64::from(read(at)) - slope * f64::from(*metres)).abs() < 1e-5);
            }
        } else {
            assert_eq!(*millimetres, 0);
            assert!([0, 4, 8].into_iter().all(|at| read(at).is_nan()));
        }
    }
    assert!(valid > 40_000 && metres != true_metres);
    // Slices at the same moment give the same measurement, wherever they are cut.
    let at = builder.moment(eye);
    let slices: Vec<_> = (0..49).map(|slice| Slice { lines: slice * 5..slice * 5 + 5, at }).collect();
    assert!(outputs(config, Shutter::Slices(&slices), &builder).0 == metres);
}

#[test]
fn depths_that_noise_moves_out_of_range_are_reported_so() {
    let noise = AxialNoise { polynomial: [0.1, 0.0, 0.0], ..AxialNoise::NONE };
    let config = narrow([64, 64]).min_depth_m(0.9).max_depth_m(1.1).model(DepthModel::new().noise(noise));
    let depth = depth_frame(&plane(1.0, 0.0), config, Pose::IDENTITY, 0);
    let share =
        |value: f32| depth.iter().filter(|depth| **depth == value).count() as f64 / depth.len() as f64;
    // Φ(−1) on either side.
    assert!((share(f32::INFINITY) - 0.1587).abs() < 0.02 && (share(f32::NEG_INFINITY) - 0.1587).abs() < 0.02);
    // A depth that is too far without noise is not brought back into range by it.
    let depth = depth_frame(&plane(1.15, 0.0), config, Pose::IDENTITY, 0);
    assert!(depth.iter().all(|depth| *depth == f32::INFINITY));
    let depth = depth_frame(&SceneBuilder::new(), config, Pose::IDENTITY, 0);
    assert!(depth.iter().all(|depth| *depth == f32::INFINITY));
}

#[test]
fn gaussian_noise_is_a_model() {
    // With a lateral noise too small to reach the next pixel, the second pass adds the Gaussian noise.
    let noise = GaussianNoise::new(
        GaussianNoiseConfig::default().mean(0.01).stddev(0.02).bias_mean(0.5).precision(0.001),
    )
    .unwrap();
    let lateral = LateralNoise { stddev_px: 1e-9, ..LateralNoise::NONE };
    let wide = depth_camera().camera(camera_of([333, 245], 1.2));
    let builder = plane(2.0, 0.5);
    let first = depth_frame(&builder, wide.model(noise), Pose::IDENTITY, 4);
    let second =
        depth_frame(&builder, wide.model(DepthModel::from(noise).window(lateral)), Pose::IDENTITY, 4);
    assert!(first == second);
}

#[test]
fn bad_parameters_are_named() {
    let error = |model: DepthModel| DepthCamera::new(depth_camera().model(model)).unwrap_err();
    let nan = error(DepthModel::new().window(LateralNoise { stddev_px: f64::NAN, ..LateralNoise::NONE }));
    assert_eq!((nan.parameter, nan.rule), ("lateral.stddev_px", Rule::Range([0.0, 100.0])));
    let negative = error(DepthModel::new().noise(AxialNoise { slant: [0.0, -0.1], ..AxialNoise::NONE }));
    assert_eq!((negative.parameter, negative.value), ("noise.slant", -0.1));
    assert_eq!(negative.to_string(), "noise.slant of the device is -0.1; it must be from 0 to 1000");
    let beyond = AxialNoise { slant_from_rad: 1.6, ..AxialNoise::NONE };
    assert_eq!(error(DepthModel::new().noise(beyond)).parameter, "noise.slant_from_rad");
    let steps = DisparitySteps { focal_px: 580.0, baseline_m: 0.0, step_px: 0.1 };
    assert_eq!(error(DepthModel::new().steps(steps)).parameter, "steps.baseline_m");
    let eye = SecondEye { half_view_rad: 2.0, ..SecondEye::at(0.1) };
    assert_eq!(error(DepthModel::new().second_eye(eye)).parameter, "second_eye.half_view_rad");
    let light =
        |hz| error(DepthModel::new().window(TimeOfFlight { modulation_hz: hz, ..published::AZURE_LIGHT }));
    for hz in [[f64::INFINITY, 0.0, 0.0], [0.0, 80e6, 16e6], [120e6, -80e6, 16e6], [120e6, 80e6, f64::NAN]] {
        assert_eq!(light(hz).parameter, "time_of_flight.modulation_hz");
    }
    // One turn of the common frequency is 120 turns of the first.
    let uncommon = light([120e6, 80e6, 1e6]);
    assert_eq!(
        uncommon.to_string(),
        "frequency in common of time_of_flight.modulation_hz of the device is 1000000; it must be from 1875000 to 120000000"
    );
    let matching = Matching { half: 0.0, ..published::D4XX_MATCHING };
    assert_eq!(error(DepthModel::new().matching(matching)).parameter, "matching.half");
    let locking = DisparityNoise { focal_px: 424.0, baseline_m: 0.05, stddev_px: 0.0, locking_px: 0.2 };
    assert_eq!(error(DepthModel::new().noise(locking)).parameter, "noise.locking_px");
}
