//! Poses between our type and rapier's. Both are in double precision, and so is every vector.

use belvedere_sensors::Pose;
use rapier3d_f64::math::Pose as RapierPose;

/// Returns the same pose as rapier's type.
pub(super) fn to_rapier(pose: &Pose) -> RapierPose {
    RapierPose::from_parts(pose.translation(), pose.rotation())
}

/// Returns the same pose as our type, which normalises the rotation.
pub(super) fn from_rapier(pose: &RapierPose) -> Pose {
    Pose::new(pose.translation, pose.rotation)
}
