//! Lidars with fixed beams: ranges and intensities, with Gazebo's range noise.

use crate::execution::SplitRows;
use crate::moment::Capture;
use crate::noise::{GaussianNoise, Stream, normals64};
use crate::optics::Optics;
use crate::optics::{MAX_GRID_SIZE, SphericalGrid};
use crate::scene::{Scene, visibility};
use crate::simd::LANES;
pub use crate::trace::TooNear;
use crate::trace::Workspace;
use crate::trace::grid::{Band, BandWork, Sight, trace_grid};
use crate::trace::image::NO_HIT;
use crate::trace::measure::Measure;
use crate::trace::packet::Faces;
use crate::trace::place::for_each_block;
use crate::trace::resolve::Resolver;
use crate::trace::view::View;
use fearless_simd::Simd;

/// Most beams of a lidar.
pub const MAX_BEAMS: u32 = 16_777_216;

/// Most beams of a scan line, and most scan lines.
pub const MAX_SAMPLES: u32 = MAX_GRID_SIZE;

/// Angles of the beams along one axis, first and last included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beams {
    /// How many, 1 … [`MAX_SAMPLES`].
    pub samples: u32,
    /// Angle of the first in radians.
    pub min_angle_rad: f64,
    /// Angle of the last in radians, not less than the first.
    pub max_angle_rad: f64,
}

impl Beams {
    /// A single beam at angle 0.
    pub const ONE: Self = Self { samples: 1, min_angle_rad: 0.0, max_angle_rad: 0.0 };

    /// Angle of beam `index`: min + i·(max − min)/(samples − 1), as Gazebo spaces them.
    pub fn angle(&self, index: u32) -> f64 {
        self.min_angle_rad + f64::from(index) * self.increment()
    }

    /// Angle from one beam to the next; 0 for a single one.
    pub fn increment(&self) -> f64 {
        if self.samples > 1 {
            (self.max_angle_rad - self.min_angle_rad) / f64::from(self.samples - 1)
        } else {
            0.0
        }
    }

    fn is_valid(&self) -> bool {
        (1..=MAX_SAMPLES).contains(&self.samples)
            && self.min_angle_rad.is_finite()
            && self.max_angle_rad.is_finite()
            && self.min_angle_rad <= self.max_angle_rad
    }
}

/// What a lidar is like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LidarConfig {
    /// Beams of a scan line; angle 0 is +x, counter-clockwise about +z.
    pub horizontal: Beams,
    /// Scan lines; angles up from the xy plane, beyond ±π/2 over the pole and down on the other side.
    pub vertical: Beams,
    /// Smallest range in metres, at least 0.
    pub range_min_m: f64,
    /// Largest range in metres, more than the smallest.
    pub range_max_m: f64,
    /// What happens nearer than the smallest range.
    pub too_near: TooNear,
    /// Noise of a range in metres; the noisy range is clamped to the two limits.
    pub noise: GaussianNoise,
    /// Seed of the simulation.
    pub seed: u64,
    /// Number of the sensor in the simulation.
    pub sensor: u32,
}

/// Why a lidar cannot be made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum LidarError {
    /// No beams, more than [`MAX_SAMPLES`] along an axis or [`MAX_BEAMS`] in all, or angles that are not finite or
    /// not in order.
    Beams,
    /// Not 0 ≤ smallest < largest range.
    Range,
}

impl core::fmt::Display for LidarError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Beams => "a lidar needs 1 to 32767 beams a line and lines, 16777216 beams in all, and finite angles, min <= max",
            Self::Range => "the ranges must be 0 <= min < max",
        })
    }
}

impl core::error::Error for LidarError {}

/// A checked lidar. Its hits are the [`COLLISION`](visibility::COLLISION) shapes, as those of Gazebo's CPU ray.
#[derive(Debug, Clone, Copy)]
pub struct Lidar {
    config: LidarConfig,
    bias: f32,
}

impl Lidar {
    /// Checks the configuration.
    ///
    /// # Errors
    /// A [`LidarError`] that names the value out of range.
    pub fn new(config: LidarConfig) -> Result<Self, LidarError> {
        let beams = u64::from(config.horizontal.samples) * u64::from(config.vertical.samples);
        if !config.horizontal.is_valid() || !config.vertical.is_valid() || beams > u64::from(MAX_BEAMS) {
            return Err(LidarError::Beams);
        }
        if !(config.range_min_m >= 0.0 && config.range_min_m < config.range_max_m) {
            return Err(LidarError::Range);
        }
        Ok(Self { config, bias: config.noise.bias(config.seed, config.sensor, 0) })
    }

    /// What it was made from.
    pub fn config(&self) -> &LidarConfig {
        &self.config
    }

    /// Beams of a scan.
    pub fn beams(&self) -> usize {
        self.config.horizontal.samples as usize * self.config.vertical.samples as usize
    }

