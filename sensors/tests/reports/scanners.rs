//! Scanners, from the middle of balls.

use super::page::{Bound, Page, Row, digits};
use super::plot::{Plot, curve};
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::scanner::presets::Preset;
use belvedere_sensors::scanner::{Echoes, Scanner, ScannerConfig};
use belvedere_sensors::scene::{SceneBuilder, Shape};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Pose, Sensor};
use glam::DVec3;

/// Ranges of which a standard deviation is worked out: of as many it is within 2 % four times out of five standard errors.
const SAMPLES: usize = 20_000;

/// Places between two steps that ranges lie at.
const PLACES: u64 = 8;

/// What is published of a scanner, in degrees, metres and seconds.
pub(crate) struct Sheet {
    name: &'static str,
    pub(crate) device: String,
    source: &'static str,
    notes: &'static str,
    lasers: f64,
    /// Lowest and highest laser.
    elevation: [f64; 2],
    /// How far a unit may be from that.
    elevation_bound: f64,
    /// How far from the middle its beams start at the most.
    off_middle: f64,
    /// Field of view across, and from one firing of a laser to the next if it turns.
    across: f64,
    step: Option<f64>,
    firings_per_s: f64,
    range: [f64; 2],
    /// Standard deviation at a range.
    stddev: fn(f64) -> f64,
    /// What ranges are whole multiples of.
    quantum: f64,
}

/// The published figures of a preset.
pub(crate) fn sheet(name: &str) -> Sheet {
    sheets()
        .into_iter()
        .chain(ousters())
        .find(|sheet| sheet.name == name)
        .unwrap_or_else(|| panic!("{name} has no report"))
}

fn sheets() -> Vec<Sheet> {
    vec![
        Sheet {
            name: "vlp16",
            device: "Velodyne VLP-16 (Puck)".into(),
            source: "VLP-16 User Manual 63-9243: firings, angles, ±3 cm",
            notes: "At 10 turns a second. The manual promises an accuracy; a third of it is taken as σ.",
            lasers: 16.0,
            elevation: [-15.0, 15.0],
            elevation_bound: 1e-3,
            off_middle: 2e-3,
            across: 360.0,
            step: Some(55.296e-6 * 10.0 * 360.0),
            firings_per_s: 16.0 / 55.296e-6,
            range: [1.0, 100.0],
            stddev: |_| 0.01,
            quantum: 0.002,
        },
        Sheet {
            name: "hdl32e",
            device: "Velodyne HDL-32E".into(),
            source: "HDL-32E User's Manual: firings, angles, ±2 cm",
            notes: "At 10 turns a second. The manual promises an accuracy; a third of it is taken as σ.",
            lasers: 32.0,
            elevation: [-30.67, 10.67],
            elevation_bound: 1e-3,
            off_middle: 2e-3,
            across: 360.0,
            step: Some(46.08e-6 * 10.0 * 360.0),
            firings_per_s: 32.0 / 46.08e-6,
            range: [0.05, 100.0],
            stddev: |_| 0.02 / 3.0,
            quantum: 0.002,
        },
        Sheet {
            name: "urg04lx",
            device: "Hokuyo URG-04LX".into(),
            source: "Specification C-42-03320: ±10 mm up to 1 m, ±1 % beyond, 1 mm, 1024 steps a turn of which 682 are measured",
            notes: "A third of the promised accuracy is taken as σ.",
            lasers: 1.0,
            elevation: [0.0, 0.0],
            elevation_bound: 1e-3,
            off_middle: 2e-3,
            across: 681.0 * 360.0 / 1024.0,
            step: Some(360.0 / 1024.0),
            firings_per_s: 6820.0,
            range: [0.02, 5.6],
            stddev: |range| 0.01 / 3.0 * range.max(1.0),
            quantum: 0.001,
        },
        Sheet {
            name: "utm30lx",
            device: "Hokuyo UTM-30LX".into(),
            source: "Specification: σ < 10 mm up to 10 m, < 30 mm up to 30 m, 0.25°, 270°, 40 Hz, 1 mm",
            notes: "",
            lasers: 1.0,
            elevation: [0.0, 0.0],
            elevation_bound: 1e-3,
            off_middle: 2e-3,
            across: 270.0,
            step: Some(0.25),
            firings_per_s: 1081.0 * 40.0,
            range: [0.1, 30.0],
            stddev: |range| if range < 10.0 { 0.01 } else { 0.03 },
            quantum: 0.001,
        },
        Sheet {
            name: "lms111",
            device: "SICK LMS111".into(),
            source: "Operating instructions: statistical error σ 12 mm, 0.25° at 25 Hz, 270°",
            notes: "Its systematic error of ±30 mm is a bias of each run, of a third of that.",
            lasers: 1.0,
            elevation: [0.0, 0.0],
            elevation_bound: 1e-3,
            off_middle: 2e-3,
            across: 270.0,
            step: Some(0.25),
            firings_per_s: 1081.0 * 25.0,
            range: [0.5, 20.0],
            stddev: |_| 0.012,
            quantum: 0.001,
        },
        Sheet {
            name: "lms511",
            device: "SICK LMS511".into(),
            source: "Operating instructions 8013796: 190° by 0.1667° at 25 Hz; statistical error σ 6, 8 and 14 mm up to 10, \
                     20 and 30 m",
            notes: "Its systematic error of ±25 mm and more is a bias of each run, of a third of that.",
            lasers: 1.0,
            elevation: [0.0, 0.0],
            elevation_bound: 1e-3,
            off_middle: 2e-3,
            across: 190.0,
            step: Some(1.0 / 6.0),
            firings_per_s: 1141.0 * 25.0,
            range: [0.7, 80.0],
            stddev: |range| {
                if range < 10.0 {
                    0.006
                } else if range < 20.0 {
                    0.008
                } else {
                    0.014
                }
            },
            quantum: 0.001,
        },
        Sheet {
            name: "rplidar_a1",
            device: "Slamtec RPLIDAR A1M8".into(),
            source: "Data sheet rev. 1.0: 0.15 … 12 m, 1° at 5.5 Hz; an error of triangulation of 3.3e-4·r² is derived from \
                     its < 0.5 mm below 1.5 m and < 1 %",
            notes: "",
            lasers: 1.0,
            elevation: [0.0, 0.0],
            elevation_bound: 1e-3,
            off_middle: 2e-3,
            across: 360.0,
            step: Some(1.0),
            firings_per_s: 1980.0,
            range: [0.15, 12.0],
            stddev: |range| 3.3e-4 * range * range,
            quantum: 0.000_25,
        },
        Sheet {
            name: "rplidar_a2",
            device: "Slamtec RPLIDAR A2M8".into(),
            source: "Data sheet rev. 2.5: 0.2 … 12 m, 0.45° at 10 Hz, < 1 %",
            notes: "A third of the promised accuracy is taken as σ.",
            lasers: 1.0,
            elevation: [0.0, 0.0],
            elevation_bound: 1e-3,
            off_middle: 2e-3,
            across: 360.0,
            step: Some(0.45),
            firings_per_s: 8000.0,
            range: [0.2, 12.0],
            stddev: |range| 0.01 / 3.0 * range,
            quantum: 0.000_25,
        },
    ]
}

