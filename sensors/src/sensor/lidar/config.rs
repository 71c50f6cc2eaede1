//! The configuration of a lidar.

use crate::ParameterError;
use crate::noise::GaussianNoise;
use crate::optics::MAX_GRID_SIZE;
use crate::scene::visibility;
use crate::trace::{Faces, TooNear};
use core::f64::consts::{PI, TAU};

/// The largest number of beams of a lidar.
pub const MAX_BEAMS: u32 = 16_777_216;

/// The largest number of beams of a scan line, and of scan lines.
pub const MAX_SAMPLES: u32 = MAX_GRID_SIZE;

/// The angles of the beams along one axis, first and last included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beams {
    /// The number of beams, 1 … [`MAX_SAMPLES`].
    pub samples: u32,
    /// The angle of the first beam, in radians.
    pub min_angle_rad: f64,
    /// The angle of the last beam, in radians; not less than that of the first.
    pub max_angle_rad: f64,
}

impl Beams {
    /// Creates `samples` beams in equal steps around a full turn, beginning at the rear (−π), without a duplicate at
    /// the end.
    ///
    /// The last beam is one step before +π; [`Beams::between_degrees`] from −180° to 180° would repeat the first.
    ///
    /// ```
    /// use belvedere_sensors::lidar::Beams;
    /// let turn = Beams::turn(360);
    /// assert!((turn.increment().to_degrees() - 1.0).abs() < 1e-12);
    /// assert!(turn.angle(180).abs() < 1e-12); // straight ahead
    /// ```
    pub const fn turn(samples: u32) -> Self {
        let step = if samples > 0 { TAU / samples as f64 } else { 0.0 };
        Self { samples, min_angle_rad: -PI, max_angle_rad: PI - step }
    }

    /// Creates `samples` beams from one angle to another, both included. The angles are in degrees, as in data sheets.
    ///
    /// ```
    /// use belvedere_sensors::lidar::Beams;
    /// // Hokuyo UTM-30LX: 270° in steps of a quarter of a degree.
    /// let line = Beams::between_degrees(1081, -135.0, 135.0);
    /// assert!((line.increment().to_degrees() - 0.25).abs() < 1e-12);
    /// ```
    pub const fn between_degrees(samples: u32, min_angle_deg: f64, max_angle_deg: f64) -> Self {
        let rad_per_deg = PI / 180.0;
        Self {
            samples,
            min_angle_rad: min_angle_deg * rad_per_deg,
            max_angle_rad: max_angle_deg * rad_per_deg,
        }
    }

    /// A single beam at angle 0.
    pub const ONE: Self = Self { samples: 1, min_angle_rad: 0.0, max_angle_rad: 0.0 };

    /// Returns the angle of beam `index` in radians: min + i·(max − min)/(samples − 1), as Gazebo spaces them.
    pub fn angle(&self, index: u32) -> f64 {
        self.min_angle_rad + f64::from(index) * self.increment()
    }

    /// Returns the angle from one beam to the next in radians; 0 if there is only one beam.
    pub fn increment(&self) -> f64 {
        if self.samples > 1 {
            (self.max_angle_rad - self.min_angle_rad) / f64::from(self.samples - 1)
        } else {
            0.0
        }
    }

    /// Checks that there are beams at ordered angles. `names` are the names of the three parameters.
    fn check(&self, [samples, min_angle, max_angle]: [&'static str; 3]) -> Result<(), ParameterError> {
        let Self { samples: count, min_angle_rad, max_angle_rad } = *self;
        ParameterError::require_in("lidar", samples, count.into(), [1.0, MAX_SAMPLES.into()])?;
        for (parameter, angle) in [(min_angle, min_angle_rad), (max_angle, max_angle_rad)] {
            ParameterError::require("lidar", parameter, angle, angle.is_finite(), "a finite number")?;
        }
        let in_order = min_angle_rad <= max_angle_rad;
        ParameterError::require("lidar", max_angle, max_angle_rad, in_order, "min_angle_rad or more")
    }
}

/// The way a lidar sweeps: whether the slices of its [`Shutter`](crate::Shutter) are columns or scan lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sweep {
    /// A lidar that turns: the lines of a slice are columns, that is, the beams of all scan lines at some azimuths.
    #[default]
    Columns,
    /// A lidar that nods: the lines of a slice are scan lines.
    Rows,
}

