//! What a camera is like, and why there can be none.

use crate::ParameterError;
use crate::device::{DeviceConfig, PixelFormat};
use crate::noise::GaussianNoise;
use crate::optics::Optics;
use crate::sensor::edges::Edges;
use crate::trace::Faces;

/// Largest width and height of a picture in pixels.
pub const MAX_IMAGE_SIZE: u32 = 16384;

/// What a camera is like.
///
/// ```
/// use belvedere_sensors::camera::{CameraConfig, PixelFormat};
/// use belvedere_sensors::optics::PinholeGrid;
/// let config = CameraConfig::new(PinholeGrid::from_fov(640, 480, 1.2)?).format(PixelFormat::Mono8).far_m(100.0);
/// assert_eq!((config.near_m, config.far_m), (0.02, 100.0));
/// # Ok::<(), belvedere_sensors::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CameraConfig<'a> {
    /// Which way the ray of each pixel goes; 1 … [`MAX_IMAGE_SIZE`] pixels across and down.
    pub optics: Optics<'a>,
    /// Layout of a pixel.
    pub format: PixelFormat,
    /// What is nearer is not seen: metres along the optical axis of a pinhole, and along the ray of any other lens,
    /// more than 0.
    pub near_m: f64,
    /// What is farther is not seen, measured as `near_m`, more than it.
    pub far_m: f64,
    /// Which sides of surfaces it sees. With [`Faces::Front`], as renderers cull back faces and Gazebo does, a camera inside its
    /// own housing sees out, and a mesh whose triangles run clockwise, seen from outside, shows its far inside or nothing.
    /// With [`Faces::Both`] nothing is seen through; the inside of a surface is shaded with its normal turned to the camera.
    pub faces: Faces,
    /// Factor of the light that reaches the sensor, finite, 0 or more: 1 as the scene is lit. Colours are proportional to
    /// it until they saturate at 1, as the electrons of a sensor are to its time of exposure (the linear model of EMVA
    /// 1288); shading computes in such proportional colours, without gamma.
    pub exposure: f32,
    /// What becomes of edges.
    pub edges: Edges,
    /// Noise of a colour value in [0, 1], which exposure leaves as it is; one sample a pixel, the same for R, G and B.
    pub noise: GaussianNoise,
    /// Sensor and electronics; without them a picture is the colours as they are shaded. `exposure` is a factor of the
    /// light that reaches the device, and `noise` is added to what it gives.
    pub device: Option<DeviceConfig>,
    /// Seed of the simulation.
    pub seed: u64,
    /// Number of the sensor in the simulation.
    pub sensor: u32,
}

impl<'a> CameraConfig<'a> {
    /// An RGB camera that sees the outside of surfaces from 0.02 to 300 m, without noise, of seed and number 0.
    pub fn new(optics: impl Into<Optics<'a>>) -> Self {
        Self {
            optics: optics.into(),
            format: PixelFormat::Rgb8,
            near_m: 0.02,
            far_m: 300.0,
            faces: Faces::Front,
            exposure: 1.0,
            edges: Edges::Sharp,
            noise: GaussianNoise::NONE,
            device: None,
            seed: 0,
            sensor: 0,
        }
    }

    setters! {
        /// Sets the layout of a pixel.
        format: PixelFormat,
        /// Sets the nearest that is seen, in metres.
        near_m: f64,
        /// Sets the farthest that is seen, in metres.
        far_m: f64,
        /// Sets which sides of surfaces it sees.
        faces: Faces,
        /// Sets the exposure.
        exposure: f32,
        /// Sets what becomes of edges.
        edges: Edges,
        /// Sets the noise of a colour value.
        noise: GaussianNoise,
        /// Sets sensor and electronics.
        device: Option<DeviceConfig>,
        /// Sets the seed of the simulation.
        seed: u64,
        /// Sets the number of the sensor in the simulation.
        sensor: u32,
    }

    /// The same with other optics, of other lifetime.
    #[cfg(feature = "alloc")]
    pub(crate) fn with_optics<'b>(&self, optics: &Optics<'b>) -> CameraConfig<'b> {
        let Self { optics: _, format, near_m, far_m, faces, exposure, edges, noise, device, seed, sensor } =
            *self;
        CameraConfig {
            optics: *optics,
            format,
            near_m,
            far_m,
            faces,
            exposure,
            edges,
            noise,
            device,
            seed,
            sensor,
        }
    }

    /// Whether a picture can have so many pixels across and down, before optics are made for it.
    ///
    /// # Errors
    /// When one of them is not 1 … [`MAX_IMAGE_SIZE`].
    pub fn check_size([width, height]: [u32; 2]) -> Result<(), ParameterError> {
        for (parameter, value) in [("width", width), ("height", height)] {
            ParameterError::require_in("camera", parameter, value.into(), [1.0, MAX_IMAGE_SIZE.into()])?;
        }
        Ok(())
    }

    /// Sets which way the rays go.
    #[must_use]
    pub fn optics(mut self, optics: impl Into<Optics<'a>>) -> Self {
        self.optics = optics.into();
        self
    }
}
