//! The noise of whole frames has the configured distribution. Seeds are fixed, so the results do not depend on chance;
//! a correct sampler fails one of the limits once in thousands of seeds.

use crate::common;

use crate::common::{LIDAR, add, camera, depth_camera, depth_frame, glowing, picture_with, scan_frame};
use belvedere_sensors::Pose;
use belvedere_sensors::camera::PixelFormat;
use belvedere_sensors::lidar::{Beams, LidarConfig};
use belvedere_sensors::noise::{GaussianNoise, GaussianNoiseConfig};
use belvedere_sensors::scene::{SceneBuilder, Shape};
use core::f64::consts::{PI, SQRT_2};
use glam::DVec3;

fn gaussian(mean: f32, stddev: f32) -> GaussianNoise {
    GaussianNoise::new(GaussianNoiseConfig::default().mean(mean).stddev(stddev)).unwrap()
}

fn mean_and_stddev(samples: &[f64]) -> (f64, f64) {
    let mean = samples.iter().sum::<f64>() / samples.len() as f64;
    let variance = samples.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (samples.len() - 1) as f64;
    (mean, variance.sqrt())
}

/// Kolmogorov and Smirnov's distance to the normal distribution, times √n: above 1.95 once in a thousand times.
fn kolmogorov_smirnov(samples: &mut [f64], mean: f64, stddev: f64) -> f64 {
    samples.sort_unstable_by(f64::total_cmp);
    let n = samples.len() as f64;
    let farthest = samples.iter().enumerate().fold(0.0_f64, |farthest, (index, x)| {
        let below = 0.5 * libm::erfc((mean - x) / (stddev * SQRT_2));
        farthest.max(below - index as f64 / n).max((index + 1) as f64 / n - below)
    });
    farthest * n.sqrt()
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let ((mean_a, stddev_a), (mean_b, stddev_b)) = (mean_and_stddev(a), mean_and_stddev(b));
    let products = a.iter().zip(b).map(|(a, b)| (a - mean_a) * (b - mean_b));
    products.sum::<f64>() / (a.len() as f64 * stddev_a * stddev_b)
}

/// The inside of a ball of 5 m: every range is 5 m.
fn ball() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    common::add_grey(&mut builder, Shape::Sphere { radius: 5.0 }, Pose::IDENTITY);
    builder
}

/// A lidar with 250 000 beams.
fn lidar(noise: GaussianNoise, sensor: u32) -> LidarConfig {
    LIDAR
        .horizontal(Beams { samples: 1000, min_angle_rad: -PI, max_angle_rad: PI })
        .vertical(Beams { samples: 250, min_angle_rad: -1.0, max_angle_rad: 1.0 })
        .noise(noise)
        .sensor(sensor)
}

fn range_errors(noise: GaussianNoise, sensor: u32, frame: u64) -> Vec<f64> {
    let (ranges, _) = scan_frame(&ball(), lidar(noise, sensor), Pose::IDENTITY, frame);
    ranges.iter().map(|range| f64::from(*range) - 5.0).collect()
}

/// A wall of this brightness, 2 m in front of the camera.
fn wall(brightness: f32) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let colour = glowing(&mut builder, [brightness; 3]);
    let shape = Shape::Box { size: [1.0, 100.0, 100.0] };
    add(&mut builder, shape, Pose::from_translation(DVec3::X * 2.5), colour);
    builder
}

#[test]
fn ranges_have_the_configured_noise() {
    let mut errors: Vec<f64> =
        (0..5).flat_map(|frame| range_errors(gaussian(0.02, 0.01), 0, frame)).collect();
    let (mean, stddev) = mean_and_stddev(&errors);
    assert!((mean / 0.02 - 1.0).abs() < 0.01 && (stddev / 0.01 - 1.0).abs() < 0.01, "{mean} ± {stddev}");
    let distance = kolmogorov_smirnov(&mut errors, 0.02, 0.01);
    assert!(distance < 1.95, "KS distance {distance}");
}

#[test]
fn depths_have_the_configured_noise() {
    let config = depth_camera().model(gaussian(-0.01, 0.005));
    let builder = wall(0.5);
    let mut errors: Vec<f64> = (0..4)
        .flat_map(|frame| depth_frame(&builder, config, Pose::IDENTITY, frame))
        .map(|depth| f64::from(depth) - 2.0)
        .collect();
    let (mean, stddev) = mean_and_stddev(&errors);
    assert!((mean / -0.01 - 1.0).abs() < 0.01 && (stddev / 0.005 - 1.0).abs() < 0.01, "{mean} ± {stddev}");
    let distance = kolmogorov_smirnov(&mut errors, -0.01, 0.005);
    assert!(distance < 1.95, "KS distance {distance}");
}