/// The configuration of a lidar.
///
/// ```
/// use belvedere_sensors::lidar::{Beams, LidarConfig};
/// let config = LidarConfig::new(Beams::turn(360)).range_min_m(0.12).range_max_m(3.5);
/// assert_eq!((config.vertical.samples, config.range_max_m), (1, 3.5));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct LidarConfig {
    /// The azimuths of the beams of a scan line: 0 is +x, positive angles are counter-clockwise about +z.
    pub horizontal: Beams,
    /// The elevations of the scan lines, upwards from the xy plane. Beyond ±π/2 they go over the pole and down on the
    /// other side. The default is [`Beams::ONE`].
    pub vertical: Beams,
    /// The smallest range in metres, at least 0. The default is 0.
    pub range_min_m: f64,
    /// The largest range in metres, greater than the smallest. The default is 30.
    pub range_max_m: f64,
    /// The treatment of surfaces nearer than the smallest range. The default is [`TooNear::Blocks`].
    pub too_near: TooNear,
    /// A bit mask of the instances that are visible: those whose own mask has a bit in common with this one; see
    /// [`visibility`]. The default is [`visibility::COLLISION`].
    pub visibility: u32,
    /// The sides of surfaces that are visible. The default is [`Faces::Both`], as of Gazebo's CPU ray sensor.
    pub faces: Faces,
    /// The way the lidar sweeps: whether the slices of a shutter are columns or scan lines. The default is
    /// [`Sweep::Columns`].
    pub sweep: Sweep,
    /// Noise of a range in metres. Noisy ranges are clamped to the two limits. The default is [`GaussianNoise::NONE`].
    pub noise: GaussianNoise,
    /// The seed of the simulation. The default is 0.
    pub seed: u64,
    /// The number of the sensor in the simulation. The default is 0.
    pub sensor: u32,
}

impl LidarConfig {
    /// Creates the configuration of a lidar with one scan line and ranges from 0 to 30 m, without noise, with seed and
    /// sensor number 0. It hits both sides of collision shapes, as Gazebo's CPU ray sensor does.
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
        /// Sets the azimuths of the beams of a scan line.
        horizontal: Beams,
        /// Sets the elevations of the scan lines.
        vertical: Beams,
        /// Sets the smallest range, in metres.
        range_min_m: f64,
        /// Sets the largest range, in metres.
        range_max_m: f64,
        /// Sets the treatment of surfaces nearer than the smallest range.
        too_near: TooNear,
        /// Sets which instances are visible: [`visibility::VISUAL`] for what Gazebo renders on a GPU.
        visibility: u32,
        /// Sets which sides of surfaces are visible: [`Faces::Front`] for what Gazebo renders on a GPU.
        faces: Faces,
        /// Sets whether the slices of a shutter are columns or scan lines.
        sweep: Sweep,
        /// Sets the noise of a range, in metres.
        noise: GaussianNoise,
        /// Sets the seed of the simulation.
        seed: u64,
        /// Sets the number of the sensor in the simulation.
        sensor: u32,
    }

    /// Checks the configuration.
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let names = ["horizontal.samples", "horizontal.min_angle_rad", "horizontal.max_angle_rad"];
        self.horizontal.check(names)?;
        self.vertical.check(["vertical.samples", "vertical.min_angle_rad", "vertical.max_angle_rad"])?;
        let beams = f64::from(self.horizontal.samples) * f64::from(self.vertical.samples);
        ParameterError::require_in("lidar", "number of all beams", beams, [1.0, MAX_BEAMS.into()])?;
        let (min_m, max_m) = (self.range_min_m, self.range_max_m);
        let in_order = min_m >= 0.0 && min_m < max_m;
        ParameterError::require(
            "lidar",
            "range_min_m",
            min_m,
            in_order,
            "0 or more, and less than range_max_m",
        )
    }
}
