//! Lidars with fixed beams: ranges and intensities, with Gazebo's range noise.

use crate::execution::{SplitRows, for_each_row};
use crate::noise::{GaussianNoise, Stream, normals64};
use crate::scene::{Scene, visibility};
use crate::simd::LANES;
use crate::trace::frame::Frame;
use crate::trace::packet::{Faces, MISS, Packet};
use crate::trace::traverse::nearest;
use crate::trace::{Capture, Workspace};
use fearless_simd::{Simd, dispatch};
use glam::DVec3;

/// Most beams of a lidar.
pub const MAX_BEAMS: u32 = 16_777_216;

/// Angles of the beams along one axis, first and last included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beams {
    /// How many, at least 1.
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
        self.samples > 0
            && self.min_angle_rad.is_finite()
            && self.max_angle_rad.is_finite()
            && self.min_angle_rad <= self.max_angle_rad
    }
}

/// What happens to something nearer than the smallest range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TooNear {
    /// REP-117: the range is −∞.
    Blocks,
    /// As Gazebo: the ray begins at the smallest range and sees what lies behind.
    SeenThrough,
}

/// What a lidar is like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LidarConfig {
    /// Beams of a scan line; angle 0 is +x, counter-clockwise about +z.
    pub horizontal: Beams,
    /// Scan lines; angles up from the xy plane.
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
    /// No beams, more than [`MAX_BEAMS`], or angles that are not finite or not in order.
    Beams,
    /// Not 0 ≤ smallest < largest range.
    Range,
}

impl core::fmt::Display for LidarError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Beams => "a lidar needs 1 to 16777216 beams with finite angles, min <= max",
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

/// Noise channel of ranges.
const RANGE_CHANNEL: u16 = 2;

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
    /// When `ranges` is not [`Lidar::beams`] long, or `intensities` neither that nor empty, or the workspace does
    /// not fit the scene.
    pub fn sense(
        &self,
        scene: &Scene<'_>,
        capture: &Capture,
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
        let origin = capture.world_from_sensor.translation();
        let frame = Frame::new(scene, origin, visibility::COLLISION, workspace);
        let lines = Lines { ranges, intensities, samples: self.config.horizontal.samples as usize };
        for_each_row(
            execution,
            0..self.config.vertical.samples as usize,
            lines,
            &|line, mut lines: Lines<'_>| {
                dispatch!(execution.level, simd => self.sense_line(simd, &frame, capture, line, &mut lines));
            },
        );
    }

    fn sense_line<S: Simd>(
        &self,
        simd: S,
        frame: &Frame<'_>,
        capture: &Capture,
        line: usize,
        lines: &mut Lines<'_>,
    ) {
        let blocks = lines.samples.div_ceil(LANES);
        for block in 0..blocks {
            let first = block * LANES;
            let last = lines.samples.min(first + LANES);
            let mut packet = self.packet(capture, line as u32, first as u32);
            nearest(simd, frame, &mut packet, Faces::Both);
            let ranges = &mut lines.ranges[first..last];
            simd.vectorize(
                #[inline(always)]
                || self.measure(&packet, capture.frame, (line * blocks + block) as u32, ranges),
            );
            if !lines.intensities.is_empty() {
                for (lane, intensity) in lines.intensities[first..last].iter_mut().enumerate() {
                    let seen = packet.placed[lane] != MISS && ranges[lane].is_finite();
                    *intensity = if seen { frame.instance(packet.placed[lane]).laser_retro } else { 0.0 };
                }
            }
        }
    }

    /// Rays of 64 beams, with t the range in metres.
    fn packet(&self, capture: &Capture, line: u32, first: u32) -> Packet {
        let config = &self.config;
        let mut packet = Packet::new();
        packet.t_min = match config.too_near {
            TooNear::Blocks => 0.0,
            TooNear::SeenThrough => config.range_min_m,
        };
        let (sin_up, cos_up) = libm::sincos(config.vertical.angle(line));
        let beams = config.horizontal.samples.saturating_sub(first).min(LANES as u32);
        for lane in 0..beams {
            let (sin, cos) = libm::sincos(config.horizontal.angle(first + lane));
            let direction = DVec3::new(cos * cos_up, sin * cos_up, sin_up);
            let direction = capture.world_from_sensor.transform_vector(direction);
            for axis in 0..3 {
                packet.direction[axis][lane as usize] = direction[axis];
            }
            packet.t[lane as usize] = config.range_max_m;
        }
        packet
    }

    #[inline(always)]
    fn measure(&self, packet: &Packet, frame: u64, block: u32, ranges: &mut [f32]) {
        let config = &self.config;
        let mut normals = [0.0; LANES];
        if !config.noise.is_none() {
            let stream = Stream { seed: config.seed, sensor: config.sensor, frame, channel: RANGE_CHANNEL };
            normals = normals64(&stream, 4 * block);
        }
        let (min, max) = (config.range_min_m as f32, config.range_max_m as f32);
        for (lane, range) in ranges.iter_mut().enumerate() {
            let truth = packet.t[lane] as f32;
            *range = if packet.placed[lane] == MISS || truth >= max {
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

/// Scan lines, cut between two of them.
struct Lines<'a> {
    ranges: &'a mut [f32],
    intensities: &'a mut [f32],
    samples: usize,
}

impl SplitRows for Lines<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        let (upper, lower) = self.ranges.split_at_mut(rows * self.samples);
        let cut = (rows * self.samples).min(self.intensities.len());
        let (upper_intensities, lower_intensities) = self.intensities.split_at_mut(cut);
        (
            Self { ranges: upper, intensities: upper_intensities, samples: self.samples },
            Self { ranges: lower, intensities: lower_intensities, samples: self.samples },
        )
    }
}
