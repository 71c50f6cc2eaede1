//! Depth cameras by principle, on rendered planes: the steps and shadows of structured light, active stereo, time of
//! flight, and the presets. The expected numbers are from papers and data sheets, or computed here in f64.

#![allow(clippy::large_types_passed_by_value, reason = "configurations made where they are used read better")]

use crate::common;

use crate::common::planes::{Frame, assert_near, narrow, nguyen_m, plane, rms, take};
use crate::common::{add_grey, camera_of, depth_camera, depth_frame, scenery};
use belvedere_sensors::Pose;
use belvedere_sensors::camera::CameraConfig;
use belvedere_sensors::depth::DepthCameraConfig;
use belvedere_sensors::device::depth_model::presets::{self, DepthPreset};
use belvedere_sensors::device::depth_model::{
    DepthModel, DisparityNoise, DotWindow, LateralNoise, SecondEye, TimeOfFlight, published,
};
use belvedere_sensors::noise::Stream;
use belvedere_sensors::optics::{Intrinsics, Pinhole, PinholeGrid};
use belvedere_sensors::scene::{SceneBuilder, Shape, visibility};
use belvedere_sensors::trace::rays::{Rays, cast_rays, workspace_len};
use belvedere_sensors::trace::{Faces, Hits, WorkspaceBuf};
use core::f64::consts::{FRAC_PI_2, PI};
use glam::DVec3;

/// A camera of 640 × 480 pixels with this focal length.
fn focal(pixels: f64) -> DepthCameraConfig<'static> {
    let lens = Intrinsics { fx: pixels, fy: pixels, cx: 319.5, cy: 239.5, skew: 0.0 };
    DepthCameraConfig::new(CameraConfig::new(
        PinholeGrid::new(640, 480, Pinhole::new(lens).unwrap()).unwrap(),
    ))
}

/// Adds a plate that faces the camera at a depth, between two positions to the left; the same range applies to its
/// height.
fn add_plate(builder: &mut SceneBuilder, depth: f64, [left, right]: [f64; 2]) {
    let middle = DVec3::new(depth, 0.5 * (left + right), 0.0);
    let pose = Pose::from_xyz_rpy(middle, DVec3::new(0.0, -FRAC_PI_2, 0.0));
    add_grey(builder, Shape::Rectangle { size: [20.0, left - right] }, pose);
}

fn errors(frame: &Frame) -> impl Iterator<Item = f64> {
    frame.depth.iter().zip(&frame.true_depth).map(|(found, truth)| f64::from(found - truth))
}

#[test]
fn steps_and_noise_of_a_kinect_by_its_disparities() {
    // Ramps of about 0.5 m around 2 and 5 m.
    for (depth, step_mm, stddev_mm) in [(2.0, 11.4, 5.7), (5.0, 71.0, 35.6)] {
        let ramp = plane(depth, f64::to_radians(45.0));
        let camera = depth_camera().camera(camera_of([640, 480], 0.5 / depth));
        let frame = take(&ramp, camera.model(DepthModel::new().steps(published::KINECT_STEPS)), 0);
        let mut values: Vec<f64> = frame.depth.iter().map(|depth| f64::from(*depth)).collect();
        values.sort_unstable_by(f64::total_cmp);
        values.dedup();
        let nearest = values.partition_point(|value| *value < depth);
        assert_near(values[nearest] - values[nearest - 1], step_mm * 1e-3, 0.02);
        // Rounding is to the nearer of two steps.
        assert!(errors(&frame).all(|error| error.abs() < 0.6 * (depth + 0.3).powi(2) * 2.85e-3));
        let frame = take(&ramp, camera.model(published::khoshelham()), 1);
        let at_1m = errors(&frame).zip(&frame.true_depth).map(|(error, z)| error / f64::from(z * z));
        assert_near(rms(at_1m) * depth * depth, stddev_mm * 1e-3, 0.02);
    }
}

