//! Movable joints: their counterparts in rapier, and their position, velocity and effort.

use super::SUBSTEPS;
use super::convert::to_rapier;
use crate::description::model::{Joint, JointDynamics, JointKind, Mimic};
use belvedere_sensors::Pose;
use glam::{DQuat, DVec3};
use rapier3d_f64::dynamics::{
    GenericJoint, GenericJointBuilder, ImpulseJointHandle, ImpulseJointSet, JointAxesMask, JointAxis,
    MotorModel, RigidBodySet,
};
use std::f64::consts::{PI, TAU};

/// State of a joint at one time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointState {
    /// Position in rad or m. An angle is not wrapped, so it includes the turns of a wheel.
    pub position: f64,
    /// Velocity in rad/s or m/s.
    pub velocity: f64,
    /// The effort of its motor in the last step, in N·m or N.
    pub effort: f64,
}

/// The way in which a joint is moved.
#[derive(Debug)]
pub(super) enum Motion {
    /// By forces on the two bodies, as a joint of rapier.
    Forces(ImpulseJointHandle),
    /// As the joint of a wheel, which a base turns at a given rate. The first body carries the second.
    Rolled {
        /// Angular velocity in rad/s.
        rate: f64,
        /// Torque in N·m.
        effort: f64,
    },
}

/// A movable joint.
#[derive(Debug)]
pub(super) struct MovingJoint {
    pub(super) motion: Motion,
    /// Indices of the bodies that it joins.
    pub(super) bodies: [usize; 2],
    /// The joint's frame in each of them; it moves along or about its x.
    pub(super) body_from_joint: [Pose; 2],
    pub(super) axis: JointAxis,
    /// Limits of an angle that are too far apart for rapier. Only the part near the position is given to rapier.
    pub(super) wide_limits: Option<[f64; 2]>,
    /// The limits of its position, if it has some.
    pub(super) limits: Option<[f64; 2]>,
    pub(super) dynamics: JointDynamics,
    /// State after the last step but one.
    pub(super) previous: JointState,
    /// State after the last step.
    pub(super) current: JointState,
}

/// How hard a motor holds its velocity, in N·m·s/rad or N·s/m. The solver itself is softer: it does not converge
/// in its few passes where a load pulls off the axis, and such a motor runs some percent slow (6 % measured for
/// 2 kg on an arm of 0.5 m at 1 rad/s and a step of 1 ms; more passes gain little).
const MOTOR_DAMPING: f64 = 1000.0;

impl MovingJoint {
    /// The rotation that takes x onto a unit axis, by the half-way vector: square roots only.
    pub(super) fn x_onto(axis: DVec3) -> DQuat {
        if axis.x < -1.0 + 1e-12 {
            // Half a turn about z.
            return DQuat::from_xyzw(0.0, 0.0, 1.0, 0.0);
        }
        let cross = DVec3::X.cross(axis);
        DQuat::from_xyzw(cross.x, cross.y, cross.z, 1.0 + axis.x).normalize()
    }

    /// Returns the joint of rapier for `joint`, its free axis, and the limits that have to follow it; none for a kind that
    /// constrains nothing.
    pub(super) fn constraint(
        joint: &Joint,
        body_from_joint: &[Pose; 2],
    ) -> Option<(GenericJoint, JointAxis, Option<[f64; 2]>)> {
        let axis = Self::axis_of(joint.kind)?;
        let limits = joint.kind.limits();
        let mut builder = Self::between(body_from_joint, JointAxesMask::all() - JointAxesMask::from(axis));
        if let Some([lower, upper]) = limits {
            builder = builder.limits(axis, near(axis, [lower, upper], joint.dynamics.initial_position));
        }
        let wide = limits.filter(|limits| axis == JointAxis::AngX && is_wide(*limits));
        Some((builder.build(), axis, wide))
    }

    /// Returns the joint of rapier for one that turns about all axes.
    pub(super) fn ball(body_from_joint: &[Pose; 2]) -> GenericJoint {
        Self::between(body_from_joint, JointAxesMask::LIN_AXES).build()
    }

    /// Returns a joint of rapier that locks some axes of two bodies. The two do not collide with each other.
    pub(super) fn between(body_from_joint: &[Pose; 2], locked: JointAxesMask) -> GenericJointBuilder {
        GenericJointBuilder::new(locked)
            .local_frame1(to_rapier(&body_from_joint[0]))
            .local_frame2(to_rapier(&body_from_joint[1]))
            .contacts_enabled(false)
    }

    /// Sets the motor's target velocity in rad/s or m/s, and its largest effort in N·m or N. The joint's own limits apply to
    /// both.
    pub(super) fn drive(&self, joints: &mut ImpulseJointSet, velocity: f64, max_effort: f64) {
        let most = self.dynamics.max_velocity;
        self.aim(joints, velocity.clamp(-most, most), max_effort.min(self.dynamics.max_effort));
    }

    /// Makes the motor follow a leader, so that the joint's error is corrected in `time_s`. Limits of 0, which files give to
    /// followers, count as none.
    pub(super) fn follow(
        &self,
        joints: &mut ImpulseJointSet,
        mimic: &Mimic,
        leader: JointState,
        time_s: f64,
    ) {
        let wanted = mimic.multiplier * leader.position + mimic.offset;
        let within = self.limits.map_or(wanted, |[lower, upper]| wanted.max(lower).min(upper));
        let along = if within == wanted { mimic.multiplier * leader.velocity } else { 0.0 };
        let limit = |most: f64| if most > 0.0 { most } else { f64::INFINITY };
        let most = limit(self.dynamics.max_velocity);
        let velocity = along + (within - self.current.position) / time_s;
        self.aim(joints, velocity.clamp(-most, most), limit(self.dynamics.max_effort));
    }

