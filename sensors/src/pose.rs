//! Rigid poses in double precision.
//!
//! A pose named `a_from_b` maps the coordinates of frame b to those of frame a, so that
//! `point_in_a = a_from_b.transform_point(point_in_b)` and `a_from_c = a_from_b * b_from_c`.

use bytemuck::{Pod, Zeroable};
use core::ops::Mul;
use glam::{DMat3, DQuat, DVec3};

/// A rotation followed by a translation, in metres.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Pose {
    /// Rotation as a unit quaternion (x, y, z, w).
    rotation: [f64; 4],
    /// Translation in metres.
    translation: [f64; 3],
}

impl Pose {
    /// The identity pose.
    pub const IDENTITY: Self = Self { rotation: [0.0, 0.0, 0.0, 1.0], translation: [0.0; 3] };

    /// Creates a pose from a translation in metres and a rotation, which is normalised.
    pub fn new(translation: DVec3, rotation: DQuat) -> Self {
        Self { rotation: rotation.normalize().to_array(), translation: translation.to_array() }
    }

    /// Creates a pure translation in metres.
    pub fn from_translation(translation: DVec3) -> Self {
        Self { translation: translation.to_array(), ..Self::IDENTITY }
    }

    /// Creates a pose from a translation in metres and fixed-axis roll, pitch, yaw in radians, as in URDF and SDF: R =
    /// Rz(yaw) · Ry(pitch) · Rx(roll).
    ///
    /// ```
    /// use belvedere_sensors::Pose;
    /// use belvedere_sensors::glam::DVec3;
    /// // The articles' ceiling camera: pitched by −90°, its x axis points up.
    /// let base_from_camera = Pose::from_xyz_rpy(DVec3::new(0.15, 0.0, 0.35), DVec3::new(0.0, -1.5708, 0.0));
    /// let up = base_from_camera.transform_vector(DVec3::X);
    /// assert!((up - DVec3::Z).length() < 1e-5);
    /// ```
    pub fn from_xyz_rpy(xyz: DVec3, rpy: DVec3) -> Self {
        // Uses libm instead of the platform's functions, so that the bits are the same on every machine.
        let half = |angle: f64| libm::sincos(angle * 0.5);
        let (sr, cr) = half(rpy.x);
        let (sp, cp) = half(rpy.y);
        let (sy, cy) = half(rpy.z);
        Self::new(
            xyz,
            DQuat::from_xyzw(
                sr * cp * cy - cr * sp * sy,
                cr * sp * cy + sr * cp * sy,
                cr * cp * sy - sr * sp * cy,
                cr * cp * cy + sr * sp * sy,
            ),
        )
    }

    /// The translation in metres.
    pub fn translation(&self) -> DVec3 {
        DVec3::from_array(self.translation)
    }

    /// The rotation as a unit quaternion.
    pub fn rotation(&self) -> DQuat {
        DQuat::from_array(self.rotation)
    }

    /// The rotation as a matrix, whose columns are the axes of the inner frame in the outer one.
    pub fn rotation_matrix(&self) -> DMat3 {
        DMat3::from_quat(self.rotation())
    }

