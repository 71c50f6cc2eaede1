//! Colour cameras: textured, lit, with shadows and Gazebo's pixel noise.

pub use crate::edges::Edges;
use crate::edges::{Canvas, Marks, Smoothing};
use crate::execution::SplitRows;
use crate::memory::Cutter;
use crate::moment::Capture;
use crate::noise::{GaussianNoise, Stream, normals64};
use crate::optics::Optics;
use crate::pixel;
pub use crate::pixel::PixelFormat;
use crate::scene::{Scene, visibility};
use crate::shade::{Colours, Shader};
use crate::simd::LANES;
use crate::trace::Workspace;
use crate::trace::grid::{Band, BandWork, Sight, trace_grid};
use crate::trace::packet::Faces;
use crate::trace::resolve::Resolver;
use crate::trace::tile::{CameraRays, TILE_HEIGHT, TILE_WIDTH, Tile};
use crate::trace::view::View;
use fearless_simd::Simd;

/// Largest width and height of a picture in pixels.
pub const MAX_IMAGE_SIZE: u32 = 16384;

/// What a camera is like.
///
/// ```
/// use belvedere_sensors::camera::{CameraConfig, PixelFormat};
/// use belvedere_sensors::optics::PinholeGrid;
/// let config = CameraConfig::new(PinholeGrid::from_fov(640, 480, 1.2)?).format(PixelFormat::Mono8).far_m(100.0);
/// assert_eq!((config.near_m, config.far_m), (0.02, 100.0));
/// # Ok::<(), belvedere_sensors::optics::LensError>(())
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
    /// Factor of the light that reaches the sensor, finite, 0 or more: 1 as the scene is lit. Colours are proportional to
    /// it until they saturate at 1, as the electrons of a sensor are to its time of exposure (the linear model of EMVA
    /// 1288); shading computes in such proportional colours, without gamma.
    pub exposure: f32,
    /// What becomes of edges.
    pub edges: Edges,
    /// Noise of a colour value in [0, 1], which exposure leaves as it is; one sample a pixel, the same for R, G and B.
    pub noise: GaussianNoise,
    /// Seed of the simulation.
    pub seed: u64,
    /// Number of the sensor in the simulation.
    pub sensor: u32,
}

impl<'a> CameraConfig<'a> {
    /// An RGB camera that sees from 0.02 to 300 m, with sharp edges and without noise, of seed and number 0.
    pub fn new(optics: impl Into<Optics<'a>>) -> Self {
        Self {
            optics: optics.into(),
            format: PixelFormat::Rgb8,
            near_m: 0.02,
            far_m: 300.0,
            exposure: 1.0,
            edges: Edges::Sharp,
            noise: GaussianNoise::NONE,
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
        /// Sets the exposure.
        exposure: f32,
        /// Sets what becomes of edges.
        edges: Edges,
        /// Sets the noise of a colour value.
        noise: GaussianNoise,
        /// Sets the seed of the simulation.
        seed: u64,
        /// Sets the number of the sensor in the simulation.
        sensor: u32,
    }

    /// Sets which way the rays go.
    #[must_use]
    pub fn optics(mut self, optics: impl Into<Optics<'a>>) -> Self {
        self.optics = optics.into();
        self
    }
}

/// Why a camera cannot be made.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum CameraError {
    /// Width or height is 0 or more than [`MAX_IMAGE_SIZE`].
    ImageSize {
        /// Pixels across and down.
        size: [u32; 2],
    },
    /// The table of rays is not in square blocks: make it by [`RayTable::from_lens`](crate::optics::RayTable::from_lens).
    Table,
    /// Not 0 < near < far.
    Clip {
        /// In metres.
        near_m: f64,
        /// In metres.
        far_m: f64,
    },
    /// The valid range of a depth camera is not 0 ≤ min < max.
    Cutoff {
        /// In metres.
        min_m: f64,
        /// In metres.
        max_m: f64,
    },
    /// The exposure is negative, NaN or infinite.
    Exposure(f32),
}

impl core::fmt::Display for CameraError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::ImageSize { size: [width, height] } => {
                write!(
                    f,
                    "a picture of {width} × {height}: width and height must be 1 to {MAX_IMAGE_SIZE} pixels"
                )
            }
            Self::Table => f.write_str("the table of a camera must be made by RayTable::from_lens"),
            Self::Clip { near_m, far_m } => {
                write!(f, "clip distances of {near_m} and {far_m} m: they must be 0 < near < far")
            }
            Self::Cutoff { min_m, max_m } => {
                write!(f, "valid depths from {min_m} to {max_m} m: they must be 0 <= min < max")
            }
            Self::Exposure(exposure) => {
                write!(f, "an exposure of {exposure}: it must be a finite number, 0 or more")
            }
        }
    }
}

impl core::error::Error for CameraError {}

