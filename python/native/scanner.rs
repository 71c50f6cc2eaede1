//! Laser scanners as they are built, by their presets.

use crate::errors::{of, value_error};
use crate::outputs::Outputs;
use crate::pool::Threads;
use crate::shots::{GivenEach, Shots};
use crate::world::World;
use belvedere_sensors::scanner::{self, Echoes, Intensity, Returns, ScannerConfig, Weather, presets};
use belvedere_sensors::{Keyframe, Sensor, Shutter};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

#[pyclass(frozen, module = "belvedere._native")]
pub(crate) struct Scanner {
    config: ScannerConfig<'static>,
    firings: usize,
    returns: usize,
}

#[pymethods]
impl Scanner {
    #[new]
    fn new(
        preset: &str,
        rate_hz: Option<f64>,
        columns: Option<u32>,
        returns: &str,
        intensity: &str,
        weather: [f64; 3],
        visibility: u32,
    ) -> PyResult<Self> {
        let found = presets::named(preset).ok_or_else(|| {
            of(
                "preset",
                format_args!("there is none called {preset:?}; there are {}", presets::NAMES.join(", ")),
            )
        })?;
        let mode = found.in_mode(columns, rate_hz).ok_or_else(|| {
            let [slowest, fastest] = found.rates_hz;
            of(
                "rate",
                format_args!("{preset} has no such mode: rates are {slowest} to {fastest} turns a second"),
            )
        })?;
        let config = mode
            .config((1e9 / mode.rate_hz).round() as u64)
            .returns(match returns {
                "strongest" => Returns::Strongest,
                "first" => Returns::First,
                "last" => Returns::Last,
                "dual" => Returns::Dual,
                _ => return Err(of("returns", "strongest, first, last or dual is expected")),
            })
            .intensity(match intensity {
                "retro" => Intensity::Retro,
                "power" => Intensity::Power,
                "reflectivity" => Intensity::Reflectivity,
                _ => return Err(of("intensity", "retro, power or reflectivity is expected")),
            })
            .weather(Weather {
                visibility_m: weather[0],
                rain_mm_per_h: weather[1],
                snow_mm_per_h: weather[2],
            })
            .visibility(visibility);
        let scanner = scanner::Scanner::new(config).map_err(value_error)?;
        Ok(Self { config, firings: scanner.most_firings(), returns: scanner.returns() })
    }

    #[staticmethod]
    fn presets() -> Vec<&'static str> {
        presets::NAMES.to_vec()
    }

    /// Firings of a frame, returns of each, nanoseconds from a frame to the next.
    #[getter]
    fn size(&self) -> (usize, usize, u64) {
        (self.firings, self.returns, self.config.frame_time_ns)
    }

    fn render(
        &self,
        py: Python<'_>,
        world: &World,
        now: &Bound<'_, PyTuple>,
        after: Option<&Bound<'_, PyTuple>>,
        before: Option<&Bound<'_, PyTuple>>,
        each: GivenEach<'_>,
        outputs: &Bound<'_, PyDict>,
        threads: usize,
    ) -> PyResult<()> {
        let shots = Shots::read(world.data(), now, after, before, each)?;
        let (firings, echoes) = (self.firings, self.firings * self.returns);
        let mut outputs = Outputs::borrow(outputs)?;
        let mut slices = outputs.lend(shots.len())?;
        let mut ranges = slices.f32::<f32>("range", echoes)?;
        let mut points = slices.f32::<[f32; 3]>("points", echoes)?;
        let mut intensities = slices.f32::<f32>("intensity", echoes)?;
        let mut times = slices.f64::<f64>("time", firings)?;
        let mut lasers = slices.u32::<u32>("laser", firings)?;
        let mut truth = slices.truth("depth", "true_range", firings)?;
        slices.finish()?;
        let frames: Vec<_> = (0..shots.len())
            .map(|_| {
                let mut parts = Echoes::new().truth(truth.next());
                (parts.ranges, parts.points, parts.intensities) =
                    (ranges.next(), points.next(), intensities.next());
                (parts.times, parts.lasers) = (times.next(), lasers.next());
                parts
            })
            .collect();
        let threads = Threads::new(threads, shots.len() * firings)?;
        let done = py.detach(|| {
            threads.for_each(frames, |index, parts, memory| {
                if !shots.is_wanted(index) {
                    return Ok(());
                }
                let scanner = scanner::Scanner::new(self.config.seed(shots.seed(index)));
                let scanner = scanner.map_err(|why| why.to_string())?;
                shots.take(index, memory, |scene, capture, workspace, _| {
                    let mut capture = *capture;
                    let frame_time_s = self.config.frame_time_ns as f64 * 1e-9;
                    // Where it goes to during the frame, if that is said.
                    let keyframes = match (capture.shutter, capture.after.take()) {
                        (Shutter::Global(first), Some(Shutter::Global(last))) => Some([
                            Keyframe { time_s: 0.0, at: first },
                            Keyframe { time_s: frame_time_s, at: last },
                        ]),
                        _ => None,
                    };
                    if let Some(keyframes) = &keyframes {
                        let moving = belvedere_sensors::Capture::new(capture.frame, keyframes.as_slice());
                        let workspace = &mut workspace.lend(scanner.workspace_len(scene, &moving));
                        return scanner
                            .sense(scene, &moving, workspace, parts)
                            .map_err(|why| why.to_string());
                    }
                    let workspace = &mut workspace.lend(scanner.workspace_len(scene, &capture));
                    scanner.sense(scene, &capture, workspace, parts).map_err(|why| why.to_string())
                })
            })
        });
        done.map_err(value_error)
    }
}
