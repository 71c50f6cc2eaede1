//! Sensors: what they measure, how, and how often.

use super::{CameraDevice, Lens, LinkIndex, PixelFormat, Plugin};
use crate::description::diagnostics::Source;
use belvedere_sensors::Pose;

/// A sensor on a link.
#[derive(Debug, Clone)]
pub struct Sensor {
    /// Name in the file.
    pub name: String,
    /// The link it is fixed to.
    pub link: LinkIndex,
    /// Pose of the sensor in its link; the sensor looks along its x, z is up.
    pub link_from_sensor: Pose,
    /// `<always_on>`.
    pub always_on: bool,
    /// Rate of the sensor itself; none means every physics step.
    pub update_rate_hz: Option<f64>,
    /// What it measures and how.
    pub kind: SensorKind,
    /// The plugin that publishes it; none means a sensor without topics of its own.
    pub plugin: Option<Plugin>,
    /// Where it stands.
    pub source: Source,
}

impl Sensor {
    /// The rate that holds for pictures and infos alike: the lower of the sensor's and its plugin's; none means
    /// every physics step.
    pub fn effective_rate_hz(&self) -> Option<f64> {
        let plugin_rate = match &self.plugin {
            Some(Plugin::Camera(camera)) => camera.update_rate_hz,
            Some(Plugin::DepthCamera(depth)) => depth.camera.update_rate_hz,
            Some(Plugin::Laser(laser)) => laser.update_rate_hz,
            Some(Plugin::Range(range)) => range.update_rate_hz,
            None => None,
        };
        match (self.update_rate_hz, plugin_rate) {
            (Some(sensor), Some(plugin)) => Some(sensor.min(plugin)),
            (one, other) => one.or(other),
        }
    }
}

/// What a sensor measures.
#[derive(Debug, Clone)]
pub enum SensorKind {
    /// Colour camera.
    Camera(CameraSensor),
    /// Depth camera with a colour camera in the same place.
    Depth(CameraSensor),
    /// Lidar.
    Ray(RaySensor),
}

/// `<camera>` of SDF.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraSensor {
    /// Full horizontal angle of view in radians: of the picture before distortion, if the lens is a pinhole that
    /// distorts. Where the lens has a focal length of its own, it is not looked at by others than pinholes.
    pub horizontal_fov_rad: f64,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Layout of a pixel.
    pub format: PixelFormat,
    /// `<anti_aliasing>`: samples a pixel; 0 and 1 ask for none besides its own.
    pub anti_aliasing: u32,
    /// Nothing nearer is seen.
    pub near_m: f64,
    /// Nothing farther is seen.
    pub far_m: f64,
    /// Noise of a colour value in [0, 1].
    pub noise: Noise,
    /// SDF `<lens>` and `<distortion>`.
    pub lens: Lens,
    /// `<device>`, which is ours.
    pub device: Option<CameraDevice>,
}

/// `<ray>` or `<lidar>` of SDF.
#[derive(Debug, Clone, PartialEq)]
pub struct RaySensor {
    /// Whether it is one of Gazebo's GPU kinds: these see the outside of visuals, the others hit collision shapes.
    pub sees_visuals: bool,
    /// Beams of a scan line.
    pub horizontal: ScanAxis,
    /// Scan lines; one at angle 0 for a 2D lidar.
    pub vertical: ScanAxis,
    /// Nothing nearer is measured.
    pub range_min_m: f64,
    /// Nothing farther is measured.
    pub range_max_m: f64,
    /// `<range><resolution>`; Gazebo never applies it, nor do we.
    pub range_resolution_m: f64,
    /// Noise of a range in metres.
    pub noise: Noise,
}

/// Angles of a lidar along one axis, first and last included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScanAxis {
    /// Number of beams, at least 1.
    pub samples: u32,
    /// Angle of the first.
    pub min_angle_rad: f64,
    /// Angle of the last.
    pub max_angle_rad: f64,
}

/// Gazebo's Gaussian noise: out = in + bias + N(mean, stddev), rounded to `precision` if that is not 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Noise {
    /// Mean of the noise.
    pub mean: f64,
    /// Standard deviation of the noise.
    pub stddev: f64,
    /// The bias is drawn once from N(`bias_mean`, `bias_stddev`), its sign flipped with probability ½.
    pub bias_mean: f64,
    /// See `bias_mean`.
    pub bias_stddev: f64,
    /// Step of `gaussian_quantized`; 0 for none.
    pub precision: f64,
}
