//! Depth cameras: depth along the optical axis, the registered colour picture, and the point cloud. What a device makes
//! of true depths is a [`depth_model`](crate::device::depth_model).

mod borders;
mod config;
mod contrast;
mod develop;
mod device_input;
mod look;
#[cfg(feature = "alloc")]
mod owned;
mod pattern;
mod rows;
mod surface;
mod too_near;

use super::Sensor;
use super::camera::brush::{Brush, ColourRows, sums_len};
use super::camera::{Camera, CameraConfig};
use super::edges::smooth;
pub use config::{DepthCameraConfig, OutOfRange};
use contrast::{Brightness, Contrast};
use develop::{Developer, Measured};
use device_input::DeviceInput;
use look::Looker;
#[cfg(feature = "alloc")]
pub use owned::DepthCameraBuf;
use pattern::DotPattern;
use rows::{DepthRows, RetouchedFrame};
use too_near::{Blocked, Blocking, Obstacles};

use crate::ParameterError;
use crate::device::depth_model::{DepthDevice, DepthNoise, Look};
use crate::memory::{Cutter, lines};
use crate::moment::Capture;
use crate::noise::{GaussianNoise, Stream, normal_columns, normal_lines};
#[cfg(feature = "alloc")]
use crate::optics::Optics;
use crate::scene::Scene;
pub use crate::trace::TooNear;
use crate::trace::error::check_output;
use crate::trace::grid::place::Place;
use crate::trace::grid::tiling::{BLOCKS, Tiling, lines_of};
use crate::trace::grid::{Band, BandWork, Frame, Sight, rays_of};
use crate::trace::hit::measure::Measure;
use crate::trace::hit::resolve::Resolver;
use crate::trace::packet::specular::Glazing;
use crate::trace::truth::check_truth;
use crate::trace::{SenseError, Truth, Workspace};
use fearless_simd::{Select, Simd, SimdBase, f32x16};

/// The number of bytes of a point of the cloud. The fields x, y, z and rgb are at offsets 0, 4, 8 and 16, all `f32`, as
/// `gazebo_ros_openni_kinect` lays them out.
pub const POINT_STEP: usize = 32;

/// The output buffers of a depth frame. Parts that are `None` are not computed. Rows run from top to bottom without
/// padding.
#[derive(Debug, Default)]
#[non_exhaustive]
pub struct DepthFrame<'a> {
    /// Depths in metres (32FC1), one per pixel.
    pub depth_32fc1: Option<&'a mut [f32]>,
    /// Depths in millimetres (16UC1), one per pixel; 0 where invalid.
    pub depth_16uc1: Option<&'a mut [u16]>,
    /// The colours in the pixel format of the camera, [`Camera::frame_len`] bytes.
    pub colour: Option<&'a mut [u8]>,
    /// The point cloud in the optical frame, [`POINT_STEP`] bytes per pixel. A point has the colour of the moment at
    /// which its depth is measured.
    pub points: Option<&'a mut [u8]>,
    /// The coordinates of the same points without colours, one per pixel, in metres; NaN where there is no depth.
    pub xyz: Option<&'a mut [[f32; 3]]>,
    /// Ground truth for each pixel.
    pub truth: Option<Truth<'a>>,
}

impl<'a> DepthFrame<'a> {
    outputs! {
        /// Sets the buffer for depths in metres.
        depth_32fc1: &'a mut [f32],
        /// Sets the buffer for depths in millimetres.
        depth_16uc1: &'a mut [u16],
        /// Sets the buffer for colours.
        colour: &'a mut [u8],
        /// Sets the buffer for the point cloud.
        points: &'a mut [u8],
        /// Sets the buffer for the coordinates of points.
        xyz: &'a mut [[f32; 3]],
        /// Sets the buffers for ground truth.
        truth: Truth<'a>,
    }
}

