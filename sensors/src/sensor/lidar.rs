//! Lidars with a regular grid of beams from one point, as in Gazebo. Lidars that fire beam by beam, as real products
//! do, are [`scanner`](crate::scanner)s.

mod config;
mod points;
mod turning;

use super::Sensor;
use crate::ParameterError;
use crate::execution::{SplitRows, split_at};
use crate::moment::{Capture, Shutter, Slice};
use crate::noise::{Stream, normals64};
use crate::optics::Optics;
use crate::optics::SphericalGrid;
use crate::scene::Scene;
use crate::simd::LANES;
pub use crate::trace::TooNear;
use crate::trace::error::check_output;
use crate::trace::grid::place::for_each_block;
use crate::trace::grid::{Band, BandWork, Frame, Sight, check_shutter};
use crate::trace::hit::measure::Measure;
use crate::trace::hit::resolve::{Resolver, hit_lanes};
use crate::trace::packet::specular::Glazing;
use crate::trace::truth::check_truth;
use crate::trace::{SenseError, Truth, Workspace};
pub use config::{Beams, LidarConfig, MAX_BEAMS, MAX_SAMPLES, Sweep};
use fearless_simd::{Simd, SimdBase, SimdMask, f32x16};

/// A lidar with a regular grid of beams from one point, as in Gazebo. Use it for that or for a simple range finder, and
/// a [`Scanner`](crate::scanner::Scanner) for a product. The configuration is checked when the lidar is created.
#[derive(Debug, Clone, Copy)]
pub struct Lidar {
    config: LidarConfig,
    bias: f32,
}

impl Lidar {
    /// Creates a lidar after checking its configuration.
    ///
    /// # Errors
    /// Returns a [`ParameterError`] that names the value out of range.
    pub fn new(config: LidarConfig) -> Result<Self, ParameterError> {
        config.check()?;
        Ok(Self { config, bias: config.noise.bias(config.seed, config.sensor, 0) })
    }

    /// Returns the configuration that the lidar was created with.
    pub fn config(&self) -> &LidarConfig {
        &self.config
    }

    /// Returns the number of beams of a scan.
    pub fn beams(&self) -> usize {
        self.config.horizontal.samples as usize * self.config.vertical.samples as usize
    }

    fn optics(&self) -> Optics<'static> {
        let (horizontal, vertical) = (&self.config.horizontal, &self.config.vertical);
        Optics::Spherical(SphericalGrid {
            columns: horizontal.samples,
            rows: vertical.samples,
            first_azimuth_rad: horizontal.min_angle_rad,
            azimuth_step_rad: horizontal.increment(),
            first_elevation_rad: vertical.min_angle_rad,
            elevation_step_rad: vertical.increment(),
        })
    }

    /// Checks that ground truth has a place for each beam and that the capture has the moments for its flow.
    fn check_truth(
        &self,
        truth: Option<&Truth<'_>>,
        scene: &Scene<'_>,
        capture: &Capture<'_>,
    ) -> Result<(), SenseError> {
        let turns = [Some(&capture.shutter), capture.before.as_ref(), capture.after.as_ref()]
            .into_iter()
            .flatten()
            .any(|shutter| self.slices_of_columns(shutter).is_some());
        if turns && truth.is_some_and(|truth| truth.flow.is_some() || truth.flow_back.is_some()) {
            return Err(SenseError::FlowOfColumns);
        }
        // Without flow, the other moments are not used.
        let capture = if turns { &Capture::new(capture.frame, capture.shutter) } else { capture };
        check_truth(truth, scene, &self.optics(), capture)
    }

    /// Returns which hits count.
    fn sight(&self) -> Sight {
        let nearest = match self.config.too_near {
            TooNear::Blocks => 0.0,
            TooNear::SeenThrough => self.config.range_min_m,
        };
        Sight { faces: self.config.faces, range: [nearest, self.config.range_max_m], within: f64::INFINITY }
    }

    /// Returns the slices if they are columns.
    fn slices_of_columns<'a>(&self, shutter: &Shutter<'a>) -> Option<&'a [Slice<'a>]> {
        match (self.config.sweep, *shutter) {
            (Sweep::Columns, Shutter::Slices(slices)) => Some(slices),
            (Sweep::Columns, Shutter::Global(_) | Shutter::Moving(_)) | (Sweep::Rows, _) => None,
        }
    }

    /// Converts the true ranges of whole scan lines to measured ones. `first_line` is the number of the first line.
    #[inline(always)]
    fn measure_lines<S: Simd>(&self, simd: S, frame: u64, first_line: usize, ranges: &mut [f32]) {
        let samples = self.config.horizontal.samples as usize;
        let blocks = samples.div_ceil(LANES);
        for (line, ranges) in ranges.chunks_mut(samples).enumerate() {
            for (block, ranges) in ranges.chunks_mut(LANES).enumerate() {
                self.measure(simd, frame, ((first_line + line) * blocks + block) as u32, ranges);
            }
        }
    }

    /// Converts the true ranges of up to 64 beams to measured ones. Noise is counted in blocks of 64 beams along each
    /// line.
    #[inline(always)]
    fn measure<S: Simd>(&self, simd: S, frame: u64, block: u32, ranges: &mut [f32]) {
        let config = &self.config;
        let mut normals = [0.0; LANES];
        if !config.noise.is_none() {
            let stream = Stream { seed: config.seed, sensor: config.sensor, frame, channel: Stream::RANGE };
            normals = normals64(simd, &stream, [4 * block, 4 * block + 1, 4 * block + 2, 4 * block + 3]);
        }
        let limits = [config.range_min_m, config.range_max_m].map(|limit| limit as f32);
        for (lane, range) in ranges.iter_mut().enumerate() {
            *range = config.noise.apply_to_range(*range, self.bias, normals[lane], limits);
        }
    }
}