fn grey_levels(brightness: f32, format: PixelFormat, sensor: u32, frame: u64) -> Vec<u8> {
    let config = camera().noise(gaussian(0.0, 0.007)).format(format).sensor(sensor);
    picture_with(&wall(brightness), config, Pose::IDENTITY, frame, belvedere_sensors::Execution::default())
}

#[test]
fn pictures_have_the_configured_noise() {
    let levels: Vec<u8> = (0..4).flat_map(|frame| grey_levels(0.5, PixelFormat::Rgb8, 0, frame)).collect();
    let (pixels, rest) = levels.as_chunks::<3>();
    assert!(rest.is_empty() && pixels.iter().all(|[r, g, b]| r == g && g == b), "one sample for R, G and B");
    let red: Vec<f64> = pixels.iter().map(|[red, _, _]| f64::from(*red)).collect();
    let (mean, stddev) = mean_and_stddev(&red);
    // Rounding to whole levels adds a variance of 1/12.
    let expected = ((0.007_f64 * 255.0).powi(2) + 1.0 / 12.0).sqrt();
    assert!((mean - 127.5).abs() < 0.01 && (stddev / expected - 1.0).abs() < 0.01, "{mean} ± {stddev}");
}

#[test]
fn brightness_is_clamped() {
    // Noise on white keeps only its lower half: the mean is σ·√(1/2π) lower.
    let levels = grey_levels(1.0, PixelFormat::Mono8, 0, 0);
    let mean = levels.iter().map(|level| f64::from(*level)).sum::<f64>() / levels.len() as f64;
    let expected = 255.0 - 0.007 * 255.0 / (2.0 * PI).sqrt();
    assert!((mean - expected).abs() < 0.03, "mean {mean}, not {expected}");
    let levels = grey_levels(0.0, PixelFormat::Mono8, 0, 0);
    assert!(levels.iter().all(|level| *level < 20), "nothing wraps below black");
}

#[test]
fn ranges_are_clamped() {
    let config = lidar(gaussian(0.0, 0.01), 0).range_min_m(4.99).range_max_m(5.005);
    let (ranges, _) = scan_frame(&ball(), config, Pose::IDENTITY, 0);
    assert!(ranges.iter().all(|range| (4.99..=5.005).contains(range)));
    // One sample in 6.3 is beyond −1 σ, one in 3.24 beyond ½ σ.
    let at = |limit: f32| ranges.iter().filter(|range| **range == limit).count() as f64 / ranges.len() as f64;
    assert!((at(4.99) - 0.158_66).abs() < 0.003 && (at(5.005) - 0.308_54).abs() < 0.003);
}

#[test]
fn biases_are_constant_and_differ_between_sensors() {
    let noise = GaussianNoise::new(GaussianNoiseConfig::default().bias_mean(0.2).bias_stddev(0.05)).unwrap();
    let mut biases = Vec::new();
    for sensor in 0..40 {
        let config = lidar(noise, sensor).horizontal(Beams::ONE).vertical(Beams::ONE);
        let range = |frame| f64::from(scan_frame(&ball(), config, Pose::IDENTITY, frame).0[0]) - 5.0;
        assert_eq!(range(0), range(1000), "a bias is drawn once");
        biases.push(range(0));
    }
    let positive = biases.iter().filter(|bias| **bias > 0.0).count();
    assert!((10..=30).contains(&positive), "{positive} of 40 biases are positive");
    let (mean, stddev) = mean_and_stddev(&biases.iter().map(|bias| bias.abs()).collect::<Vec<_>>());
    assert!((mean - 0.2).abs() < 0.03 && (stddev - 0.05).abs() < 0.025, "{mean} ± {stddev}");
}

#[test]
fn frames_sensors_and_neighbours_are_independent() {
    let noise = gaussian(0.0, 0.01);
    let first = range_errors(noise, 0, 0);
    // The standard deviation is 1/√250 000 = 0.002.
    let limit = 0.009;
    for (what, other) in [
        ("the next frame", range_errors(noise, 0, 1)),
        ("another sensor", range_errors(noise, 1, 0)),
        ("a frame of the far future", range_errors(noise, 0, 1 << 33)),
    ] {
        let correlation = correlation(&first, &other);
        assert!(correlation.abs() < limit, "{correlation} to {what}");
    }
    for lag in [1, 4, 16, 64, 1000] {
        let correlation = correlation(&first[lag..], &first[..first.len() - lag]);
        assert!(correlation.abs() < limit, "{correlation} at a lag of {lag}");
    }
    let level = |sensor, frame| -> Vec<f64> {
        grey_levels(0.5, PixelFormat::Mono8, sensor, frame).into_iter().map(f64::from).collect()
    };
    assert!(correlation(&level(0, 0), &level(0, 1)).abs() < limit);
    assert!(correlation(&level(0, 0), &level(1, 0)).abs() < limit);
}

