//! Scanners in the centre of balls.

use super::page::{Bound, Page, Row, digits};
use super::plot::{Plot, curve};
use super::sheets::sheet;
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::scanner::presets::Preset;
use belvedere_sensors::scanner::{Echoes, Pattern, Scanner, ScannerConfig};
use belvedere_sensors::scene::{SceneBuilder, Shape};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Pose, Sensor};
use glam::DVec3;

/// The number of ranges from which a standard deviation is computed: its standard error is 0.5 %, a quarter of the
/// bound of 2 %.
const SAMPLES: usize = 20_000;

/// The number of positions of ranges within a rounding step.
const PLACES: u64 = 8;

/// A frame.
struct Taken {
    ranges: Vec<f32>,
    points: Vec<DVec3>,
    lasers: Vec<u32>,
}

fn frame_time_ns(preset: &Preset) -> u64 {
    (1e9 / preset.rate_hz).round() as u64
}

/// A frame from the centre of a ball.
fn take(config: ScannerConfig<'_>, radius: f64, frame: u64) -> Taken {
    let mut ball = SceneBuilder::new();
    super::common::add_grey(&mut ball, Shape::Sphere { radius }, Pose::IDENTITY);
    let scanner = Scanner::new(config).unwrap();
    let (count, most) = (scanner.firings(frame), scanner.most_firings());
    let (mut ranges, mut points, mut lasers) = (vec![0.0; most], vec![[0.0; 3]; most], vec![0; most]);
    let output = Echoes::new().ranges(&mut ranges).points(&mut points).lasers(&mut lasers);
    let (scene, capture) = (ball.scene(), Capture::new(frame, ball.moment(Pose::IDENTITY)));
    let mut memory = WorkspaceBuf::default();
    scanner
        .sense(&scene, &capture, &mut memory.lend(scanner.workspace_len(&scene, &capture)), output)
        .unwrap();
    ranges.truncate(count);
    lasers.truncate(count);
    let points = points[..count].iter().map(|point| DVec3::from(point.map(f64::from))).collect();
    Taken { ranges, points, lasers }
}

fn without_noise(preset: &Preset) -> ScannerConfig<'static> {
    preset.config().noise(GaussianNoise::NONE).spreads(&[])
}

/// The largest or smallest radius of a ball at which there is a range.
fn limit(preset: &Preset, about: f64, is_upper: bool) -> f64 {
    let (mut within, mut beyond) =
        (about * if is_upper { 0.9 } else { 1.2 }, about * if is_upper { 1.1 } else { 0.8 });
    for _ in 0..14 {
        let middle = 0.5 * (within + beyond);
        let found = take(without_noise(preset), middle, 0).ranges;
        let measured = found.iter().filter(|range| range.is_finite()).count();
        *(if 2 * measured > found.len() { &mut within } else { &mut beyond }) = middle;
    }
    0.5 * (within + beyond)
}

/// The standard deviation of measured ranges about their mean.
fn stddev(preset: &Preset, radius: f64) -> f64 {
    let (mut count, mut sum, mut squares, mut frame) = (0, 0.0, 0.0, 0);
    while count < SAMPLES || frame < PLACES {
        let config = preset.config();
        // All positions within a rounding step of the ranges.
        let radius = radius + preset.resolution_m * (frame % PLACES) as f64 / PLACES as f64;
        let exact = take(without_noise(preset), radius, frame).ranges;
        for (range, truth) in take(config, radius, frame).ranges.iter().zip(exact) {
            let error = f64::from(*range) - f64::from(truth);
            if error.is_finite() {
                (count, sum, squares) = (count + 1, sum + error, squares + error * error);
            }
        }
        frame += 1;
    }
    let mean = sum / f64::from(count as u32);
    (squares / f64::from(count as u32) - mean * mean).sqrt()
}

