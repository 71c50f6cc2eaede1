//! Colour cameras with textures, lighting and shadows, and with Gazebo's pixel noise.

pub(super) mod brush;
mod config;
#[cfg(feature = "alloc")]
mod owned;

use super::Sensor;
pub use super::edges::Edges;
use super::edges::{Canvas, TILE_HEIGHT, smooth};
use super::pixel;
use crate::ParameterError;
use crate::device::{Device, Exposure, FrameStatistics, Metering, TileView, meter};
pub use crate::device::{Mosaic, PixelFormat};
use crate::execution::SplitRows;
use crate::memory::lines;
use crate::moment::{Capture, Shutter};
use crate::noise::{Stream, normals64};
use crate::optics::Optics;
use crate::scene::{ColourSpace, Scene};
use crate::shade::Colours;
use crate::simd::LANES;
use crate::trace::error::check_output;
use crate::trace::grid::{Band, BandWork, Frame, Sight};
use crate::trace::truth::check_truth;
use crate::trace::{SenseError, Truth, Workspace};
use brush::{Brush, ColourRows, sums_len};
pub use config::{CameraConfig, MAX_IMAGE_SIZE};
use fearless_simd::Simd;
#[cfg(feature = "alloc")]
pub use owned::CameraBuf;
#[cfg(feature = "alloc")]
pub(super) use owned::{lend_optics, own_optics};

/// A colour camera, with a checked configuration.
///
/// The camera looks along +x of its frame; right in the picture is −y and down is −z. Only front faces of surfaces are
/// visible, unless [`CameraConfig::faces`](CameraConfig#structfield.faces) says otherwise.
///
/// ```
/// use belvedere_sensors::{camera::*, optics::PinholeGrid, scene::*, trace::*, Capture, Pose, Sensor};
/// let mut builder = SceneBuilder::new();
/// let black = MaterialConfig { diffuse: [0.0; 3], ambient: [0.0; 3], ..Default::default() };
/// let red = builder.add_material(&MaterialConfig { emissive: [1.0, 0.0, 0.0], ..black })?;
/// builder.add_instance(&InstanceConfig {
///     shape: Shape::Sphere { radius: 0.5 },
///     world_from_instance: Pose::from_translation(belvedere_sensors::glam::DVec3::X * 2.0),
///     material: red,
///     ..Default::default()
/// })?;
/// let camera = Camera::new(CameraConfig::new(PinholeGrid::from_fov(64, 48, 1.0)?))?;
/// let mut pixels = vec![0; camera.frame_len()];
/// let mut workspace = WorkspaceBuf::default();
/// let capture = Capture::new(0, builder.moment(Pose::IDENTITY));
/// let scene = builder.scene();
/// camera.sense_in(&mut workspace, &scene, &capture, Picture::new().colour(&mut pixels))?;
/// let middle = 24 * camera.row_stride() + 32 * 3;
/// assert_eq!(pixels[middle..middle + 3], [255, 0, 0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Camera<'a> {
    config: CameraConfig<'a>,
    bias: f32,
    device: Option<Device>,
}

impl<'a> Camera<'a> {
    /// Creates a camera after checking its configuration.
    ///
    /// # Errors
    /// Returns a [`ParameterError`] that names the value out of range.
    pub fn new(config: CameraConfig<'a>) -> Result<Self, ParameterError> {
        CameraConfig::check_size(config.optics.asked_size())?;
        config.optics.check()?;
        let (near_m, far_m) = (config.near_m, config.far_m);
        let in_order = near_m > 0.0 && near_m < far_m;
        let rule = "more than 0 and less than far_m";
        ParameterError::require("camera", "near_m", near_m, in_order, rule)?;
        let is_factor = config.exposure.is_finite() && config.exposure >= 0.0;
        let rule = "a finite number, 0 or more";
        ParameterError::require_f32("camera", "exposure", config.exposure, is_factor, rule)?;
        Ok(Self {
            config,
            bias: config.noise.bias(config.seed, config.sensor, 0),
            device: config.device.as_ref().map(Device::new).transpose()?,
        })
    }

    /// Sets exposure time and gain of the device from the next frame on, as automatic exposure does between two frames.
    /// A camera without a device is not changed.
    ///
    /// # Errors
    /// Returns a [`ParameterError`] if one of them is out of range; the camera is not changed in that case.
    pub fn set_device_exposure(&mut self, exposure: Exposure) -> Result<(), ParameterError> {
        if let Some(config) = self.config.device {
            let config = config.exposure(exposure);
            self.device = Some(Device::new(&config)?);
            self.config.device = Some(config);
        }
        Ok(())
    }