/// Ouster's heads by lasers, highest and lowest beam.
fn ousters() -> impl Iterator<Item = Sheet> {
    let names = ["os0_32", "os0_64", "os0_128", "os1_32", "os1_64", "os1_128", "os2_32", "os2_64", "os2_128"];
    let highest = [43.28, 44.80, 45.75, 20.55, 21.20, 21.51, 10.27, 10.60, 10.76];
    names.into_iter().enumerate().map(move |(index, name)| {
        let (kind, lasers) = (index / 3, [32.0, 64.0, 128.0][index % 3]);
        Sheet {
            name,
            device: format!("Ouster OS{kind}-{lasers}"),
            source: "Metadata of units of 128 lasers in ouster_example: angles, where beams start; OS1 data sheet: σ 15 mm \
                     where the return is strong; User Guide v1.14: lidar_mode",
            notes: "At 1024x10. Each unit has angles of its own; those of the heads with fewer lasers are every second or \
                    fourth, by the polynomial. Published σ of OS0 and OS2 are not known to us: that of the OS1 is taken.",
            lasers,
            elevation: [[-46.26, -21.44, -11.09][kind], highest[index]],
            elevation_bound: [0.25, 0.05, 0.03][kind],
            off_middle: [0.064, 0.052, 0.092][kind],
            across: 360.0,
            step: Some(360.0 / 1024.0),
            firings_per_s: 10_240.0 * lasers,
            range: [[0.3, 55.0], [0.8, 120.0], [1.0, 240.0]][kind],
            stddev: |_| 0.015,
            quantum: 0.001,
        }
    })
}

/// A frame.
struct Taken {
    ranges: Vec<f32>,
    points: Vec<DVec3>,
    lasers: Vec<u32>,
}

fn frame_time_ns(preset: &Preset) -> u64 {
    (1e9 / preset.rate_hz).round() as u64
}

/// A frame from the middle of a ball.
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
    preset.config(frame_time_ns(preset)).noise(GaussianNoise::NONE).spreads(&[])
}

/// The radius of a ball beyond which, or within which, there is no range.
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

/// Standard deviation about the mean of measured ranges.
fn stddev(preset: &Preset, radius: f64) -> f64 {
    let (mut count, mut sum, mut squares, mut frame) = (0, 0.0, 0.0, 0);
    while count < SAMPLES || frame < PLACES {
        let config = preset.config(frame_time_ns(preset));
        // All places between two steps of the ranges.
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

/// Degrees across that beams fill, and from one of the first laser to the next.
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
    // A whole circle has no gap that is wider than a step.
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
    // Beams need not start in the middle.
    let directions: Vec<DVec3> =
        near.points.iter().zip(&far.points).map(|(near, far)| (*far - *near).normalize()).collect();
    let elevations = || directions.iter().map(|direction| libm::asin(direction.z).to_degrees());
    let (found_across, found_step) = across(&directions, &near.lasers);
    let scanner = Scanner::new(without_noise(preset)).unwrap();
    let firings: usize = (0..20).map(|frame| scanner.firings(frame)).sum();
    let rate = firings as f64 / (20.0 * 1e-9 * frame_time_ns(preset) as f64);
    let lasers = near.lasers.iter().max().map_or(0.0, |laser| f64::from(laser + 1));
    let exact = Bound::Share(1e-4);
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
        Row::new("field of view across", "°", sheet.across, found_across, exact),
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
    // Lasers start some millimetres off the middle.
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