    /// Returns the inverse pose: `a_from_b.inverse()` is `b_from_a`.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation().conjugate();
        Self { rotation: rotation.to_array(), translation: (rotation * -self.translation()).to_array() }
    }

    /// Transforms a point.
    pub fn transform_point(&self, point: DVec3) -> DVec3 {
        self.rotation() * point + self.translation()
    }

    /// Rotates a direction, without translating it.
    pub fn transform_vector(&self, vector: DVec3) -> DVec3 {
        self.rotation() * vector
    }

    /// Interpolates between this pose (`fraction` 0) and `other` (`fraction` 1).
    ///
    /// The translation moves along a straight line, the rotation along the shorter arc by normalised linear
    /// interpolation, which differs from constant speed by less than 1e-6 rad for steps below 0.05 rad and needs no
    /// transcendental function.
    #[must_use]
    pub fn interpolate(&self, other: &Self, fraction: f64) -> Self {
        let (from, to) = (self.rotation(), other.rotation());
        let to = if from.dot(to) < 0.0 { -to } else { to };
        Self::new(
            self.translation() + (other.translation() - self.translation()) * fraction,
            from * (1.0 - fraction) + to * fraction,
        )
    }

    /// Returns fixed-axis roll, pitch and yaw in radians: the inverse of [`Pose::from_xyz_rpy`]. At a pitch of ±90°,
    /// the roll is 0.
    pub fn rpy(&self) -> DVec3 {
        let m = self.rotation_matrix();
        let sin_pitch = -m.x_axis.z;
        if sin_pitch.abs() > 1.0 - 1e-12 {
            let yaw = libm::atan2(-m.y_axis.x, m.y_axis.y);
            return DVec3::new(0.0, libm::copysign(core::f64::consts::FRAC_PI_2, sin_pitch), yaw);
        }
        DVec3::new(
            libm::atan2(m.y_axis.z, m.z_axis.z),
            libm::asin(sin_pitch),
            libm::atan2(m.x_axis.y, m.x_axis.x),
        )
    }

    /// Returns true if every component is finite.
    pub fn is_finite(&self) -> bool {
        self.rotation().is_finite() && self.translation().is_finite()
    }
}

impl Default for Pose {
    fn default() -> Self {
        Self::IDENTITY
    }
}

/// The reason why a matrix is not a [`Pose`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum NotRigid {
    /// An element is NaN or infinite.
    NotFinite,
    /// The upper left 3×3 part scales, shears or mirrors by more than 1e-6.
    NotRotation,
    /// The last row is not (0, 0, 0, 1).
    NotAffine,
}

impl core::fmt::Display for NotRigid {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "the matrix has an element that is NaN or infinite",
            Self::NotRotation => "the matrix scales, shears or mirrors; a pose only turns and moves",
            Self::NotAffine => "the last row of the matrix must be 0 0 0 1; is the matrix transposed?",
        })
    }
}

impl core::error::Error for NotRigid {}

impl Mul for Pose {
    type Output = Self;

    fn mul(self, inner: Self) -> Self {
        Self::new(self.transform_point(inner.translation()), self.rotation() * inner.rotation())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rpy_round_trips() {
        for rpy in [DVec3::new(0.1, -0.7, 2.9), DVec3::new(-3.0, 1.5, -0.2), DVec3::ZERO] {
            let pose = Pose::from_xyz_rpy(DVec3::new(1.0, 2.0, 3.0), rpy);
            assert!((pose.rpy() - rpy).length() < 1e-12, "{rpy} came back as {}", pose.rpy());
        }
    }

    #[test]
    fn inverse_undoes() {
        let a_from_b = Pose::from_xyz_rpy(DVec3::new(4.0, -5.0, 6.0), DVec3::new(0.3, 0.2, -1.1));
        let point = DVec3::new(0.5, 0.25, -8.0);
        assert!(
            (a_from_b.inverse().transform_point(a_from_b.transform_point(point)) - point).length() < 1e-12
        );
        let nothing = a_from_b * a_from_b.inverse();
        assert!(nothing.translation().length() < 1e-12 && nothing.rpy().length() < 1e-12);
    }

    #[test]
    fn interpolation_hits_both_ends() {
        let from = Pose::from_xyz_rpy(DVec3::ZERO, DVec3::ZERO);
        let to = Pose::from_xyz_rpy(DVec3::X, DVec3::new(0.0, 0.0, 0.04));
        assert_eq!(from.interpolate(&to, 0.0), from);
        assert!((from.interpolate(&to, 1.0).rpy() - to.rpy()).length() < 1e-12);
        assert!((from.interpolate(&to, 0.25).rpy().z - 0.01).abs() < 1e-6);
    }
}
