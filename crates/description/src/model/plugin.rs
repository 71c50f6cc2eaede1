//! The plugins that publish sensors: their topics, frames and rates.

/// Parameters shared by the camera plugins. Topics are absolute: the camera name is a prefix unless the topic begins
/// with a slash.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraPlugin {
    /// `cameraName`.
    pub camera_name: String,
    /// Absolute topic of the image.
    pub image_topic: String,
    /// Absolute topic of its `CameraInfo`.
    pub camera_info_topic: String,
    /// `frameName`.
    pub frame_name: String,
    /// `hackBaseline` in metres: P\[3\] = −f·baseline.
    pub hack_baseline_m: f64,
    /// k1, k2, k3, t1, t2 as written to `CameraInfo`; all 0 for the lens's own.
    pub distortion: [f64; 5],
    /// `autoDistortion`: if true, `CameraInfo` has the coefficients of the lens, as in Gazebo.
    pub auto_distortion: bool,
    /// `CxPrime`, `Cx`, `Cy` if given and not 0.
    pub principal_point: [Option<f64>; 2],
    /// `focalLength` in pixels if given and not 0.
    pub focal_length: Option<f64>,
}

/// Parameters of the Kinect plugin.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthCameraPlugin {
    /// Parameters of the colour image and its `CameraInfo`, and those that apply to both images.
    pub camera: CameraPlugin,
    /// Absolute topic of the depth image.
    pub depth_image_topic: String,
    /// Absolute topic of its `CameraInfo`.
    pub depth_camera_info_topic: String,
    /// Absolute topic of the cloud.
    pub point_cloud_topic: String,
    /// `pointCloudCutoff`: depths at or below it are invalid.
    pub cutoff_m: f64,
    /// `pointCloudCutoffMax`: depths at or above it are invalid.
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
    /// `fov` in radians, as published; the beams are the sensor's own.
    pub field_of_view_rad: f64,
}

/// The kind of radiation of a rangefinder.
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
    /// Layout of the cloud, for plugins that publish one as a driver does.
    pub cloud: Option<CloudLayout>,
    /// Absolute topic of the points of the scan, which gz-sim publishes besides the scan.
    pub points_topic: Option<String>,
}

/// The points in a cloud, and their order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CloudLayout {
    /// `organize_cloud`: one row per column of beams, with NaN for misses; otherwise only hits.
    pub is_organized: bool,
    /// `min_intensity`: weaker returns are left out.
    pub min_intensity: f64,
}

impl Default for CloudLayout {
    fn default() -> Self {
        Self { is_organized: false, min_intensity: f64::NEG_INFINITY }
    }
}
