//! Depth cameras.

use crate::camera::{Eye, gaussian};
use crate::errors::{of, value_error};
use crate::outputs::Outputs;
use crate::pool::Threads;
use crate::shots::{GivenEach, Shots};
use crate::world::World;
use belvedere_sensors::Sensor;
use belvedere_sensors::depth::{self, DepthCameraConfig, DepthFrame};
use belvedere_sensors::device::depth_model::{DepthModel, presets};
use belvedere_sensors::trace::Faces;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::ops::RangeInclusive;

/// The focal lengths in pixels that device models accept.
const FOCAL_PX: RangeInclusive<f64> = 1e-6..=1e6;

#[pyclass(frozen, module = "belvedere._native")]
pub(crate) struct DepthCamera {
    eye: Eye,
    range: [f64; 2],
    model: DepthModel,
    faces: Faces,
}

impl DepthCamera {
    fn config(&self, seed: u64) -> DepthCameraConfig<'_> {
        let [min_m, max_m] = self.range;
        let config = DepthCameraConfig::new(self.eye.config(seed)).min_depth_m(min_m).max_depth_m(max_m);
        config.model(self.model).faces(self.faces)
    }
}

#[pymethods]
impl DepthCamera {
    #[new]
    #[pyo3(signature = (size, lens, clip, exposure, grey, smooth, noise, device, range, depth_noise, model, projector, faces))]
    fn new(
        size: [u32; 2],
        lens: (Option<(String, Vec<f64>)>, Option<f64>),
        clip: [f64; 2],
        exposure: f32,
        grey: bool,
        smooth: bool,
        noise: [f32; 2],
        device: Option<&str>,
        range: [Option<f64>; 2],
        depth_noise: [f32; 2],
        model: Option<&str>,
        projector: bool,
        faces: u8,
    ) -> PyResult<Self> {
        let argument = if lens.0.is_some() { "lens" } else { "fov" };
        let eye = Eye::new(size, lens, clip, exposure, (grey, smooth), noise, device)?;
        let mut limits = [0.0, f64::INFINITY];
        let mut depth_model = DepthModel::from(gaussian(depth_noise)?);
        if let Some(name) = model {
            let preset = presets::named(name).ok_or_else(|| {
                of(
                    "model",
                    format_args!("there is no preset {name:?}; there are {}", presets::NAMES.join(", ")),
                )
            })?;
            limits = preset.range_m;
            let focal_px = eye.rays.focal_px().unwrap_or_else(|| preset.focal_px());
            if !FOCAL_PX.contains(&focal_px) {
                let [least, most] = [FOCAL_PX.start(), FOCAL_PX.end()];
                return Err(of(
                    argument,
                    format_args!(
                        "{name} takes focal lengths of {least:e} to {most:e} pixels, not {focal_px:.3e}"
                    ),
                ));
            }
            depth_model = preset.model(focal_px);
            if !projector {
                depth_model = depth_model.without_projector().ok_or_else(|| {
                    of(
                        "projector",
                        format_args!("a {name} cannot measure without its projector; leave it on"),
                    )
                })?;
            }
        }
        let range = [range[0].unwrap_or(limits[0]), range[1].unwrap_or(limits[1])];
        // The numbers used by the Python package.
        let faces = if faces == 1 { Faces::Both } else { Faces::Front };
        let camera = Self { eye, range, model: depth_model, faces };
        depth::DepthCamera::new(camera.config(0)).map_err(value_error)?;
        Ok(camera)
    }

    /// Returns the presets: name, size, horizontal field of view in degrees, range in metres.
    #[staticmethod]
    fn presets() -> Vec<(&'static str, [u32; 2], f64, [f64; 2])> {
        let all = presets::ALL.iter();
        all.map(|preset| (preset.name, preset.size, preset.horizontal_fov_deg, preset.range_m)).collect()
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
        let pixels = self.eye.pixels();
        let mut outputs = Outputs::borrow(outputs)?;
        let mut slices = outputs.lend(shots.len())?;
        let mut colour = slices.u8::<u8>("rgb", self.eye.bytes())?;
        let mut depth = slices.f32::<f32>("depth", pixels)?;
        let mut millimetres = slices.u16::<u16>("depth_mm", pixels)?;
        let mut points = slices.f32::<[f32; 3]>("points", pixels)?;
        let mut truth = slices.truth("true_depth", "range", pixels)?;
        slices.finish()?;
        shots.check_flows(truth.flows())?;
        let frames: Vec<_> = (0..shots.len())
            .map(|_| (colour.next(), depth.next(), millimetres.next(), points.next(), truth.next()))
            .collect();
        let threads = Threads::new(threads, shots.len() * pixels)?;
        py.detach(|| {
            threads.for_each(frames, |index, (colour, depth, millimetres, points, truth), memory| {
                if !shots.is_wanted(index) {
                    return Ok(());
                }
                let camera =
                    depth::DepthCamera::new(self.config(shots.seed(index))).map_err(|why| why.to_string())?;
                shots.take(index, memory, |scene, capture, workspace| {
                    let mut frame = DepthFrame::new().truth(truth);
                    (frame.colour, frame.depth_32fc1, frame.depth_16uc1) = (colour, depth, millimetres);
                    frame.xyz = points;
                    camera.sense_in(workspace, scene, capture, frame).map_err(|why| why.to_string())
                })
            })
        })
    }
}