    /// Measures the brightness of a picture of this camera, for [`AutoExposure`](crate::device::AutoExposure).
    ///
    /// The pixel values are converted back to linear light. Two of every eight rows are sampled.
    ///
    /// # Errors
    /// Fails if `picture` is not [`Camera::frame_len`] bytes long.
    pub fn meter(&self, picture: &[u8], metering: Metering) -> Result<FrameStatistics, SenseError> {
        check_output("picture", Some(picture.len()), self.frame_len())?;
        let CameraConfig { format, device, .. } = &self.config;
        Ok(meter(picture, self.size(), *format, device.as_ref(), metering))
    }

    /// Returns the same camera with other optics, which must have been checked.
    #[cfg(feature = "alloc")]
    pub(super) fn with_optics<'b>(&self, optics: &Optics<'b>) -> Camera<'b> {
        Camera { config: self.config.with_optics(optics), bias: self.bias, device: self.device }
    }

    /// Returns the configuration that the camera was created with.
    pub fn config(&self) -> &CameraConfig<'a> {
        &self.config
    }

    /// Returns the width and height of the picture in pixels.
    pub fn size(&self) -> [usize; 2] {
        self.config.optics.size()
    }

    /// Returns the number of bytes from one row to the next. Rows are not padded.
    pub fn row_stride(&self) -> usize {
        self.size()[0] * self.config.format.bytes()
    }

    /// Returns the number of bytes of a picture.
    pub fn frame_len(&self) -> usize {
        self.row_stride() * self.size()[1]
    }

    /// Returns which hits count. With back-face culling, the inside of a housing is invisible: a camera sees out of its
    /// own.
    pub(crate) fn sight(&self) -> Sight {
        Sight {
            faces: self.config.faces,
            range: [self.config.near_m, self.config.far_m],
            within: f64::INFINITY,
        }
    }

    /// Returns the number of marks of a picture: one per pixel if edges are smoothed, otherwise 0.
    pub(super) fn marks(&self, shutter: &Shutter<'_>) -> usize {
        let [width, height] = self.size();
        let kept = self.config.edges == Edges::Smooth
            && matches!(shutter, Shutter::Global(_))
            && !matches!(self.config.optics, Optics::Spherical(_));
        if kept { width * height } else { 0 }
    }

    /// Returns the largest value of the 16-bit formats.
    pub(super) fn full_scale(&self) -> f32 {
        self.device.map_or(65_535.0, |device| device.full_scale())
    }

    /// Applies exposure, then the device or the sRGB curve, then noise to a tile. Pixels without a ray (`missing`)
    /// receive no light: they are black, or show the dark signal of the device.
    #[inline(always)]
    pub(super) fn expose<S: Simd>(
        &self,
        simd: S,
        (frame, space): (u64, ColourSpace),
        view: &TileView<'_>,
        missing: u64,
        colours: &mut Colours,
    ) {
        let CameraConfig { seed, sensor, exposure, ref noise, format, .. } = self.config;
        if exposure != 1.0 {
            pixel::expose(colours, exposure);
        }
        if let Some(device) = &self.device {
            blacken(colours, missing);
            let stream = Stream { seed, sensor, frame, channel: 0 };
            device.expose(simd, format.planes(), &stream, view, colours);
        } else if space == ColourSpace::Srgb {
            pixel::encode(colours);
        }
        if !noise.is_none() {
            let stream = Stream { seed, sensor, frame, channel: Stream::COLOUR };
            let normals = normals64(simd, &stream, view.samples);
            pixel::add_noise(colours, noise, self.bias, &normals);
        }
        if self.device.is_none() {
            blacken(colours, missing);
        }
    }
}

/// Makes pixels without a ray black.
#[inline(always)]
fn blacken(colours: &mut Colours, missing: u64) {
    if missing == 0 {
        return;
    }
    for channel in colours {
        for lane in 0..LANES {
            channel[lane] = if missing >> lane & 1 != 0 { 0.0 } else { channel[lane] };
        }
    }
}

/// The output buffers of a picture. Rows run from top to bottom without padding.
#[derive(Debug, Default)]
#[non_exhaustive]
pub struct Picture<'a> {
    /// The colours in the pixel format of the camera, [`Camera::frame_len`] bytes.
    pub colour: Option<&'a mut [u8]>,
    /// Ground truth for each pixel.
    pub truth: Option<Truth<'a>>,
}

impl<'a> Picture<'a> {
    outputs! {
        /// Sets the buffer for colours.
        colour: &'a mut [u8],
        /// Sets the buffers for ground truth.
        truth: Truth<'a>,
    }
}

