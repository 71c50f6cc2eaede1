//! What a lidar is like.

use crate::noise::GaussianNoise;
use crate::optics::MAX_GRID_SIZE;
use crate::scene::visibility;
use crate::trace::{Faces, TooNear};

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

    pub(super) fn is_valid(&self) -> bool {
        (1..=MAX_SAMPLES).contains(&self.samples)
            && self.min_angle_rad.is_finite()
            && self.max_angle_rad.is_finite()
            && self.min_angle_rad <= self.max_angle_rad
    }
}

/// Which beams of a lidar are taken together, where its [`Shutter`](crate::Shutter) has slices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sweep {
    /// It turns: the lines of a slice are columns, the beams of all scan lines at some azimuths.
    #[default]
    Columns,
    /// It nods: the lines of a slice are scan lines.
    Rows,
}

/// What a lidar is like.
///
/// ```
/// use belvedere_sensors::lidar::{Beams, LidarConfig};
/// let line = Beams { samples: 360, min_angle_rad: -3.1, max_angle_rad: 3.1 };
/// let config = LidarConfig::new(line).range_min_m(0.12).range_max_m(3.5);
/// assert_eq!((config.vertical.samples, config.range_max_m), (1, 3.5));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
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
    /// Which instances it sees: those that have a bit of it in common; see [`visibility`].
    pub visibility: u32,
    /// Which sides of their surfaces.
    pub faces: Faces,
    /// Which beams are taken together.
    pub sweep: Sweep,
    /// Noise of a range in metres; the noisy range is clamped to the two limits.
    pub noise: GaussianNoise,
    /// Seed of the simulation.
    pub seed: u64,
    /// Number of the sensor in the simulation.
    pub sensor: u32,
}

impl LidarConfig {
    /// One scan line, seen from 0 to 30 m, without noise, of seed and number 0. Both sides of collision shapes are hit,
    /// as by Gazebo's CPU ray.
    pub const fn new(horizontal: Beams) -> Self {
        Self {
            horizontal,
            vertical: Beams::ONE,
            range_min_m: 0.0,
            range_max_m: 30.0,
            too_near: TooNear::Blocks,
            visibility: visibility::COLLISION,
            faces: Faces::Both,
            sweep: Sweep::Columns,
            noise: GaussianNoise::NONE,
            seed: 0,
            sensor: 0,
        }
    }

    setters! {
        /// Sets the beams of a scan line.
        horizontal: Beams,
        /// Sets the scan lines.
        vertical: Beams,
        /// Sets the smallest range, in metres.
        range_min_m: f64,
        /// Sets the largest range, in metres.
        range_max_m: f64,
        /// Sets what happens nearer than the smallest range.
        too_near: TooNear,
        /// Sets which instances it sees: [`visibility::VISUAL`] for what Gazebo renders on a GPU.
        visibility: u32,
        /// Sets which sides of surfaces it sees: [`Faces::Front`] for what Gazebo renders on a GPU.
        faces: Faces,
        /// Sets which beams are taken together.
        sweep: Sweep,
        /// Sets the noise of a range, in metres.
        noise: GaussianNoise,
        /// Sets the seed of the simulation.
        seed: u64,
        /// Sets the number of the sensor in the simulation.
        sensor: u32,
    }
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
