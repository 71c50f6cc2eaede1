//! The configuration of a depth camera.

use crate::ParameterError;
use crate::device::depth_model::DepthModel;
use crate::device::depth_model::presets::DepthPreset;
#[cfg(feature = "alloc")]
use crate::optics::Optics;
use crate::optics::PinholeGrid;
use crate::sensor::camera::CameraConfig;
use crate::trace::{Faces, TooNear};

/// The configuration of a depth camera.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct DepthCameraConfig<'a> {
    /// The lens, the clip distances and the colour picture. Its `faces` are ignored.
    pub camera: CameraConfig<'a>,
    /// The sides of surfaces that are visible, in depths, colours, point cloud and ground truth alike, so that all of
    /// them show the same surfaces. The default is [`Faces::Both`].
    ///
    /// With [`Faces::Both`] no surface is seen through: a mesh whose triangles run clockwise is measured as well, and
    /// so is the inside of a housing around the camera. With [`Faces::Front`], as in Gazebo, only front faces are
    /// visible.
    pub faces: Faces,
    /// Depths at or below this value are too near, in metres. The default is 0.
    pub min_depth_m: f64,
    /// Depths at or above this value are too far, in metres; it may be infinite. The default is infinity.
    pub max_depth_m: f64,
    /// The values that stand for too near and too far. The default is [`OutOfRange::Infinite`].
    pub out_of_range: OutOfRange,
    /// The treatment of surfaces nearer than the camera's `near_m`. In the colour picture they are invisible in either
    /// case, as in that of a [`Camera`](crate::camera::Camera). The default is [`TooNear::Blocks`].
    pub too_near: TooNear,
    /// The model by which the device measures true depths. Depths that it moves to the limits or beyond are too near or
    /// too far. The default is [`DepthModel::new`], which reports true depths.
    pub model: DepthModel,
}

impl<'a> DepthCameraConfig<'a> {
    /// Creates the configuration of a depth camera without noise, which sees both sides of surfaces. Its depths are
    /// limited by the clip distances alone.
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

    /// Returns the same configuration with other optics, which may have another lifetime.
    #[cfg(feature = "alloc")]
    pub(crate) fn with_optics<'b>(&self, optics: &Optics<'b>) -> DepthCameraConfig<'b> {
        let Self { camera, faces, min_depth_m, max_depth_m, out_of_range, too_near, model } = *self;
        let camera = camera.with_optics(optics);
        DepthCameraConfig { camera, faces, min_depth_m, max_depth_m, out_of_range, too_near, model }
    }

    /// Creates the configuration of a preset: its picture, range and model.
    ///
    /// ```
    /// use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig};
    /// use belvedere_sensors::device::depth_model::presets;
    /// let kinect = presets::named("kinect_v1").expect("there is one");
    /// let config = DepthCameraConfig::of_preset(&kinect)?;
    /// assert_eq!((config.min_depth_m, config.max_depth_m), (0.8, 4.0));
    /// assert_eq!(DepthCamera::new(config)?.pixels(), 640 * 480);
    /// # Ok::<(), Box<dyn core::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Never fails for the presets of this crate.
    pub fn of_preset(preset: &DepthPreset) -> Result<Self, ParameterError> {
        let [width, height] = preset.size;
        let lens = PinholeGrid::from_fov(width, height, preset.horizontal_fov_deg.to_radians())?;
        let [min_m, max_m] = preset.range_m;
        let model = preset.model(preset.focal_px());
        Ok(Self::new(CameraConfig::new(lens)).min_depth_m(min_m).max_depth_m(max_m).model(model))
    }

    setters! {
        /// Sets the lens, the clip distances and the colour picture.
        camera: CameraConfig<'a>,
        /// Sets which sides of surfaces are visible: [`Faces::Front`] for what Gazebo renders.
        faces: Faces,
        /// Sets the depth at and below which surfaces are too near, in metres.
        min_depth_m: f64,
        /// Sets the depth at and above which surfaces are too far, in metres.
        max_depth_m: f64,
        /// Sets the values that stand for too near and too far.
        out_of_range: OutOfRange,
        /// Sets the treatment of surfaces nearer than the camera's `near_m`.
        too_near: TooNear,
    }

    /// Sets the model by which the device measures true depths: a [`DepthModel`], or just Gaussian noise in metres.
    #[must_use]
    pub fn model(mut self, model: impl Into<DepthModel>) -> Self {
        self.model = model.into();
        self
    }
}

/// The value of a 32FC1 depth outside the valid range. In 16UC1 it is always 0, and in the point cloud NaN.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutOfRange {
    /// REP-117: −∞ if too near; +∞ if too far or if nothing is hit. Depths that the device cannot measure are NaN.
    Infinite,
    /// NaN, as from Gazebo's Kinect plugin.
    Nan,
}
