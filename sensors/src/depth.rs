//! Depth cameras: depth along the optical axis, the colour picture that belongs to it, and the cloud of points.

use crate::camera::{Camera, CameraConfig, CameraError, blacken};
use crate::edges::{Canvas, Marks};
use crate::execution::SplitRows;
use crate::memory::Cutter;
use crate::moment::Capture;
use crate::noise::{GaussianNoise, Stream, normals64};
use crate::optics::rays::Rays;
use crate::pixel::{self, to_byte};
use crate::scene::{Scene, visibility};
use crate::shade::Colours;
use crate::simd::{LANES, Lanes};
pub use crate::trace::TooNear;
use crate::trace::Workspace;
use crate::trace::grid::{Band, BandWork, Sight, trace_grid};
use crate::trace::image::NO_HIT;
use crate::trace::measure::Measure;
use crate::trace::resolve::Resolver;
use crate::trace::tile::{CameraRays, TILE_HEIGHT, TILE_WIDTH, Tile};
use crate::trace::view::View;
use fearless_simd::Simd;

/// Bytes of a point of the cloud: x 0, y 4, z 8, rgb 16, all f32, as `gazebo_ros_openni_kinect` lays it out.
pub const POINT_STEP: usize = 32;

/// What a depth camera is like.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct DepthCameraConfig<'a> {
    /// Geometry, clip distances, and the colour picture.
    pub camera: CameraConfig<'a>,
    /// Depth at or below is too near, in metres.
    pub min_depth_m: f64,
    /// Depth at or above is too far, in metres; may be infinite.
    pub max_depth_m: f64,
    /// What stands for too near and too far.
    pub out_of_range: OutOfRange,
    /// What happens to depths nearer than the camera's `near_m`. The colour picture does not show what is there in
    /// either case, as that of a [`Camera`].
    pub too_near: TooNear,
    /// Noise of a depth in metres; what it takes to the limits or beyond is too near or too far.
    pub noise: GaussianNoise,
}

impl<'a> DepthCameraConfig<'a> {
    /// A depth camera without noise, whose depths are limited by the clip distances alone.
    pub fn new(camera: CameraConfig<'a>) -> Self {
        Self {
            camera,
            min_depth_m: 0.0,
            max_depth_m: f64::INFINITY,
            out_of_range: OutOfRange::Infinite,
            too_near: TooNear::Blocks,
            noise: GaussianNoise::NONE,
        }
    }

    setters! {
        /// Sets the camera.
        camera: CameraConfig<'a>,
        /// Sets the depth at and below which is too near, in metres.
        min_depth_m: f64,
        /// Sets the depth at and above which is too far, in metres.
        max_depth_m: f64,
        /// Sets what stands for too near and too far.
        out_of_range: OutOfRange,
        /// Sets what happens to depths nearer than the camera's `near_m`.
        too_near: TooNear,
        /// Sets the noise of a depth in metres.
        noise: GaussianNoise,
    }
}

/// What a 32FC1 depth outside the valid range becomes. In 16UC1 it is 0 in any case, and in the cloud NaN.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutOfRange {
    /// REP-117: too near is −∞, too far or nothing there +∞.
    Infinite,
    /// As Gazebo's Kinect plugin: NaN.
    Nan,
}

/// Where the parts of a depth frame go; what is none is not worked out. Rows run from the top, not padded.
#[derive(Debug, Default)]
pub struct DepthFrame<'a> {
    /// Depth in metres (32FC1), one per pixel.
    pub depth_32fc1: Option<&'a mut [f32]>,
    /// Depth in millimetres (16UC1), one per pixel; 0 where invalid.
    pub depth_16uc1: Option<&'a mut [u16]>,
    /// Colours in the format of the camera, [`Camera::frame_len`] bytes.
    pub colour: Option<&'a mut [u8]>,
    /// Points in the optical frame, [`POINT_STEP`] bytes per pixel.
    pub points: Option<&'a mut [u8]>,
}