#[test]
fn redwood_without_noise_is_its_formula() {
    let ramp = plane(3.0, f64::to_radians(60.0));
    let camera = depth_camera().camera(camera_of([640, 480], 0.9));
    let steps = DepthModel::new().steps(published::redwood().steps);
    let frame = take(&ramp, camera.model(steps), 0);
    let mut off = 0;
    for (found, truth) in frame.depth.iter().zip(&frame.true_depth) {
        let eighths = (35.130 / f64::from(*truth) * 8.0).round_ties_even();
        off += usize::from((f64::from(*found) / (35.130 * 8.0 / eighths) - 1.0).abs() > 1e-6);
    }
    // In single precision, some values between two steps are rounded differently.
    assert!(off < 20, "{off} of {}", frame.depth.len());
    assert_near(published::redwood().steps.unwrap().step_m(1.0), 3.56e-3, 0.001);
    // With noise: σ of 1/36 of a pixel, and rounding.
    let frame = take(&plane(2.0, 0.3), narrow([320, 240]).model(published::redwood()), 0);
    let at_1m = rms(errors(&frame).map(|error| error / 4.0 * 35.13));
    assert!(at_1m > 0.027_778 && at_1m < 0.0625 + 0.027_778, "{at_1m}");
}

#[test]
fn projector_shadows_have_the_width_of_triangulation() {
    const PLACES: usize = 8;
    let baseline = 0.075;
    for (near, far) in [(1.0, 2.0), (0.8, 4.0), (1.5, 1.9), (2.0, 3.0)] {
        for right in [baseline, -baseline] {
            let mut hidden_pixels = 0;
            for place in 0..PLACES {
                // Edges at all positions between two pixels.
                let off = place as f64 / PLACES as f64 * near / 580.0;
                let mut builder = plane(far, 0.0);
                add_plate(&mut builder, near, [0.1 * near + off, -0.1 * near + off]);
                let config = focal(580.0).model(DepthModel::new().second_eye(SecondEye::at(right)));
                let frame = take(&builder, config, 0);
                for row in [0, 100, 240, 479] {
                    let line = &frame.depth[row * 640..(row + 1) * 640];
                    let hidden: Vec<usize> = (0..640).filter(|x| line[*x].is_nan()).collect();
                    hidden_pixels += hidden.len();
                    // On the side of the plate away from the projector, one connected shadow beside it.
                    let plate: Vec<usize> =
                        (0..640).filter(|x| (f64::from(line[*x]) - near).abs() < 1e-3).collect();
                    let beside =
                        if right > 0.0 { plate[0] - hidden.len() } else { plate[plate.len() - 1] + 1 };
                    assert!(hidden.iter().copied().eq(beside..beside + hidden.len()), "row {row}");
                }
            }
            let width = hidden_pixels as f64 / (4 * PLACES) as f64;
            let expected = 580.0 * baseline * (1.0 / near - 1.0 / far);
            assert!((width - expected).abs() < 0.15, "{width} px, not {expected}");
        }
    }
}

#[test]
fn shadows_of_all_shapes_agree_with_single_rays() {
    let mut builder = SceneBuilder::new();
    scenery(&mut builder);
    // Shadows of meshes, solids and terrain are computed by other code than single rays.
    let eye = Pose::from_xyz_rpy(DVec3::new(-3.2, 0.3, 1.4), DVec3::new(0.1, 0.2, -0.05));
    let config = depth_camera().camera(camera_of([333, 245], 1.2));
    let truth = depth_frame(&builder, config, eye, 0);
    let seen = depth_frame(&builder, config.model(DepthModel::new().second_eye(SecondEye::at(0.2))), eye, 0);
    let lens = common::pinhole(&config.camera).intrinsics();
    let axes = eye.rotation_matrix();
    let from = axes * DVec3::new(0.0, -0.2, 0.0);
    let directions: Vec<[f32; 3]> = (0..truth.len())
        .map(|pixel| {
            let slopes = DVec3::new(
                1.0,
                (lens.cx - (pixel % 333) as f64) / lens.fx,
                (lens.cy - (pixel / 333) as f64) / lens.fy,
            );
            let depth = if truth[pixel].is_finite() { f64::from(truth[pixel]) } else { 1.0 };
            (axes * slopes * depth - from).as_vec3().to_array()
        })
        .collect();
    let mut distances = vec![0.0; truth.len()];
    let scene = builder.scene();
    cast_rays(
        &scene,
        builder.poses(),
        eye.translation(),
        &Rays { origins: &[from.as_vec3().to_array()], directions: &directions, ranges: None },
        visibility::VISUAL,
        Faces::Both,
        &mut WorkspaceBuf::default().lend(workspace_len(&scene)),
        Hits { distance: Some(&mut distances), ..Hits::default() },
    )
    .unwrap();
    let (mut shadows, mut unlike) = (0, 0);
    for (pixel, found) in seen.iter().enumerate() {
        if truth[pixel].is_finite() {
            let is_hidden = distances[pixel] < 1.0 - 1e-3;
            shadows += usize::from(is_hidden);
            unlike += usize::from(found.is_nan() != is_hidden);
            assert!(found.is_nan() || *found == truth[pixel]);
        } else {
            assert_eq!(*found, truth[pixel]);
        }
    }
    assert!(shadows > 4000 && unlike < 10, "{unlike} of {shadows} shadows");
}

