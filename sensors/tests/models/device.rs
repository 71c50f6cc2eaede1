//! The device behind the lens, tested from outside: flat fields and dark frames against closed forms. Seeds are fixed.

use crate::common;

use crate::common::{add, camera_of, glowing, picture_with};
use belvedere_sensors::camera::{Camera, CameraConfig, Mosaic, Picture, PixelFormat};
use belvedere_sensors::device::{
    AutoExposure, AutoExposureConfig, DeviceConfig, Exposure, Metering, Tone, Vignetting, presets,
};
use belvedere_sensors::scene::{SceneBuilder, Shape};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Execution, Pose, Sensor, Slice};
use glam::DVec3;

const SIZE: [u32; 2] = [320, 240];

/// A wall of this colour that fills the picture.
fn wall(colour: [f32; 3]) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let colour = glowing(&mut builder, colour);
    let shape = Shape::Box { size: [1.0, 100.0, 100.0] };
    add(&mut builder, shape, Pose::from_translation(DVec3::X * 2.5), colour);
    builder
}

/// A device that counts electrons: one DN per electron, 16 bits, and only shot noise.
fn counter() -> DeviceConfig {
    DeviceConfig::default().bits(16).dn_per_electron(1.0).full_well_e(65_000.0)
}

/// The device with an exposure that gives this number of electrons for a colour of 1.
fn exposed(device: DeviceConfig, electrons: f64) -> DeviceConfig {
    let Exposure { time_s, gain } = device.exposure;
    let time_s = time_s * electrons / device.electrons_of_white()[0];
    device.exposure(Exposure { time_s, gain })
}

fn config(device: DeviceConfig) -> CameraConfig<'static> {
    camera_of(SIZE, 0.9).format(PixelFormat::Mono16).device(Some(device))
}

/// The values of a picture of a white wall.
fn white(device: DeviceConfig, frame: u64) -> Vec<f64> {
    levels(&picture_with(&wall([1.0; 3]), config(device), Pose::IDENTITY, frame, Execution::default()))
}

fn levels(pixels: &[u8]) -> Vec<f64> {
    pixels.as_chunks::<2>().0.iter().map(|level| f64::from(u16::from_le_bytes(*level))).collect()
}

fn mean(samples: &[f64]) -> f64 {
    samples.iter().sum::<f64>() / samples.len() as f64
}

/// Half the variance of the difference of two frames: temporal noise without fixed patterns.
fn temporal_variance(a: &[f64], b: &[f64]) -> f64 {
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    let mean = mean(&differences);
    differences.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (2.0 * differences.len() as f64)
}

/// The covariance of two frames: the variance of fixed patterns.
fn covariance(a: &[f64], b: &[f64]) -> f64 {
    let (mean_a, mean_b) = (mean(a), mean(b));
    a.iter().zip(b).map(|(a, b)| (a - mean_a) * (b - mean_b)).sum::<f64>() / a.len() as f64
}

#[test]
fn electrons_are_poisson_s() {
    for electrons in [0.05, 0.7, 3.0, 7.9, 8.1, 12.0, 15.9, 16.1, 40.0, 900.0, 30_000.0] {
        let counts: Vec<f64> = (0..2).flat_map(|frame| white(exposed(counter(), electrons), frame)).collect();
        let n = counts.len() as f64;
        let moment = |power| counts.iter().map(|count| (count - electrons).powi(power)).sum::<f64>() / n;
        // The standard deviations of the estimates follow from Poisson's fourth and sixth moments.
        let (m, limit) = (electrons, 4.5);
        assert!(moment(1).abs() < limit * (m / n).sqrt(), "mean {} of {m}", m + moment(1));
        let spread = ((m + 2.0 * m * m) / n).sqrt();
        assert!((moment(2) - m).abs() < limit * spread + 1e-3 * m, "variance {} of {m}", moment(2));
        let spread = ((m + 25.0 * m * m + 15.0 * m.powi(3) - m * m) / n).sqrt();
        assert!((moment(3) - m).abs() < limit * spread, "third moment {} of {m}", moment(3));
    }
}

