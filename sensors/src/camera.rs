//! Colour cameras: textured, lit, with shadows and Gazebo's pixel noise.

use crate::execution::SplitRows;
use crate::lens::Pinhole;
use crate::noise::{GaussianNoise, Stream, normals64};
use crate::pixel;
pub use crate::pixel::PixelFormat;
use crate::scene::{Scene, visibility};
use crate::shade::{Colours, Shader};
use crate::simd::LANES;
use crate::trace::grid::{Band, BandWork, Sight, trace_pinhole};
use crate::trace::image::Projection;
use crate::trace::packet::Faces;
use crate::trace::resolve::Resolver;
use crate::trace::tile::{CameraRays, TILE_HEIGHT, TILE_WIDTH, Tile};
use crate::trace::view::View;
use crate::trace::{Capture, RayGrid, Workspace};
use fearless_simd::Simd;

/// Largest width and height of a picture in pixels.
pub const MAX_IMAGE_SIZE: u32 = 16384;

/// What a camera is like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraConfig {
    /// Pixels across, 1 … [`MAX_IMAGE_SIZE`].
    pub width: u32,
    /// Pixels down, 1 … [`MAX_IMAGE_SIZE`].
    pub height: u32,
    /// Full horizontal angle of view in radians, in (0, π).
    pub horizontal_fov_rad: f64,
    /// Layout of a pixel.
    pub format: PixelFormat,
    /// What is nearer along the optical axis is not seen, in metres, more than 0.
    pub near_m: f64,
    /// What is farther along the optical axis is not seen, in metres, more than `near_m`.
    pub far_m: f64,
    /// Factor of the light that reaches the sensor, finite, 0 or more: 1 as the scene is lit. Colours are proportional to
    /// it until they saturate at 1, as the electrons of a sensor are to its time of exposure (the linear model of EMVA
    /// 1288); shading computes in such proportional colours, without gamma.
    pub exposure: f32,
    /// Noise of a colour value in [0, 1], which exposure leaves as it is; one sample a pixel, the same for R, G and B.
    pub noise: GaussianNoise,
    /// Seed of the simulation.
    pub seed: u64,
    /// Number of the sensor in the simulation.
    pub sensor: u32,
}

/// Why a camera cannot be made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum CameraError {
    /// Width or height is 0 or more than [`MAX_IMAGE_SIZE`].
    ImageSize,
    /// The angle of view is not in (0, π).
    FieldOfView,
    /// Not 0 < near < far.
    Clip,
    /// The valid range of a depth camera is not 0 ≤ min < max.
    Cutoff,
    /// The exposure is negative, NaN or infinite.
    Exposure,
}

impl core::fmt::Display for CameraError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::ImageSize => "width and height must be 1 to 16384 pixels",
            Self::FieldOfView => "the angle of view must be more than 0 and less than π",
            Self::Clip => "the clip distances must be 0 < near < far",
            Self::Cutoff => "the valid depths must be 0 <= min < max",
            Self::Exposure => "the exposure must be a finite number, 0 or more",
        })
    }
}

impl core::error::Error for CameraError {}

/// A checked colour camera. It looks along +x of its frame, its picture's right is −y and down is −z.
///
/// ```
/// use belvedere_sensors::{camera::*, noise::GaussianNoise, scene::*, trace::*, Pose};
/// let mut builder = SceneBuilder::new();
/// let red = builder.add_material(&MaterialConfig { emissive: [1.0, 0.0, 0.0], diffuse: [0.0; 3], ambient: [0.0; 3], ..Default::default() })?;
/// builder.add_instance(&InstanceConfig {
///     shape: Shape::Sphere { radius: 0.5 },
///     world_from_instance: Pose::from_translation(glam::DVec3::X * 2.0),
///     material: red,
///     ..Default::default()
/// })?;
/// let camera = Camera::new(CameraConfig {
///     width: 64, height: 48, horizontal_fov_rad: 1.0, format: PixelFormat::Rgb8, near_m: 0.02, far_m: 300.0,
///     exposure: 1.0, noise: GaussianNoise::NONE, seed: 1, sensor: 0,
/// })?;
/// let mut pixels = vec![0; camera.frame_len()];
/// let mut workspace = WorkspaceBuf::default();
/// let capture = Capture { world_from_sensor: Pose::IDENTITY, frame: 0 };
/// let scene = builder.scene();
/// camera.sense(&scene, &capture, &mut workspace.lend(&scene, camera.rays()), &mut pixels);
/// let middle = 24 * camera.row_stride() + 32 * 3;
/// assert_eq!(pixels[middle..middle + 3], [255, 0, 0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Camera {
    config: CameraConfig,
    lens: Pinhole,
    bias: f32,
    /// Whether colours stay as they are shaded.
    is_ideal: bool,
}