#[test]
fn active_stereo_by_the_white_paper() {
    let d435 = presets::named("d435").unwrap();
    for (depth, rms_mm) in [(1.0, 3.77), (2.0, 15.1), (4.0, 60.4)] {
        let config = DepthCameraConfig::of_preset(&d435).unwrap();
        let frame = take(&plane(depth, 0.0), config, 0);
        // Points that only the left eye sees, f·B/z pixels at the left, have no depth.
        let band = 424.0 * 0.05 / depth;
        for row in frame.depth.chunks(848) {
            let without = row.iter().filter(|depth| depth.is_nan()).count();
            assert!((without as f64 - band).abs() <= 0.5 + 1e-6, "{without}, not {band}");
            assert!(row[..without].iter().all(|depth| depth.is_nan()));
        }
        assert_near(plane_fit_rms(&frame.depth, 848), rms_mm * 1e-3, 0.02);
    }
    // The noise of the others scales with f·B.
    for (name, focal, baseline) in [("d415", 1280.0 / (2.0 * 0.637_07), 0.055), ("d455", 446.8, 0.095)] {
        let config = DepthCameraConfig::of_preset(&presets::named(name).unwrap()).unwrap();
        let frame = take(&plane(2.0, 0.0), config, 0);
        let width = presets::named(name).unwrap().size[0] as usize;
        assert_near(plane_fit_rms(&frame.depth, width), 4.0 * 0.08 / (focal * baseline), 0.02);
    }
}

/// The root mean square of depths about the plane that fits them best by least squares.
fn plane_fit_rms(depth: &[f32], width: usize) -> f64 {
    let valid = || {
        depth.iter().enumerate().filter(|(_, depth)| depth.is_finite()).map(|(pixel, depth)| {
            let (x, y) = (pixel % width, pixel / width);
            (DVec3::new(x as f64 / 1000.0, y as f64 / 1000.0, 1.0), f64::from(*depth))
        })
    };
    let (mut normal, mut right) = (glam::DMat3::ZERO, DVec3::ZERO);
    for (at, depth) in valid() {
        normal += glam::DMat3::from_cols(at * at.x, at * at.y, at * at.z);
        right += at * depth;
    }
    let fit = normal.inverse() * right;
    rms(valid().map(|(at, depth)| depth - fit.dot(at)))
}

#[test]
fn kinect_v2_by_fankhauser() {
    for (depth, degrees) in [(1.0_f64, 0.0), (2.0, 0.0), (4.0, 0.0), (2.0, 60.0), (1.0, 75.0_f64)] {
        let angle = degrees.to_radians();
        let slant = angle * angle / (FRAC_PI_2 - angle).powi(2);
        let expected_mm = 1.5 - 0.5 * depth + 0.3 * depth * depth + 0.1 * depth.powf(1.5) * slant;
        let frame = take(&plane(depth, angle), narrow([320, 240]).model(published::fankhauser()), 0);
        assert_near(rms(errors(&frame)), expected_mm * 1e-3, 0.02);
    }
}

/// c/(4πf)·arg Σ aₖ·exp(i·4πf·rₖ/c) for amplitudes and ranges.
fn mixed(light: &TimeOfFlight, parts: &[(f64, f64)]) -> f64 {
    let phase = |range: f64| 2.0 * PI * range / light.ambiguity_m();
    let sum = |part: fn(f64) -> f64| parts.iter().map(|(a, range)| a * part(phase(*range))).sum::<f64>();
    let turns = sum(f64::sin).atan2(sum(f64::cos)) / (2.0 * PI);
    (turns - turns.floor()) * light.ambiguity_m()
}