    /// Takes a scan: lines from the lowest angle up, beams from the first angle on. A range is metres along the
    /// beam, +∞ where nothing is in range (REP-117). `intensities` may be empty when nobody wants them; they are
    /// 0 where there is no range.
    ///
    /// # Panics
    /// When `ranges` is not [`Lidar::beams`] long, or `intensities` neither that nor empty, the workspace does not fit
    /// the scene, or the moment does not have one pose for each instance.
    pub fn sense(
        &self,
        scene: &Scene<'_>,
        capture: &Capture<'_>,
        workspace: &mut Workspace<'_>,
        ranges: &mut [f32],
        intensities: &mut [f32],
    ) {
        assert_eq!(ranges.len(), self.beams(), "the buffer must hold exactly one scan");
        assert!(
            intensities.is_empty() || intensities.len() == ranges.len(),
            "one intensity per range, or none"
        );
        let execution = workspace.execution;
        let grid = self.grid();
        let mut memory = workspace.cut(scene, self.rays());
        let instances = scene.instances().len();
        let view = View::new(scene, &capture.moment, visibility::COLLISION, memory.view(instances));
        let nearest = match self.config.too_near {
            TooNear::Blocks => 0.0,
            TooNear::SeenThrough => self.config.range_min_m,
        };
        let sight = Sight { faces: Faces::Both, range: [nearest, self.config.range_max_m] };
        let samples = self.config.horizontal.samples as usize;
        let rows_in_block = 1 << Optics::Spherical(grid).fan().shift_y;
        let lines = Lines { ranges, intensities, samples, rows_in_block };
        let scanner = Scanner { lidar: self, capture };
        trace_grid(&view, &Optics::Spherical(grid), &sight, execution, &mut memory, lines, &scanner);
    }

    /// Rays that a [`Workspace`] must have room for.
    pub fn rays(&self) -> usize {
        Optics::Spherical(self.grid()).rays()
    }

    fn grid(&self) -> SphericalGrid {
        let (horizontal, vertical) = (&self.config.horizontal, &self.config.vertical);
        SphericalGrid {
            columns: horizontal.samples,
            rows: vertical.samples,
            first_azimuth_rad: horizontal.min_angle_rad,
            azimuth_step_rad: horizontal.increment(),
            first_elevation_rad: vertical.min_angle_rad,
            elevation_step_rad: vertical.increment(),
        }
    }

    /// Turns true ranges of up to 64 beams into measured ones. Noise is counted by 64 beams along each line.
    #[inline(always)]
    fn measure(&self, frame: u64, block: u32, ranges: &mut [f32]) {
        let config = &self.config;
        let mut normals = [0.0; LANES];
        if !config.noise.is_none() {
            let stream = Stream { seed: config.seed, sensor: config.sensor, frame, channel: Stream::RANGE };
            normals = normals64(&stream, 4 * block);
        }
        let (min, max) = (config.range_min_m as f32, config.range_max_m as f32);
        for (lane, range) in ranges.iter_mut().enumerate() {
            let truth = *range;
            *range = if truth >= max || truth == f32::INFINITY {
                f32::INFINITY
            } else if truth <= min {
                f32::NEG_INFINITY
            } else {
                let noisy = config.noise.apply(truth, self.bias, normals[lane]);
                if noisy < min {
                    min
                } else if noisy > max {
                    max
                } else {
                    noisy
                }
            };
        }
    }
}

/// Measures the beams of a scan.
struct Scanner<'a> {
    lidar: &'a Lidar,
    capture: &'a Capture<'a>,
}

impl BandWork<Lines<'_>> for Scanner<'_> {
    #[inline(always)]
    fn finish<S: Simd>(&self, simd: S, band: &Band<'_>, lines: Lines<'_>) {
        let Lines { ranges, intensities, samples, .. } = lines;
        let measure = Measure::new(&self.capture.moment.world_from_sensor);
        let mut resolver = Resolver::new(band.view);
        for_each_block(
            band,
            #[inline(always)]
            |place, block| {
                place.write(&measure.block::<S, false>(simd, band, &mut resolver, block), ranges);
                if !intensities.is_empty() {
                    let retro = band.target.slot[place.block]
                        .map(|slot| if slot == NO_HIT { 0.0 } else { resolver.laser_retro(slot) });
                    place.write(&retro, intensities);
                }
            },
        );
        let blocks = samples.div_ceil(LANES);
        for (line, ranges) in ranges.chunks_mut(samples).enumerate() {
            let first = (band.rows[0] as usize + line) * blocks;
            for (block, ranges) in ranges.chunks_mut(LANES).enumerate() {
                self.lidar.measure(self.capture.frame, (first + block) as u32, ranges);
            }
        }
        for (intensity, range) in intensities.iter_mut().zip(ranges.iter()) {
            *intensity = if range.is_finite() { *intensity } else { 0.0 };
        }
    }
}

/// Scan lines, cut between two rows of blocks.
struct Lines<'a> {
    ranges: &'a mut [f32],
    intensities: &'a mut [f32],
    samples: usize,
    rows_in_block: usize,
}

impl SplitRows for Lines<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        let Self { samples, rows_in_block, .. } = self;
        let at = rows * rows_in_block * samples;
        let (ranges, ranges_rest) = self.ranges.split_at_mut(at);
        let (intensities, intensities_rest) = self.intensities.split_at_mut(at.min(self.intensities.len()));
        (
            Self { ranges, intensities, samples, rows_in_block },
            Self { ranges: ranges_rest, intensities: intensities_rest, samples, rows_in_block },
        )
    }
}