    fn aim(&self, joints: &mut ImpulseJointSet, velocity: f64, max_effort: f64) {
        if let Motion::Forces(handle) = self.motion
            && let Some(joint) = joints.get_mut(handle, true)
        {
            joint
                .data
                .set_motor_model(self.axis, MotorModel::ForceBased)
                .set_motor_velocity(self.axis, velocity, MOTOR_DAMPING)
                .set_motor_max_force(self.axis, max_effort.min(f64::MAX));
        }
    }

    /// Returns the position of the second joint frame in the first, along or about x; an angle is within (−π, π].
    pub(super) fn position(&self, world_from_body: [Pose; 2]) -> f64 {
        let world_from_joint = [0, 1].map(|side| world_from_body[side] * self.body_from_joint[side]);
        let first_from_second = world_from_joint[0].inverse() * world_from_joint[1];
        match self.axis {
            JointAxis::AngX => {
                let turn = first_from_second.rotation();
                wrap(2.0 * libm::atan2(turn.x, turn.w))
            }
            _ => first_from_second.translation().x,
        }
    }

    /// Gives rapier the part of wide limits that is near the current position.
    pub(super) fn follow_limits(&self, joints: &mut ImpulseJointSet) {
        if let (Some(limits), Motion::Forces(handle)) = (self.wide_limits, &self.motion)
            && let Some(joint) = joints.get_mut(*handle, false)
        {
            joint.data.set_limits(self.axis, near(self.axis, limits, self.current.position));
        }
    }

    /// Returns the pose of the second body of a rolled joint, from that of the first.
    pub(super) fn carried(&self, world_from_first: Pose) -> Pose {
        let turn = Self::moved(self.axis, self.current.position);
        world_from_first * self.body_from_joint[0] * turn * self.body_from_joint[1].inverse()
    }

    /// Returns the pose of the second joint frame in the first, at a position.
    pub(super) fn moved(axis: JointAxis, position: f64) -> Pose {
        if axis != JointAxis::AngX {
            return Pose::from_translation(DVec3::X * position);
        }
        let (sin, cos) = libm::sincos(0.5 * position);
        Pose::new(DVec3::ZERO, DQuat::from_xyzw(sin, 0.0, 0.0, cos))
    }

    /// Resets its state to its initial position.
    pub(super) fn begin(&mut self, joints: &mut ImpulseJointSet) {
        let state = JointState { position: self.dynamics.initial_position, ..JointState::default() };
        (self.previous, self.current) = (state, state);
        self.follow_limits(joints);
    }

    /// Returns the joint's free axis; `None` for a kind with no or several free axes.
    pub(super) fn axis_of(kind: JointKind) -> Option<JointAxis> {
        match kind {
            JointKind::Fixed | JointKind::Ball | JointKind::Floating => None,
            JointKind::Continuous | JointKind::Revolute { .. } => Some(JointAxis::AngX),
            JointKind::Prismatic { .. } => Some(JointAxis::LinX),
        }
    }

    /// Updates the state after a step.
    pub(super) fn update(
        &mut self,
        world_from_body: [Pose; 2],
        handles: [rapier3d_f64::dynamics::RigidBodyHandle; 2],
        bodies: &RigidBodySet,
        joints: &mut ImpulseJointSet,
        step_s: f64,
    ) {
        self.previous = self.current;
        let handle = match self.motion {
            Motion::Forces(handle) => handle,
            Motion::Rolled { rate, effort } => {
                let position = self.previous.position + rate * step_s;
                self.current = JointState { position, velocity: rate, effort };
                return;
            }
        };
        let position = self.position(world_from_body);
        self.current.position = match self.axis {
            JointAxis::AngX => self.previous.position + wrap(position - self.previous.position),
            _ => position,
        };
        self.follow_limits(joints);
        let world_from_joint = world_from_body[0] * self.body_from_joint[0];
        let axis_in_world = world_from_joint.transform_vector(DVec3::X);
        let [first, second] = handles.map(|handle| &bodies[handle]);
        let difference = if self.axis == JointAxis::AngX {
            second.angvel() - first.angvel()
        } else {
            let anchor = (world_from_body[1] * self.body_from_joint[1]).translation();
            second.velocity_at_point(anchor) - first.velocity_at_point(anchor)
        };
        self.current.velocity = difference.dot(axis_in_world);
        let impulse = joints
            .get(handle)
            .and_then(|joint| joint.data.motor(self.axis))
            .map_or(0.0, |motor| motor.impulse);
        self.current.effort = impulse * SUBSTEPS as f64 / step_s;
    }
}

/// Limits farther than this angle in rad from the position are not given to rapier, which knows an angle only within a turn.
const HORIZON_RAD: f64 = 3.0;

/// A length in m beyond which there is no limit.
const FAR_M: f64 = 1e30;

fn is_wide([lower, upper]: [f64; 2]) -> bool {
    upper - lower > 2.0 * HORIZON_RAD
}

/// Returns the part of two limits that is near a position.
fn near(axis: JointAxis, [lower, upper]: [f64; 2], position: f64) -> [f64; 2] {
    if axis != JointAxis::AngX {
        return [lower.max(-FAR_M), upper.min(FAR_M)];
    }
    if !is_wide([lower, upper]) {
        return [lower, upper];
    }
    // A position beyond a limit, as at the start, does not lose that limit.
    let within = position.max(lower).min(upper);
    [lower.max(within - HORIZON_RAD), upper.min(within + HORIZON_RAD)]
}

/// Returns the same angle in (−π, π].
fn wrap(angle: f64) -> f64 {
    let wrapped = angle - TAU * libm::floor(angle / TAU);
    if wrapped > PI { wrapped - TAU } else { wrapped }
}