/// The probability of less than k by Giles's second order, ⌊m + w·√m + ⅓ + w²/6 − (2w + w³)/(72·√m)⌋ for a normal w.
fn giles(m: f64, k: u32) -> f64 {
    let count =
        |w: f64| m + w * m.sqrt() + 1.0 / 3.0 + w * w / 6.0 - (2.0 * w + w.powi(3)) / (72.0 * m.sqrt());
    let (mut low, mut high) = (-6.0, 6.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *(if count(middle) < f64::from(k) { &mut low } else { &mut high }) = middle;
    }
    0.5 * libm::erfc(-low / core::f64::consts::SQRT_2)
}

#[test]
fn counts_have_the_probabilities_of_poisson_s() {
    // Sampled by inversion below a mean of sixteen, and by Giles's second order above: the total variation is at most
    // 3e-4.
    let means = [(0.4, 0.0), (3.0, 0.0), (7.5, 0.0), (8.1, 0.0), (12.0, 0.0), (15.9, 0.0), (16.1, 3e-4)];
    for (electrons, error) in means {
        let counts: Vec<f64> = (0..4).flat_map(|frame| white(exposed(counter(), electrons), frame)).collect();
        let n = counts.len() as f64;
        let (mut chi_squared, mut cells, mut variation) = (0.0, 0.0, 0.0);
        for k in 0..60 {
            let exact =
                libm::exp(f64::from(k) * libm::log(electrons) - electrons - libm::lgamma(f64::from(k + 1)));
            let p = if error == 0.0 { exact } else { giles(electrons, k + 1) - giles(electrons, k) };
            variation += 0.5 * (p - exact).abs();
            if p * n < 20.0 {
                continue;
            }
            let found = counts.iter().filter(|count| **count == f64::from(k)).count() as f64;
            chi_squared += (found - p * n).powi(2) / (p * n);
            cells += 1.0;
        }
        assert!(variation <= error, "a total variation of {variation} at {electrons}");
        assert!(
            chi_squared < cells + 4.5 * (2.0_f64 * cells).sqrt(),
            "{chi_squared} of {cells} at {electrons}"
        );
    }
}

#[test]
fn no_pixel_has_a_negative_count() {
    const BLACK: f64 = 100.0;
    for electrons in [8.1, 9.0, 10.0, 12.0, 16.1] {
        let device = exposed(counter().black_level_dn(BLACK), electrons);
        let counts: Vec<f64> = (0..12).flat_map(|frame| white(device, frame)).collect();
        let least = counts.iter().fold(f64::INFINITY, |least, level| least.min(*level));
        assert!(least >= BLACK, "{least} DN of {electrons} electrons above a black level of {BLACK}");
        // None, one and two electrons have their Poisson frequencies.
        let n = counts.len() as f64;
        let mut p = libm::exp(-electrons);
        for k in 0..3 {
            let found = counts.iter().filter(|level| **level == BLACK + f64::from(k)).count() as f64;
            let expected = n * p;
            let off = (found - expected).abs();
            assert!(off < 4.0 * expected.sqrt() + 1.0, "{found} of {k} at {electrons}, not {expected}");
            p *= electrons / f64::from(k + 1);
        }
    }
}