impl DepthFrame<'_> {
    fn lend(&mut self) -> DepthFrame<'_> {
        DepthFrame {
            depth_32fc1: self.depth_32fc1.as_deref_mut(),
            depth_16uc1: self.depth_16uc1.as_deref_mut(),
            colour: self.colour.as_deref_mut(),
            points: self.points.as_deref_mut(),
        }
    }
}

/// A checked depth camera; it looks along +x of its frame like a [`Camera`].
#[derive(Debug, Clone, Copy)]
pub struct DepthCamera<'a> {
    config: DepthCameraConfig<'a>,
    camera: Camera<'a>,
    bias: f32,
}

impl<'a> DepthCamera<'a> {
    /// Checks the configuration.
    ///
    /// # Errors
    /// A [`CameraError`] that names the value out of range.
    pub fn new(config: DepthCameraConfig<'a>) -> Result<Self, CameraError> {
        let (min_m, max_m) = (config.min_depth_m, config.max_depth_m);
        if !(min_m >= 0.0 && min_m < max_m) {
            return Err(CameraError::Cutoff { min_m, max_m });
        }
        let camera = Camera::new(config.camera)?;
        Ok(Self { config, camera, bias: config.noise.bias(config.camera.seed, config.camera.sensor, 1) })
    }

    /// What it was made from.
    pub fn config(&self) -> &DepthCameraConfig<'a> {
        &self.config
    }

    /// The colour camera in the same place, pixel for pixel.
    pub fn camera(&self) -> &Camera<'a> {
        &self.camera
    }

    /// Pixels of a frame.
    pub fn pixels(&self) -> usize {
        self.camera.size().into_iter().product()
    }

    /// Takes a frame.
    ///
    /// # Panics
    /// When a buffer is not exactly as long as a frame needs, the workspace does not fit the scene, or the
    /// moment does not have one pose for each instance.
    pub fn sense(
        &self,
        scene: &Scene<'_>,
        capture: &Capture<'_>,
        workspace: &mut Workspace<'_>,
        mut output: DepthFrame<'_>,
    ) {
        let pixels = self.pixels();
        let check = |length: Option<usize>, expected: usize| {
            assert!(length.is_none_or(|length| length == expected), "a buffer must hold exactly one frame");
        };
        check(output.depth_32fc1.as_ref().map(|depth| depth.len()), pixels);
        check(output.depth_16uc1.as_ref().map(|depth| depth.len()), pixels);
        check(output.colour.as_ref().map(|colour| colour.len()), self.camera.frame_len());
        check(output.points.as_ref().map(|points| points.len()), pixels * POINT_STEP);

        let execution = workspace.execution;
        let mut memory = workspace.cut(scene, self.rays());
        let instances = scene.instances().len();
        let view = View::new(scene, &capture.moment, visibility::VISUAL, memory.view(instances));
        let (optics, sight) = (&self.config.camera.optics, self.camera.sight());
        let wants_depth =
            output.depth_32fc1.is_some() || output.depth_16uc1.is_some() || output.points.is_some();
        let blocks = self.config.too_near == TooNear::Blocks;
        let reach = sight.range[0] * optics.longest_direction();
        let blocked: &mut [u16] = if wants_depth && blocks && view.may_be_within(reach) {
            let fan = optics.fan();
            let across = fan.blocks_across();
            let blocked = memory.take(across * fan.blocks_down());
            let near = Sight { range: [0.0, sight.range[0]], ..sight };
            let lanes = Blocked { lanes: &mut *blocked, across };
            trace_grid(&view, optics, &near, execution, &mut Cutter(&mut *memory.0), lanes, &Blocking);
            blocked
        } else {
            &mut []
        };
        let wants_colour = output.colour.is_some() || output.points.is_some();
        let marks = if wants_colour { self.camera.marks(&mut memory) } else { &mut [] };
        let (width, colour_stride) = (self.camera.size()[0], self.camera.row_stride());
        let parts = Parts { output: output.lend(), width, colour_stride };
        let rows = Rows { parts, marks: Marks::new(marks, width) };
        let measurer = Measurer { camera: self, capture, blocked };
        trace_grid(&view, optics, &sight, execution, &mut memory, rows, &measurer);
        if let Some(smoothing) = self.camera.smoothing(&view, capture, marks) {
            let parts = Parts { output, width, colour_stride };
            smoothing.paint(execution, Retouched { camera: &self.camera, frame: capture.frame, parts });
        }
    }

    /// Rays that a [`Workspace`] must have room for.
    pub fn rays(&self) -> usize {
        self.camera.rays()
    }

    /// Measured depths in metres: REP-117 values where there is none. What noise takes out of the valid range is out of
    /// it, as what was there before.
    #[inline(always)]
    fn depths(&self, truth: &Lanes<f32>, frame: u64, tile: u32) -> Lanes<f32> {
        let config = &self.config;
        let mut noisy = *truth;
        if !config.noise.is_none() {
            let CameraConfig { seed, sensor, .. } = config.camera;
            let normals = normals64(&Stream { seed, sensor, frame, channel: Stream::DEPTH }, 4 * tile);
            config.noise.apply_all(&mut noisy, self.bias, &normals);
        }
        let (min, max) = (config.min_depth_m as f32, config.max_depth_m as f32);
        let mut depths = [0.0; LANES];
        for lane in 0..LANES {
            let (truth, noisy) = (truth[lane], noisy[lane]);
            let measured = if noisy <= min { f32::NEG_INFINITY } else { noisy };
            let measured = if noisy >= max { f32::INFINITY } else { measured };
            let near = if truth <= min { f32::NEG_INFINITY } else { measured };
            depths[lane] = if truth >= max { f32::INFINITY } else { near };
        }
        depths
    }

    #[inline(always)]
    fn write_tile<S: Simd>(
        &self,
        simd: S,
        depths: &Lanes<f32>,
        colours: &Colours,
        rays: &Rays<'_>,
        [column, row]: [usize; 2],
        output: &mut DepthFrame<'_>,
    ) {
        let width = self.camera.size()[0];
        let first = column * TILE_WIDTH;
        let tile_rows = || depths.as_chunks::<TILE_WIDTH>().0.iter();
        if let Some(depth) = &mut output.depth_32fc1 {
            let nan = self.config.out_of_range == OutOfRange::Nan;
            for (line, depths) in depth.chunks_mut(width).zip(tile_rows()) {
                let across = TILE_WIDTH.min(line.len() - first);
                let line = &mut line[first..first + across];
                match <&mut [f32; TILE_WIDTH]>::try_from(&mut *line) {
                    Ok(line) => *line = *depths,
                    Err(_) => line.copy_from_slice(&depths[..across]),
                }
                if nan {
                    for depth in line {
                        *depth = if depth.is_finite() { *depth } else { f32::NAN };
                    }
                }
            }
        }
        if let Some(depth) = &mut output.depth_16uc1 {
            for (line, depths) in depth.chunks_mut(width).zip(tile_rows()) {
                for (pixel, &depth) in line[first..].iter_mut().zip(depths) {
                    let millimetres = depth * 1000.0 + 0.5;
                    *pixel = if (1.0..65536.0).contains(&millimetres) { millimetres as u16 } else { 0 };
                }
            }
        }
        if let Some(colour) = &mut output.colour {
            pixel::write_tile(
                simd,
                colours,
                self.config.camera.format,
                first,
                colour,
                self.camera.row_stride(),
            );
        }
        if let Some(points) = &mut output.points {
            let lines = points.chunks_mut(width * POINT_STEP);
            for (y, (line, depths)) in lines.zip(tile_rows()).enumerate() {
                for (x, point) in
                    line[first * POINT_STEP..].chunks_exact_mut(POINT_STEP).take(TILE_WIDTH).enumerate()
                {
                    let ray = rays.direction((first + x) as i32, (row * TILE_HEIGHT + y) as i32);
                    let colour = [0, 1, 2].map(|channel| colours[channel][y * TILE_WIDTH + x]);
                    let slopes = [((0.0 - ray.y) / ray.x) as f32, ((0.0 - ray.z) / ray.x) as f32];
                    write_point(point, slopes, depths[x], colour);
                }
            }
        }
    }
}

