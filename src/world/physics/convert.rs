//! Poses and vectors between our double precision and rapier's single precision: the only place where it
//! happens.

use belvedere_sensors::Pose;
use glam::DVec3;
use rapier3d::math::{Pose as RapierPose, Vector};

/// Narrows a pose.
pub(super) fn to_rapier(pose: &Pose) -> RapierPose {
    RapierPose::from_parts(pose.translation().as_vec3(), pose.rotation().as_quat().normalize())
}

/// Widens a pose; the rotation is normalised again in double precision.
pub(super) fn from_rapier(pose: &RapierPose) -> Pose {
    Pose::new(pose.translation.as_dvec3(), pose.rotation.as_dquat())
}

/// Narrows a vector.
pub(super) fn vector(vector: DVec3) -> Vector {
    vector.as_vec3()
}