#[test]
fn the_photon_transfer_line() {
    let device = DeviceConfig::default()
        .dn_per_electron(0.4)
        .gain_of(1.5)
        .full_well_e(6000.0)
        .read_noise_e(4.0)
        .converter_noise_dn(1.2)
        .black_level_dn(100.0)
        .dark_current_e_per_s(50.0)
        .prnu(0.02)
        .dsnu_e(3.0);
    let k = 0.4 * 1.5;
    let dark_variance = k * k * 16.0 + 1.2 * 1.2 + 1.0 / 12.0;
    for electrons in [0.0, 5.0, 200.0, 4000.0] {
        let device = exposed(device, electrons);
        let (a, b) = (white(device, 0), white(device, 1));
        let collected = electrons + 50.0 * device.exposure.time_s;
        let expected = k * collected + 100.0;
        // The pattern's own mean has an uncertainty that depends on the number of pixels.
        let spread = (k * k * (collected + 16.0 + 9.0 + (0.02 * electrons).powi(2)) / a.len() as f64).sqrt();
        assert!((mean(&a) - expected).abs() < 4.5 * spread + 1e-3, "{} DN, not {expected}", mean(&a));
        let variance = dark_variance + k * k * collected;
        let found = temporal_variance(&a, &b);
        assert!((found / variance - 1.0).abs() < 0.025, "{found}, not {variance} at {electrons}");
        let pattern = k * k * (9.0 + (0.02 * electrons).powi(2));
        let uncertain = 4.5 * (pattern + variance) / (a.len() as f64).sqrt();
        assert!((covariance(&a, &b) - pattern).abs() < uncertain, "{} of {pattern}", covariance(&a, &b));
    }
}

/// Gives the gain in a chain of calls, which reads better.
trait Gain {
    fn gain_of(self, gain: f64) -> Self;
}

impl Gain for DeviceConfig {
    fn gain_of(self, gain: f64) -> Self {
        let time_s = self.exposure.time_s;
        self.exposure(Exposure { time_s, gain })
    }
}

#[test]
fn wells_and_converters_saturate() {
    let device = exposed(DeviceConfig::default().dn_per_electron(0.2).black_level_dn(40.0), 1e5);
    let all = |device, level: f64| assert!(white(device, 0).iter().all(|found| *found == level), "{level}");
    all(device, 0.2 * 16_000.0 + 40.0);
    all(device.gain_of(2.0), 4095.0);
    // Without light, the output is the black level, at any number of bits.
    for bits in [8, 10, 12, 14, 16] {
        all(device.exposure(Exposure { time_s: 0.0, gain: 1.0 }).bits(bits), 40.0);
        all(device.gain_of(1e4).bits(bits), f64::from((1_u32 << bits) - 1));
    }
}

#[test]
fn read_noise_is_added_to_the_charge_of_the_well() {
    const WELL: f64 = 4000.0;
    const BLACK: f64 = 100.0;
    // Read noise that is drawn together with shot noise, and separately.
    for (read, k) in [(4.0, 2.0), (0.3, 10.0)] {
        let device = counter().dn_per_electron(k).full_well_e(WELL).black_level_dn(BLACK).read_noise_e(read);
        let of_reading = (k * read).powi(2) + 1.0 / 12.0;
        let frames = |electrons| [0, 1].map(|frame| white(exposed(device, electrons), frame));
        // Far above the full well, every pixel is full, and only read noise remains.
        let [a, b] = frames(1e5);
        let (found, n) = (temporal_variance(&a, &b), a.len() as f64);
        assert!((found / of_reading - 1.0).abs() < 0.03, "a variance of {found} DN² of {read} electrons");
        assert!((mean(&a) - (k * WELL + BLACK)).abs() < 4.5 * (of_reading / n).sqrt());
        // If half of the pixels are full, the variance of the charge is ½ − 1/(2π) of Poisson's.
        let [a, b] = frames(WELL);
        let found = temporal_variance(&a, &b);
        let expected = of_reading + k * k * WELL * (0.5 - 0.5 / core::f64::consts::PI);
        assert!((found / expected - 1.0).abs() < 0.05, "a variance of {found} DN², not {expected}");
    }
}

