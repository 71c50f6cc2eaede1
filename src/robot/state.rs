//! [`RobotState`]: a snapshot of the state that a robot publishes.

use super::base::Base;
use super::odometry::Odometry;
use super::transforms::{Transform, Transforms};
use crate::world::physics::{JointState, ModelIndex, Physics};
use std::sync::Arc;

/// The state that a robot publishes at one time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RobotState {
    /// Simulated time in ns.
    pub stamp_ns: u64,
    /// The newest odometry at or before that time (which has its own timestamp); `None` for a robot without a base.
    pub odometry: Option<Odometry>,
    /// Names of the joints that move, in the order of the file.
    pub joint_names: Vec<Arc<str>>,
    /// Their states, in the same order.
    pub joints: Vec<JointState>,
    /// The moving transforms: first `odom` to the base if odometry is published as a transform, then one per joint.
    pub transforms: Vec<Transform>,
}

impl RobotState {
    /// Writes the state at a time, using the vectors' memory again.
    pub(super) fn fill(
        &mut self,
        stamp_ns: u64,
        model: ModelIndex,
        transforms: &Transforms,
        base: Option<&dyn Base>,
        physics: &Physics,
    ) {
        self.stamp_ns = stamp_ns;
        self.odometry = base.map(|base| base.odometry_at(physics, stamp_ns));
        self.joint_names.clear();
        self.joints.clear();
        self.transforms.clear();
        if let Some(odometry) = &self.odometry {
            self.transforms.extend(transforms.odom(odometry.odom_from_base));
        }
        for joint in transforms.moving() {
            // A joint that is fixed for lack of mass stays at zero.
            let state = physics.joint_state_at(model, joint.joint, stamp_ns).unwrap_or_default();
            self.joint_names.push(joint.name.clone());
            self.joints.push(state);
            self.transforms.push(joint.at(state.position));
        }
    }
}