/// The angle in degrees that beams cover, and the angle between successive beams of the first laser.
fn across(directions: &[DVec3], lasers: &[u32]) -> (f64, f64) {
    let degrees = |direction: &DVec3| libm::atan2(direction.y, direction.x).to_degrees();
    let mut all: Vec<f64> = directions.iter().map(degrees).collect();
    all.sort_unstable_by(f64::total_cmp);
    let back = all[0] + 360.0 - all[all.len() - 1];
    let widest = all.windows(2).map(|pair| pair[1] - pair[0]).fold(back, f64::max);
    let of_first: Vec<f64> = directions
        .iter()
        .zip(lasers)
        .filter(|(_, laser)| **laser == 0)
        .map(|(direction, _)| degrees(direction))
        .collect();
    let mut steps: Vec<f64> = of_first
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .map(|step| step.min(360.0 - step))
        .collect();
    steps.sort_unstable_by(f64::total_cmp);
    let step = steps.get(steps.len() / 2).copied().unwrap_or(0.0);
    // A full circle has no gap wider than a step.
    (if widest < 1.5 * step { 360.0 } else { 360.0 - widest }, step)
}

/// The page of a preset.
pub(crate) fn page(preset: &Preset) -> Page {
    let sheet = sheet(preset.name);
    let [least, most] = sheet.range;
    let (near, far) = (
        take(without_noise(preset), least + 0.3 * (most - least), 0),
        take(without_noise(preset), 0.9 * most, 0),
    );
    // Beams may start beside the centre.
    let directions: Vec<DVec3> =
        near.points.iter().zip(&far.points).map(|(near, far)| (*far - *near).normalize()).collect();
    let elevations = || directions.iter().map(|direction| libm::asin(direction.z).to_degrees());
    let (found_across, found_step) = across(&directions, &near.lasers);
    let scanner = Scanner::new(without_noise(preset)).unwrap();
    let firings: usize = (0..20).map(|frame| scanner.firings(frame)).sum();
    let rate = firings as f64 / (20.0 * 1e-9 * frame_time_ns(preset) as f64);
    let lasers = near.lasers.iter().max().map_or(0.0, |laser| f64::from(laser + 1));
    // Rosettes fill their cone over time.
    let is_rosette = matches!(preset.pattern, Pattern::Rosette(_) | Pattern::Prisms(_));
    let across_bound = Bound::Share(if is_rosette { 0.01 } else { 1e-4 });
    let mut rows = vec![
        Row::new("lasers", "", sheet.lasers, lasers, Bound::By(0.0)),
        Row::new("firings a second", "", sheet.firings_per_s, rate, Bound::Share(1e-3)),
        Row::new(
            "lowest beam",
            "°",
            sheet.elevation[0],
            elevations().fold(f64::MAX, f64::min),
            Bound::By(sheet.elevation_bound),
        ),
        Row::new(
            "highest beam",
            "°",
            sheet.elevation[1],
            elevations().fold(f64::MIN, f64::max),
            Bound::By(sheet.elevation_bound),
        ),
        Row::new("field of view across", "°", sheet.across, found_across, across_bound),
    ];
    if let Some(step) = sheet.step {
        rows.push(Row::new(
            "from one beam of a laser to the next",
            "°",
            step,
            found_step,
            Bound::Share(1e-3),
        ));
    }
    // Lasers start some millimetres from the centre.
    rows.push(Row::new("least range", "m", least, limit(preset, least, false), Bound::By(sheet.off_middle)));
    rows.push(Row::new(
        "greatest range",
        "m",
        most,
        limit(preset, most, true),
        Bound::By(sheet.off_middle.max(0.02)),
    ));
    let published = |range: f64| {
        let (stddev, quantum) = ((sheet.stddev)(range), sheet.quantum);
        (stddev * stddev + quantum * quantum / 12.0).sqrt()
    };
    let mut points = Vec::new();
    for share in [0.05, 0.15, 0.3, 0.5, 0.7, 0.9] {
        let range = (share * most).max(1.5 * least);
        let found = stddev(preset, range);
        let what = format!("σ of ranges at {} m", digits(range));
        rows.push(Row::new(what, "mm", published(range) * 1e3, found * 1e3, Bound::Share(0.02)));
        points.push((range, found * 1e3));
    }
    let plot = Plot {
        title: format!("{}: σ of ranges", sheet.device),
        axes: ["range in m", "σ in mm"],
        curve: curve([least, most], |range| published(range) * 1e3),
        points,
        is_logarithmic: false,
    };
    Page {
        name: preset.name,
        source: format!("{}. {}", sheet.device, sheet.source),
        notes: format!(
            "{}{}Rounding to {} mm is a part of σ.",
            sheet.notes,
            if sheet.notes.is_empty() { "" } else { " " },
            digits(sheet.quantum * 1e3)
        ),
        rows,
        plots: vec![plot],
    }
}
