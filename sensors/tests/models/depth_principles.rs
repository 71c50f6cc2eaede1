//! Depth cameras beyond their noise: subpixel locking, stereo matching, and light of several frequencies, on rendered
//! planes against formulas in f64.

#![allow(clippy::large_types_passed_by_value, reason = "configurations made where they are used read better")]

use crate::common::planes::{assert_near, narrow, plane, rms, take};
use crate::common::random::case;
use crate::common::{add, add_grey, camera_of, depth_camera, depth_frame};
use belvedere_sensors::camera::CameraConfig;
use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig, DepthFrame};
use belvedere_sensors::device::depth_model::{
    AxialNoise, DepthModel, DisparityNoise, Matching, TimeOfFlight, published,
};
use belvedere_sensors::scene::{Environment, MaterialConfig, SceneBuilder, Shape};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Pose, Sensor};
use core::f64::consts::{FRAC_PI_2, SQRT_2, TAU};
use glam::DVec3;

const LIGHT: f64 = 299_792_458.0;

/// Numbers of a fixed seed, uniform on a range.
fn random(index: u32, range: [f64; 2]) -> f64 {
    case(20, index, range)
}

#[test]
fn locking_pulls_disparities_to_whole_pixels() {
    for case in 0..6_u32 {
        let number = |index, range| random(8 * case + index, range);
        let (focal_px, baseline_m) = (number(0, [300.0, 900.0]), number(1, [0.03, 0.12]));
        let locking_px = number(2, [0.01, 0.15]);
        let noise = DisparityNoise { focal_px, baseline_m, stddev_px: 0.0, locking_px };
        let ramp = plane(number(3, [1.0, 3.0]), number(4, [0.6, 1.1]));
        let camera = depth_camera().camera(camera_of([640, 100], 0.8)).model(DepthModel::new().noise(noise));
        let frame = take(&ramp, camera, 0);
        let mut off = Vec::new();
        for (found, truth) in frame.depth.iter().zip(&frame.true_depth) {
            let [found, truth] = [found, truth].map(|depth| focal_px * baseline_m / f64::from(*depth));
            let expected = truth - locking_px * (TAU * truth).sin();
            // The tolerance of single precision, for disparities and for depths.
            assert!((found - expected).abs() < 1e-6 * truth + 1e-6, "{found}, not {expected}");
            off.push(found - truth);
        }
        let pixels = off.len() as f64;
        // The mean over whole pixels of disparity is 0, except for the ends of the ramps.
        assert!(off.iter().sum::<f64>().abs() / pixels < 0.2 * locking_px);
        assert_near(rms(off.into_iter()), locking_px / SQRT_2, 0.2);
    }
    // The order is kept: where a ramp comes nearer, so does its measurement.
    let noise = DisparityNoise { focal_px: 400.0, baseline_m: 0.05, stddev_px: 0.0, locking_px: 0.15 };
    let camera = depth_camera().camera(camera_of([640, 4], 0.8)).model(DepthModel::new().noise(noise));
    let row = &take(&plane(2.0, 0.9), camera, 0).depth[..640];
    assert!(row.is_sorted() || row.is_sorted_by(|a, b| a >= b));
}

/// The fraction of pixels that have a depth.
fn found(depth: &[f32]) -> f64 {
    depth.iter().filter(|depth| depth.is_finite()).count() as f64 / depth.len() as f64
}

fn scatter(share: f64, count: usize) -> f64 {
    4.5 * (share * (1.0 - share) / count as f64).sqrt() + 1e-4
}

