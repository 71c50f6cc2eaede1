//! Lidars with a regular grid of beams.

use crate::camera::gaussian;
use crate::errors::value_error;
use crate::outputs::Outputs;
use crate::pool::Threads;
use crate::shots::{GivenEach, Shots};
use crate::world::World;
use belvedere_sensors::Sensor;
use belvedere_sensors::lidar::{self, Beams, LidarConfig, Scan};
use belvedere_sensors::trace::Faces;
use pyo3::prelude::*;
use pyo3::types::PyDict;

#[pyclass(frozen, module = "belvedere._native")]
pub(crate) struct Lidar(LidarConfig);

#[pymethods]
impl Lidar {
    #[new]
    fn new(
        horizontal: (u32, f64, f64),
        vertical: (u32, f64, f64),
        range: [f64; 2],
        noise: [f32; 2],
        visibility: u32,
        both_faces: bool,
    ) -> PyResult<Self> {
        let beams = |(samples, min_angle_rad, max_angle_rad)| Beams { samples, min_angle_rad, max_angle_rad };
        let config = LidarConfig::new(beams(horizontal))
            .vertical(beams(vertical))
            .range_min_m(range[0])
            .range_max_m(range[1])
            .noise(gaussian(noise)?)
            .visibility(visibility)
            .faces(if both_faces { Faces::Both } else { Faces::Front });
        lidar::Lidar::new(config).map_err(value_error)?;
        Ok(Self(config))
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
        let beams = (self.0.horizontal.samples * self.0.vertical.samples) as usize;
        let mut outputs = Outputs::borrow(outputs)?;
        let mut slices = outputs.lend(shots.len())?;
        let mut ranges = slices.f32::<f32>("range", beams)?;
        let mut intensities = slices.f32::<f32>("intensity", beams)?;
        let mut truth = slices.truth("depth", "true_range", beams)?;
        slices.finish()?;
        shots.check_flows(truth.flows())?;
        let frames: Vec<_> =
            (0..shots.len()).map(|_| (ranges.next(), intensities.next(), truth.next())).collect();
        let threads = Threads::new(threads, shots.len() * beams)?;
        py.detach(|| {
            threads.for_each(frames, |index, (ranges, intensities, truth), memory| {
                if !shots.is_wanted(index) {
                    return Ok(());
                }
                let lidar =
                    lidar::Lidar::new(self.0.seed(shots.seed(index))).map_err(|why| why.to_string())?;
                let mut scan = Scan::new().truth(truth);
                (scan.ranges, scan.intensities) = (ranges, intensities);
                shots.take(index, memory, |scene, capture, workspace| {
                    lidar.sense_in(workspace, scene, capture, scan).map_err(|why| why.to_string())
                })
            })
        })
    }
}