impl Sensor for Camera<'_> {
    type Output<'a> = Picture<'a>;

    fn workspace_len(&self, scene: &Scene<'_>, capture: &Capture<'_>) -> usize {
        let (optics, shutter) = (&self.config.optics, &capture.shutter);
        let marks = lines(self.marks(shutter) * size_of::<u32>());
        Frame::workspace_len(scene, optics, shutter)
            + sums_len(&Frame::ray_grid_of(optics, shutter), shutter)
            + marks
    }

    fn sense(
        &self,
        scene: &Scene<'_>,
        capture: &Capture<'_>,
        workspace: &mut Workspace<'_>,
        output: Picture<'_>,
    ) -> Result<(), SenseError> {
        check_output("colour", output.colour.as_ref().map(|colour| colour.len()), self.frame_len())?;
        check_truth(output.truth.as_ref(), scene, &self.config.optics, capture)?;
        let execution = workspace.execution;
        let mut memory = workspace.cut(self.workspace_len(scene, capture))?;
        let optics = &self.config.optics;
        let sees = self.config.visibility;
        let frame = Frame::new(scene, optics, &capture.shutter, sees, execution, &mut memory)?;
        let Picture { mut colour, truth } = output;
        let marks = memory.take(self.marks(&capture.shutter));
        let drawn = (colour.as_deref_mut(), &mut *marks);
        let rows = PictureRows {
            wants_colour: drawn.0.is_some(),
            colour: ColourRows::new(self, frame.ray_grid(), &capture.shutter, drawn, &mut memory),
            truth,
            rays_in_row: frame.rays_in_row(),
        };
        frame.trace(&self.sight(), &mut memory, rows, &Painter { camera: self, capture });
        if let Some(pixels) = colour {
            let canvas =
                RetouchedPicture { camera: self, frame: capture.frame, space: scene.colour_space(), pixels };
            smooth((&frame, optics), self.sight(), marks, execution, canvas);
        }
        Ok(())
    }
}

/// Paints the tiles of a picture.
struct Painter<'a> {
    camera: &'a Camera<'a>,
    capture: &'a Capture<'a>,
}

impl BandWork<PictureRows<'_>> for Painter<'_> {
    #[inline(always)]
    fn finish<S: Simd>(&self, simd: S, band: &Band<'_>, output: &mut PictureRows<'_>) {
        if let Some(truth) = &mut output.truth {
            truth.write(simd, band, &self.camera.sight(), self.capture);
        }
        if !output.wants_colour {
            return;
        }
        let output = &mut output.colour;
        let mut brush = Brush::new(self.camera, self.capture, band);
        brush.set_shader();
        for row in band.block_rows() {
            for column in 0..brush.tiles {
                let tile = [column, row];
                brush.see(simd, band, tile);
                brush.mark(simd, band, tile, output);
                if brush.take_mean(band, tile, output) {
                    brush.expose(simd, tile);
                    brush.write(simd, band, tile, output);
                }
            }
        }
    }

    fn is_mean(&self) -> bool {
        true
    }
}

/// The outputs of a picture, split between rows of blocks.
struct PictureRows<'a> {
    wants_colour: bool,
    colour: ColourRows<'a>,
    truth: Option<Truth<'a>>,
    rays_in_row: usize,
}

impl SplitRows for PictureRows<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        let Self { wants_colour, rays_in_row, .. } = self;
        let (colour, colour_below) = self.colour.split_rows(rows);
        let (truth, truth_below) = self.truth.map(|truth| truth.split_at(rows * rays_in_row)).unzip();
        (
            Self { wants_colour, colour, truth, rays_in_row },
            Self { wants_colour, colour: colour_below, truth: truth_below, rays_in_row },
        )
    }
}

/// The rest of a picture from some row of tiles on, whose edges are painted over.
struct RetouchedPicture<'a> {
    camera: &'a Camera<'a>,
    frame: u64,
    space: ColourSpace,
    pixels: &'a mut [u8],
}

impl SplitRows for RetouchedPicture<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        let Self { camera, frame, space, pixels } = self;
        let (pixels, below) = pixels.split_at_mut(rows * TILE_HEIGHT * camera.row_stride());
        (Self { camera, frame, space, pixels }, Self { camera, frame, space, pixels: below })
    }
}

impl Canvas for RetouchedPicture<'_> {
    #[inline(always)]
    fn paint<S: Simd>(
        &mut self,
        simd: S,
        view: &TileView<'_>,
        [column, row]: [usize; 2],
        lanes: u64,
        colours: &mut Colours,
    ) {
        let Self { camera, frame, space, pixels } = self;
        camera.expose(simd, (*frame, *space), view, 0, colours);
        let (format, stride) = ((camera.config.format, camera.full_scale()), camera.row_stride());
        let rows = &mut pixels[row * TILE_HEIGHT * stride..];
        pixel::write_lanes(simd, (colours, lanes), format, column, rows, stride);
    }
}