impl Camera {
    /// Checks the configuration.
    ///
    /// # Errors
    /// A [`CameraError`] that names the value out of range.
    pub fn new(config: CameraConfig) -> Result<Self, CameraError> {
        let size = 1..=MAX_IMAGE_SIZE;
        if !size.contains(&config.width) || !size.contains(&config.height) {
            return Err(CameraError::ImageSize);
        }
        if !(config.horizontal_fov_rad > 0.0 && config.horizontal_fov_rad < core::f64::consts::PI) {
            return Err(CameraError::FieldOfView);
        }
        if !(config.near_m > 0.0 && config.near_m < config.far_m) {
            return Err(CameraError::Clip);
        }
        if !(config.exposure.is_finite() && config.exposure >= 0.0) {
            return Err(CameraError::Exposure);
        }
        Ok(Self {
            config,
            lens: Pinhole::from_fov(config.width, config.height, config.horizontal_fov_rad),
            bias: config.noise.bias(config.seed, config.sensor, 0),
            is_ideal: config.exposure == 1.0 && config.noise.is_none(),
        })
    }

    /// What it was made from.
    pub fn config(&self) -> &CameraConfig {
        &self.config
    }

    /// The projection that the picture really has.
    pub fn lens(&self) -> &Pinhole {
        &self.lens
    }

    /// Bytes from one row to the next: rows are not padded.
    pub fn row_stride(&self) -> usize {
        self.config.width as usize * self.config.format.bytes()
    }

    /// Bytes of a picture.
    pub fn frame_len(&self) -> usize {
        self.row_stride() * self.config.height as usize
    }

    /// Takes a picture into `pixels`, top row first.
    ///
    /// # Panics
    /// When `pixels` is not [`Camera::frame_len`] long, or the workspace does not fit the scene.
    pub fn sense(
        &self,
        scene: &Scene<'_>,
        capture: &Capture,
        workspace: &mut Workspace<'_>,
        pixels: &mut [u8],
    ) {
        assert_eq!(pixels.len(), self.frame_len(), "the buffer must hold exactly one picture");
        let execution = workspace.execution;
        let mut memory = workspace.cut(scene, self.rays());
        let instances = scene.instances().len();
        let view = View::new(scene, &capture.world_from_sensor, visibility::VISUAL, memory.view(instances));
        let rows = Rows { pixels, bytes: self.row_stride() * TILE_HEIGHT };
        let painter = Painter { camera: self, capture };
        trace_pinhole(&view, &self.lens, &self.sight(), execution, &mut memory, rows, &painter);
    }

    /// Rays that a [`Workspace`] must have room for.
    pub fn rays(&self) -> usize {
        self.grid().rays()
    }

    pub(crate) fn grid(&self) -> RayGrid<'static> {
        RayGrid::Pinhole(self.lens)
    }

    /// Housings are seen from outside only: a camera within its own sees out.
    pub(crate) fn sight(&self) -> Sight {
        Sight { faces: Faces::Front, range: [self.config.near_m, self.config.far_m] }
    }

    /// Exposure and noise of a tile. Samples are counted tile by tile, 64 to each, along the rows of tiles.
    #[inline(always)]
    pub(crate) fn expose(&self, frame: u64, tile: u32, colours: &mut Colours) {
        if self.is_ideal {
            return;
        }
        if self.config.exposure != 1.0 {
            pixel::expose(colours, self.config.exposure);
        }
        if self.config.noise.is_none() {
            return;
        }
        let stream =
            Stream { seed: self.config.seed, sensor: self.config.sensor, frame, channel: COLOUR_CHANNEL };
        pixel::add_noise(colours, &self.config.noise, self.bias, &normals64(&stream, 4 * tile));
    }
}

/// Paints the tiles of a picture.
struct Painter<'a> {
    camera: &'a Camera,
    capture: &'a Capture,
}

impl BandWork<Rows<'_>> for Painter<'_> {
    #[inline(always)]
    fn finish<S: Simd, P: Projection>(&self, simd: S, band: &Band<'_, P>, output: Rows<'_>) {
        let Self { camera, capture } = self;
        let rays = CameraRays::new(&camera.lens, &capture.world_from_sensor);
        let mut resolver = Resolver::new(band.view);
        let mut tile = Tile::new();
        let mut shader = Shader::new();
        let mut colours = [[0.0; LANES]; 3];
        let tiles = camera.lens.tiles()[0];
        let stride = camera.row_stride();
        for (row, pixels) in band.block_rows().zip(output.pixels.chunks_mut(output.bytes)) {
            for column in 0..tiles {
                tile.take(simd, band, &mut resolver, &rays, [column, row]);
                shader.shade(simd, band.view, &tile, &rays, &mut colours);
                camera.expose(capture.frame, (row * tiles + column) as u32, &mut colours);
                pixel::write_tile(simd, &colours, camera.config.format, column * TILE_WIDTH, pixels, stride);
            }
        }
    }
}

/// Noise channel of colours.
const COLOUR_CHANNEL: u16 = 0;

/// Rows of pixels, cut between rows of tiles.
struct Rows<'a> {
    pixels: &'a mut [u8],
    /// Bytes of a row of tiles.
    bytes: usize,
}

impl SplitRows for Rows<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        let (upper, lower) = self.pixels.split_at_mut(rows * self.bytes);
        (Self { pixels: upper, bytes: self.bytes }, Self { pixels: lower, bytes: self.bytes })
    }
}
