//! Poses in the types of other crates.

use crate::pose::Pose;
use glam::{DAffine3, DMat4};

impl From<Pose> for DAffine3 {
    /// ```
    /// use belvedere_sensors::Pose;
    /// use glam::{DAffine3, DVec3};
    /// let a_from_b = Pose::from_xyz_rpy(DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.1, 0.2, 0.3));
    /// let point = DVec3::new(4.0, 5.0, 6.0);
    /// let off = DAffine3::from(a_from_b).transform_point3(point) - a_from_b.transform_point(point);
    /// assert!(off.length() < 1e-14);
    /// ```
    fn from(pose: Pose) -> Self {
        Self::from_rotation_translation(pose.rotation(), pose.translation())
    }
}

impl From<Pose> for DMat4 {
    fn from(pose: Pose) -> Self {
        Self::from_rotation_translation(pose.rotation(), pose.translation())
    }
}

#[cfg(feature = "nalgebra")]
impl From<Pose> for nalgebra::Isometry3<f64> {
    /// ```
    /// use belvedere_sensors::Pose;
    /// use glam::DVec3;
    /// use nalgebra::{Isometry3, Point3};
    /// let a_from_b = Pose::from_xyz_rpy(DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.1, 0.2, 0.3));
    /// let isometry = Isometry3::from(a_from_b);
    /// let off = isometry * Point3::new(4.0, 5.0, 6.0) - Point3::new(4.679_798_2, 7.718_901_3, 8.545_561_6);
    /// assert!(off.norm() < 1e-6, "{off}");
    /// let back = Pose::from(isometry);
    /// assert!((back.rotation().dot(a_from_b.rotation()) - 1.0).abs() < 1e-15);
    /// assert_eq!(back.translation(), a_from_b.translation());
    /// ```
    fn from(pose: Pose) -> Self {
        let [x, y, z, w] = pose.rotation().to_array();
        let rotation = nalgebra::UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(w, x, y, z));
        Self::from_parts(pose.translation().to_array().into(), rotation)
    }
}

#[cfg(feature = "nalgebra")]
impl From<nalgebra::Isometry3<f64>> for Pose {
    fn from(isometry: nalgebra::Isometry3<f64>) -> Self {
        let [x, y, z, w] = isometry.rotation.coords.into();
        let [tx, ty, tz] = isometry.translation.vector.into();
        Self::new(glam::DVec3::new(tx, ty, tz), glam::DQuat::from_xyzw(x, y, z, w))
    }
}

#[cfg(feature = "parry")]
impl From<parry3d::math::Pose> for Pose {
    /// ```
    /// use belvedere_sensors::Pose;
    /// let of_parry = parry3d::math::Pose::from_translation(parry3d::math::Vector::new(1.0, 2.0, 3.0));
    /// assert_eq!(Pose::from(of_parry).translation(), glam::DVec3::new(1.0, 2.0, 3.0));
    /// assert_eq!(parry3d::math::Pose::from(Pose::from(of_parry)), of_parry);
    /// ```
    fn from(pose: parry3d::math::Pose) -> Self {
        Self::new(pose.translation.as_dvec3(), pose.rotation.as_dquat())
    }
}

#[cfg(feature = "parry")]
impl From<Pose> for parry3d::math::Pose {
    /// Rounded to single precision.
    fn from(pose: Pose) -> Self {
        Self::from_parts(pose.translation().as_vec3(), pose.rotation().as_quat())
    }
}
