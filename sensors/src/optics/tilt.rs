//! An image plane that is tilted with respect to the lens (Scheimpflug), as in OpenCV's fourteen coefficients.
//!
//! s·(x″, y″, 1) = P·R·(x′, y′, 1), where R rotates by τx about x and then by τy about y,
//!
//! | R = | | |
//! |---|---|---|
//! | cos τy | sin τy·sin τx | −sin τy·cos τx |
//! | 0 | cos τx | sin τx |
//! | sin τy | −cos τy·sin τx | cos τy·cos τx |
//!
//! and P projects the rotated plane back along the axis: its rows are (R₃₃, 0, −R₁₃), (0, R₃₃, −R₂₃), (0, 0, 1). Points
//! with s ≤ 0 are behind the plane. (OpenCV, documentation of `calib3d`.)

use glam::{DMat3, DVec2};

/// The homography of a tilt and its inverse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tilt {
    forward: DMat3,
    backward: DMat3,
}

impl Tilt {
    /// Creates a tilt from its angles in radians, both less than π/2 either way.
    pub(super) fn new(tau_x: f64, tau_y: f64) -> Self {
        let ((sin_x, cos_x), (sin_y, cos_y)) = (libm::sincos(tau_x), libm::sincos(tau_y));
        let turn = DMat3::from_cols_array_2d(&[
            [cos_y, 0.0, sin_y],
            [sin_y * sin_x, cos_x, -cos_y * sin_x],
            [-sin_y * cos_x, sin_x, cos_y * cos_x],
        ]);
        let axis = turn.z_axis;
        let flatten =
            DMat3::from_cols_array_2d(&[[axis.z, 0.0, 0.0], [0.0, axis.z, 0.0], [-axis.x, -axis.y, 1.0]]);
        let unflatten = DMat3::from_cols_array_2d(&[
            [1.0 / axis.z, 0.0, 0.0],
            [0.0, 1.0 / axis.z, 0.0],
            [axis.x / axis.z, axis.y / axis.z, 1.0],
        ]);
        Self { forward: flatten * turn, backward: turn.transpose() * unflatten }
    }

    /// Maps a point from the upright plane to the tilted one.
    pub(super) fn apply(&self, upright: DVec2) -> Option<DVec2> {
        through(&self.forward, upright)
    }

    /// The inverse of [`Tilt::apply`].
    pub(super) fn invert(&self, tilted: DVec2) -> Option<DVec2> {
        through(&self.backward, tilted)
    }
}

/// Applies a homography to a point; `None` for a point behind the plane.
fn through(matrix: &DMat3, point: DVec2) -> Option<DVec2> {
    let image = *matrix * point.extend(1.0);
    (image.z > 0.0).then(|| image.truncate() / image.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        for (tau_x, tau_y) in [(0.0, 0.0), (0.1, -0.2), (-1.2, 0.9)] {
            let tilt = Tilt::new(tau_x, tau_y);
            for point in [DVec2::ZERO, DVec2::new(0.3, -0.2), DVec2::new(-0.5, 0.4)] {
                let tilted = tilt.apply(point).unwrap();
                assert!((tilt.invert(tilted).unwrap() - point).length() < 1e-14);
            }
            // The axis stays where it is.
            assert!(tilt.apply(DVec2::ZERO).unwrap().length() < 1e-15);
        }
    }
}