#[test]
fn time_of_flight_has_flying_pixels_and_wraps() {
    let light = TimeOfFlight::of_one(80e6, 0.5);
    assert_near(light.ambiguity_m(), 1.8737, 1e-4);
    // The fractions of the footprint of a pixel beside an edge that are in front and behind.
    let (side, corner) = ((-2.0_f64).exp(), (-4.0_f64).exp());
    let (near_share, far_share) = (side + 2.0 * corner, 1.0 + 3.0 * side + 2.0 * corner);
    // If the two surfaces have equal amplitudes, the depth is in the middle, below half the ambiguity range.
    let equal = (far_share / near_share).sqrt();
    let near = 0.4;
    for (far, is_equal) in [(near * equal, true), (0.8, false), (1.1, false)] {
        let mut builder = plane(far, 0.0);
        let camera = depth_camera().camera(camera_of([64, 48], 1e-3)).model(DepthModel::new().window(light));
        add_plate(&mut builder, near, [5.0, 0.0]);
        let depth = depth_frame(&builder, camera, Pose::IDENTITY, 0);
        let amplitude = |share: f64, range: f64| (share / (range * range), range);
        let behind = mixed(&light, &[amplitude(near_share, near), amplitude(far_share, far)]);
        let before = mixed(&light, &[amplitude(far_share, near), amplitude(near_share, far)]);
        if is_equal {
            assert!(far - near < 0.5 * light.ambiguity_m());
            assert!((behind - 0.5 * (near + far)).abs() < 1e-9);
        }
        for row in 1..47 {
            let line = &depth[row * 64..][..64];
            for (column, expected) in [(30, near), (31, before), (32, behind), (33, far)] {
                assert!(
                    (f64::from(line[column]) - expected).abs() < 1e-5,
                    "column {column}: {}",
                    line[column]
                );
            }
        }
    }
    // Beyond the ambiguity range it wraps around; a slanted plane keeps its shape.
    let camera = depth_camera().camera(camera_of([64, 48], 0.5)).model(DepthModel::new().window(light));
    let frame = take(&plane(2.9, 0.0), camera, 0);
    for (pixel, (found, truth)) in frame.depth.iter().zip(&frame.true_depth).enumerate() {
        let lens = common::pinhole(&camera.camera).intrinsics();
        let slopes = [(pixel % 64) as f64 - lens.cx, (pixel / 64) as f64 - lens.cy].map(|off| off / lens.fx);
        let longer = (1.0 + slopes[0] * slopes[0] + slopes[1] * slopes[1]).sqrt();
        let expected = (f64::from(*truth) * longer - light.ambiguity_m()) / longer;
        let is_inside = (1..63).contains(&(pixel % 64)) && (1..47).contains(&(pixel / 64));
        assert!(!is_inside || (f64::from(*found) - expected).abs() < 1e-4, "{found}, not {expected}");
    }
    let frame = take(&plane(1.2, 0.7), camera, 0);
    assert!(rms(errors(&frame)) < 1e-3);
    assert!(
        depth_frame(&SceneBuilder::new(), camera, Pose::IDENTITY, 0)
            .iter()
            .all(|depth| *depth == f32::INFINITY)
    );
}

