//! Brown–Conrady: the distortion of OpenCV's `projectPoints`, with 0 to 14 coefficients.

use super::distortion::Distortion;
use super::error::{require, require_finite};
use super::lens::unit;
use super::tilt::Tilt;
use super::{Intrinsics, Lens};
use crate::ParameterError;
use core::f64::consts::FRAC_PI_2;
use glam::{DVec2, DVec3};

/// Names of the coefficients, in order.
const NAMES: [&str; 14] =
    ["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4", "tau_x", "tau_y"];

/// A lens with a field of view of less than 180°, with radial, tangential and thin-prism distortion and a tilted
/// sensor.
///
/// With x = X/Z, y = Y/Z and r² = x² + y²:
///
/// | | |
/// |---|---|
/// | x′ | x·(1 + k1r² + k2r⁴ + k3r⁶)/(1 + k4r² + k5r⁴ + k6r⁶) + 2p1xy + p2(r² + 2x²) + s1r² + s2r⁴ |
/// | y′ | y·(the same) + p1(r² + 2y²) + 2p2xy + s3r² + s4r⁴ |
///
/// followed by the tilt by τx and τy about the axes of the sensor, and the intrinsic parameters.
///
/// The domain is the disc r ≤ [`max_radius`](BrownConrady::max_radius) around the axis, in which no two directions
/// share a pixel. Without tangential and prism terms it ends where the radial map stops increasing, or exceeds 10⁶;
/// with these terms it ends at a bound slightly before that. OpenCV has no such bound: its `projectPoints` folds points
/// from farther out back into the image, and the fixed-point iteration of its `undistortPoints` diverges there. Inside
/// the domain, the two agree.
///
/// ```
/// use belvedere_sensors::optics::{BrownConrady, Intrinsics, Lens};
/// use belvedere_sensors::glam::{DVec2, DVec3};
/// let intrinsics = Intrinsics { fx: 500.0, fy: 500.0, cx: 320.0, cy: 240.0, skew: 0.0 };
/// let lens = BrownConrady::new(intrinsics, &[-0.3, 0.1, 0.001, -0.0005, 0.0]).unwrap();
/// // x = 0.4, y = 0.3, r² = 0.25: x′ = 0.372455, y′ = 0.279685.
/// let pixel = lens.project(DVec3::new(0.8, 0.6, 2.0)).unwrap();
/// assert!(pixel.distance(DVec2::new(506.2275, 379.8425)) < 1e-9);
/// let direction = lens.unproject(pixel).unwrap();
/// assert!((direction / direction.z).distance(DVec3::new(0.4, 0.3, 1.0)) < 1e-12);
///
/// let error = BrownConrady::new(intrinsics, &[-0.3, 0.1, 0.001]).unwrap_err();
/// assert!(error.to_string().starts_with("number of coefficients of the lens is 3; it must be 0, 4, 5,"));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BrownConrady {
    intrinsics: Intrinsics,
    distortion: Distortion,
    tilt: Option<Tilt>,
}

impl BrownConrady {
    /// Creates a lens from the first 0, 4, 5, 8, 12 or 14 coefficients of k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 τx τy,
    /// the order of OpenCV and of ROS's `camera_info`; the others are 0. τx and τy are in radians, the others have no
    /// unit.
    ///
    /// # Errors
    /// If the number of coefficients is not one of these, if one is not finite, if a tilt is not less than π/2 either
    /// way, or if the intrinsic parameters are invalid, as in [`Pinhole::new`](super::Pinhole::new).
    pub fn new(intrinsics: Intrinsics, coefficients: &[f64]) -> Result<Self, ParameterError> {
        intrinsics.check()?;
        let count = coefficients.len();
        if !matches!(count, 0 | 4 | 5 | 8 | 12 | 14) {
            let rule = "0, 4, 5, 8, 12 or 14 (k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 τx τy): fill up with zeros";
            return Err(ParameterError::new("lens", "number of coefficients", count as f64, rule));
        }
        for (name, &value) in NAMES.into_iter().zip(coefficients) {
            require_finite(name, value)?;
        }
        let all: [f64; 14] = core::array::from_fn(|index| coefficients.get(index).copied().unwrap_or(0.0));
        let [most @ .., tau_x, tau_y] = all;
        for (name, value) in [("tau_x", tau_x), ("tau_y", tau_y)] {
            require(name, value, value.abs() < FRAC_PI_2, "between -π/2 and π/2")?;
        }
        let tilted = tau_x != 0.0 || tau_y != 0.0;
        Ok(Self {
            intrinsics,
            distortion: Distortion::new(most),
            tilt: tilted.then(|| Tilt::new(tau_x, tau_y)),
        })
    }

    /// The intrinsic parameters.
    pub fn intrinsics(&self) -> Intrinsics {
        self.intrinsics
    }

    /// The radius of the domain: the greatest r, the tangent of the angle from the axis. At most 10⁶.
    pub fn max_radius(&self) -> f64 {
        self.distortion.max_radius()
    }
}

impl Lens for BrownConrady {
    fn project(&self, point_in_optical: DVec3) -> Option<DVec2> {
        if !(point_in_optical.z > 0.0) {
            return None;
        }
        let undistorted = point_in_optical.truncate() / point_in_optical.z;
        if !self.distortion.contains(undistorted) {
            return None;
        }
        let distorted = self.distortion.apply(undistorted);
        let on_sensor = match &self.tilt {
            Some(tilt) => tilt.apply(distorted)?,
            None => distorted,
        };
        self.intrinsics.to_pixel(on_sensor)
    }

    fn unproject(&self, pixel: DVec2) -> Option<DVec3> {
        let on_sensor = self.intrinsics.to_plane(pixel)?;
        let distorted = match &self.tilt {
            Some(tilt) => tilt.invert(on_sensor)?,
            None => on_sensor,
        };
        unit(self.distortion.invert(distorted)?.extend(1.0))
    }
}
