//! The pinhole camera: (x/z, y/z), for z > 0.

use super::lens::unit;
use super::{Intrinsics, Lens};
use crate::ParameterError;
use glam::{DVec2, DVec3};

/// A lens without distortion. Its domain is all directions less than 90° from the axis.
///
/// ```
/// use belvedere_sensors::optics::{Intrinsics, Lens, Pinhole};
/// use belvedere_sensors::glam::{DVec2, DVec3};
/// let intrinsics = Intrinsics { fx: 300.0, fy: 400.0, cx: 319.5, cy: 239.5, skew: 0.0 };
/// let lens = Pinhole::new(intrinsics).unwrap();
/// assert_eq!(lens.project(DVec3::new(1.0, -0.5, 2.0)), Some(DVec2::new(469.5, 139.5)));
/// assert_eq!(lens.unproject(DVec2::new(319.5, 239.5)), Some(DVec3::Z));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pinhole {
    intrinsics: Intrinsics,
}

impl Pinhole {
    /// Creates a pinhole camera.
    ///
    /// # Errors
    /// If an intrinsic parameter is not finite, or a focal length is not greater than 0.
    pub fn new(intrinsics: Intrinsics) -> Result<Self, ParameterError> {
        intrinsics.check()?;
        Ok(Self { intrinsics })
    }

    /// The intrinsic parameters.
    pub fn intrinsics(&self) -> Intrinsics {
        self.intrinsics
    }
}

impl Lens for Pinhole {
    fn project(&self, point_in_optical: DVec3) -> Option<DVec2> {
        if !(point_in_optical.z > 0.0) {
            return None;
        }
        self.intrinsics.to_pixel(point_in_optical.truncate() / point_in_optical.z)
    }

    fn unproject(&self, pixel: DVec2) -> Option<DVec3> {
        unit(self.intrinsics.to_plane(pixel)?.extend(1.0))
    }
}
