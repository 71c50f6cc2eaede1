//! What a depth camera is like.

use crate::ParameterError;
use crate::device::depth::DepthModel;
use crate::device::depth::presets::DepthPreset;
#[cfg(feature = "alloc")]
use crate::optics::Optics;
use crate::optics::PinholeGrid;
use crate::sensor::camera::CameraConfig;
use crate::trace::{Faces, TooNear};

/// What a depth camera is like.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct DepthCameraConfig<'a> {
    /// Geometry, clip distances, and the colour picture. Its `faces` do not count.
    pub camera: CameraConfig<'a>,
    /// Which sides of surfaces it sees, in depths, colours, cloud and truth alike, so that these are of the same surfaces.
    /// With [`Faces::Both`] nothing is seen through: a mesh whose triangles run clockwise is measured as well, and so is the
    /// inside of a housing around the camera. With [`Faces::Front`], as in Gazebo, only outsides are seen.
    pub faces: Faces,
    /// Depth at or below is too near, in metres.
    pub min_depth_m: f64,
    /// Depth at or above is too far, in metres; may be infinite.
    pub max_depth_m: f64,
    /// What stands for too near and too far.
    pub out_of_range: OutOfRange,
    /// What happens to depths nearer than the camera's `near_m`. The colour picture does not show what is there in
    /// either case, as that of a [`Camera`](crate::camera::Camera).
    pub too_near: TooNear,
    /// What the device makes of true depths; what it takes to the limits or beyond is too near or too far.
    pub model: DepthModel,
}

impl<'a> DepthCameraConfig<'a> {
    /// A depth camera without noise, whose depths are limited by the clip distances alone, and which sees both sides of
    /// surfaces.
    pub fn new(camera: CameraConfig<'a>) -> Self {
        Self {
            camera,
            faces: Faces::Both,
            min_depth_m: 0.0,
            max_depth_m: f64::INFINITY,
            out_of_range: OutOfRange::Infinite,
            too_near: TooNear::Blocks,
            model: DepthModel::new(),
        }
    }

    /// The same with other optics, of other lifetime.
    #[cfg(feature = "alloc")]
    pub(crate) fn with_optics<'b>(&self, optics: &Optics<'b>) -> DepthCameraConfig<'b> {
        let Self { camera, faces, min_depth_m, max_depth_m, out_of_range, too_near, model } = *self;
        let camera = camera.with_optics(optics);
        DepthCameraConfig { camera, faces, min_depth_m, max_depth_m, out_of_range, too_near, model }
    }

    /// A camera of a preset: its picture, its range and its model.
    ///
    /// ```
    /// use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig};
    /// use belvedere_sensors::device::depth::presets;
    /// let kinect = presets::named("kinect_v1").expect("there is one");
    /// let config = DepthCameraConfig::of_preset(kinect)?;
    /// assert_eq!((config.min_depth_m, config.max_depth_m), (0.8, 4.0));
    /// assert_eq!(DepthCamera::new(config)?.pixels(), 640 * 480);
    /// # Ok::<(), Box<dyn core::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// None with the presets of this crate.
    pub fn of_preset(preset: &DepthPreset) -> Result<Self, ParameterError> {
        let [width, height] = preset.size;
        let lens = PinholeGrid::from_fov(width, height, preset.horizontal_fov_deg.to_radians())?;
        let [min_m, max_m] = preset.range_m;
        let model = preset.model(preset.focal_px());
        Ok(Self::new(CameraConfig::new(lens)).min_depth_m(min_m).max_depth_m(max_m).model(model))
    }

    setters! {
        /// Sets the camera.
        camera: CameraConfig<'a>,
        /// Sets which sides of surfaces it sees: [`Faces::Front`] for what Gazebo renders.
        faces: Faces,
        /// Sets the depth at and below which is too near, in metres.
        min_depth_m: f64,
        /// Sets the depth at and above which is too far, in metres.
        max_depth_m: f64,
        /// Sets what stands for too near and too far.
        out_of_range: OutOfRange,
        /// Sets what happens to depths nearer than the camera's `near_m`.
        too_near: TooNear,
    }

    /// Sets what the device makes of true depths: a model, or Gaussian noise in metres alone.
    #[must_use]
    pub fn model(mut self, model: impl Into<DepthModel>) -> Self {
        self.model = model.into();
        self
    }
}

/// What a 32FC1 depth outside the valid range becomes. In 16UC1 it is 0 in any case, and in the cloud NaN.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutOfRange {
    /// REP-117: too near is −∞, too far or nothing there +∞. What the device cannot measure is NaN.
    Infinite,
    /// As Gazebo's Kinect plugin: NaN.
    Nan,
}
