//! Cameras in front of a grey wall, measured by EMVA 1288: variation of frames in time, and from pixel to pixel.

use super::common::{add, camera_of, glowing, picture_with};
use super::page::{Bound, Page, Row};
use super::plot::{Plot, curve};
use belvedere_sensors::camera::PixelFormat;
use belvedere_sensors::device::{DeviceConfig, Exposure, Tone, Vignetting, presets};
use belvedere_sensors::scene::{SceneBuilder, Shape};
use belvedere_sensors::{Execution, Pose};
use glam::DVec3;

/// The published figures of a camera.
pub(crate) struct Sheet {
    pub(crate) device: String,
    source: &'static str,
    /// The gain in DN per electron, and the number of bits.
    gain: f64,
    bits: u32,
    /// The full well in electrons.
    full_well_e: f64,
    /// The noise of dark frames in DN.
    dark_dn: f64,
    /// Fixed patterns: of the dark signal in electrons, and of the response as a fraction.
    patterns: [f64; 2],
}

/// The published figures of a preset.
pub(crate) fn sheet(name: &str) -> Sheet {
    match name {
        "machine_vision" => Sheet {
            device: "Sony IMX900, FRAMOS".into(),
            source: "EMVA 1288 report of the IMX900-AMR-C at 536 nm: K 0.399 DN/e⁻, dark noise 5.56 e⁻, full well 9458 e⁻, \
                     DSNU 3.7 e⁻, PRNU 0.7 %",
            gain: 0.399,
            bits: 12,
            full_well_e: 9458.0,
            dark_dn: 5.56 * 0.399,
            patterns: [3.7, 0.007],
        },
        "raspberry_pi_hq" => Sheet {
            device: "Sony IMX477, Raspberry Pi HQ".into(),
            source: "\"Pi HQ Cam Sensor Performance\" (strollswithmydog.com, 2020): K 0.47 DN/e⁻, clipping at 8180 e⁻, 1.53 DN in \
                     the dark; PRNU is assumed",
            gain: 0.47,
            bits: 12,
            full_well_e: 8180.0,
            dark_dn: (1.53_f64 * 1.53 - 1.0 / 12.0).sqrt(),
            patterns: [0.0, 0.005],
        },
        "webcam" => Sheet {
            device: "OmniVision OV5647 behind USB".into(),
            source: "User guide of OptArc's AF51: full well 4.3 ke⁻, dynamic range 68 dB, fixed patterns below 1 %; bits and \
                     gain are assumed",
            gain: 1007.0 / 4300.0,
            bits: 10,
            full_well_e: 4300.0,
            dark_dn: 4300.0 / libm::pow(10.0, 68.0 / 20.0) * 1007.0 / 4300.0,
            patterns: [0.0, 0.01],
        },
        _ => panic!("{name} has no report"),
    }
}

/// The raw values of a frame of a white wall that gives a pixel this number of electrons.
fn levels(preset: DeviceConfig, electrons: f64, frame: u64) -> Vec<f64> {
    let green = preset.quantum_efficiency[1];
    let device = preset.tone(Tone::Raw).vignetting(Vignetting::NONE).quantum_efficiency([green; 3]);
    let time_s = device.exposure.time_s * electrons / device.electrons_of_white()[0];
    let device = device.exposure(Exposure { time_s, gain: 1.0 });
    let mut wall = SceneBuilder::new();
    let colour = glowing(&mut wall, [1.0; 3]);
    add(&mut wall, Shape::Box { size: [1.0, 100.0, 100.0] }, Pose::from_translation(DVec3::X * 2.5), colour);
    let config = camera_of([320, 240], 0.9).format(PixelFormat::Mono16).device(Some(device));
    let pixels = picture_with(&wall, config, Pose::IDENTITY, frame, Execution::default());
    pixels.as_chunks::<2>().0.iter().map(|level| f64::from(u16::from_le_bytes(*level))).collect()
}