/// The output buffers of a scan, in row-major order: scan lines from the first vertical angle on, and the beams of each
/// from the first horizontal angle on.
#[derive(Debug, Default)]
#[non_exhaustive]
pub struct Scan<'a> {
    /// Ranges along the beams in metres, one per beam; +∞ where nothing is in range, −∞ where something is too near
    /// (REP-117).
    pub ranges: Option<&'a mut [f32]>,
    /// The measured points in metres, in the frame of the sensor at the time of the beam, one per beam; NaN where there
    /// is no range.
    pub points: Option<&'a mut [[f32; 3]]>,
    /// The [`laser_retro`](crate::scene::InstanceConfig::laser_retro) of the surface that is hit, one per beam; 0 where
    /// there is no range.
    pub intensities: Option<&'a mut [f32]>,
    /// Ground truth for each beam.
    pub truth: Option<Truth<'a>>,
}

impl<'a> Scan<'a> {
    outputs! {
        /// Sets the buffer for ranges.
        ranges: &'a mut [f32],
        /// Sets the buffer for points.
        points: &'a mut [[f32; 3]],
        /// Sets the buffer for intensities.
        intensities: &'a mut [f32],
        /// Sets the buffers for ground truth.
        truth: Truth<'a>,
    }
}

impl Scan<'_> {
    /// Reborrows the buffers.
    fn reborrow(&mut self) -> Scan<'_> {
        Scan {
            ranges: self.ranges.as_deref_mut(),
            points: self.points.as_deref_mut(),
            intensities: self.intensities.as_deref_mut(),
            truth: self.truth.as_mut().map(Truth::reborrow),
        }
    }

    /// Splits off the parts of the first beams.
    fn split_at(self, beams: usize) -> (Self, Self) {
        let (ranges, ranges_rest) = split_at(self.ranges, beams);
        let (points, points_rest) = split_at(self.points, beams);
        let (intensities, intensities_rest) = split_at(self.intensities, beams);
        let (truth, truth_rest) = self.truth.map(|truth| truth.split_at(beams)).unzip();
        (
            Self { ranges, points, intensities, truth },
            Self {
                ranges: ranges_rest,
                points: points_rest,
                intensities: intensities_rest,
                truth: truth_rest,
            },
        )
    }
}

impl Sensor for Lidar {
    type Output<'a> = Scan<'a>;

    fn workspace_len(&self, scene: &Scene<'_>, capture: &Capture<'_>) -> usize {
        match self.slices_of_columns(&capture.shutter) {
            Some(slices) => turning::workspace_len(self, scene, slices),
            None => Frame::workspace_len(scene, &self.optics(), &capture.shutter),
        }
    }

    fn sense(
        &self,
        scene: &Scene<'_>,
        capture: &Capture<'_>,
        workspace: &mut Workspace<'_>,
        output: Scan<'_>,
    ) -> Result<(), SenseError> {
        check_output("ranges", output.ranges.as_ref().map(|ranges| ranges.len()), self.beams())?;
        check_output("points", output.points.as_ref().map(|points| points.len()), self.beams())?;
        check_output("intensities", output.intensities.as_ref().map(|values| values.len()), self.beams())?;
        self.check_truth(output.truth.as_ref(), scene, capture)?;
        let Scan { mut ranges, mut points, intensities, truth } = output;
        let held = match (&mut ranges, &mut points) {
            (Some(ranges), _) => Some(&mut **ranges),
            (None, Some(points)) => Some(points::room_for_ranges(points)),
            (None, None) => None,
        };
        self.trace(scene, capture, workspace, Scan { ranges: held, points: None, intensities, truth })?;
        if let Some(points) = points {
            points::fill(&self.config, ranges.as_deref(), points);
        }
        Ok(())
    }
}