#[test]
fn fixed_patterns_depend_on_the_sensor() {
    let device = DeviceConfig::default().dsnu_e(20.0).dn_per_electron(1.0).black_level_dn(1000.0);
    let dark = device.exposure(Exposure { time_s: 0.0, gain: 1.0 });
    let picture = |config: CameraConfig<'static>, frame| {
        levels(&picture_with(&wall([1.0; 3]), config, Pose::IDENTITY, frame, Execution::default()))
    };
    let pattern = picture(config(dark), 0);
    assert_eq!(pattern, picture(config(dark), 1), "the same in every frame");
    let n = pattern.len() as f64;
    assert!((mean(&pattern) - 1000.0).abs() < 4.5 * 20.0 / n.sqrt());
    assert!((covariance(&pattern, &pattern) / (400.0 + 1.0 / 12.0) - 1.0).abs() < 4.5 * (2.0 / n).sqrt());
    for other in [config(dark).sensor(1), config(dark).seed(2)] {
        assert!(covariance(&pattern, &picture(other, 0)).abs() < 4.5 * 400.0 / n.sqrt());
    }
    let neighbours = covariance(&pattern[1..], &pattern[..pattern.len() - 1]);
    assert!(neighbours.abs() < 4.5 * 400.0 / n.sqrt());
}

#[test]
fn patterns_are_the_same_under_a_rolling_shutter() {
    let device = DeviceConfig::default().dsnu_e(20.0).dn_per_electron(1.0).black_level_dn(1000.0);
    let dark = device.exposure(Exposure { time_s: 0.0, gain: 1.0 });
    // Not a multiple of a tile's size.
    let config = camera_of([75, 30], 0.9).format(PixelFormat::Bayer16(Mosaic::Grbg)).device(Some(dark));
    let camera = Camera::new(config).unwrap();
    let builder = wall([1.0; 3]);
    let (scene, moment) = (builder.scene(), builder.moment(Pose::IDENTITY));
    let slices: Vec<Slice<'_>> = (0..30).map(|line| Slice { lines: line..line + 1, at: moment }).collect();
    let take = |capture: Capture<'_>| {
        let mut pixels = vec![0; camera.frame_len()];
        let mut memory = WorkspaceBuf::default();
        camera.sense_in(&mut memory, &scene, &capture, Picture::new().colour(&mut pixels)).unwrap();
        pixels
    };
    assert_eq!(take(Capture::new(0, moment)), take(Capture::new(1, slices.as_slice())));
}

#[test]
fn vignetting_follows_its_formula() {
    let vignetting = Vignetting { natural: true, polynomial: [-0.3, 0.2, 0.1] };
    let device = exposed(counter(), 30_000.0).vignetting(vignetting);
    let found = white(device, 0);
    let focal = f64::from(SIZE[0]) / 2.0 / (0.45_f64).tan();
    let (width, height) = (SIZE[0] as usize, SIZE[1] as usize);
    // Means over squares of 20 × 20.
    for (top, left) in (0..height).step_by(20).flat_map(|y| (0..width).step_by(20).map(move |x| (y, x))) {
        let (mut sum, mut expected) = (0.0, 0.0);
        for (y, x) in (top..top + 20).flat_map(|y| (left..left + 20).map(move |x| (y, x))) {
            let radius = ((x as f64 - 159.5).hypot(y as f64 - 119.5) / focal).atan();
            sum += found[y * width + x];
            expected += 30_000.0 * vignetting.at(radius);
        }
        assert!((sum - expected).abs() < 5.0 * expected.sqrt(), "{} at {left}, {top}", sum / expected);
    }
}

