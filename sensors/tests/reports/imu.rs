//! Inertial units at rest: overlapping Allan deviations.

use super::page::{Bound, Page, Row, digits};
use super::plot::{Plot, curve};
use belvedere_sensors::imu::{Imu, InertialReading, presets};

/// The published figures of a unit: densities of white noise and of the bias random walk, and correlation times, of
/// angular rates (rad/s) and of forces (m/s²).
pub(crate) struct Sheet {
    pub(crate) device: String,
    source: &'static str,
    gyro: Process,
    accelerometer: Process,
}

/// White noise, and a Gauss–Markov bias.
#[derive(Clone, Copy)]
struct Process {
    density: f64,
    drift: f64,
    drift_time_s: f64,
    step: f64,
}

impl Process {
    /// The Allan deviation over a time t for samples at this interval: white noise N/√t, rounding, and the Gauss–Markov
    /// closed form.
    fn allan(&self, period_s: f64, t: f64) -> f64 {
        let x = t / self.drift_time_s;
        let markov = self.drift * self.drift_time_s / t.sqrt();
        let share = 1.0 - (3.0 - 4.0 * libm::exp(-x) + libm::exp(-2.0 * x)) / (2.0 * x);
        let rounding = self.step * self.step / 12.0 * period_s / t;
        (self.density * self.density / t + markov * markov * share + rounding).sqrt()
    }
}

/// The published figures of a preset.
pub(crate) fn sheet(name: &str) -> Sheet {
    match name {
        "adis16448" => Sheet {
            device: "Analog Devices ADIS16448".into(),
            source: "Densities, bias walks and correlation times of the simulator RotorS; steps of the data sheet",
            gyro: Process {
                density: 3.394e-4,
                drift: 3.879e-5,
                drift_time_s: 1000.0,
                step: 0.04_f64.to_radians(),
            },
            accelerometer: Process {
                density: 4e-3,
                drift: 6e-3,
                drift_time_s: 300.0,
                step: 0.833e-3 * 9.80665,
            },
        },
        _ => panic!("{name} has no report"),
    }
}

const RATE_HZ: usize = 200;
const SECONDS: usize = 2000;
/// The number of runs, each with three axes.
const RUNS: u64 = 4;

/// The overlapping Allan deviation over `m` samples, of all series together.
fn allan(series: &[Vec<f64>], m: usize) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for sums in series {
        for first in 0..sums.len() - 2 * m {
            let difference = (sums[first + 2 * m] - 2.0 * sums[first + m] + sums[first]) / m as f64;
            sum += 0.5 * difference * difference;
            count += 1.0;
        }
    }
    (sum / count).sqrt()
}

/// The page of a preset.
pub(crate) fn page(name: &'static str) -> Page {
    let sheet = sheet(name);
    let config = presets::named(name).unwrap().config();
    let period_s = 1.0 / RATE_HZ as f64;
    let [mut turns, mut forces] = [Vec::new(), Vec::new()];
    for run in 0..RUNS {
        let unit = Imu::new(config, 1 + run, 0).unwrap();
        let mut state = unit.start();
        let mut sums = vec![vec![0.0]; 6];
        for frame in 0..(RATE_HZ * SECONDS) as u64 {
            let read = unit.measure(&InertialReading::default(), frame, period_s, &mut state);
            let values = read.angular_velocity.to_array().into_iter().chain(read.specific_force.to_array());
            for (sums, value) in sums.iter_mut().zip(values) {
                sums.push(sums[sums.len() - 1] + value);
            }
        }
        forces.extend(sums.split_off(3));
        turns.extend(sums);
    }
    let (mut rows, mut plots) = (Vec::new(), Vec::new());
    for (what, unit, process, series) in
        [("gyro", "rad/s", sheet.gyro, &turns), ("accelerometer", "m/s²", sheet.accelerometer, &forces)]
    {
        let mut points = Vec::new();
        for samples in [4, 20, 100, 200, 1000, 4000, 20_000] {
            let t = samples as f64 * period_s;
            let (expected, found) = (process.allan(period_s, t), allan(series, samples));
            // Over longer times there are too few windows for the bound.
            if t <= 5.0 {
                let what = format!("Allan deviation of the {what} over {} s", digits(t));
                rows.push(Row::new(what, unit, expected, found, Bound::Share(0.03)));
            }
            points.push((t, found));
        }
        plots.push(Plot {
            title: format!("{}: Allan deviation of the {what}", sheet.device),
            axes: ["averaging time in s", unit],
            curve: curve([0.0_f64, 4.0], |decades| decades)
                .iter()
                .map(|(decades, _)| {
                    let t = 0.01 * libm::pow(10.0, *decades);
                    (t, process.allan(period_s, t))
                })
                .collect(),
            points,
            is_logarithmic: true,
        });
    }
    Page {
        name,
        source: format!("{}. {}", sheet.device, sheet.source),
        notes: format!("At rest, {RUNS} runs of {SECONDS} s at {RATE_HZ} Hz, three axes each."),
        rows,
        plots,
    }
}