/// A depth camera, with a checked configuration.
///
/// Like a [`Camera`], it looks along +x of its frame. Both sides of surfaces are visible, unless
/// [`DepthCameraConfig::faces`](DepthCameraConfig#structfield.faces) says otherwise.
#[derive(Debug, Clone, Copy)]
pub struct DepthCamera<'a> {
    config: DepthCameraConfig<'a>,
    camera: Camera<'a>,
    /// Noise that is added while rays are traced, and its bias.
    noise: GaussianNoise,
    bias: f32,
    /// The device model, applied in a second pass over the frame.
    device: Option<DepthDevice>,
    /// Depths at or below the first limit are too near; those at or above the second are too far.
    limits: [f32; 2],
}

impl<'a> DepthCamera<'a> {
    /// Creates a depth camera after checking its configuration.
    ///
    /// # Errors
    /// Returns a [`ParameterError`] that names the value out of range.
    pub fn new(config: DepthCameraConfig<'a>) -> Result<Self, ParameterError> {
        let (min_m, max_m) = (config.min_depth_m, config.max_depth_m);
        let in_order = min_m >= 0.0 && min_m < max_m;
        let rule = "0 or more, and less than max_depth_m";
        ParameterError::require("depth camera", "min_depth_m", min_m, in_order, rule)?;
        let camera = Camera::new(config.camera.faces(config.faces))?;
        let noise = match config.model.noise {
            DepthNoise::Gaussian(noise) => noise,
            DepthNoise::Axial(_) | DepthNoise::Disparity(_) => GaussianNoise::NONE,
        };
        let bias = noise.bias(config.camera.seed, config.camera.sensor, 1);
        let device = DepthDevice::new(&config.model, bias)?;
        Ok(Self { config, camera, noise, bias, device, limits: [min_m as f32, max_m as f32] })
    }

    /// Returns the same camera with other optics, which must have been checked.
    #[cfg(feature = "alloc")]
    pub(super) fn with_optics<'b>(&self, optics: &Optics<'b>) -> DepthCamera<'b> {
        let Self { config, camera, noise, bias, device, limits } = self;
        DepthCamera {
            config: config.with_optics(optics),
            camera: camera.with_optics(optics),
            noise: *noise,
            bias: *bias,
            device: *device,
            limits: *limits,
        }
    }

    /// Returns the configuration that the camera was created with.
    pub fn config(&self) -> &DepthCameraConfig<'a> {
        &self.config
    }

    /// Returns the colour camera that is registered to the depths pixel by pixel. It sees the same sides of surfaces.
    pub fn camera(&self) -> &Camera<'a> {
        &self.camera
    }

    /// Returns the number of pixels of a frame.
    pub fn pixels(&self) -> usize {
        self.camera.size().into_iter().product()
    }

    /// Returns the random numbers for the depths of a tile, block by block.
    #[inline(always)]
    fn normals<S: Simd>(
        &self,
        simd: S,
        tiling: Tiling,
        frame: u64,
        samples: [u32; BLOCKS],
    ) -> [f32x16<S>; BLOCKS] {
        let CameraConfig { seed, sensor, .. } = self.config.camera;
        let stream = Stream { seed, sensor, frame, channel: Stream::DEPTH };
        match tiling {
            // The four samples of a line that lie in the same block lie in the same column.
            Tiling::Square => normal_columns(simd, &stream, samples),
            Tiling::Rows => normal_lines(simd, &stream, samples),
        }
    }

    /// Limits noisy depths, in metres, to the valid range; depths outside become REP-117 values. A depth is outside if
    /// either the true or the noisy value is.
    #[inline(always)]
    fn limited<S: Simd>(&self, simd: S, truth: f32x16<S>, noisy: f32x16<S>) -> f32x16<S> {
        let [min, max] = self.limits;
        let (near, far) = (f32x16::splat(simd, f32::NEG_INFINITY), f32x16::splat(simd, f32::INFINITY));
        let measured = noisy.min(truth).simd_le(min).select(near, noisy);
        noisy.max(truth).simd_ge(max).select(far, measured)
    }

    /// Returns measured depths with the out-of-range values that 32FC1 has.
    #[inline(always)]
    fn shown<S: Simd>(&self, simd: S, depths: f32x16<S>) -> f32x16<S> {
        match self.config.out_of_range {
            OutOfRange::Infinite => depths,
            OutOfRange::Nan => {
                let is_finite = depths.abs().simd_lt(f32x16::splat(simd, f32::INFINITY));
                is_finite.select(depths, f32x16::splat(simd, f32::NAN))
            }
        }
    }
}