#[test]
fn all_formats_show_the_same_colours() {
    let mut builder = SceneBuilder::new();
    common::scenery(&mut builder);
    let pose = Pose::from_xyz_rpy(DVec3::new(-3.2, 0.3, 1.4), DVec3::new(0.1, 0.2, -0.05));
    let take = |format| {
        let camera = camera_of([333, 245], 1.2).format(format);
        (camera, picture_with(&builder, camera, pose, 0, Execution::default()))
    };
    let (_, rgb) = take(PixelFormat::Rgb8);
    let rgb = rgb.as_chunks::<3>().0;
    let (_, rgba) = take(PixelFormat::Rgba8);
    assert!(
        rgba.as_chunks::<4>().0.iter().zip(rgb).all(|([r, g, b, a], rgb)| [*r, *g, *b] == *rgb && *a == 255)
    );
    for mosaic in Mosaic::ALL {
        let expected: Vec<u8> =
            rgb.iter().enumerate().map(|(i, pixel)| pixel[mosaic.channel(i % 333, i / 333)]).collect();
        let (camera, bytes) = take(PixelFormat::Bayer8(mosaic));
        assert_eq!(Camera::new(camera).unwrap().row_stride(), 333);
        assert!(bytes == expected, "{mosaic:?}");
        let (_, words) = take(PixelFormat::Bayer16(mosaic));
        assert!(
            levels(&words)
                .iter()
                .zip(expected)
                .all(|(word, byte)| (word / 257.0 - f64::from(byte)).abs() <= 0.502)
        );
    }
    let (_, mono) = take(PixelFormat::Mono16);
    for (word, [r, g, b]) in levels(&mono).iter().zip(rgb) {
        // Brightness is computed before values are clamped.
        if [r, g, b].contains(&&255) {
            continue;
        }
        let grey = 0.299 * f64::from(*r) + 0.587 * f64::from(*g) + 0.114 * f64::from(*b);
        assert!((word / 257.0 - grey).abs() < 0.51);
    }
}

#[test]
fn mosaics_read_one_colour_a_pixel() {
    let device = exposed(DeviceConfig::default().bits(8).dn_per_electron(0.01), 10_000.0);
    let device = device.quantum_efficiency([0.25, 0.5, 0.125]);
    let camera = config(device).format(PixelFormat::Bayer8(Mosaic::Bggr));
    let pixels = picture_with(&wall([1.0, 0.5, 1.0]), camera, Pose::IDENTITY, 0, Execution::default());
    let sums = pixels.iter().enumerate().fold([[0.0; 2]; 3], |mut sums, (i, pixel)| {
        let sum = &mut sums[Mosaic::Bggr.channel(i % 320, i / 320)];
        *sum = [sum[0] + f64::from(*pixel), sum[1] + 1.0];
        sums
    });
    for ([sum, count], expected) in sums.into_iter().zip([50.0, 50.0, 25.0]) {
        assert!((sum / count - expected).abs() < 0.05, "{} of {expected}", sum / count);
    }
    assert_eq!(sums[1][1], 2.0 * sums[0][1]);
}

#[test]
fn noise_comes_before_the_curve() {
    let device = exposed(DeviceConfig::default().read_noise_e(20.0).black_level_dn(200.0), 3000.0);
    let camera = |tone| config(device.tone(tone));
    let picture =
        |camera| levels(&picture_with(&wall([1.0; 3]), camera, Pose::IDENTITY, 0, Execution::default()));
    let raw = picture(camera(Tone::Raw));
    let curved = picture(camera(Tone::Srgb { white_balance: [1.5; 3] }));
    for (raw, curved) in raw.iter().zip(curved) {
        let linear = (raw - 200.0) / (4095.0 - 200.0) * 1.5;
        assert_eq!(
            curved,
            f64::from((belvedere_sensors::srgb::encode(linear as f32) * 4095.0 + 0.5).floor()),
            "of {raw}"
        );
    }
}

#[test]
fn eight_bit_formats_scale_a_finer_converter() {
    let device = exposed(DeviceConfig::default(), 8000.0);
    let fine = white(device, 3);
    let bytes = config(device).format(PixelFormat::Mono8);
    let bytes = picture_with(&wall([1.0; 3]), bytes, Pose::IDENTITY, 3, Execution::default());
    for (byte, level) in bytes.into_iter().zip(fine) {
        assert_eq!(f64::from(byte), (level * 255.0 / 4095.0).round());
    }
}