impl Lidar {
    /// Takes a scan without points. The lengths of the outputs must have been checked.
    fn trace(
        &self,
        scene: &Scene<'_>,
        capture: &Capture<'_>,
        workspace: &mut Workspace<'_>,
        output: Scan<'_>,
    ) -> Result<(), SenseError> {
        let execution = workspace.execution;
        if let Some(slices) = self.slices_of_columns(&capture.shutter) {
            check_shutter(scene, &capture.shutter, self.config.horizontal.samples)?;
            let mut memory = workspace.cut(self.workspace_len(scene, capture))?;
            turning::sense(self, scene, (capture, slices), execution, &mut memory, output);
            return Ok(());
        }
        let mut memory = workspace.cut(self.workspace_len(scene, capture))?;
        let (optics, shutter) = (self.optics(), &capture.shutter);
        let frame = Frame::new(scene, &optics, shutter, self.config.visibility, execution, &mut memory)?;
        let sight = self.sight();
        let samples = self.config.horizontal.samples as usize;
        let lines = Lines { scan: output, samples, rows_in_block: 1 << frame.ray_grid().shift_y };
        frame.trace(&sight, &mut memory, lines, &LidarBeams { lidar: self, capture, sight, is_whole: true });
        Ok(())
    }
}

/// Measures the beams of a scan.
struct LidarBeams<'a> {
    lidar: &'a Lidar,
    capture: &'a Capture<'a>,
    sight: Sight,
    /// Whether the lines are complete, so that ranges get their noise here. Ranges of parts of lines remain exact.
    is_whole: bool,
}

impl BandWork<Lines<'_>> for LidarBeams<'_> {
    #[inline(always)]
    fn finish<S: Simd>(&self, simd: S, band: &Band<'_>, output: &mut Lines<'_>) {
        if let Some(truth) = &mut output.scan.truth {
            truth.write(simd, band, &self.sight, self.capture);
        }
        let measure = Measure::new(&band.view.world_from_sensor);
        let mut resolver = Resolver::new(band.view);
        let Lines { scan: Scan { ranges, intensities, .. }, samples, .. } = output;
        let config = &self.lidar.config;
        let (min, max) = (config.range_min_m as f32, config.range_max_m as f32);
        let glazing = Glazing::of(band.view);
        for_each_block(
            band,
            #[inline(always)]
            |place, block| {
                let mut truth = measure.block::<S, false>(simd, band, &mut resolver, block);
                let mut slots = &band.target.slot[place.block];
                let mut seen = None;
                if let Some(glazing) = glazing {
                    seen = glazing.look::<S, false>(simd, band, &mut resolver, &self.sight, block);
                }
                if let Some(seen) = &mut seen {
                    truth = seen.put_far(simd, truth);
                    slots = seen.put_slots(slots);
                }
                if let Some(ranges) = ranges.as_deref_mut() {
                    place.write_f32(simd, truth, ranges);
                }
                if let Some(intensities) = intensities.as_deref_mut() {
                    let in_range =
                        truth.simd_gt(f32x16::splat(simd, min)) & truth.simd_lt(f32x16::splat(simd, max));
                    let lanes = hit_lanes(simd, slots) & in_range.to_bitmask() as u16;
                    place.write_f32(simd, resolver.laser_retros(simd, slots, lanes), intensities);
                }
            },
        );
        if let (true, Some(ranges)) = (self.is_whole, ranges) {
            let [first, last] = band.rows.map(|row| row as usize);
            let from = first - band.first_row as usize;
            let ranges = &mut ranges[from * *samples..][..(last - first + 1) * *samples];
            self.lidar.measure_lines(simd, self.capture.frame, first, ranges);
        }
    }
}

/// Scan lines, split between rows of blocks.
struct Lines<'a> {
    scan: Scan<'a>,
    samples: usize,
    rows_in_block: usize,
}

impl SplitRows for Lines<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        let Self { samples, rows_in_block, .. } = self;
        let (scan, below) = self.scan.split_at(rows * rows_in_block * samples);
        (Self { scan, samples, rows_in_block }, Self { scan: below, samples, rows_in_block })
    }
}