#[test]
fn the_projector_matches_surfaces_without_texture() {
    let matching = Matching { projector: 0.4, half: 0.02, full: 0.03, spread: 0.25 };
    let camera = narrow([200, 150]);
    let of = |depth: f64, angle: f64, matching: Matching| {
        depth_frame(
            &plane(depth, angle),
            camera.model(DepthModel::new().matching(matching)),
            Pose::IDENTITY,
            1,
        )
    };
    let mut seen = [0; 3];
    for case in 0..12 {
        let (depth, angle) = (random(100 + case, [2.0, 6.5]), random(200 + case, [0.0, 1.2]));
        let expected = matching.fill_factor(matching.projected(depth) * angle.cos());
        let share = found(&of(depth, angle, matching));
        assert!(
            (share - expected).abs() < scatter(expected, 30_000),
            "{depth} m, {angle}: {share}, {expected}"
        );
        seen[usize::from(expected > 0.02) + usize::from(expected > 0.98)] += 1;
    }
    // All, some and none of the pixels are matched in different cases.
    assert!(seen.iter().all(|count| *count > 0), "{seen:?}");
    // Without a projector, no pixel of a grey plane is matched.
    assert!(of(1.0, 0.0, Matching { projector: 0.0, ..matching }).iter().all(|depth| depth.is_nan()));
    let nothing = camera.model(DepthModel::new().matching(matching));
    let sky = depth_frame(&SceneBuilder::new(), nothing, Pose::IDENTITY, 0);
    assert!(sky.iter().all(|depth| *depth == f32::INFINITY));
    // Other pixels are matched in another frame.
    let [first, second] = [1, 2].map(|number| {
        depth_frame(
            &plane(4.4, 0.0),
            camera.model(DepthModel::new().matching(matching)),
            Pose::IDENTITY,
            number,
        )
    });
    assert!(first.iter().zip(&second).any(|(a, b)| a.is_nan() != b.is_nan()));
}

/// A plane 2 m away with random grey texels of about the size of pixels, whose contrast increases from left to right.
fn textured() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    builder.set_environment(Environment { ambient: [1.0; 3], background: [0.0; 3] });
    let texels: Vec<[u8; 4]> = (0..256 * 256)
        .map(|texel| {
            let amplitude = f64::from(texel % 256) / 4.0;
            let grey = (128.0 + random(10_000 + texel, [-amplitude, amplitude])) as u8;
            [grey, grey, grey, 255]
        })
        .collect();
    let texture = builder.add_texture(256, 256, &texels).unwrap();
    let look = MaterialConfig {
        ambient: [1.0; 3],
        diffuse: [0.0; 3],
        texture: Some(texture),
        ..MaterialConfig::default()
    };
    let material = builder.add_material(&look).unwrap();
    let pose = Pose::from_xyz_rpy(DVec3::X * 2.0, DVec3::new(0.0, -FRAC_PI_2, 0.0));
    add(&mut builder, Shape::Rectangle { size: [2.0, 2.0] }, pose, material);
    builder
}

#[test]
fn textures_are_matched_by_their_contrast() {
    let (width, height) = (333, 245);
    let builder = textured();
    let matching = Matching { projector: 0.0, half: 0.035, full: 0.05, spread: 0.2 };
    let noise = DisparityNoise { focal_px: 300.0, baseline_m: 0.05, stddev_px: 0.05, locking_px: 0.0 };
    let lens = camera_of([width as u32, height as u32], 0.9);
    let config = DepthCameraConfig::new(lens).model(DepthModel::new().matching(matching).noise(noise));
    let camera = DepthCamera::new(config).unwrap();
    let (mut depth, mut colour) = (vec![0.0; width * height], vec![0; width * height * 3]);
    let (scene, capture) = (builder.scene(), Capture::new(0, builder.moment(Pose::IDENTITY)));
    let mut memory = WorkspaceBuf::default();
    let output = DepthFrame::new().depth_32fc1(&mut depth).colour(&mut colour);
    camera.sense(&scene, &capture, &mut memory.lend(camera.workspace_len(&scene, &capture)), output).unwrap();
    // Depths are the same without colours: brightness does not depend on whether colours are requested.
    let alone = depth_frame(&builder, config, Pose::IDENTITY, 0);
    assert!(depth.iter().zip(&alone).all(|(a, b)| a.to_bits() == b.to_bits()));

    // The contrast in the picture.
    let grey = |x: i64, y: i64| {
        let (x, y) = (x.clamp(0, width as i64 - 1) as usize, y.clamp(0, height as i64 - 1) as usize);
        f64::from(colour[(y * width + x) * 3]) / 255.0
    };
    let contrast = |x: i64, y: i64| {
        let squares = (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| (dx, dy)));
        rms(squares.map(|(dx, dy)| 0.5 * (grey(x + dx + 1, y + dy) - grey(x + dx - 1, y + dy))))
    };
    let mut filled = 0;
    let mut bins = [(); 6].map(|()| (0.0, 0.0, 0_usize, Vec::new()));
    for (pixel, depth) in depth.iter().enumerate() {
        let contrast = contrast((pixel % width) as i64, (pixel / width) as i64);
        let (expected, found, count, errors) = &mut bins[((contrast / 0.01) as usize).min(5)];
        *expected += matching.fill_factor(contrast);
        *found += f64::from(u8::from(depth.is_finite()));
        *count += 1;
        if depth.is_finite() {
            let noisier = (matching.full / contrast).max(1.0);
            errors.push((1.0 / f64::from(*depth) - 0.5) * 15.0 / (0.05 * noisier));
        }
    }
    for (expected, found, count, errors) in bins {
        if count < 500 {
            continue;
        }
        filled += 1;
        let (expected, found) = (expected / count as f64, found / count as f64);
        // Pictures are rounded to 1/255.
        assert!(
            (found - expected).abs() < scatter(expected, count) + 0.01,
            "{found}, not {expected}, of {count}"
        );
        if errors.len() > 1000 {
            assert_near(rms(errors.iter().copied()), 1.0, 0.03);
        }
    }
    assert!(filled >= 4 && (0.1..0.9).contains(&self::found(&depth)), "{filled}, {}", self::found(&depth));
}

