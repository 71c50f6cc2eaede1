//! The equirectangular panorama.

use super::error::require;
use super::lens::{length, unit};
use super::{Intrinsics, Lens};
use crate::ParameterError;
use core::f64::consts::{FRAC_PI_2, PI, TAU};
use glam::{DVec2, DVec3};

/// A panorama of 360° × 180°: columns are longitudes and rows latitudes, both evenly spaced.
///
/// | | |
/// |---|---|
/// | longitude | λ = atan2(x, z), to the right of the axis |
/// | latitude | φ = atan2(−y, √(x² + z²)), up |
/// | column | (λ/2π + ½)·width − ½ |
/// | row | (½ − φ/π)·height − ½ |
///
/// The axis is in the middle of the image, and what is behind at its left and right borders. Its domain are all
/// directions, and all pixels from (−½, −½) to (width − ½, height − ½). Straight up and down, each of which is a
/// whole row's border, is given the middle column.
///
/// ```
/// use belvedere_sensors::optics::{Equirectangular, Lens};
/// use glam::{DVec2, DVec3};
/// let lens = Equirectangular::new(3600, 1800).unwrap();
/// assert_eq!(lens.project(DVec3::Z), Some(DVec2::new(1799.5, 899.5)));
/// // Right is 90° = 900 columns on.
/// assert_eq!(lens.project(DVec3::X), Some(DVec2::new(2699.5, 899.5)));
/// // Up is −y.
/// assert_eq!(lens.project(DVec3::NEG_Y), Some(DVec2::new(1799.5, -0.5)));
/// assert!(lens.unproject(DVec2::new(2699.5, 899.5)).unwrap().distance(DVec3::X) < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Equirectangular {
    /// fx and fy are pixels per radian of longitude and of latitude.
    intrinsics: Intrinsics,
}

impl Equirectangular {
    /// A panorama of that many pixels; square ones if the width is twice the height.
    ///
    /// # Errors
    /// When a side is 0.
    pub fn new(width: u32, height: u32) -> Result<Self, ParameterError> {
        let [width, height] = [width, height].map(f64::from);
        require("width", width, width > 0.0, "at least 1")?;
        require("height", height, height > 0.0, "at least 1")?;
        Self::with_intrinsics(Intrinsics {
            fx: width / TAU,
            fy: height / PI,
            cx: (width - 1.0) * 0.5,
            cy: (height - 1.0) * 0.5,
            skew: 0.0,
        })
    }

    /// A part of one: fx and fy are pixels per radian of longitude and of latitude, cx and cy where both are 0.
    ///
    /// # Errors
    /// When an intrinsic parameter is not finite, or a focal length not greater than 0.
    pub fn with_intrinsics(intrinsics: Intrinsics) -> Result<Self, ParameterError> {
        intrinsics.check()?;
        Ok(Self { intrinsics })
    }
}

impl Lens for Equirectangular {
    fn project(&self, point_in_optical: DVec3) -> Option<DVec2> {
        let direction = unit(point_in_optical)?;
        let longitude = libm::atan2(direction.x, direction.z);
        let latitude = libm::atan2(-direction.y, length(DVec2::new(direction.x, direction.z)));
        self.intrinsics.to_pixel(DVec2::new(longitude, -latitude))
    }

    fn unproject(&self, pixel: DVec2) -> Option<DVec3> {
        let DVec2 { x: longitude, y: down } = self.intrinsics.to_plane(pixel)?;
        // Rounding may put the edge of a picture a little beyond.
        if !(longitude.abs() <= PI * (1.0 + 1e-12) && down.abs() <= FRAC_PI_2 * (1.0 + 1e-12)) {
            return None;
        }
        let (sin_longitude, cos_longitude) = libm::sincos(longitude);
        let (sin_latitude, cos_latitude) = libm::sincos(-down);
        Some(DVec3::new(cos_latitude * sin_longitude, -sin_latitude, cos_latitude * cos_longitude))
    }
}