/// The dot filter applied to disparities, dot by dot: each dot spreads its disparity over pixels up to three pixels
/// away with a weight of 1/(1 + r²); the first of two equal weights counts.
fn dot_filter(disparity: &[f64], [width, height]: [usize; 2], seed: u64, sensor: u32) -> Vec<f64> {
    let pattern = Stream { seed, sensor, frame: 0, channel: Stream::DOTS };
    let across = width.div_ceil(3);
    let dots: Vec<[usize; 2]> = (0..across * height.div_ceil(3))
        .map(|square| {
            let place = (u64::from(pattern.word(square as u32)) * 9 / (1 << 32)) as usize;
            [square % across * 3 + place % 3, square / across * 3 + place / 3]
        })
        .filter(|dot| dot[0] < width && dot[1] < height)
        .collect();
    let (mut best, mut result) = (vec![0.0; width * height], vec![f64::NAN; width * height]);
    for dot in &dots {
        let off = |other: &[usize; 2]| [dot[0].abs_diff(other[0]), dot[1].abs_diff(other[1])];
        let window: Vec<(f64, f64)> = dots
            .iter()
            .filter(|other| off(other).into_iter().all(|off| off <= 4))
            .map(|other| {
                let [x, y] = off(other).map(|off| off as f64);
                (disparity[other[1] * width + other[0]], x * x + y * y)
            })
            .collect();
        let valid: Vec<_> = window.iter().filter(|(disparity, _)| *disparity > 0.0).collect();
        let own = disparity[dot[1] * width + dot[0]];
        let most = window.len() as f64 / 1.2;
        if own <= 0.0 || valid.len() as f64 <= most {
            continue;
        }
        let mean = valid.iter().map(|(disparity, _)| disparity).sum::<f64>() / valid.len() as f64;
        let weight = |squared: f64| if squared == 0.0 { 1.0 } else { 1.0 / (1.44 * squared) };
        let inliers =
            valid.iter().filter(|(disparity, squared)| (disparity - mean).abs() * weight(*squared) < 0.1);
        if inliers.count() as f64 <= most {
            continue;
        }
        for y in dot[1].saturating_sub(3)..(dot[1] + 4).min(height) {
            for x in dot[0].saturating_sub(3)..(dot[0] + 4).min(width) {
                let [across, down] = [x as f64 - dot[0] as f64, y as f64 - dot[1] as f64];
                let squared = across * across + down * down;
                if squared <= 9.0 && 1.0 / (1.0 + squared) > best[y * width + x] {
                    best[y * width + x] = 1.0 / (1.0 + squared);
                    result[y * width + x] = (own * 8.0).round() / 8.0;
                }
            }
        }
    }
    result
}

#[test]
fn dots_are_found_by_the_published_filter() {
    let mut builder = SceneBuilder::new();
    scenery(&mut builder);
    let eye = Pose::from_xyz_rpy(DVec3::new(-3.2, 0.3, 1.4), DVec3::new(0.1, 0.2, -0.05));
    let size = [161, 122];
    let config = depth_camera().camera(camera_of(size, 1.2).sensor(3));
    let truth = depth_frame(&builder, config, eye, 0);
    let window = DotWindow { focal_px: 480.0, baseline_m: 0.075, lateral: LateralNoise::NONE };
    let found = depth_frame(&builder, config.model(DepthModel::new().window(window)), eye, 9);
    let at_1m = 480.0 * 0.075;
    let disparity: Vec<f64> =
        truth.iter().map(|z| if z.is_finite() { at_1m / f64::from(*z) } else { 0.0 }).collect();
    let expected = dot_filter(&disparity, size.map(|size| size as usize), 1, 3);
    let (mut holes, mut unlike) = (0, 0);
    for (found, disparity) in found.iter().zip(&expected) {
        holes += usize::from(disparity.is_nan());
        let same = (f64::from(*found) * disparity / at_1m - 1.0).abs() < 1e-5;
        unlike += usize::from(!(same || found.is_nan() && disparity.is_nan()));
    }
    // In single precision, some values are rounded and decided differently.
    assert!(holes > 1000 && unlike < 40, "{unlike} unlike, {holes} holes of {}", expected.len());
    // A plane that faces the camera has a single depth, and holes only where its last dots are beyond the picture.
    let wall =
        depth_frame(&plane(2.0, 0.0), config.model(DepthModel::new().window(window)), Pose::IDENTITY, 0);
    for (pixel, depth) in wall.iter().enumerate() {
        let is_last = pixel % 161 > 157 || pixel / 161 > 118;
        // 18 px are a whole number of eighths.
        assert!((f64::from(*depth) - 2.0).abs() < 1e-6 || is_last && depth.is_nan(), "{depth} at {pixel}");
    }
}

#[test]
fn icl_nuim_has_the_steps_of_its_formula() {
    let camera = depth_camera().camera(camera_of([320, 240], 1.0));
    let frame = take(&plane(3.0, 0.5), camera.model(published::icl_nuim()), 0);
    let mut valid = 0;
    for (found, truth) in frame.depth.iter().zip(&frame.true_depth).filter(|(found, _)| found.is_finite()) {
        valid += 1;
        let steps = 351.30 / f64::from(*found);
        assert!((steps - steps.round()).abs() < 1e-3, "{found}");
        // Half a step of an eighth of a pixel at 36 px·m, the slope over three pixels with a σ of 0.5, and several σ of
        // 1/6 of a step.
        assert!((found - truth).abs() < 0.1 + 0.02 * truth, "{found}, {truth}");
    }
    assert!(valid > 70_000, "{valid}");
}

