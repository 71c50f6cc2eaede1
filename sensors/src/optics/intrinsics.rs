//! The mapping from the plane of a lens model to pixels.
//!
//! column = fx·x + skew·y + cx, row = fy·y + cy: the upper two rows of OpenCV's camera matrix K. The plane coordinates
//! (x, y) have no unit; each lens model defines how they depend on the direction.

use super::error::{require, require_finite};
use crate::ParameterError;
use glam::DVec2;

/// Intrinsic parameters in pixels.
///
/// ```
/// use belvedere_sensors::optics::Intrinsics;
/// use belvedere_sensors::glam::DVec2;
/// let intrinsics = Intrinsics { fx: 300.0, fy: 310.0, cx: 319.5, cy: 239.5, skew: 2.0 };
/// assert_eq!(intrinsics.to_pixel(DVec2::new(0.5, -0.5)), Some(DVec2::new(468.5, 84.5)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intrinsics {
    /// Focal length along a row, greater than 0.
    pub fx: f64,
    /// Focal length along a column, greater than 0.
    pub fy: f64,
    /// Column of the principal point.
    pub cx: f64,
    /// Row of the principal point.
    pub cy: f64,
    /// Shift in columns per unit of y; 0 for nearly every camera. OpenCV's `fisheye` uses alpha = skew / fx.
    pub skew: f64,
}

impl Intrinsics {
    /// Creates the parameters of a centred pinhole camera with square pixels: f = w / (2·tan(hfov / 2)), principal
    /// point ((w−1)/2, (h−1)/2).
    ///
    /// # Errors
    /// If a side is 0, or the field of view (in radians) is not between 0 and π.
    ///
    /// ```
    /// use belvedere_sensors::optics::Intrinsics;
    /// let intrinsics = Intrinsics::from_fov(640, 480, 1.3962634).unwrap();
    /// assert!((intrinsics.fx - 381.36115).abs() < 1e-4 && intrinsics.fx == intrinsics.fy);
    /// assert_eq!((intrinsics.cx, intrinsics.cy), (319.5, 239.5));
    /// ```
    pub fn from_fov(width: u32, height: u32, horizontal_fov_rad: f64) -> Result<Self, ParameterError> {
        let inside = horizontal_fov_rad > 0.0 && horizontal_fov_rad < core::f64::consts::PI;
        require("horizontal_fov_rad", horizontal_fov_rad, inside, "between 0 and π radians")?;
        Self::centred(width, height, f64::from(width) / (2.0 * libm::tan(horizontal_fov_rad * 0.5)))
    }

    /// Principal point in the middle of the image, with the same focal length in both directions.
    pub(super) fn centred(width: u32, height: u32, focal: f64) -> Result<Self, ParameterError> {
        require("width", f64::from(width), width > 0, "at least 1")?;
        require("height", f64::from(height), height > 0, "at least 1")?;
        let [cx, cy] = [width, height].map(|side| (f64::from(side) - 1.0) * 0.5);
        Ok(Self { fx: focal, fy: focal, cx, cy, skew: 0.0 })
    }

    /// The pixel (column, row) of a point in the model's plane, or `None` if it is not finite.
    pub fn to_pixel(&self, plane: DVec2) -> Option<DVec2> {
        let pixel = DVec2::new(
            self.fx * plane.x + self.skew * plane.y + self.cx, //
            self.fy * plane.y + self.cy,
        );
        pixel.is_finite().then_some(pixel)
    }

    /// The inverse of [`Intrinsics::to_pixel`]: the point in the model's plane for a pixel.
    pub fn to_plane(&self, pixel: DVec2) -> Option<DVec2> {
        let y = (pixel.y - self.cy) / self.fy;
        let plane = DVec2::new((pixel.x - self.cx - self.skew * y) / self.fx, y);
        (pixel.is_finite() && plane.is_finite()).then_some(plane)
    }

    /// Rejects parameters that no camera has.
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        for (name, value) in [("fx", self.fx), ("fy", self.fy)] {
            require(name, value, value > 0.0 && value.is_finite(), "a finite number greater than 0")?;
        }
        require_finite("cx", self.cx)?;
        require_finite("cy", self.cy)?;
        require_finite("skew", self.skew)
    }
}