/// The mean, the temporal variance, and the variance from pixel to pixel, of two frames.
fn moments(device: DeviceConfig, electrons: f64) -> [f64; 3] {
    let [a, b] = [0, 1].map(|frame| levels(device, electrons, frame));
    let count = a.len() as f64;
    let mean = a.iter().chain(&b).sum::<f64>() / (2.0 * count);
    let in_time = a.iter().zip(&b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / (2.0 * count);
    let pattern = a.iter().zip(&b).map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>() / count;
    [mean, in_time, pattern]
}

/// The page of a preset.
pub(crate) fn page(name: &'static str) -> Page {
    let sheet = sheet(name);
    let device = presets::named(name).unwrap().config();
    let [dark, dark_variance, dark_pattern] = moments(device, 0.0);
    let half = moments(device, 0.5 * sheet.full_well_e);
    let gain = (half[1] - dark_variance) / (half[0] - dark);
    let [published_dsnu, published_prnu] = sheet.patterns;
    let two = Bound::Share(0.02);
    let quantised = rounded_stddev(device.black_level_dn, sheet.dark_dn);
    let mut rows = vec![
        Row::new("gain by the photon transfer", "DN/e⁻", sheet.gain, gain, two),
        Row::new("noise in the dark, with rounding", "DN", quantised, dark_variance.sqrt(), two),
    ];
    if published_dsnu > 0.0 {
        rows.push(Row::new("DSNU", "e⁻", published_dsnu, dark_pattern.sqrt() / sheet.gain, two));
    }
    let prnu = (half[2] - dark_pattern).sqrt() / (half[0] - dark);
    rows.push(Row::new("PRNU", "%", 100.0 * published_prnu, 100.0 * prnu, Bound::Share(0.03)));
    let published = |electrons: f64| {
        // Shot noise spreads the levels over the steps of the converter.
        let noise_e = (sheet.dark_dn * sheet.dark_dn + 1.0 / 12.0).sqrt() / sheet.gain;
        20.0 * libm::log10(electrons / (noise_e * noise_e + electrons).sqrt())
    };
    let mut points = Vec::new();
    for share in [1e-3, 1e-2, 0.1, 0.3, 0.9] {
        let electrons = share * sheet.full_well_e;
        let [mean, variance, _] = moments(device, electrons);
        let found = 20.0 * libm::log10((mean - dark) / variance.sqrt());
        let what = format!("signal to noise of {electrons:.0} e⁻");
        rows.push(Row::new(what, "dB", published(electrons), found, Bound::By(0.2)));
        points.push((electrons, found));
    }
    let decades = curve([0.0, libm::log10(sheet.full_well_e)], |decades| decades);
    let plot = Plot {
        title: format!("{}: signal to noise in time", sheet.device),
        axes: ["electrons", "signal to noise"],
        curve: decades
            .iter()
            .map(|(decades, _)| libm::pow(10.0, *decades))
            .map(|e| (e, ratio(published(e))))
            .collect(),
        points: points.into_iter().map(|(electrons, decibels)| (electrons, ratio(decibels))).collect(),
        is_logarithmic: true,
    };
    let notes = format!(
        "Raw numbers of {} bits, all pixels as the green ones, without the lens's vignetting.",
        sheet.bits
    );
    Page { name, source: format!("{}. {}", sheet.device, sheet.source), notes, rows, plots: vec![plot] }
}

/// The standard deviation of a normal number that is rounded to integers.
fn rounded_stddev(mean: f64, stddev: f64) -> f64 {
    let below = |limit: f64| 0.5 * libm::erfc((mean - limit) / (stddev * core::f64::consts::SQRT_2));
    let levels = || (-40..=40).map(|step| mean.round() + f64::from(step));
    let moment =
        |power| levels().map(|x| (x - mean).powi(power) * (below(x + 0.5) - below(x - 0.5))).sum::<f64>();
    (moment(2) - moment(1) * moment(1)).sqrt()
}

/// The ratio for a number of decibels.
fn ratio(decibels: f64) -> f64 {
    libm::pow(10.0, decibels / 20.0)
}