#[test]
fn presets_are_as_noisy_as_published() {
    let error = |preset: &DepthPreset, depth: f64| {
        let [least, most] = preset.range_m;
        assert!((least..most).contains(&depth), "{}", preset.name);
        let focal = preset.focal_px();
        // The middle of the preset's picture.
        let lens = Intrinsics { fx: focal, fy: focal, cx: 159.5, cy: 119.5, skew: 0.0 };
        let grid = PinholeGrid::new(320, 240, Pinhole::new(lens).unwrap()).unwrap();
        let model = preset.model(focal);
        let config = DepthCameraConfig::new(CameraConfig::new(grid)).model(model);
        // Steep enough for the steps to average out.
        let frame = take(&plane(depth, 0.05), config, 0);
        rms(errors(&frame).filter(|error| !error.is_nan()))
    };
    for name in ["kinect_v1", "xtion"] {
        let preset = presets::named(name).unwrap();
        for depth in [0.9, 1.5, 2.0, 3.0] {
            assert_near(error(&preset, depth), nguyen_m(depth, 0.05), 0.02);
        }
    }
    let v2 = presets::named("kinect_v2").unwrap();
    for (depth, expected_mm) in [(1.0, 1.3), (2.0, 1.7), (4.0, 4.3)] {
        assert_near(error(&v2, depth), expected_mm * 1e-3, 0.02);
    }
    let azure = presets::named("azure_kinect").unwrap();
    assert!(error(&azure, 3.5) < 0.0175 && error(&azure, 1.0) < 0.002);
    for preset in presets::ALL {
        assert!(preset.source.len() > 30 && presets::named(preset.name).is_some());
        let config = DepthCameraConfig::of_preset(preset).unwrap();
        let lens = common::pinhole(&config.camera);
        assert_eq!(lens.size(), preset.size);
        assert!((lens.intrinsics().fx - preset.focal_px()).abs() < 1e-9);
    }
}

#[test]
fn kinect_v1_as_a_whole_keeps_its_noise_on_slanted_planes() {
    let preset = presets::named("kinect_v1").unwrap();
    let config = DepthCameraConfig::of_preset(&preset).unwrap().min_depth_m(0.1).max_depth_m(20.0);
    for depth in [0.6, 1.0, 2.0, 3.5, 5.0] {
        // Not at 0°: if all pixels have the same depth, rounding is not noise.
        for degrees in [2.0, 30.0, 50.0, 65.0, 80.0_f64] {
            let frame = take(&plane(depth, degrees.to_radians()), config, 7);
            let around = if degrees < 10.0 { 8.0 } else { 3.0 };
            let mut near = Vec::new();
            for ((error, truth), angle) in errors(&frame).zip(&frame.true_depth).zip(&frame.incidence) {
                let (truth, angle) = (f64::from(*truth), f64::from(*angle));
                // Pixels similar to those at the axis; the formula is only valid in its range.
                if !error.is_nan() && truth < 5.2 && (angle.to_degrees() - degrees).abs() < around {
                    near.push(error / nguyen_m(truth, angle));
                }
            }
            assert!(near.len() > 5000, "{depth} m, {degrees}°: {}", near.len());
            assert_near(rms(near.iter().copied()), 1.0, 0.02);
        }
    }
}

#[test]
fn noise_of_disparities_ends_at_infinity() {
    let noise = DisparityNoise { focal_px: 424.0, baseline_m: 0.05, stddev_px: 2.0, locking_px: 0.0 };
    let config = narrow([64, 64]).max_depth_m(100.0).model(DepthModel::new().noise(noise));
    let depth = depth_frame(&plane(20.0, 0.0), config, Pose::IDENTITY, 0);
    let far = depth.iter().filter(|depth| **depth == f32::INFINITY).count() as f64 / depth.len() as f64;
    // 1.06 px with a σ of 2 px: the probability of less than 0.212 px (beyond 100 m and behind) is Φ(−0.424).
    assert!((far - 0.3358).abs() < 0.025, "{far}");
    assert!(depth.iter().all(|depth| *depth > 0.0));
}

