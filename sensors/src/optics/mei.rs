//! Mei's model: the unified camera model with radial and tangential distortion.

use super::distortion::Distortion;
use super::error::{require, require_finite};
use super::lens::unit;
use super::{Intrinsics, Lens};
use crate::ParameterError;
use glam::{DVec2, DVec3};

/// A fisheye lens or a mirror: the point on the unit sphere is projected to v = (x, y)/(z + ξ), then distorted to v·(1
/// + k1r² + k2r⁴) plus tangential terms as in [`BrownConrady`](super::BrownConrady).
///
/// The domain requires z > −ξ if ξ ≤ 1, and z > −1/ξ otherwise, since there r stops increasing with the angle; and r
/// within the domain of the distortion ([`max_radius`](Mei::max_radius)). OpenCV's `omnidir` is the same without a
/// domain.
///
/// (C. Mei, P. Rives, "Single view point omnidirectional camera calibration from planar grids", 2007,
/// doi:10.1109/ROBOT.2007.364084.)
///
/// ```
/// use belvedere_sensors::optics::{Intrinsics, Lens, Mei};
/// use belvedere_sensors::glam::{DVec2, DVec3};
/// let intrinsics = Intrinsics { fx: 400.0, fy: 400.0, cx: 319.5, cy: 239.5, skew: 0.0 };
/// let lens = Mei::new(intrinsics, 1.25, [-0.1, 0.0, 0.0, 0.0]).unwrap();
/// // At 90° r = 1/ξ = 0.8, and r′ = 0.8·(1 − 0.064).
/// let pixel = lens.project(DVec3::X).unwrap();
/// assert!(pixel.distance(DVec2::new(319.5 + 400.0 * 0.748_8, 239.5)) < 1e-9);
/// assert!(lens.unproject(pixel).unwrap().distance(DVec3::X) < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mei {
    intrinsics: Intrinsics,
    xi: f64,
    distortion: Distortion,
    /// The domain is z > `lowest` on the unit sphere.
    lowest: f64,
}

impl Mei {
    /// Creates a lens from ξ, greater than −1, and the distortion coefficients k1 k2 p1 p2.
    ///
    /// # Errors
    /// If ξ is out of range, if a coefficient is not finite, or if the intrinsic parameters are invalid, as in
    /// [`Pinhole::new`](super::Pinhole::new).
    pub fn new(intrinsics: Intrinsics, xi: f64, coefficients: [f64; 4]) -> Result<Self, ParameterError> {
        intrinsics.check()?;
        require("xi", xi, xi > -1.0 && xi.is_finite(), "a finite number greater than -1")?;
        for (name, value) in ["k1", "k2", "p1", "p2"].into_iter().zip(coefficients) {
            require_finite(name, value)?;
        }
        let mut all = [0.0; 12];
        all[..4].copy_from_slice(&coefficients);
        let lowest = if xi <= 1.0 { -xi } else { -1.0 / xi };
        Ok(Self { intrinsics, xi, distortion: Distortion::new(all), lowest })
    }

    /// The intrinsic parameters.
    pub fn intrinsics(&self) -> Intrinsics {
        self.intrinsics
    }

    /// The end of the distortion's domain: the greatest r in the plane, before distortion.
    pub fn max_radius(&self) -> f64 {
        self.distortion.max_radius()
    }
}

impl Lens for Mei {
    fn project(&self, point_in_optical: DVec3) -> Option<DVec2> {
        let direction = unit(point_in_optical)?;
        if !(direction.z > self.lowest) {
            return None;
        }
        let plane = direction.truncate() / (direction.z + self.xi);
        if !self.distortion.contains(plane) {
            return None;
        }
        self.intrinsics.to_pixel(self.distortion.apply(plane))
    }

    fn unproject(&self, pixel: DVec2) -> Option<DVec3> {
        let plane = self.distortion.invert(self.intrinsics.to_plane(pixel)?)?;
        // The last intersection with the sphere of the ray through (x, y, 1) that starts ξ behind the sphere's centre.
        let square = plane.dot(plane);
        let under_root = 1.0 + (1.0 - self.xi * self.xi) * square;
        if !(under_root >= 0.0) {
            return None;
        }
        let along = (self.xi + libm::sqrt(under_root)) / (1.0 + square);
        unit((plane * along).extend(along - self.xi))
    }
}
