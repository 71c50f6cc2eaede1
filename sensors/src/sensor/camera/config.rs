//! The configuration of a camera.

use crate::ParameterError;
use crate::device::{DeviceConfig, PixelFormat};
use crate::noise::GaussianNoise;
use crate::optics::Optics;
use crate::scene::visibility;
use crate::sensor::edges::Edges;
use crate::trace::Faces;

/// The largest width and height of a picture in pixels.
pub const MAX_IMAGE_SIZE: u32 = 16384;

/// The configuration of a camera.
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
    /// The lens: the direction of the ray of each pixel. Width and height are 1 … [`MAX_IMAGE_SIZE`] pixels.
    pub optics: Optics<'a>,
    /// The pixel format. The default is [`PixelFormat::Rgb8`].
    pub format: PixelFormat,
    /// The near clip distance in metres, more than 0: along the optical axis for a pinhole, along the ray for any other
    /// lens. Nothing nearer is visible. The default is 0.02.
    pub near_m: f64,
    /// The far clip distance in metres, measured like `near_m` and greater than it. Nothing farther is visible. The
    /// default is 300.
    pub far_m: f64,
    /// The sides of surfaces that are visible. The default is [`Faces::Front`].
    ///
    /// With [`Faces::Front`], back faces are culled, as in most renderers and in Gazebo. A camera inside its own
    /// housing then sees out of it. A mesh whose triangles run clockwise, seen from outside, shows the inside of its
    /// far side or nothing. With [`Faces::Both`] no surface is seen through: back faces are visible too, shaded with
    /// their normal turned towards the camera.
    pub faces: Faces,
    /// The instances that are visible: those whose [visibility](crate::scene::InstanceConfig::visibility) has a bit in
    /// common with this mask. Hidden ones cast no shadow either. The default is [`visibility::VISUAL`].
    pub visibility: u32,
    /// The factor by which light is multiplied before it reaches the sensor, finite and at least 0; 1 leaves the scene
    /// as it is lit. Colours are proportional to it until they saturate at 1, as the electrons of a sensor are to its
    /// exposure time (the linear model of EMVA 1288). Shading computes such linear colours, without gamma. The default
    /// is 1.
    pub exposure: f32,
    /// The treatment of edges: sharp or anti-aliased. The default is [`Edges::Sharp`].
    pub edges: Edges,
    /// Noise of a colour value in [0, 1], independent of exposure. There is one sample per pixel, the same for R, G and
    /// B. The default is [`GaussianNoise::NONE`].
    pub noise: GaussianNoise,
    /// The image sensor and its electronics. Without a device, the picture holds the colours as they are shaded.
    /// `exposure` scales the light that reaches the device, and `noise` is added to its output. The default is `None`.
    pub device: Option<DeviceConfig>,
    /// The seed of the simulation. The default is 0.
    pub seed: u64,
    /// The number of the sensor in the simulation. The default is 0.
    pub sensor: u32,
}

impl<'a> CameraConfig<'a> {
    /// Creates the configuration of an RGB camera that sees front faces from 0.02 to 300 m, without noise, with seed
    /// and sensor number 0.
    pub fn new(optics: impl Into<Optics<'a>>) -> Self {
        Self {
            optics: optics.into(),
            format: PixelFormat::Rgb8,
            near_m: 0.02,
            far_m: 300.0,
            faces: Faces::Front,
            visibility: visibility::VISUAL,
            exposure: 1.0,
            edges: Edges::Sharp,
            noise: GaussianNoise::NONE,
            device: None,
            seed: 0,
            sensor: 0,
        }
    }

    setters! {
        /// Sets the pixel format.
        format: PixelFormat,
        /// Sets the near clip distance, in metres.
        near_m: f64,
        /// Sets the far clip distance, in metres.
        far_m: f64,
        /// Sets which sides of surfaces are visible.
        faces: Faces,
        /// Sets the mask of the instances that are visible.
        visibility: u32,
        /// Sets the factor by which light is multiplied.
        exposure: f32,
        /// Sets the treatment of edges.
        edges: Edges,
        /// Sets the noise of a colour value.
        noise: GaussianNoise,
        /// Sets the image sensor and its electronics.
        device: Option<DeviceConfig>,
        /// Sets the seed of the simulation.
        seed: u64,
        /// Sets the number of the sensor in the simulation.
        sensor: u32,
    }

    /// Returns the same configuration with other optics, which may have another lifetime.
    #[cfg(feature = "alloc")]
    pub(crate) fn with_optics<'b>(&self, optics: &Optics<'b>) -> CameraConfig<'b> {
        let Self {
            optics: _,
            format,
            near_m,
            far_m,
            faces,
            visibility,
            exposure,
            edges,
            noise,
            device,
            seed,
            sensor,
        } = *self;
        CameraConfig {
            optics: *optics,
            format,
            near_m,
            far_m,
            faces,
            visibility,
            exposure,
            edges,
            noise,
            device,
            seed,
            sensor,
        }
    }

    /// Checks the width and height of a picture in pixels, before optics are created for it.
    ///
    /// # Errors
    /// Returns a [`ParameterError`] if one of them is not in 1 … [`MAX_IMAGE_SIZE`].
    pub fn check_size([width, height]: [u32; 2]) -> Result<(), ParameterError> {
        for (parameter, value) in [("width", width), ("height", height)] {
            ParameterError::require_in("camera", parameter, value.into(), [1.0, MAX_IMAGE_SIZE.into()])?;
        }
        Ok(())
    }

    /// Sets the lens: the direction of the ray of each pixel.
    #[must_use]
    pub fn optics(mut self, optics: impl Into<Optics<'a>>) -> Self {
        self.optics = optics.into();
        self
    }
}