/// The range that fits phases in turns best, found by trying all ranges in small steps, and the root mean square of the
/// phase errors in radians.
fn unwrapped(light: &TimeOfFlight, phases: &[f64]) -> (f64, f64) {
    let off = |range: f64| {
        let turns =
            light.modulation_hz.iter().zip(phases).map(|(hz, phase)| range * 2.0 * hz / LIGHT - phase);
        TAU * rms(turns.map(|turns| turns - turns.round()))
    };
    let steps = 20_000;
    let step = light.ambiguity_m() / f64::from(steps);
    let nearest =
        (0..steps).map(|index| f64::from(index) * step).min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap();
    let finer = (-100..=100).map(|index| nearest + f64::from(index) * 0.01 * step);
    let best = finer.min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap();
    (best, off(best))
}

const LIGHTS: [TimeOfFlight; 3] = [
    published::KINECT_V2_LIGHT,
    published::AZURE_LIGHT,
    TimeOfFlight { modulation_hz: [20e6, 0.0, 90e6], footprint_px: 0.5, most_off_rad: 0.3 },
];

#[test]
fn several_frequencies_unwrap_up_to_the_ambiguity_range() {
    for (index, light) in LIGHTS.iter().enumerate() {
        let camera = narrow([32, 8]).model(DepthModel::new().window(*light));
        for case in 0..10 {
            // Up to three times the ambiguity range.
            let range = random(300 + 10 * index as u32 + case, [0.2, 3.0 * light.ambiguity_m()]);
            let depth = depth_frame(&plane(range, 0.0), camera, Pose::IDENTITY, 0);
            let expected = range % light.ambiguity_m();
            for depth in depth {
                assert!((f64::from(depth) - expected).abs() < 1e-4, "{range}: {depth}, not {expected}");
            }
        }
    }
    // The greatest common divisors are 8, 30 and 10 MHz.
    let ambiguities = LIGHTS.map(|light| light.ambiguity_m());
    for (found, expected) in ambiguities.into_iter().zip([18.737, 4.9965, 14.9896]) {
        assert_near(found, expected, 1e-4);
    }
}

#[test]
fn phases_that_do_not_agree_at_edges_have_no_depth() {
    // The fractions of the footprint of a pixel beside an edge that are in front and behind.
    let (side, corner) = ((-2.0_f64).exp(), (-4.0_f64).exp());
    let (near_share, far_share) = (side + 2.0 * corner, 1.0 + 3.0 * side + 2.0 * corner);
    let (mut flying, mut lost) = (0, 0);
    for case in 0..60 {
        let light =
            TimeOfFlight { most_off_rad: random(600 + case, [0.03, 0.3]), ..LIGHTS[case as usize % 3] };
        let near = random(400 + case, [0.5, 1.5]);
        let far = near + random(500 + case, [0.01, 1.5]);
        let mut builder = plane(far, 0.0);
        let pose = Pose::from_xyz_rpy(DVec3::new(near, 2.5, 0.0), DVec3::new(0.0, -FRAC_PI_2, 0.0));
        add_grey(&mut builder, Shape::Rectangle { size: [20.0, 5.0] }, pose);
        let lens: CameraConfig<'_> = camera_of([64, 8], 1e-3);
        let depth = depth_frame(
            &builder,
            depth_camera().camera(lens).model(DepthModel::new().window(light)),
            Pose::IDENTITY,
            0,
        );
        for (column, shares) in [(31, [far_share, near_share]), (32, [near_share, far_share])] {
            let parts = [shares[0] / (near * near), shares[1] / (far * far)];
            let phases: Vec<f64> = (light.modulation_hz.iter())
                .map(|hz| {
                    let angle = |range: f64| TAU * range * 2.0 * hz / LIGHT;
                    let sum =
                        |part: fn(f64) -> f64| parts[0] * part(angle(near)) + parts[1] * part(angle(far));
                    sum(f64::sin).atan2(sum(f64::cos)) / TAU
                })
                .collect();
            let (expected, off) = unwrapped(&light, &phases);
            let found = f64::from(depth[4 * 64 + column]);
            // 0 Hz has no error; the mean is over the other frequencies.
            let count = light.modulation_hz.iter().filter(|hz| **hz > 0.0).count();
            let off = off * (3.0 / count as f64).sqrt();
            if (off - light.most_off_rad).abs() < 1e-3 {
                continue;
            }
            if off > light.most_off_rad {
                lost += 1;
                assert!(found.is_nan(), "case {case}: {found} of {near} and {far}, off {off}");
            } else {
                flying += usize::from((found - near).abs() > 1e-3 && (found - far).abs() > 1e-3);
                assert!((found - expected).abs() < 1e-3, "case {case}: {found}, not {expected}, off {off}");
            }
        }
    }
    assert!(flying > 20 && lost > 20, "{flying} fly, {lost} are lost");
}

