//! A base that moves in the plane exactly as commanded. Gazebo's plugin sets its velocity in each step.
//!
//! Here a force moves it instead, so that it falls and is stopped by walls. Its shapes are frictionless, so that
//! nothing slows it down. Its wheels are part of its body, so that it does not rock on them; they do not turn.

use super::base::Base;
use super::command::Command;
use super::odometry::Odometry;
use super::tracker::Tracker;
use super::transforms::base_link;
use crate::description::model::{BasePlugin, JointIndex, JointKind, LinkIndex, Model};
use crate::world::physics::{ModelIndex, Physics};
use glam::DVec3;

/// Highest speed in m/s along each axis, and rate of turn in rad/s. Physics cannot handle higher ones.
const MOST: f64 = 1e3;

/// Returns the joints of its wheels: continuous joints whose link has a collision shape and no children.
pub(super) fn wheels(model: &Model) -> Vec<JointIndex> {
    let is_wheel = |joint: &JointIndex| {
        let joint = &model.joints[*joint];
        joint.kind == JointKind::Continuous
            && !model.links[joint.child].collisions.is_empty()
            && model.joints.iter().all(|other| other.parent != joint.child)
    };
    (0..model.joints.len()).filter(is_wheel).collect()
}

/// A base that moves in the plane without driven wheels.
#[derive(Debug)]
pub(super) struct Planar {
    model: ModelIndex,
    base: LinkIndex,
    timeout_ns: u64,
    command: Command,
    command_ns: u64,
    tracker: Tracker,
}

impl Planar {
    pub(super) fn new(model: &Model, plugin: &BasePlugin, index: ModelIndex, physics: &mut Physics) -> Self {
        for link in 0..model.links.len() {
            physics.set_link_friction(index, link, 0.0);
        }
        Self {
            model: index,
            base: base_link(model),
            timeout_ns: plugin.command_timeout_s.map_or(u64::MAX, |time_s| (time_s * 1e9) as u64),
            command: Command::STOP,
            command_ns: 0,
            tracker: Tracker::of_truth(index, &plugin.odometry),
        }
    }
}

impl Base for Planar {
    fn command(&mut self, command: Command, stamp_ns: u64) {
        let Command { linear_m_s, lateral_m_s, angular_rad_s } = command.or_stop();
        let [linear_m_s, lateral_m_s, angular_rad_s] =
            [linear_m_s, lateral_m_s, angular_rad_s].map(|value| value.clamp(-MOST, MOST));
        self.command = Command { linear_m_s, lateral_m_s, angular_rad_s };
        self.command_ns = stamp_ns;
    }

    fn control(&mut self, physics: &mut Physics) {
        let expired = physics.time_ns().saturating_sub(self.command_ns) >= self.timeout_ns;
        let command = if expired { Command::STOP } else { self.command };
        let world_from_base = physics.world_from_link(self.model, self.base);
        // The plane is horizontal in the world, however the base leans.
        let up = -physics.gravity().try_normalize().unwrap_or(DVec3::NEG_Z);
        let along = world_from_base.transform_vector(DVec3::X).reject_from_normalized(up);
        let Some(ahead) = along.try_normalize() else { return };
        let left = up.cross(ahead);
        let Some((mass_kg, centre, inertia)) = physics.body_mass(self.model, self.base, up) else { return };
        let (origin_m_s, turn) = physics.link_velocity(self.model, self.base);
        let arm = centre - world_from_base.translation();
        let velocity = origin_m_s + turn.cross(arm);
        let wanted =
            ahead * command.linear_m_s + left * command.lateral_m_s + (up * command.angular_rad_s).cross(arm);
        let force = (wanted - velocity) * (mass_kg / physics.step_s());
        let torque_n_m = (command.angular_rad_s - turn.dot(up)) * inertia / physics.step_s();
        physics.push(self.model, self.base, force.reject_from_normalized(up), up * torque_n_m);
    }

    fn observe(&mut self, physics: &Physics) {
        self.tracker.observe(physics);
    }

    fn odometry_at(&self, physics: &Physics, stamp_ns: u64) -> Odometry {
        self.tracker.odometry_at(physics, stamp_ns)
    }

    fn reset_odometry(&mut self, physics: &Physics) {
        self.tracker.reset(physics);
    }
}
