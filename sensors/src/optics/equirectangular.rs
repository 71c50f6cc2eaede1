//! The equirectangular panorama.

use super::error::require;
use super::lens::{length, unit};
use super::{Intrinsics, Lens};
use crate::ParameterError;
use core::f64::consts::{FRAC_PI_2, PI, TAU};
use glam::{DVec2, DVec3};

/// A panorama of 360° × 180°: columns are longitudes, rows are latitudes, both equally spaced.
///
/// | | |
/// |---|---|
/// | longitude | λ = atan2(x, z), to the right of the axis |
/// | latitude | φ = atan2(−y, √(x² + z²)), up |
/// | column | (λ/2π + ½)·width − ½ |
/// | row | (½ − φ/π)·height − ½ |
///
/// The axis is in the middle of the image; the direction backwards is at its left and right edges. The domain contains
/// all directions, and all pixels from (−½, −½) to (width − ½, height − ½). The directions straight up and straight
/// down, each of which fills a whole edge, are given the middle column.
///
/// ```
/// use belvedere_sensors::optics::{Equirectangular, Lens};
/// use belvedere_sensors::glam::{DVec2, DVec3};
/// let lens = Equirectangular::new(3600, 1800).unwrap();
/// assert_eq!(lens.project(DVec3::Z), Some(DVec2::new(1799.5, 899.5)));
/// // Right is 90°, which is 900 columns further.
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
    /// Creates a full panorama of the given size in pixels. Pixels are square if the width is twice the height.
    ///
    /// # Errors
    /// If a side is 0.
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

    /// Creates a part of a panorama. fx and fy are pixels per radian of longitude and of latitude; (cx, cy) is the
    /// pixel at which both are 0.
    ///
    /// # Errors
    /// If an intrinsic parameter is not finite, or a focal length is not greater than 0.
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
        // Rounding may move the edge of the image slightly outwards.
        if !(longitude.abs() <= PI * (1.0 + 1e-12) && down.abs() <= FRAC_PI_2 * (1.0 + 1e-12)) {
            return None;
        }
        let (sin_longitude, cos_longitude) = libm::sincos(longitude);
        let (sin_latitude, cos_latitude) = libm::sincos(-down);
        Some(DVec3::new(cos_latitude * sin_longitude, -sin_latitude, cos_latitude * cos_longitude))
    }
}
