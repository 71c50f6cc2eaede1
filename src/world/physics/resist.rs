//! Joints of rapier for what resists a joint: its spring and damper, and its dry friction.
//!
//! rapier has one motor for each axis of a joint, and that is what a robot drives. A spring with a damper is a motor, too, and
//! dry friction is one that holds still with a force that is limited. So each of them is another joint between the same two
//! bodies, which leaves all axes free. All are solved at once, at the end of the step, so that none is too stiff for it.

use super::joint::MovingJoint;
use crate::description::model::JointDynamics;
use belvedere_sensors::Pose;
use rapier3d_f64::dynamics::{GenericJoint, GenericJointBuilder, JointAxesMask, JointAxis, MotorModel};

/// How hard dry friction holds still, in N·m·s/rad or N·s/m: with 10 N·m it creeps by 10⁻⁵ rad/s.
const HOLDING: f64 = 1e6;

/// Largest stiffness or damping. It is rigid, and rapier's products of it are still finite.
const STIFFEST: f64 = 1e30;
/// Farthest reference of a spring, in rad or m.
const FARTHEST: f64 = 1e6;

/// Returns the joints of rapier for what resists a joint that moves along or about `axis`.
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
