//! The double sphere camera model.

use super::error::require;
use super::eucm::bound;
use super::lens::unit;
use super::{Intrinsics, Lens};
use crate::ParameterError;
use glam::{DVec2, DVec3};

/// A fisheye lens: (x, y)/(αd₂ + (1−α)(ξd₁ + z)) with d₁ = √(x² + y² + z²), d₂ = √(x² + y² + (ξd₁ + z)²).
///
/// A direction is projected onto a unit sphere, then onto a second one shifted by ξ along the axis, then by a pinhole
/// shifted by α/(1−α). Fisheye lenses have ξ of about −0.2 and α of about 0.6. The inverse has a closed form.
///
/// The domain contains the pixels with r² ≤ 1/(2α−1) if α > ½, and all pixels otherwise. For points, the same domain is
/// ξd₁ + z > −w·d₂, with w = α/(1−α) if α ≤ ½ and w = (1−α)/α otherwise. The paper bounds points by z > −w₂d₁ with w₂ =
/// (w + ξ)/√(2wξ + ξ² + 1), which is the same only for ξ = 0. Otherwise, pixels at the rim have no points (for ξ =
/// −0.2, α = 0.6 points end at 122.05°, the image at 123.24°), or, for ξ near −1, points are allowed that have no
/// pixel.
///
/// (V. Usenko, N. Demmel, D. Cremers, "The double sphere camera model", 2018, arXiv:1807.08957.)
///
/// ```
/// use belvedere_sensors::optics::{DoubleSphere, Intrinsics, Lens};
/// use belvedere_sensors::glam::{DVec2, DVec3};
/// let intrinsics = Intrinsics { fx: 200.0, fy: 200.0, cx: 319.5, cy: 239.5, skew: 0.0 };
/// let lens = DoubleSphere::new(intrinsics, -0.2, 0.6).unwrap();
/// // d₁ = 1, d₂ = √1.04: r = 1/(0.6·√1.04 − 0.4·0.2).
/// let pixel = lens.project(DVec3::X).unwrap();
/// assert!(pixel.distance(DVec2::new(319.5 + 200.0 * 1.880_115_5, 239.5)) < 1e-4);
/// assert!(lens.unproject(pixel).unwrap().distance(DVec3::X) < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoubleSphere {
    intrinsics: Intrinsics,
    xi: f64,
    alpha: f64,
    /// The bound w of the domain.
    bound: f64,
}

impl DoubleSphere {
    /// Creates a lens from ξ, greater than −1 and at most 1, and α, from 0 to 1.
    ///
    /// # Errors
    /// If ξ or α is out of range, or if the intrinsic parameters are invalid, as in
    /// [`Pinhole::new`](super::Pinhole::new).
    pub fn new(intrinsics: Intrinsics, xi: f64, alpha: f64) -> Result<Self, ParameterError> {
        intrinsics.check()?;
        require("xi", xi, xi > -1.0 && xi <= 1.0, "greater than -1 and at most 1")?;
        require("alpha", alpha, (0.0..=1.0).contains(&alpha), "from 0 to 1")?;
        Ok(Self { intrinsics, xi, alpha, bound: bound(alpha) })
    }

    /// The intrinsic parameters.
    pub fn intrinsics(&self) -> Intrinsics {
        self.intrinsics
    }

    /// The end of the domain: all angles from the axis are less than this, in radians.
    pub fn max_angle(&self) -> f64 {
        // As seen from the centre of the second sphere, the last direction has cosine −w; it leaves the first sphere at
        // z = d₂·(−w) − ξ with d₂ = −wξ + √(1 − ξ²(1 − w²)).
        let (w, xi) = (self.bound, self.xi);
        let d2 = -w * xi + libm::sqrt(1.0 - xi * xi * (1.0 - w * w));
        libm::acos((-w * d2 - xi).max(-1.0))
    }
}

impl Lens for DoubleSphere {
    fn project(&self, point_in_optical: DVec3) -> Option<DVec2> {
        let direction = unit(point_in_optical)?;
        let across = direction.truncate();
        let shifted = self.xi + direction.z;
        let d2 = libm::sqrt(across.dot(across) + shifted * shifted);
        if !(shifted > -self.bound * d2) {
            return None;
        }
        self.intrinsics.to_pixel(across / (self.alpha * d2 + (1.0 - self.alpha) * shifted))
    }

    fn unproject(&self, pixel: DVec2) -> Option<DVec3> {
        let plane = self.intrinsics.to_plane(pixel)?;
        let square = plane.dot(plane);
        let under_root = 1.0 - (2.0 * self.alpha - 1.0) * square;
        if !(under_root >= 0.0) {
            return None;
        }
        // Step 1: the direction from the centre of the second sphere.
        let z = (1.0 - self.alpha * self.alpha * square)
            / (self.alpha * libm::sqrt(under_root) + 1.0 - self.alpha);
        let from_second = unit(plane.extend(z))?;
        // Step 2: its intersection with the first sphere, whose centre is ξ behind.
        let along = self.xi * from_second.z;
        let distance = along + libm::sqrt((1.0 - self.xi * self.xi) + along * along);
        unit(from_second * distance - DVec3::new(0.0, 0.0, self.xi))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The figures of the documentation: the end of the image, and the end of points according to the paper.
    #[test]
    fn end_of_the_domain() {
        let intrinsics = Intrinsics { fx: 1.0, fy: 1.0, cx: 0.0, cy: 0.0, skew: 0.0 };
        let lens = DoubleSphere::new(intrinsics, -0.2, 0.6).unwrap();
        assert!((lens.max_angle().to_degrees() - 123.24).abs() < 0.01);
        let rim = lens.unproject(DVec2::new(libm::sqrt(1.0 / 0.2) * 0.999_999_999, 0.0)).unwrap();
        assert!((libm::acos(rim.z) - lens.max_angle()).abs() < 1e-3);
        let (w, xi) = (bound(0.6), -0.2);
        let w2 = (w + xi) / libm::sqrt(2.0 * w * xi + xi * xi + 1.0);
        assert!((libm::acos(-w2).to_degrees() - 122.05).abs() < 0.01);
    }
}