/// From where on a point has its colour.
const POINT_RGB: usize = 16;

/// The colour of a point.
#[inline(always)]
fn rgb(colour: [f32; 3]) -> [u8; 4] {
    let [red, green, blue] = colour.map(to_byte);
    [blue, green, red, 0]
}

#[inline(always)]
fn write_point(point: &mut [u8], [right, down]: [f32; 2], depth: f32, colour: [f32; 3]) {
    let xyz = if depth.is_finite() { [right * depth, down * depth, depth] } else { [f32::NAN; 3] };
    let [x, y, z] = xyz.map(f32::to_bits);
    let words = [x, y, z, 0, u32::from_le_bytes(rgb(colour)), 0, 0, 0];
    for (bytes, word) in point.as_chunks_mut::<4>().0.iter_mut().zip(words) {
        *bytes = word.to_le_bytes();
    }
}

/// Measures the tiles of a frame.
struct Measurer<'a> {
    camera: &'a DepthCamera<'a>,
    capture: &'a Capture<'a>,
    /// The lanes of each block that something too near is in the way of; empty if nothing is.
    blocked: &'a [u16],
}

impl Measurer<'_> {
    /// Takes away the depths of a tile that something is in the way of.
    #[inline(always)]
    fn block(&self, truth: &mut Lanes<f32>, across: usize, [column, row]: [usize; 2]) {
        const PARTS: usize = TILE_WIDTH / 4;
        let first = column * PARTS;
        let Some(blocked) = self.blocked.get(row * across + first..row * across + across) else { return };
        for (part, &lanes) in blocked.iter().take(PARTS).enumerate() {
            let mut rest = lanes;
            while rest != 0 {
                let lane = rest.trailing_zeros() as usize;
                rest &= rest - 1;
                truth[lane / 4 * TILE_WIDTH + part * 4 + lane % 4] = f32::NEG_INFINITY;
            }
        }
    }
}