#[test]
fn noisy_phases_miscount_their_turns() {
    let light = TimeOfFlight { most_off_rad: 10.0, ..published::AZURE_LIGHT };
    let squares: f64 = light.modulation_hz.iter().map(|hz| hz * hz).sum();
    for (stddev, range) in [(0.004, 2.3), (0.03, 2.3), (0.04, 2.0)] {
        let noise = AxialNoise { polynomial: [stddev, 0.0, 0.0], ..AxialNoise::NONE };
        let camera = narrow([320, 240]).model(DepthModel::new().window(light).noise(noise));
        let depth = depth_frame(&plane(range, 0.0), camera, Pose::IDENTITY, 0);
        let errors = || depth.iter().map(|depth| f64::from(*depth) - range);
        // Half a turn of the highest frequency is 0.28 m.
        let is_right = |error: &f64| error.abs() < 0.25;
        let wrong = errors().filter(|error| !is_right(error)).count() as f64 / depth.len() as f64;
        // The standard deviation is the requested one. If some pixels miscount, it is slightly smaller for the others.
        let share = if wrong > 0.0 { 0.1 } else { 0.02 };
        assert_near(rms(errors().filter(is_right)), stddev, share);

        // The same search with other random numbers.
        let turns = stddev * 2.0 * squares.sqrt() / LIGHT;
        let tries = 1000;
        let expected = (0..tries)
            .filter(|index| {
                let normal = |number: u32| {
                    let pair =
                        [0, 1].map(|half| random(1_000_000 + 8 * index + 2 * number + half, [0.0, 1.0]));
                    (-2.0 * pair[0].ln()).sqrt() * (TAU * pair[1]).cos()
                };
                let phases: Vec<f64> = (light.modulation_hz.iter().zip(0..))
                    .map(|(hz, number)| range * 2.0 * hz / LIGHT + turns * normal(number))
                    .collect();
                !is_right(&(unwrapped(&light, &phases).0 - range))
            })
            .count() as f64
            / f64::from(tries);
        assert!(
            (wrong - expected).abs() < scatter(expected, tries as usize) + 2e-3,
            "{wrong}, not {expected}"
        );
        assert!(wrong < 1e-9 || stddev > 0.02);
    }
    // Pixels whose phases do not agree have no depth, so few miscounted ones remain.
    let strict = TimeOfFlight { most_off_rad: 0.4, ..light };
    let noise = AxialNoise { polynomial: [0.03, 0.0, 0.0], ..AxialNoise::NONE };
    let [loose, strict] = [light, strict].map(|light| {
        let camera = narrow([320, 240]).model(DepthModel::new().window(light).noise(noise));
        let depth = depth_frame(&plane(2.3, 0.0), camera, Pose::IDENTITY, 0);
        let wrong = depth.iter().filter(|depth| (**depth - 2.3).abs() > 0.25).count();
        (wrong, depth.iter().filter(|depth| depth.is_nan()).count())
    });
    assert!(loose.1 == 0 && strict.1 > 0 && strict.0 * 3 < loose.0, "{loose:?}, {strict:?}");
}