impl Sensor for DepthCamera<'_> {
    type Output<'a> = DepthFrame<'a>;

    fn workspace_len(&self, scene: &Scene<'_>, capture: &Capture<'_>) -> usize {
        let (optics, shutter) = (&self.config.camera.optics, &capture.shutter);
        let ray_grid = Frame::ray_grid_of(optics, shutter);
        let marks = lines(self.camera.marks(shutter) * size_of::<u32>());
        let blocked = lines(ray_grid.blocks_across() * ray_grid.blocks_down() * size_of::<u16>());
        let seen = self.device.map_or(0, |device| {
            let pattern =
                matches!(device.look, Look::Dots(_)).then(|| DotPattern::workspace_len(self.camera.size()));
            let brightness = device.matcher.map(|_| Brightness::workspace_len(self.pixels()));
            DeviceInput::workspace_len(self.pixels()) + pattern.unwrap_or(0) + brightness.unwrap_or(0)
        });
        Frame::workspace_len(scene, optics, shutter) + sums_len(&ray_grid, shutter) + blocked + marks + seen
    }

    fn sense(
        &self,
        scene: &Scene<'_>,
        capture: &Capture<'_>,
        workspace: &mut Workspace<'_>,
        output: DepthFrame<'_>,
    ) -> Result<(), SenseError> {
        let DepthFrame { mut depth_32fc1, mut depth_16uc1, mut colour, mut points, mut xyz, truth } = output;
        let pixels = self.pixels();
        check_output("depth_32fc1", depth_32fc1.as_ref().map(|depth| depth.len()), pixels)?;
        check_output("depth_16uc1", depth_16uc1.as_ref().map(|depth| depth.len()), pixels)?;
        check_output("colour", colour.as_ref().map(|colour| colour.len()), self.camera.frame_len())?;
        check_output("points", points.as_ref().map(|points| points.len()), pixels * POINT_STEP)?;
        check_output("xyz", xyz.as_ref().map(|xyz| xyz.len()), pixels)?;
        check_truth(truth.as_ref(), scene, &self.config.camera.optics, capture)?;

        let execution = workspace.execution;
        let mut memory = workspace.cut(self.workspace_len(scene, capture))?;
        let (optics, shutter) = (&self.config.camera.optics, &capture.shutter);
        let sees = self.config.camera.visibility;
        let frame = Frame::new(scene, optics, shutter, sees, execution, &mut memory)?;
        let sight = self.camera.sight();
        let wants_depth = depth_32fc1.is_some() || depth_16uc1.is_some() || points.is_some() || xyz.is_some();
        let blocks = self.config.too_near == TooNear::Blocks;
        let within = sight.range[0] * optics.longest_direction();
        let blocked: &mut [u16] = if wants_depth && blocks && frame.may_be_within(within) {
            let across = frame.ray_grid().blocks_across();
            let blocked = memory.take(across * frame.ray_grid().blocks_down());
            let near = Sight { range: [0.0, sight.range[0]], within, ..sight };
            let lanes = Blocked { lanes: &mut *blocked, across };
            frame.trace(&near, &mut Cutter(&mut *memory.0), lanes, &Blocking);
            blocked
        } else {
            &mut []
        };
        let device = self.device.as_ref().filter(|_| wants_depth);
        let mut seen = device.map(|_| DeviceInput::new(pixels, &mut memory));
        let mut brightness =
            device.filter(|device| device.matcher.is_some()).map(|_| Brightness::new(pixels, &mut memory));
        let wants_colour = colour.is_some() || points.is_some();
        let marks = memory.take(if wants_colour { self.camera.marks(shutter) } else { 0 });
        let drawn = (colour.as_deref_mut(), &mut *marks);
        let rows = DepthRows {
            depth_32fc1: depth_32fc1.as_deref_mut(),
            depth_16uc1: depth_16uc1.as_deref_mut(),
            points: points.as_deref_mut(),
            xyz: xyz.as_deref_mut(),
            seen: seen.as_mut().map(DeviceInput::reborrow),
            brightness: brightness.as_mut().map(|Brightness(all)| Brightness(all)),
            truth,
            width: self.camera.size()[0],
            lines_in_tile: Tiling::of(frame.ray_grid()).size()[1],
            wants_colour: drawn.0.is_some(),
            colour: ColourRows::new(&self.camera, frame.ray_grid(), shutter, drawn, &mut memory),
        };
        let work = Measurer { camera: self, capture, obstacles: Obstacles(blocked) };
        frame.trace(&sight, &mut Cutter(&mut *memory.0), rows, &work);
        if let (Some(device), Some(DeviceInput(seen))) = (device, seen) {
            let CameraConfig { seed, sensor, .. } = self.config.camera;
            let rays = rays_of(optics, (*frame.ray_grid(), 0), execution, &mut memory);
            let numbers = Stream { seed, sensor, frame: capture.frame, channel: 0 };
            let looker = Looker::new(&rays, self.camera.size(), numbers, seen);
            let pattern = DotPattern::find(&looker, device, execution, &mut memory);
            let contrast = device.matcher.zip(brightness).map(|(matcher, Brightness(brightness))| Contrast {
                matcher,
                brightness,
                size: self.camera.size(),
            });
            let (points, width) = (points.as_deref_mut(), self.camera.size()[0]);
            let output = Measured { depth_32fc1, depth_16uc1, points, xyz, width };
            Developer { camera: self, device, looker, pattern, contrast }.develop(execution, output);
        }
        let (camera, space) = (&self.camera, scene.colour_space());
        let canvas = RetouchedFrame { camera, frame: capture.frame, space, colour, points };
        smooth((&frame, optics), sight, marks, execution, canvas);
        Ok(())
    }
}

