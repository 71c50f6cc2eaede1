//! The spring, damper and dry friction of a joint, as joints of rapier.
//!
//! rapier has one motor for each axis of a joint, which the robot's drive needs. A spring with a damper is a motor as well, and
//! dry friction is a motor of velocity 0 with limited force. So each of them is another joint between the same two bodies that
//! leaves all axes free. They are solved implicitly, so that none is too stiff for the step.

use super::joint::MovingJoint;
use crate::description::model::JointDynamics;
use belvedere_sensors::Pose;
use rapier3d_f64::dynamics::{GenericJoint, GenericJointBuilder, JointAxesMask, JointAxis, MotorModel};

/// Stiffness with which dry friction holds, in N·m·s/rad or N·s/m: under 10 N·m a joint creeps by 10⁻⁵ rad/s.
const HOLDING: f64 = 1e6;

/// Largest stiffness or damping: practically rigid, but rapier's products with it are still finite.
const STIFFEST: f64 = 1e30;
/// Farthest reference of a spring, in rad or m.
const FARTHEST: f64 = 1e6;

/// Returns the joints of rapier for the spring, damper and friction of a joint that moves along or about `axis`.
pub(super) fn joints(
    dynamics: &JointDynamics,
    axis: JointAxis,
    body_from_joint: &[Pose; 2],
) -> impl Iterator<Item = GenericJoint> {
    let free = || MovingJoint::between(body_from_joint, JointAxesMask::empty());
    let yields = dynamics.damping > 0.0 || dynamics.spring_stiffness > 0.0;
    let spring = yields.then(|| {
        let [stiffness, damping] =
            [dynamics.spring_stiffness, dynamics.damping].map(|value| value.min(STIFFEST));
        let reference = dynamics.spring_reference.clamp(-FARTHEST, FARTHEST);
        free().motor_position(axis, reference, stiffness, damping)
    });
    let friction = (dynamics.friction > 0.0)
        .then(|| free().motor_velocity(axis, 0.0, HOLDING).motor_max_force(axis, dynamics.friction));
    let build = move |joint: GenericJointBuilder| joint.motor_model(axis, MotorModel::ForceBased).build();
    spring.into_iter().chain(friction).map(build)
}
