//! Colour cameras.

use crate::errors::{of, value_error};
use crate::lens::Rays;
use crate::outputs::Outputs;
use crate::pool::Threads;
use crate::shots::{GivenEach, Shots};
use crate::world::World;
use belvedere_sensors::Sensor;
use belvedere_sensors::camera::{self, CameraConfig, Edges, Picture, PixelFormat};
use belvedere_sensors::device::{DeviceConfig, presets};
use belvedere_sensors::noise::{GaussianNoise, GaussianNoiseConfig};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The configuration of a camera without its seed.
pub(crate) struct Eye {
    pub(crate) rays: Rays,
    pub(crate) size: [u32; 2],
    format: PixelFormat,
    clip: [f64; 2],
    exposure: f32,
    edges: Edges,
    noise: GaussianNoise,
    device: Option<DeviceConfig>,
}

/// A lens from Python: a name and numbers, or a field of view.
type GivenLens = (Option<(String, Vec<f64>)>, Option<f64>);

impl Eye {
    pub(crate) fn new(
        [width, height]: [u32; 2],
        (lens, fov): GivenLens,
        clip: [f64; 2],
        exposure: f32,
        (grey, smooth): (bool, bool),
        noise: [f32; 2],
        device: Option<&str>,
    ) -> PyResult<Self> {
        CameraConfig::check_size([width, height]).map_err(value_error)?;
        let rays = match (lens, fov) {
            (Some((name, numbers)), _) => Rays::new(width, height, &name, &numbers)?,
            (None, fov) => Rays::from_fov(width, height, fov.unwrap_or_default())?,
        };
        let device = device.map(|name| {
            presets::named(name).map(|preset| preset.config()).ok_or_else(|| {
                of(
                    "device",
                    format_args!("there is no preset {name:?}; there are {}", presets::NAMES.join(", ")),
                )
            })
        });
        let eye = Self {
            rays,
            size: [width, height],
            format: if grey { PixelFormat::Mono8 } else { PixelFormat::Rgb8 },
            clip,
            exposure,
            edges: if smooth { Edges::Smooth } else { Edges::Sharp },
            noise: gaussian(noise)?,
            device: device.transpose()?,
        };
        camera::Camera::new(eye.config(0)).map_err(value_error)?;
        Ok(eye)
    }

    /// Returns the camera's configuration with a seed.
    pub(crate) fn config(&self, seed: u64) -> CameraConfig<'_> {
        let [near_m, far_m] = self.clip;
        CameraConfig::new(self.rays.optics())
            .format(self.format)
            .near_m(near_m)
            .far_m(far_m)
            .exposure(self.exposure)
            .edges(self.edges)
            .noise(self.noise)
            .device(self.device)
            .seed(seed)
    }

    /// Returns the number of pixels of a frame.
    pub(crate) fn pixels(&self) -> usize {
        self.size.into_iter().product::<u32>() as usize
    }

    /// Returns the number of bytes of an image.
    pub(crate) fn bytes(&self) -> usize {
        self.pixels() * self.format.bytes()
    }
}

/// Creates noise with a mean and a standard deviation.
pub(crate) fn gaussian([mean, stddev]: [f32; 2]) -> PyResult<GaussianNoise> {
    GaussianNoise::new(GaussianNoiseConfig::default().mean(mean).stddev(stddev))
        .map_err(|error| of("noise", error))
}

#[pyclass(frozen, module = "belvedere._native")]
pub(crate) struct Camera(Eye);

#[pymethods]
impl Camera {
    #[new]
    #[pyo3(signature = (size, lens, clip, exposure, grey, smooth, noise, device))]
    fn new(
        size: [u32; 2],
        lens: GivenLens,
        clip: [f64; 2],
        exposure: f32,
        grey: bool,
        smooth: bool,
        noise: [f32; 2],
        device: Option<&str>,
    ) -> PyResult<Self> {
        Eye::new(size, lens, clip, exposure, (grey, smooth), noise, device).map(Self)
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
        let mut outputs = Outputs::borrow(outputs)?;
        let mut slices = outputs.lend(shots.len())?;
        let mut colour = slices.u8::<u8>("rgb", self.0.bytes())?;
        let mut truth = slices.truth("depth", "range", self.0.pixels())?;
        slices.finish()?;
        shots.check_flows(truth.flows())?;
        let frames: Vec<_> = (0..shots.len()).map(|_| (colour.next(), truth.next())).collect();
        let threads = Threads::new(threads, shots.len() * self.0.pixels())?;
        py.detach(|| {
            threads.for_each(frames, |index, (colour, truth), memory| {
                if !shots.is_wanted(index) {
                    return Ok(());
                }
                let camera =
                    camera::Camera::new(self.0.config(shots.seed(index))).map_err(|why| why.to_string())?;
                let mut picture = Picture::new().truth(truth);
                picture.colour = colour;
                shots.take(index, memory, |scene, capture, workspace| {
                    camera.sense_in(workspace, scene, capture, picture).map_err(|why| why.to_string())
                })
            })
        })
    }
}
