//! The enhanced unified camera model.

use super::error::require;
use super::lens::unit;
use super::{Intrinsics, Lens};
use crate::ParameterError;
use core::f64::consts::PI;
use glam::{DVec2, DVec3};

/// A wide-angle lens: (x, y)/(αd + (1−α)z) with d = √(β(x² + y²) + z²).
///
/// α = 0 is a pinhole; β = 1 is the unified camera model. The domain contains the directions with z > −w·d, where w =
/// α/(1−α) if α ≤ ½ and w = (1−α)/α otherwise, and the pixels with r² ≤ 1/(β(2α−1)) if α > ½. The inverse has a closed
/// form: z = (1 − βα²r²)/(α√(1 − (2α−1)βr²) + 1 − α) for (x, y) on the plane.
///
/// (B. Khomutenko, G. Garcia, P. Martinet, "An enhanced unified camera model", 2016; V. Usenko, N. Demmel,
/// D. Cremers, "The double sphere camera model", 2018, arXiv:1807.08957, for the domain.)
///
/// ```
/// use belvedere_sensors::optics::{Eucm, Intrinsics, Lens};
/// use belvedere_sensors::glam::{DVec2, DVec3};
/// let intrinsics = Intrinsics { fx: 200.0, fy: 200.0, cx: 319.5, cy: 239.5, skew: 0.0 };
/// let lens = Eucm::new(intrinsics, 0.625, 1.0).unwrap();
/// // At 90° d = 1, so r = 1/α.
/// assert_eq!(lens.project(DVec3::new(0.0, 3.0, 0.0)), Some(DVec2::new(319.5, 559.5)));
/// // The image ends at r² = 1/(2α−1) = 4.
/// assert!(lens.unproject(DVec2::new(319.5 + 399.9, 239.5)).is_some());
/// assert_eq!(lens.unproject(DVec2::new(319.5 + 400.1, 239.5)), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eucm {
    intrinsics: Intrinsics,
    alpha: f64,
    beta: f64,
    /// The bound w of the domain.
    bound: f64,
}

impl Eucm {
    /// Creates a lens from α, 0 to 1, and β, greater than 0.
    ///
    /// # Errors
    /// If α or β is out of range, or if the intrinsic parameters are invalid, as in
    /// [`Pinhole::new`](super::Pinhole::new).
    pub fn new(intrinsics: Intrinsics, alpha: f64, beta: f64) -> Result<Self, ParameterError> {
        intrinsics.check()?;
        require("alpha", alpha, (0.0..=1.0).contains(&alpha), "from 0 to 1")?;
        require("beta", beta, beta > 0.0 && beta.is_finite(), "a finite number greater than 0")?;
        Ok(Self { intrinsics, alpha, beta, bound: bound(alpha) })
    }

    /// The intrinsic parameters.
    pub fn intrinsics(&self) -> Intrinsics {
        self.intrinsics
    }

    /// The end of the domain: all angles from the axis are less than this, in radians.
    pub fn max_angle(&self) -> f64 {
        // z = −w·d with z² + (x² + y²) = 1.
        let square = self.bound * self.bound;
        let cos = -self.bound * libm::sqrt(self.beta / (1.0 - square + square * self.beta));
        if cos > -1.0 { libm::acos(cos) } else { PI }
    }
}

/// The bound w of the domain. For z > −w·d, the image radius of the unified model increases with the angle (α > ½), or
/// its denominator is positive (α ≤ ½).
pub(super) fn bound(alpha: f64) -> f64 {
    if alpha <= 0.5 { alpha / (1.0 - alpha) } else { (1.0 - alpha) / alpha }
}

impl Lens for Eucm {
    fn project(&self, point_in_optical: DVec3) -> Option<DVec2> {
        let direction = unit(point_in_optical)?;
        let across = direction.truncate();
        let d = libm::sqrt(self.beta * across.dot(across) + direction.z * direction.z);
        if !(direction.z > -self.bound * d) {
            return None;
        }
        self.intrinsics.to_pixel(across / (self.alpha * d + (1.0 - self.alpha) * direction.z))
    }

    fn unproject(&self, pixel: DVec2) -> Option<DVec3> {
        let plane = self.intrinsics.to_plane(pixel)?;
        let square = self.beta * plane.dot(plane);
        let under_root = 1.0 - (2.0 * self.alpha - 1.0) * square;
        if !(under_root >= 0.0) {
            return None;
        }
        let z = (1.0 - self.alpha * self.alpha * square)
            / (self.alpha * libm::sqrt(under_root) + 1.0 - self.alpha);
        unit(plane.extend(z))
    }
}