/// Measures the tiles of a frame.
struct Measurer<'a> {
    camera: &'a DepthCamera<'a>,
    capture: &'a Capture<'a>,
    obstacles: Obstacles<'a>,
}

impl Measurer<'_> {
    /// Measures the depths of a tile and writes them, block by block.
    #[inline(always)]
    fn measure<S: Simd>(
        &self,
        simd: S,
        band: &Band<'_>,
        (measure, resolver, glazing): (&Measure, &mut Resolver<'_>, Option<Glazing>),
        [column, row]: [usize; 2],
        output: &mut DepthRows<'_>,
    ) -> [f32x16<S>; BLOCKS] {
        let ray_grid = band.rays.ray_grid();
        let (tiling, across, first) = (Tiling::of(ray_grid), ray_grid.blocks_across(), column * BLOCKS);
        let samples = tiling.samples(ray_grid.width as usize, [column, row]);
        let noise = &self.camera.noise;
        let has_noise = !noise.is_none();
        let mut normals = [f32x16::splat(simd, 0.0); BLOCKS];
        if has_noise {
            normals = self.camera.normals(simd, tiling, self.capture.frame, samples);
        }
        let mut place = Place::new(ray_grid, band, first, row);
        let mut blocks = [f32x16::splat(simd, f32::INFINITY); BLOCKS];
        for part in 0..BLOCKS.min(across - first) {
            let block = [first + part, row];
            let mut truth = measure.block::<S, true>(simd, band, resolver, block);
            if let Some(glazing) = glazing
                && let Some(seen) =
                    glazing.look::<S, true>(simd, band, resolver, &self.camera.camera.sight(), block)
            {
                truth = seen.put_far(simd, truth);
            }
            let truth = self.obstacles.hide(simd, row * across + first + part, truth);
            let mut noisy = truth;
            if has_noise {
                noisy = noise.apply_vector(simd, truth, self.camera.bias, normals[part]);
            }
            let depths = self.camera.limited(simd, truth, noisy);
            output.write_depths(simd, self.camera, depths, &place);
            place.step();
            blocks[part] = depths;
        }
        blocks
    }
}

