//! The initial positions of a model's joints, and the poses of its links that follow from them.

use super::joint::MovingJoint;
use super::lump::joints_in;
use crate::description::model::{Joint, JointIndex, LinkIndex, Model};
use belvedere_sensors::Pose;

/// Returns the initial position of a joint, within its limits. That of a follower results from its leader.
pub(super) fn position(model: &Model, joint: JointIndex) -> f64 {
    let (mut factor, mut offset, mut at) = (1.0, 0.0, joint);
    // The descriptions let no joint follow itself.
    for _ in 0..model.joints.len() {
        let Some(mimic) = model.joints[at].dynamics.mimic else { break };
        offset += factor * mimic.offset;
        (factor, at) = (factor * mimic.multiplier, mimic.leader);
    }
    let within = |joint: &Joint, position: f64| {
        joint.kind.limits().map_or(position, |[lower, upper]| position.max(lower).min(upper))
    };
    let leader = &model.joints[at];
    within(&model.joints[joint], factor * within(leader, leader.dynamics.initial_position) + offset)
}

/// Returns the pose in the child of the frame of a joint, which moves along or about the x axis of that frame.
pub(super) fn child_from_joint(joint: &Joint) -> Pose {
    Pose::new(joint.pivot, MovingJoint::x_onto(joint.axis))
}

/// Returns the pose of each link in the model while every joint is at its initial position. The joints of wheels that are
/// `carried` begin at 0.
pub(super) fn link_poses(model: &Model, order: &[LinkIndex], carried: &[JointIndex]) -> Vec<Pose> {
    let mut poses = model.rest_poses();
    let mut placed = vec![false; poses.len()];
    for number in joints_in(order, model) {
        let joint = &model.joints[number];
        if model.links[joint.child].is_static || std::mem::replace(&mut placed[joint.child], true) {
            continue;
        }
        let axis = MovingJoint::axis_of(joint.kind).filter(|_| !carried.contains(&number));
        let motion = axis.map_or(Pose::IDENTITY, |axis| MovingJoint::moved(axis, position(model, number)));
        // This also moves the links that are attached to a moved link.
        if motion != Pose::IDENTITY || poses[joint.parent] != model.links[joint.parent].model_from_link {
            let child_from_joint = child_from_joint(joint);
            let parent_from_child =
                joint.parent_from_child * child_from_joint * motion * child_from_joint.inverse();
            poses[joint.child] = poses[joint.parent] * parent_from_child;
        }
    }
    poses
}