/// A square of 3 m, 2 m ahead, in front of a wall; its triangles are clockwise or counter-clockwise as seen from the
/// camera.
fn square(clockwise: bool) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let red = common::glowing(&mut builder, [1.0, 0.0, 0.0]);
    let corners = [[2.0, 1.5, 1.5], [2.0, -1.5, 1.5], [2.2, -1.5, -1.5], [2.2, 1.5, -1.5]];
    let triangles = if clockwise { [[0, 1, 2], [0, 2, 3]] } else { [[0, 2, 1], [0, 3, 2]] };
    let square = builder.add_mesh(&corners, &[], &triangles).unwrap();
    common::add(&mut builder, Shape::Mesh(square), Pose::IDENTITY, red);
    let blue = common::glowing(&mut builder, [0.0, 0.0, 1.0]);
    let wall = Pose::from_translation(DVec3::X * 5.5);
    common::add(&mut builder, Shape::Box { size: [1.0, 30.0, 30.0] }, wall, blue);
    builder
}

#[test]
fn both_sides_of_surfaces_are_measured() {
    use belvedere_sensors::depth::{DepthCamera, DepthFrame, POINT_STEP};
    use belvedere_sensors::trace::Truth;
    use belvedere_sensors::{Capture, Sensor};
    let config = depth_camera().camera(camera_of([160, 120], 1.2));
    let take = |builder: &SceneBuilder, faces| {
        let camera = DepthCamera::new(config.faces(faces)).unwrap();
        let (scene, capture) = (builder.scene(), Capture::new(0, builder.moment(Pose::IDENTITY)));
        let pixels = camera.pixels();
        let (mut depth, mut true_depth) = (vec![0.0_f32; pixels], vec![0.0_f32; pixels]);
        let (mut colour, mut points) = (vec![0; 3 * pixels], vec![0; POINT_STEP * pixels]);
        let output = DepthFrame::new().depth_32fc1(&mut depth).colour(&mut colour).points(&mut points);
        let output = output.truth(Truth::new().depth(&mut true_depth));
        let mut memory = WorkspaceBuf::default();
        camera
            .sense(&scene, &capture, &mut memory.lend(camera.workspace_len(&scene, &capture)), output)
            .unwrap();
        assert_eq!(depth, true_depth);
        for (index, depth) in depth.iter().enumerate() {
            let z = f32::from_le_bytes(*points[POINT_STEP * index + 8..].first_chunk().unwrap());
            assert_eq!(z.to_bits(), depth.to_bits(), "the cloud is of the same surfaces");
            let rgb = &colour[3 * index..3 * index + 3];
            assert_eq!(*rgb, if *depth < 3.0 { [255, 0, 0] } else { [0, 0, 255] }, "and so is the picture");
        }
        depth
    };
    let expected = take(&square(false), Faces::Front);
    assert!(expected.iter().filter(|depth| **depth < 3.0).count() > 8000);
    let near = |found: &[f32]| found.iter().zip(&expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-6);
    assert_eq!(DepthCameraConfig::new(config.camera).faces, Faces::Both, "the default");
    for clockwise in [false, true] {
        assert!(near(&take(&square(clockwise), Faces::Both)), "clockwise: {clockwise}");
    }
    assert!(take(&square(true), Faces::Front).iter().all(|depth| (depth - 5.0).abs() < 1e-5), "the wall");
}

#[test]
fn devices_measure_back_faces_as_they_do_front_faces() {
    let config = depth_camera().camera(camera_of([160, 120], 1.2));
    for model in [published::nguyen(), published::fankhauser(), published::redwood()] {
        let frame = |clockwise| {
            depth_frame(&square(clockwise), config.model(model).faces(Faces::Both), Pose::IDENTITY, 3)
        };
        let (front, back) = (frame(false), frame(true));
        let off = front
            .iter()
            .zip(&back)
            .filter(|(a, b)| !(**a == **b || (*a - *b).abs() < 1e-4 || a.is_nan() && b.is_nan()));
        let off = off.count();
        assert!(off < 20, "{off} depths differ");
    }
}
