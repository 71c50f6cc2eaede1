//! Kannala–Brandt: fisheye lenses whose image radius is an odd polynomial of the angle.

use super::error::require_finite;
use super::increasing::solve;
use super::lens::{at_angle, length, unit};
use super::polynomial::Polynomial;
use super::{Intrinsics, Lens};
use crate::ParameterError;
use core::f64::consts::PI;
use glam::{DVec2, DVec3};

/// A fisheye lens: r(θ) = θ + k1θ³ + k2θ⁵ + k3θ⁷ + k4θ⁹ at the angle θ from the axis, up to θ = π.
///
/// The point in the plane is r(θ)·(x, y)/√(x² + y²). With k = 0 the lens is equidistant. The domain ends at
/// [`max_angle`](KannalaBrandt::max_angle), where r stops increasing. OpenCV's `fisheye` is the same for points in
/// front of the camera, but does not support points behind it; here angles beyond 90° are treated like any others.
///
/// (J. Kannala, S. S. Brandt, "A generic camera model and calibration method for conventional, wide-angle, and
/// fish-eye lenses", 2006, doi:10.1109/TPAMI.2006.153.)
///
/// ```
/// use belvedere_sensors::optics::{Intrinsics, KannalaBrandt, Lens};
/// use belvedere_sensors::glam::{DVec2, DVec3};
/// let intrinsics = Intrinsics { fx: 250.0, fy: 250.0, cx: 319.5, cy: 239.5, skew: 0.0 };
/// let lens = KannalaBrandt::new(intrinsics, [-0.02, 0.0, 0.0, 0.0]).unwrap();
/// // θ = 1, on the left: r = 0.98.
/// let point = DVec3::new(-1.0_f64.sin(), 0.0, 1.0_f64.cos());
/// let pixel = lens.project(point).unwrap();
/// assert!(pixel.distance(DVec2::new(74.5, 239.5)) < 1e-9);
/// assert!(lens.unproject(pixel).unwrap().distance(point) < 1e-14);
/// // 1 − 0.06θ² becomes 0 only beyond π.
/// assert_eq!(lens.max_angle(), std::f64::consts::PI);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KannalaBrandt {
    intrinsics: Intrinsics,
    coefficients: [f64; 4],
    max_angle: f64,
}

impl KannalaBrandt {
    /// Creates a lens from k1 k2 k3 k4, in the order of OpenCV and of ROS's `equidistant`.
    ///
    /// # Errors
    /// If a coefficient is not finite, or if the intrinsic parameters are invalid, as in
    /// [`Pinhole::new`](super::Pinhole::new).
    pub fn new(intrinsics: Intrinsics, coefficients: [f64; 4]) -> Result<Self, ParameterError> {
        intrinsics.check()?;
        for (name, value) in ["k1", "k2", "k3", "k4"].into_iter().zip(coefficients) {
            require_finite(name, value)?;
        }
        let [k1, k2, k3, k4] = coefficients;
        // dr/dθ as a polynomial in θ².
        let slope = Polynomial::new([1.0, 3.0 * k1, 5.0 * k2, 7.0 * k3, 9.0 * k4]);
        let max_square = slope.positive_up_to(PI * PI);
        let max_angle = libm::sqrt(max_square).min(PI);
        Ok(Self { intrinsics, coefficients, max_angle })
    }

    /// The intrinsic parameters.
    pub fn intrinsics(&self) -> Intrinsics {
        self.intrinsics
    }

    /// The end of the domain: the greatest angle from the axis in radians, at most π.
    pub fn max_angle(&self) -> f64 {
        self.max_angle
    }

    /// r and dr/dθ at an angle.
    fn radius(&self, angle: f64) -> (f64, f64) {
        let [k1, k2, k3, k4] = self.coefficients;
        let s = angle * angle;
        (
            angle * (1.0 + s * (k1 + s * (k2 + s * (k3 + s * k4)))),
            1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * (7.0 * k3 + s * 9.0 * k4))),
        )
    }
}

impl Lens for KannalaBrandt {
    fn project(&self, point_in_optical: DVec3) -> Option<DVec2> {
        let direction = unit(point_in_optical)?;
        let from_axis = length(direction.truncate());
        let angle = libm::atan2(from_axis, direction.z);
        if angle > self.max_angle {
            return None;
        }
        if from_axis == 0.0 {
            // The direction straight backwards is a circle in the image, not a pixel.
            return if direction.z > 0.0 { self.intrinsics.to_pixel(DVec2::ZERO) } else { None };
        }
        self.intrinsics.to_pixel(direction.truncate() * (self.radius(angle).0 / from_axis))
    }

    fn unproject(&self, pixel: DVec2) -> Option<DVec3> {
        let plane = self.intrinsics.to_plane(pixel)?;
        let radius = length(plane);
        if !(radius <= self.radius(self.max_angle).0) {
            return None;
        }
        let angle =
            solve(|angle| self.radius(angle), radius, self.max_angle, radius.min(self.max_angle * 0.9));
        Some(at_angle(angle, plane, radius))
    }
}
