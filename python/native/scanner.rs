//! Laser scanners by their presets.

use crate::errors::{of, value_error};
use crate::outputs::Outputs;
use crate::pool::Threads;
use crate::shots::{GivenEach, Shots};
use crate::world::World;
use belvedere_sensors::scanner::presets::{self, Preset};
use belvedere_sensors::scanner::{self, Echoes, Intensity, Returns, ScannerConfig, Weather};
use belvedere_sensors::{Capture, Keyframe, Moment, Sensor, Shutter};
use numpy::PyArray2;
use numpy::ndarray::Array2;
use pyo3::prelude::*;
use pyo3::types::PyDict;

#[pyclass(frozen, module = "belvedere._native")]
pub(crate) struct Scanner {
    config: ScannerConfig<'static>,
    firings: usize,
    returns: usize,
}

/// Returns the error for a combination of columns and rate that a preset does not have.
fn no_mode(preset: &Preset, columns: Option<u32>, rate_hz: Option<f64>) -> PyErr {
    let Preset { name, modes, rates_hz: [slowest, fastest], .. } = preset;
    if modes.is_empty() {
        return match (columns, rate_hz) {
            (Some(columns), _) => {
                of("columns", format_args!("{name} has no choice of columns; leave out the {columns}"))
            }
            (None, rate_hz) => of(
                "rate",
                format_args!(
                    "{name} has no such mode: {slowest} to {fastest} turns a second are expected, not {}",
                    rate_hz.unwrap_or_default()
                ),
            ),
        };
    }
    let modes = modes.iter().map(|mode| format!("{} at {}", mode.columns.at_angles(), mode.rate_hz));
    let given = match (columns, rate_hz) {
        (Some(columns), Some(rate_hz)) => format!("{columns} at {rate_hz}"),
        (Some(columns), None) => columns.to_string(),
        (None, rate_hz) => format!("any at {}", rate_hz.unwrap_or_default()),
    };
    of(
        if columns.is_some() { "columns" } else { "rate" },
        format_args!(
            "{name} has no such mode: columns at turns a second are {}, not {given}",
            modes.collect::<Vec<_>>().join(", ")
        ),
    )
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
        let mode = found.in_mode(columns, rate_hz).ok_or_else(|| no_mode(&found, columns, rate_hz))?;
        let config = mode
            .config()
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

    /// Returns the directions of a frame's firings in the frame of the sensor: (firings, 3).
    fn directions<'py>(&self, py: Python<'py>, frame: u64) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let scanner = scanner::Scanner::new(self.config).map_err(value_error)?;
        let direction = |index| scanner.firing(frame, index).direction.as_vec3().to_array();
        let numbers: Vec<f32> = (0..self.firings).flat_map(direction).collect();
        let array = Array2::from_shape_vec((self.firings, 3), numbers).map_err(value_error)?;
        Ok(PyArray2::from_owned_array(py, array))
    }

    /// Returns the firings of a frame, the returns of each, and the nanoseconds from one frame to the next.
    #[getter]
    fn size(&self) -> (usize, usize, u64) {
        (self.firings, self.returns, self.config.frame_time_ns)
    }

    fn render(
        &self,
        py: Python<'_>,
        world: &World,
        now: &Bound<'_, PyAny>,
        after: Option<&Bound<'_, PyAny>>,
        before: Option<&Bound<'_, PyAny>>,
        each: GivenEach<'_>,
        outputs: &Bound<'_, PyDict>,
        threads: usize,
    ) -> PyResult<()> {
        let shots = Shots::read(world.data(py), now, after, before, each)?;
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
        py.detach(|| {
            threads.for_each(frames, |index, parts, memory| {
                if !shots.is_wanted(index) {
                    return Ok(());
                }
                let scanner = scanner::Scanner::new(self.config.seed(shots.seed(index)));
                let scanner = scanner.map_err(|why| why.to_string())?;
                shots.take(index, memory, |scene, capture, workspace| {
                    let mut capture = *capture;
                    let frame_time_s = self.config.frame_time_ns as f64 * 1e-9;
                    // The motion during the frame, if it was given.
                    if let (Shutter::Global(first), Some(Shutter::Global(last))) =
                        (capture.shutter, capture.after.take())
                    {
                        let between = shots.between(index);
                        let between = between.iter().map(|(world_from_sensor, world_from_instance)| Moment {
                            world_from_sensor: *world_from_sensor,
                            world_from_instance,
                        });
                        let moments: Vec<_> =
                            std::iter::once(first).chain(between).chain(std::iter::once(last)).collect();
                        let step_s = frame_time_s / (moments.len() - 1) as f64;
                        let keyframes = moments.into_iter().enumerate();
                        let keyframes: Vec<_> = keyframes
                            .map(|(step, at)| Keyframe { time_s: step as f64 * step_s, at })
                            .collect();
                        let moving = Capture::new(capture.frame, keyframes.as_slice());
                        let workspace = &mut workspace.lend(scanner.workspace_len(scene, &moving));
                        return scanner
                            .sense(scene, &moving, workspace, parts)
                            .map_err(|why| why.to_string());
                    }
                    scanner.sense_in(workspace, scene, &capture, parts).map_err(|why| why.to_string())
                })
            })
        })
    }
}
