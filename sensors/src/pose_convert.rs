//! Conversions between poses and the types of other crates.

use crate::pose::{NotRigid, Pose};
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};

impl From<(DQuat, DVec3)> for Pose {
    /// Creates a pose from a rotation, which is normalised, and a translation in metres.
    ///
    /// ```
    /// use belvedere_sensors::Pose;
    /// use belvedere_sensors::glam::{DQuat, DVec3};
    /// let quarter = DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2);
    /// let a_from_b = Pose::from((quarter, DVec3::new(1.0, 0.0, 0.0)));
    /// assert!((a_from_b.transform_point(DVec3::X) - DVec3::new(1.0, 1.0, 0.0)).length() < 1e-15);
    /// assert_eq!(<(DQuat, DVec3)>::from(a_from_b).1, DVec3::new(1.0, 0.0, 0.0));
    /// ```
    fn from((rotation, translation): (DQuat, DVec3)) -> Self {
        Self::new(translation, rotation)
    }
}

impl From<Pose> for (DQuat, DVec3) {
    fn from(pose: Pose) -> Self {
        (pose.rotation(), pose.translation())
    }
}

impl TryFrom<DAffine3> for Pose {
    type Error = NotRigid;

    /// Converts a rigid transform to a pose.
    ///
    /// # Errors
    /// If the matrix is not a rotation and a translation.
    fn try_from(affine: DAffine3) -> Result<Self, NotRigid> {
        let DAffine3 { matrix3, translation } = affine;
        if !(matrix3.is_finite() && translation.is_finite()) {
            return Err(NotRigid::NotFinite);
        }
        let is_rotation =
            (matrix3.transpose() * matrix3).abs_diff_eq(DMat3::IDENTITY, 1e-6) && matrix3.determinant() > 0.0;
        if !is_rotation {
            return Err(NotRigid::NotRotation);
        }
        Ok(Self::new(translation, DQuat::from_mat3(&matrix3)))
    }
}

impl TryFrom<DMat4> for Pose {
    type Error = NotRigid;

    /// Converts a rigid transform to a pose.
    ///
    /// ```
    /// use belvedere_sensors::pose::{NotRigid, Pose};
    /// use belvedere_sensors::glam::{DMat4, DQuat, DVec3};
    /// let turned = DMat4::from_rotation_translation(DQuat::from_rotation_x(0.5), DVec3::new(1.0, 2.0, 3.0));
    /// let pose = Pose::try_from(turned)?;
    /// assert!((pose.rpy() - DVec3::new(0.5, 0.0, 0.0)).length() < 1e-12);
    /// assert_eq!(Pose::try_from(DMat4::from_scale(DVec3::splat(2.0))), Err(NotRigid::NotRotation));
    /// # Ok::<(), NotRigid>(())
    /// ```
    ///
    /// # Errors
    /// If the matrix is not a rotation and a translation.
    fn try_from(matrix: DMat4) -> Result<Self, NotRigid> {
        if !matrix.is_finite() {
            return Err(NotRigid::NotFinite);
        }
        if matrix.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
            return Err(NotRigid::NotAffine);
        }
        DAffine3::from_mat4(matrix).try_into()
    }
}

#[cfg(feature = "mint")]
impl From<(mint::Quaternion<f64>, mint::Vector3<f64>)> for Pose {
    /// Creates a pose from a rotation, which is normalised, and a translation in metres, in the types of `mint` that
    /// many crates support.
    ///
    /// ```
    /// use belvedere_sensors::Pose;
    /// use mint::{Quaternion, Vector3};
    /// let rotation = Quaternion { v: Vector3 { x: 0.0, y: 0.0, z: 0.0 }, s: 1.0 };
    /// let pose = Pose::from((rotation, Vector3 { x: 1.0, y: 2.0, z: 3.0 }));
    /// let (_, translation): (Quaternion<f64>, Vector3<f64>) = pose.into();
    /// assert_eq!(translation, Vector3 { x: 1.0, y: 2.0, z: 3.0 });
    /// ```
    fn from((rotation, translation): (mint::Quaternion<f64>, mint::Vector3<f64>)) -> Self {
        Self::new(translation.into(), rotation.into())
    }
}

#[cfg(feature = "mint")]
impl From<Pose> for (mint::Quaternion<f64>, mint::Vector3<f64>) {
    fn from(pose: Pose) -> Self {
        (pose.rotation().into(), pose.translation().into())
    }
}

impl From<Pose> for DAffine3 {
    /// Converts a pose to an affine transform.
    ///
    /// ```
    /// use belvedere_sensors::Pose;
    /// use belvedere_sensors::glam::{DAffine3, DVec3};
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
    /// Converts a pose to an isometry of `nalgebra`.
    ///
    /// ```
    /// use belvedere_sensors::Pose;
    /// use belvedere_sensors::glam::DVec3;
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
    /// Converts a pose of parry3d, in single precision.
    ///
    /// ```
    /// use belvedere_sensors::Pose;
    /// let of_parry = parry3d::math::Pose::from_translation(parry3d::math::Vector::new(1.0, 2.0, 3.0));
    /// assert_eq!(Pose::from(of_parry).translation(), belvedere_sensors::glam::DVec3::new(1.0, 2.0, 3.0));
    /// assert_eq!(parry3d::math::Pose::from(Pose::from(of_parry)), of_parry);
    /// ```
    fn from(pose: parry3d::math::Pose) -> Self {
        Self::new(pose.translation.as_dvec3(), pose.rotation.as_dquat())
    }
}

#[cfg(feature = "parry")]
impl From<Pose> for parry3d::math::Pose {
    /// Converts a pose to one of parry3d, rounded to single precision.
    fn from(pose: Pose) -> Self {
        Self::from_parts(pose.translation().as_vec3(), pose.rotation().as_quat())
    }
}
