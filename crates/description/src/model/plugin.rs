//! The plugins that publish sensors: their topics, frames and rates.

/// Parameters shared by the camera plugins. Topics are resolved: absolute, camera name prefixed unless the
/// topic began with a slash.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraPlugin {
    /// `cameraName`.
    pub camera_name: String,
    /// Absolute topic of the picture.
    pub image_topic: String,
    /// Absolute topic of its `CameraInfo`.
    pub camera_info_topic: String,
    /// `frameName`.
    pub frame_name: String,
    /// `hackBaseline` in metres: P\[3\] = −f·baseline.
    pub hack_baseline_m: f64,
    /// k1, k2, k3, t1, t2 as written to `CameraInfo`; all 0 for those of the lens.
    pub distortion: [f64; 5],
    /// `autoDistortion`: `CameraInfo` has the coefficients of the lens, in Gazebo as well.
    pub auto_distortion: bool,
    /// `CxPrime`, `Cx`, `Cy` if given and not 0.
    pub principal_point: [Option<f64>; 2],
    /// `focalLength` in pixels if given and not 0.
    pub focal_length: Option<f64>,
}

/// Parameters of the Kinect plugin.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthCameraPlugin {
    /// Colour picture and info, and what both share.
    pub camera: CameraPlugin,
    /// Absolute topic of the depth picture.
    pub depth_image_topic: String,
    /// Absolute topic of its `CameraInfo`.
    pub depth_camera_info_topic: String,
    /// Absolute topic of the cloud.
    pub point_cloud_topic: String,
    /// `pointCloudCutoff`: depth at or below is invalid.
    pub cutoff_m: f64,
    /// `pointCloudCutoffMax`: depth at or above is invalid.
    pub cutoff_max_m: f64,
    /// True for 16UC1 in millimetres (`useDepth16UC1MM`), false for 32FC1 in metres.
    pub depth_16uc1: bool,
}

/// Parameters of the plugin of rangefinders.
#[derive(Debug, Clone, PartialEq)]
pub struct RangePlugin {
    /// Absolute topic of the range.
    pub topic: String,
    /// `frameName`.
    pub frame_name: String,
    /// `radiation`.
    pub radiation: Radiation,
    /// `fov` in radians, as messages say it; the beams are the sensor's.
    pub field_of_view_rad: f64,
}

/// What a rangefinder sends out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Radiation {
    /// Sound.
    Ultrasound,
    /// Infrared light.
    Infrared,
}

/// Parameters of the laser plugins.
#[derive(Debug, Clone, PartialEq)]
pub struct LaserPlugin {
    /// Absolute topic of the scan.
    pub topic: String,
    /// `frameName`.
    pub frame_name: String,
    /// Of the plugins that send a cloud, as a driver does: how it is laid out.
    pub cloud: Option<CloudLayout>,
}

/// Which points a cloud has, and in which order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CloudLayout {
    /// `organize_cloud`: a row for each column of beams, NaN for those that hit nothing; otherwise what was hit alone.
    pub is_organized: bool,
    /// `min_intensity`: what sends less back is left out.
    pub min_intensity: f64,
}

impl Default for CloudLayout {
    fn default() -> Self {
        Self { is_organized: false, min_intensity: f64::NEG_INFINITY }
    }
}