/// A checked colour camera. It looks along +x of its frame, its picture's right is −y and down is −z.
///
/// ```
/// use belvedere_sensors::{camera::*, optics::PinholeGrid, scene::*, trace::*, Capture, Pose};
/// let mut builder = SceneBuilder::new();
/// let red = builder.add_material(&MaterialConfig { emissive: [1.0, 0.0, 0.0], diffuse: [0.0; 3], ambient: [0.0; 3], ..Default::default() })?;
/// builder.add_instance(&InstanceConfig {
///     shape: Shape::Sphere { radius: 0.5 },
///     world_from_instance: Pose::from_translation(glam::DVec3::X * 2.0),
///     material: red,
///     ..Default::default()
/// })?;
/// let camera = Camera::new(CameraConfig::new(PinholeGrid::from_fov(64, 48, 1.0)?))?;
/// let mut pixels = vec![0; camera.frame_len()];
/// let mut workspace = WorkspaceBuf::default();
/// let capture = Capture::new(0, builder.moment(Pose::IDENTITY));
/// let scene = builder.scene();
/// camera.sense(&scene, &capture, &mut workspace.lend(&scene, camera.rays()), &mut pixels);
/// let middle = 24 * camera.row_stride() + 32 * 3;
/// assert_eq!(pixels[middle..middle + 3], [255, 0, 0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Camera<'a> {
    config: CameraConfig<'a>,
    bias: f32,
    /// Whether colours stay as they are shaded.
    is_ideal: bool,
}

impl<'a> Camera<'a> {
    /// Checks the configuration.
    ///
    /// # Errors
    /// A [`CameraError`] that names the value out of range.
    pub fn new(config: CameraConfig<'a>) -> Result<Self, CameraError> {
        let size = config.optics.size().map(|size| size as u32);
        if !size.iter().all(|size| (1..=MAX_IMAGE_SIZE).contains(size)) {
            return Err(CameraError::ImageSize { size });
        }
        let fan = config.optics.fan();
        if [fan.shift_x, fan.shift_y] != [2, 2] {
            return Err(CameraError::Table);
        }
        let (near_m, far_m) = (config.near_m, config.far_m);
        if !(near_m > 0.0 && near_m < far_m) {
            return Err(CameraError::Clip { near_m, far_m });
        }
        if !(config.exposure.is_finite() && config.exposure >= 0.0) {
            return Err(CameraError::Exposure(config.exposure));
        }
        Ok(Self {
            config,
            bias: config.noise.bias(config.seed, config.sensor, 0),
            is_ideal: config.exposure == 1.0 && config.noise.is_none(),
        })
    }

    /// What it was made from.
    pub fn config(&self) -> &CameraConfig<'a> {
        &self.config
    }

    /// Pixels across and down.
    pub fn size(&self) -> [usize; 2] {
        self.config.optics.size()
    }

    /// Tiles across and down.
    pub(crate) fn tiles(&self) -> [usize; 2] {
        let [width, height] = self.size();
        [width.div_ceil(TILE_WIDTH), height.div_ceil(TILE_HEIGHT)]
    }

    /// Bytes from one row to the next: rows are not padded.
    pub fn row_stride(&self) -> usize {
        self.size()[0] * self.config.format.bytes()
    }

    /// Bytes of a picture.
    pub fn frame_len(&self) -> usize {
        self.row_stride() * self.size()[1]
    }

    /// Takes a picture into `pixels`, top row first.
    ///
    /// # Panics
    /// When `pixels` is not [`Camera::frame_len`] long, the workspace does not fit the scene, or the
    /// moment does not have one pose for each instance.
    pub fn sense(
        &self,
        scene: &Scene<'_>,
        capture: &Capture<'_>,
        workspace: &mut Workspace<'_>,
        pixels: &mut [u8],
    ) {
        assert_eq!(pixels.len(), self.frame_len(), "the buffer must hold exactly one picture");
        let execution = workspace.execution;
        let mut memory = workspace.cut(scene, self.rays());
        let instances = scene.instances().len();
        let view = View::new(scene, &capture.moment, visibility::VISUAL, memory.view(instances));
        let marks = self.marks(&mut memory);
        let picture = Picture { pixels: &mut *pixels, bytes: self.row_stride() * TILE_HEIGHT };
        let rows = Rows { picture, marks: Marks::new(marks, self.size()[0]) };
        let painter = Painter { camera: self, capture };
        trace_grid(&view, &self.config.optics, &self.sight(), execution, &mut memory, rows, &painter);
        if let Some(smoothing) = self.smoothing(&view, capture, marks) {
            let picture = Picture { pixels, bytes: self.row_stride() * TILE_HEIGHT };
            smoothing.paint(execution, Retouched { camera: self, frame: capture.frame, picture });
        }
    }

    /// Memory for the marks of a picture, if they are needed.
    pub(crate) fn marks<'m>(&self, memory: &mut Cutter<'m>) -> &'m mut [u32] {
        let [width, height] = self.size();
        memory.take(if self.config.edges == Edges::Smooth { width * height } else { 0 })
    }

    /// What is to be done about the edges of a marked picture.
    pub(crate) fn smoothing<'m>(
        &'m self,
        view: &'m View<'m>,
        capture: &Capture<'_>,
        marks: &'m [u32],
    ) -> Option<Smoothing<'m>> {
        let pose = &capture.moment.world_from_sensor;
        (!marks.is_empty()).then(|| Smoothing::new(view, &self.config.optics, self.sight(), pose, marks))
    }

    /// Rays that a [`Workspace`] must have room for.
    pub fn rays(&self) -> usize {
        self.config.optics.rays()
    }

    /// Housings are seen from outside only: a camera within its own sees out.
    pub(crate) fn sight(&self) -> Sight {
        Sight { faces: Faces::Front, range: [self.config.near_m, self.config.far_m] }
    }

    /// Marks the pixels of a tile as they are shaded, if marks are kept.
    #[inline(always)]
    pub(crate) fn mark<S: Simd>(
        &self,
        simd: S,
        marks: &mut Marks<'_>,
        shader: &Shader,
        tile: &Tile,
        colours: &Colours,
        place: [usize; 2],
    ) {
        marks.put(simd, colours, self.config.exposure, shader, tile.missing, place);
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
            Stream { seed: self.config.seed, sensor: self.config.sensor, frame, channel: Stream::COLOUR };
        pixel::add_noise(colours, &self.config.noise, self.bias, &normals64(&stream, 4 * tile));
    }
}