/// Finds out where something is too near.
struct Blocking;

impl BandWork<Blocked<'_>> for Blocking {
    #[inline(always)]
    fn finish<S: Simd>(&self, _simd: S, band: &Band<'_>, blocked: Blocked<'_>) {
        for (lanes, slots) in blocked.lanes.iter_mut().zip(band.target.slot.iter()) {
            *lanes = 0;
            for (lane, &slot) in slots.iter().enumerate() {
                *lanes |= u16::from(slot != NO_HIT) << lane;
            }
        }
    }
}

/// A bit for each lane of each block, cut between rows of blocks.
struct Blocked<'a> {
    lanes: &'a mut [u16],
    across: usize,
}

impl SplitRows for Blocked<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        let (lanes, rest) = self.lanes.split_at_mut(rows * self.across);
        (Self { lanes, across: self.across }, Self { lanes: rest, across: self.across })
    }
}

impl BandWork<Rows<'_>> for Measurer<'_> {
    #[inline(always)]
    fn finish<S: Simd>(&self, simd: S, band: &Band<'_>, rows: Rows<'_>) {
        let Self { camera, capture, .. } = self;
        let rays = CameraRays::new(&band.rays, &capture.moment.world_from_sensor);
        let measure = Measure::new(&capture.moment.world_from_sensor);
        let wants_colour = rows.parts.output.colour.is_some() || rows.parts.output.points.is_some();
        let mut resolver = Resolver::new(band.view);
        let mut seen = Tile::new();
        let mut shader = rows.marks.shader();
        let mut colours = [[0.0; LANES]; 3];
        let tiles = camera.camera.tiles()[0];
        let mut rest = Some(rows);
        for row in band.block_rows() {
            let Some(rows) = rest.take() else { return };
            let last = row == *band.block_rows().end();
            let (mut rows, below) = if last { (rows, None) } else { split_first(rows) };
            rest = below;
            for column in 0..tiles {
                let tile = (row * tiles + column) as u32;
                if wants_colour {
                    seen.take(simd, band, &mut resolver, &rays, [column, row]);
                    shader.shade(simd, band.view, &seen, &rays.steps, &mut colours);
                    camera.camera.mark(simd, &mut rows.marks, &shader, &seen, &colours, [column, 0]);
                    camera.camera.expose(capture.frame, tile, &mut colours);
                    blacken(&mut colours, seen.missing);
                }
                let mut truth = measure.tile(simd, band, &mut resolver, [column, row]);
                self.block(&mut truth, band.rays.fan().blocks_across(), [column, row]);
                let depths = camera.depths(&truth, capture.frame, tile);
                camera.write_tile(simd, &depths, &colours, &band.rays, [column, row], &mut rows.parts.output);
            }
        }
    }
}

