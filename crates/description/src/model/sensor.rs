//! SDF elements that several kinds of sensors share.

use super::{CameraDevice, Lens, PixelFormat};

/// `<camera>` of SDF.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraSensor {
    /// Full horizontal angle of view in radians: of the image before distortion, if the lens is a pinhole that
    /// distorts. If the lens has its own focal length, only pinholes use this.
    pub horizontal_fov_rad: f64,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Layout of a pixel.
    pub format: PixelFormat,
    /// `<anti_aliasing>`: samples per pixel; 0 and 1 mean no anti-aliasing.
    pub anti_aliasing: u32,
    /// Near clip distance in metres.
    pub near_m: f64,
    /// Far clip distance in metres.
    pub far_m: f64,
    /// It sees the visuals whose flags have one of these bits (`<visibility_mask>`).
    pub visibility_mask: u32,
    /// Noise of a colour value in [0, 1].
    pub noise: Noise,
    /// SDF `<lens>` and `<distortion>`.
    pub lens: Lens,
    /// `<device>`, our extension.
    pub device: Option<CameraDevice>,
}

/// `<ray>` or `<lidar>` of SDF.
#[derive(Debug, Clone, PartialEq)]
pub struct RaySensor {
    /// True for Gazebo's GPU lidars: they see the outside of visuals, the others hit collision shapes.
    pub sees_visuals: bool,
    /// It sees the visuals whose flags have one of these bits (`<visibility_mask>`); collision shapes have no flags.
    pub visibility_mask: u32,
    /// Beams of a scan line.
    pub horizontal: ScanAxis,
    /// Scan lines; one at angle 0 for a 2D lidar.
    pub vertical: ScanAxis,
    /// Smallest range that is measured, in metres.
    pub range_min_m: f64,
    /// Greatest range that is measured, in metres.
    pub range_max_m: f64,
    /// `<range><resolution>`; neither Gazebo nor this simulator applies it.
    pub range_resolution_m: f64,
    /// Noise of a range in metres.
    pub noise: Noise,
}

/// Angles of a lidar along one axis, first and last included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScanAxis {
    /// Number of beams, at least 1.
    pub samples: u32,
    /// Angle of the first beam.
    pub min_angle_rad: f64,
    /// Angle of the last beam.
    pub max_angle_rad: f64,
}

/// Gazebo's Gaussian noise: out = in + bias + N(mean, stddev), rounded to `precision` if that is not 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Noise {
    /// Mean of the noise.
    pub mean: f64,
    /// Standard deviation of the noise.
    pub stddev: f64,
    /// Mean magnitude of the bias, which is drawn once from N(`bias_mean`, `bias_stddev`); its sign is flipped with probability ½.
    pub bias_mean: f64,
    /// Standard deviation of the bias.
    pub bias_stddev: f64,
    /// Rounding step of `gaussian_quantized`; 0 for none.
    pub precision: f64,
    /// `dynamic_bias_stddev` and `dynamic_bias_correlation_time` in s, for instruments: the noise density that drives a drifting
    /// bias, and its correlation time.
    pub drift: [f64; 2],
}