/// Paints the tiles of a picture.
struct Painter<'a> {
    camera: &'a Camera<'a>,
    capture: &'a Capture<'a>,
}

impl BandWork<Rows<'_>> for Painter<'_> {
    #[inline(always)]
    fn finish<S: Simd>(&self, simd: S, band: &Band<'_>, output: Rows<'_>) {
        let Self { camera, capture } = self;
        let rays = CameraRays::new(&band.rays, &capture.moment.world_from_sensor);
        let mut resolver = Resolver::new(band.view);
        let mut tile = Tile::new();
        let Rows { picture, mut marks } = output;
        let mut shader = marks.shader();
        let mut colours = [[0.0; LANES]; 3];
        let tiles = camera.tiles()[0];
        let stride = camera.row_stride();
        let lines = picture.pixels.chunks_mut(picture.bytes);
        for (row_in_band, (row, pixels)) in band.block_rows().zip(lines).enumerate() {
            for column in 0..tiles {
                tile.take(simd, band, &mut resolver, &rays, [column, row]);
                shader.shade(simd, band.view, &tile, &rays.steps, &mut colours);
                camera.mark(simd, &mut marks, &shader, &tile, &colours, [column, row_in_band]);
                camera.expose(capture.frame, (row * tiles + column) as u32, &mut colours);
                blacken(&mut colours, tile.missing);
                pixel::write_tile(simd, &colours, camera.config.format, column * TILE_WIDTH, pixels, stride);
            }
        }
    }
}

/// Where there is no ray, a pixel is black.
#[inline(always)]
pub(crate) fn blacken(colours: &mut Colours, missing: u64) {
    if missing == 0 {
        return;
    }
    for channel in colours {
        for lane in 0..LANES {
            channel[lane] = if missing >> lane & 1 != 0 { 0.0 } else { channel[lane] };
        }
    }
}

/// A picture and its marks, cut between rows of tiles.
struct Rows<'a> {
    picture: Picture<'a>,
    marks: Marks<'a>,
}

impl SplitRows for Rows<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        let (picture, lower) = self.picture.split_rows(rows);
        let (marks, lower_marks) = self.marks.split_rows(rows);
        (Self { picture, marks }, Self { picture: lower, marks: lower_marks })
    }
}

/// Rows of pixels, cut between rows of tiles.
struct Picture<'a> {
    pixels: &'a mut [u8],
    /// Bytes of a row of tiles.
    bytes: usize,
}

impl SplitRows for Picture<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        let (upper, lower) = self.pixels.split_at_mut(rows * self.bytes);
        (Self { pixels: upper, bytes: self.bytes }, Self { pixels: lower, bytes: self.bytes })
    }
}

/// A picture whose edges are painted over.
struct Retouched<'a> {
    camera: &'a Camera<'a>,
    frame: u64,
    picture: Picture<'a>,
}

impl SplitRows for Retouched<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        let Self { camera, frame, picture } = self;
        let (picture, lower) = picture.split_rows(rows);
        (Self { camera, frame, picture }, Self { camera, frame, picture: lower })
    }
}

impl Canvas for Retouched<'_> {
    #[inline(always)]
    fn paint<S: Simd>(
        &mut self,
        simd: S,
        [column, row]: [usize; 2],
        row_in_part: usize,
        lanes: u64,
        colours: &mut Colours,
    ) {
        let Self { camera, frame, picture } = self;
        camera.expose(*frame, (row * camera.tiles()[0] + column) as u32, colours);
        let rows = &mut picture.pixels[row_in_part * picture.bytes..];
        let format = camera.config.format;
        pixel::write_lanes(simd, (colours, lanes), format, column * TILE_WIDTH, rows, camera.row_stride());
    }
}