#[test]
fn sensors_draw_from_their_documented_channels() {
    use belvedere_sensors::noise::{Stream, fill_standard_normal};
    use belvedere_sensors::simd::best_level;
    let seed_and_sensor = |channel| Stream { seed: LIDAR.seed, sensor: 5, frame: 3, channel };
    // 64 beams, whose normals are consecutive.
    let beams = Beams { samples: 64, min_angle_rad: -1.0, max_angle_rad: 1.0 };
    let config = lidar(gaussian(0.0, 0.01), 5).horizontal(beams);
    let config = config.vertical(Beams::ONE);
    let (ranges, _) = scan_frame(&ball(), config, Pose::IDENTITY, 3);
    let mut normals = [0.0; 64];
    fill_standard_normal(best_level(), &seed_and_sensor(Stream::RANGE), 0, &mut normals);
    for (range, normal) in ranges.iter().zip(normals) {
        assert!((range - (5.0 + 0.01 * normal)).abs() < 1e-5, "{range}, {normal}");
    }
    // The first tile of a picture.
    let camera = common::camera_of([16, 4], 1.2).sensor(5);
    let noise = gaussian(0.0, 0.01);
    let depths = depth_frame(&wall(0.5), depth_camera().camera(camera).model(noise), Pose::IDENTITY, 3);
    fill_standard_normal(best_level(), &seed_and_sensor(Stream::DEPTH), 0, &mut normals);
    for (depth, normal) in depths.iter().zip(normals) {
        assert!((depth - (2.0 + 0.01 * normal)).abs() < 1e-5, "{depth}, {normal}");
    }
    let camera = camera.noise(gaussian(0.0, 0.05)).format(PixelFormat::Rgb8);
    let pixels = picture_with(&wall(0.5), camera, Pose::IDENTITY, 3, belvedere_sensors::Execution::default());
    fill_standard_normal(best_level(), &seed_and_sensor(Stream::COLOUR), 0, &mut normals);
    for (pixel, normal) in pixels.as_chunks::<3>().0.iter().zip(normals) {
        assert!((f32::from(pixel[0]) - 255.0 * (0.5 + 0.05 * normal)).abs() < 0.51, "{pixel:?}, {normal}");
    }
    // The bias of a noise without any other component.
    let bias =
        GaussianNoise::new(GaussianNoiseConfig::default().bias_stddev(1.0)).unwrap().bias(LIDAR.seed, 5, 0);
    let stream = Stream { frame: 0, ..seed_and_sensor(Stream::BIAS) };
    fill_standard_normal(best_level(), &stream, 0, &mut normals);
    let flipped = Stream { channel: Stream::BIAS_SIGN, ..stream }.word(0) >> 31 == 1;
    assert_eq!(bias, if flipped { -normals[0] } else { normals[0] });
    let numbered = (0..20).chain([64, 65, 66, 67, 68, 69, 70, 71, 72, 73, 0xFFF0, 0xFFF1]);
    assert!(Stream::TAKEN.into_iter().eq(numbered), "{:?}", Stream::TAKEN);
}

#[test]
fn no_precision_makes_a_finite_value_infinite() {
    for (precision, value) in [(1.2e-38, 10.0), (1e-30, -3e9), (0.001, 3e38), (2e38, 3.3e38), (3.0, f32::MAX)]
    {
        let noise = GaussianNoise::new(GaussianNoiseConfig::default().precision(precision)).unwrap();
        let stepped = noise.apply(value, 0.0, 0.0);
        assert!((stepped / value - 1.0).abs() < 1e-6, "{stepped} of {value} by {precision}");
        assert_eq!(noise.apply(f32::NEG_INFINITY, 0.0, 0.0), f32::NEG_INFINITY);
        assert!(noise.apply(f32::NAN, 0.0, 0.0).is_nan());
    }
    // The same in a frame.
    let fine = GaussianNoise::new(GaussianNoiseConfig::default().precision(1.2e-38)).unwrap();
    let camera = depth_camera().camera(common::camera_of([16, 4], 1.2)).model(fine);
    let depths = depth_frame(&wall(0.5), camera, Pose::IDENTITY, 0);
    assert!(depths.iter().all(|depth| (depth - 2.0).abs() < 1e-5), "{depths:?}");
}