fn split_first(rows: Rows<'_>) -> (Rows<'_>, Option<Rows<'_>>) {
    let (first, rest) = rows.split_rows(1);
    (first, Some(rest))
}

/// The parts of a frame and the marks of its colours, cut between rows of tiles.
struct Rows<'a> {
    parts: Parts<'a>,
    marks: Marks<'a>,
}

impl SplitRows for Rows<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        let (parts, lower) = self.parts.split_rows(rows);
        let (marks, lower_marks) = self.marks.split_rows(rows);
        (Self { parts, marks }, Self { parts: lower, marks: lower_marks })
    }
}

/// The parts of a frame, cut between rows of tiles.
struct Parts<'a> {
    output: DepthFrame<'a>,
    width: usize,
    colour_stride: usize,
}

impl SplitRows for Parts<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        fn cut<T>(slice: Option<&mut [T]>, at: usize) -> (Option<&mut [T]>, Option<&mut [T]>) {
            slice.map(|slice| slice.split_at_mut(at)).unzip()
        }
        let pixels = rows * TILE_HEIGHT * self.width;
        let (depth_32fc1, lower_32fc1) = cut(self.output.depth_32fc1, pixels);
        let (depth_16uc1, lower_16uc1) = cut(self.output.depth_16uc1, pixels);
        let (colour, lower_colour) = cut(self.output.colour, rows * TILE_HEIGHT * self.colour_stride);
        let (points, lower_points) = cut(self.output.points, pixels * POINT_STEP);
        let with = |output| Self { output, width: self.width, colour_stride: self.colour_stride };
        (
            with(DepthFrame { depth_32fc1, depth_16uc1, colour, points }),
            with(DepthFrame {
                depth_32fc1: lower_32fc1,
                depth_16uc1: lower_16uc1,
                colour: lower_colour,
                points: lower_points,
            }),
        )
    }
}

/// A frame whose edges are painted over.
struct Retouched<'a> {
    camera: &'a Camera<'a>,
    frame: u64,
    parts: Parts<'a>,
}

impl SplitRows for Retouched<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        let Self { camera, frame, parts } = self;
        let (parts, lower) = parts.split_rows(rows);
        (Self { camera, frame, parts }, Self { camera, frame, parts: lower })
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
        let Self { camera, frame, parts } = self;
        camera.expose(*frame, (row * camera.tiles()[0] + column) as u32, colours);
        let first = row_in_part * TILE_HEIGHT;
        if let Some(colour) = &mut parts.output.colour {
            let (rows, stride) = (&mut colour[first * parts.colour_stride..], parts.colour_stride);
            let format = camera.config().format;
            pixel::write_lanes(simd, (colours, lanes), format, column * TILE_WIDTH, rows, stride);
        }
        if let Some(points) = &mut parts.output.points {
            let mut rest = lanes;
            while rest != 0 {
                let lane = rest.trailing_zeros() as usize % LANES;
                rest &= rest - 1;
                let pixel =
                    (first + lane / TILE_WIDTH) * parts.width + column * TILE_WIDTH + lane % TILE_WIDTH;
                let point = &mut points[pixel * POINT_STEP..(pixel + 1) * POINT_STEP];
                point[POINT_RGB..POINT_RGB + 4]
                    .copy_from_slice(&rgb([0, 1, 2].map(|channel| colours[channel][lane])));
            }
        }
    }
}