impl BandWork<DepthRows<'_>> for Measurer<'_> {
    #[inline(always)]
    fn finish<S: Simd>(&self, simd: S, band: &Band<'_>, output: &mut DepthRows<'_>) {
        let Self { camera, capture, .. } = self;
        if let Some(truth) = &mut output.truth {
            truth.write(simd, band, &camera.camera.sight(), capture);
        }
        if let (Some(seen), Some(device)) = (&mut output.seen, &camera.device) {
            seen.write(simd, band, device, &camera.camera.sight(), self.obstacles);
        }
        self.write_tiles(simd, band, output);
    }

    fn is_mean(&self) -> bool {
        true
    }
}

impl Measurer<'_> {
    /// Writes depths and colours of a band. By itself, for the sake of the stack.
    #[inline(never)]
    fn write_tiles<S: Simd>(&self, simd: S, band: &Band<'_>, output: &mut DepthRows<'_>) {
        simd.vectorize(
            #[inline(always)]
            || self.write_each_tile(simd, band, output),
        );
    }

    #[inline(always)]
    fn write_each_tile<S: Simd>(&self, simd: S, band: &Band<'_>, output: &mut DepthRows<'_>) {
        let Self { camera, capture, .. } = self;
        let tiling = Tiling::of(band.rays.ray_grid());
        let mut brush = Brush::new(&camera.camera, capture, band);
        brush.set_shader();
        let glazing = Glazing::of(band.view).filter(|_| output.seen.is_none());
        let measure = Measure::new(&band.view.world_from_sensor);
        let mut resolver = Resolver::new(band.view);
        let is_measured = output.wants_measured();
        for row in band.block_rows() {
            // The depths of a line are those of its first slice.
            let is_first = (row * tiling.size()[1]) as i32 >= band.fresh_from;
            for column in 0..brush.tiles {
                let tile = [column, row];
                let wants_points = is_first && output.points.is_some();
                let wants_brightness = is_first && output.brightness.is_some();
                if output.wants_colour || wants_points || wants_brightness {
                    brush.see(simd, band, tile);
                }
                if output.wants_colour || wants_points {
                    brush.mark(simd, band, tile, &mut output.colour);
                }
                if wants_brightness {
                    output.write_brightness(&brush.colours, band, tile);
                }
                let mut is_exposed = false;
                if is_first {
                    let mut depths = [f32x16::splat(simd, f32::NAN); BLOCKS];
                    if is_measured {
                        let tools = (&measure, &mut resolver, glazing);
                        depths = self.measure(simd, band, tools, tile, output);
                    }
                    if output.wants_places() {
                        depths = lines_of(simd, tiling, depths);
                    }
                    if wants_points {
                        // Where light is averaged over moments, the points have the colours of the first one.
                        let light = (output.wants_colour && output.colour.sums()).then_some(brush.colours);
                        brush.expose(simd, tile);
                        output.write_points(simd, &depths, &brush.colours, band, tile);
                        is_exposed = light.is_none();
                        if let Some(light) = light {
                            brush.colours = light;
                        }
                    } else if is_measured && output.xyz.is_some() {
                        output.write_points(simd, &depths, &brush.colours, band, tile);
                    }
                }
                if output.wants_colour && brush.take_mean(band, tile, &mut output.colour) {
                    if !is_exposed {
                        brush.expose(simd, tile);
                    }
                    brush.write(simd, band, tile, &mut output.colour);
                }
            }
        }
    }
}