#[test]
fn parameters_out_of_range_are_named() {
    let refused = |device| Camera::new(config(device)).unwrap_err().to_string();
    let device = DeviceConfig::default;
    assert_eq!(refused(device().prnu(1.5)), "prnu of the device is 1.5; it must be from 0 to 1");
    assert_eq!(refused(device().bits(7)), "bits of the device is 7; it must be from 8 to 16");
    assert_eq!(refused(device().bits(40)), "bits of the device is 40; it must be from 8 to 16");
    let message = refused(device().exposure(Exposure { time_s: f64::NAN, gain: 1.0 }));
    assert_eq!(message, "exposure.time_s of the device is NaN; it must be from 0 to 3600");
    let message = refused(device().black_level_dn(4095.0));
    assert_eq!(message, "black_level_dn of the device is 4095; it must be from 0 to 4094");
    let mut camera = Camera::new(config(device())).unwrap();
    assert!(camera.set_device_exposure(Exposure { time_s: -1.0, gain: 1.0 }).is_err());
    assert_eq!(camera.config().device, Some(device()));
}

/// Exposures and means of frames of the scenery in light of this brightness, and the last picture.
fn expose_automatically(
    light: f32,
    (device, format): (DeviceConfig, PixelFormat),
    metering: Metering,
) -> (Vec<(Exposure, f64)>, Vec<u8>) {
    let mut builder = SceneBuilder::new();
    common::scenery(&mut builder);
    let pose = Pose::from_xyz_rpy(DVec3::new(-3.2, 0.3, 1.4), DVec3::new(0.1, 0.2, -0.05));
    let limits = AutoExposureConfig::default().time_range_s([1e-7, 4.0]).most_gain(64.0).tolerance(0.02);
    let mut automatic = AutoExposure::new(limits, device.exposure).unwrap();
    let (mut frames, mut picture) = (Vec::new(), Vec::new());
    for frame in 0..14 {
        let device = device.exposure(automatic.exposure());
        let config = camera_of([160, 120], 1.0).format(format).device(Some(device)).exposure(light);
        picture = picture_with(&builder, config, pose, frame, Execution::default());
        let seen = Camera::new(config).unwrap().meter(&picture, metering).unwrap();
        frames.push((automatic.exposure(), seen.mean));
        automatic.next(&seen);
    }
    (frames, picture)
}

#[test]
fn exposure_settles_within_ten_frames() {
    let bayer = (presets::machine_vision(), PixelFormat::Bayer16(Mosaic::Rggb));
    let curved = (presets::raspberry_pi_hq(), PixelFormat::Rgb8);
    let webcam = (presets::webcam(), PixelFormat::Mono8);
    for (device, metering) in [(bayer, Metering::Mean), (curved, Metering::Centre), (webcam, Metering::Mean)]
    {
        for light in [1e-3, 0.03, 1.0, 40.0, 1e3] {
            let (frames, picture) = expose_automatically(light, device, metering);
            for (exposure, mean) in &frames[9..] {
                assert_eq!(*exposure, frames[9].0, "settled in a light of {light}");
                assert!((mean / 0.18 - 1.0).abs() < 0.03, "{mean} in a light of {light}");
            }
            // A second run gives the same bits.
            assert!((frames, picture) == expose_automatically(light, device, metering));
        }
    }
}

#[test]
fn a_flat_field_is_metered_exactly() {
    for metering in [Metering::Mean, Metering::Centre] {
        for format in [PixelFormat::Mono16, PixelFormat::Rgb8, PixelFormat::Bayer8(Mosaic::Gbrg)] {
            let device = exposed(DeviceConfig::default().black_level_dn(64.0), 4000.0);
            let camera = config(device).format(format);
            let picture = picture_with(&wall([1.0; 3]), camera, Pose::IDENTITY, 0, Execution::default());
            let seen = Camera::new(camera).unwrap().meter(&picture, metering).unwrap();
            assert!((seen.mean - 0.25).abs() < 0.002 && seen.saturated == 0.0, "{seen:?}");
            assert!(Camera::new(camera).unwrap().meter(&picture[1..], metering).is_err());
        }
    }
}
