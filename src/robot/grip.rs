//! [`Axle`]: the forces with which wheels move the body that they are part of.
//!
//! **Wheels are not separate bodies.** A wheel of 10 g would have to carry the whole base, and an iterative solver
//! cannot balance 1 : 240. With hinged, motorised wheels a Kobuki sank 1 mm into the ground, turned 9 % short at a step
//! of 1 ms, and overturned at 10 ms; stiffer contacts made it worse.
//!
//! Instead the base is one rigid body on frictionless wheels, and their grip is computed here. In each step the base
//! gets the force that gives its axle the commanded velocity, forward, sideways (zero) and in yaw. The force is limited
//! by friction (μ of the wheels × weight) and by the motors, and acts only while wheels touch something. So the base
//! drives exactly at any step size, stands on slopes, is stopped by walls, pushes light objects, slips if it exceeds its
//! grip, and does not drive in the air. The force acts on the centre of mass, so the base does not pitch when it brakes.
//!
//! The wheels' joints turn at the commanded rate if the motor is stronger than the grip, or with the ground if the
//! motor is the weaker part. Encoders count these turns, so a base that pushes against a wall loses its odometry like a
//! real one.

use super::command::Command;
use super::transforms::base_link;
use crate::description::diagnostics::{Problem, Severity, Source};
use crate::description::model::{
    BasePlugin, Collision, Geometry, JointIndex, JointKind, LinkIndex, Model, Wheels,
};
use crate::world::physics::{ModelIndex, Physics};
use glam::DVec3;

/// Radius of a wheel without a shape in the model, in m: that of a Kobuki.
const DEFAULT_RADIUS_M: f64 = 0.035;

/// A wheel of an axle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wheel {
    pub(super) joint: JointIndex,
    pub(super) link: LinkIndex,
    /// +1 if a positive turn of the joint rolls the base forward, −1 if backward.
    pub(super) sign: f64,
    /// 0 left, 1 right.
    pub(super) side: usize,
}

/// The driven wheels of a model. All left wheels turn at the same speed, and all right ones.
#[derive(Debug, Clone)]
pub(super) struct Axle {
    pub(super) wheels: Vec<Wheel>,
    /// Distance between the left and the right wheels.
    pub(super) separation_m: f64,
    /// Radius of the wheels, from their shapes.
    pub(super) radius_m: f64,
    friction: f64,
    torque_n_m: f64,
    /// The point between the wheels in the base's frame.
    pub(super) centre: DVec3,
    /// Lever arm in m with which the wheels turn the base.
    pub(super) yaw_arm_m: f64,
}

impl Axle {
    /// Finds the wheels in a model. Their positions decide which are on the left.
    ///
    /// # Errors
    /// A warning if the wheels cannot drive.
    pub(super) fn of(model: &Model, plugin: &BasePlugin, wheels: &Wheels) -> Result<Self, Problem> {
        let problem = |source: &Source, what: String, remedy: &str| Problem {
            severity: Severity::Warning,
            source: source.clone(),
            what: format!("robot '{}' cannot drive: {what}", model.name),
            remedy: remedy.into(),
        };
        let rest = model.rest_poses();
        let base_from_model = rest.get(base_link(model)).copied().unwrap_or_default().inverse();
        let mut found = Vec::new();
        let mut sums = [DVec3::ZERO; 2];
        for (side, joints) in [&wheels.left, &wheels.right].into_iter().enumerate() {
            for number in joints {
                let joint = &model.joints[*number];
                let base_from_wheel = base_from_model * rest[joint.child];
                let across = base_from_wheel.transform_vector(joint.axis).y;
                let turns = match joint.kind {
                    JointKind::Continuous => true,
                    JointKind::Revolute { lower, upper } => lower.is_infinite() && upper.is_infinite(),
                    _ => false,
                };
                if !turns || across.abs() < 0.99 {
                    let (how, remedy) = match joint.kind {
                        JointKind::Revolute { lower, upper } if !turns => {
                            (format!("turns only from {lower} to {upper} rad"), "make it continuous")
                        }
                        _ if !turns => ("does not turn".into(), "make it continuous"),
                        _ => {
                            let how = "does not turn about the base's y axis".into();
                            (how, "turn its axis so that it lies across the base")
                        }
                    };
                    return Err(problem(&joint.source, format!("joint '{}' {how}", joint.name), remedy));
                }
                sums[side] += base_from_wheel.transform_point(joint.pivot);
                found.push(Wheel { joint: *number, link: joint.child, sign: across.signum(), side });
            }
        }
        let mut centres = [sums[0] / wheels.left.len() as f64, sums[1] / wheels.right.len() as f64];
        if centres[0].y < centres[1].y {
            centres.swap(0, 1);
            for wheel in &mut found {
                wheel.side = 1 - wheel.side;
            }
            // The left wheels come first.
            found.sort_by_key(|wheel| wheel.side);
        }
        let separation_m = centres[0].y - centres[1].y;
        if separation_m < 0.01 {
            return Err(problem(
                &plugin.source,
                format!("its left wheel is {separation_m} m to the left of its right one"),
                "put them on their sides of the base, for a Kobuki at y = 0.115 and -0.115",
            ));
        }
        let first = found[0];
        let shapes = &model.links[first.link].collisions;
        let axis = model.joints[first.joint].axis;
        let pivot = model.joints[first.joint].pivot;
        let radius_m =
            shapes.iter().find_map(|shape| radius_about(axis, pivot, shape)).filter(|radius| *radius > 0.0);
        Ok(Self {
            wheels: found,
            separation_m,
            radius_m: radius_m.or(wheels.radius_m).unwrap_or(DEFAULT_RADIUS_M),
            friction: shapes.iter().find_map(|shape| shape.friction).unwrap_or(1.0).max(0.0),
            torque_n_m: wheels.torque_n_m,
            centre: (centres[0] + centres[1]) * 0.5,
            yaw_arm_m: 0.5 * separation_m,
        })
    }

    /// Makes the wheels frictionless, because their grip is computed here.
    pub(super) fn release(&self, physics: &mut Physics, model: ModelIndex) {
        for wheel in &self.wheels {
            physics.set_link_friction(model, wheel.link, 0.0);
        }
    }

    /// Applies the grip of the wheels for one step, so that the base moves as commanded. `rims_m_s` are the intended
    /// rim speeds of its left and right wheels.
    pub(super) fn grip(
        &self,
        physics: &mut Physics,
        model: ModelIndex,
        base: LinkIndex,
        command: Command,
        rims_m_s: [f64; 2],
    ) {
        let step_s = physics.step_s();
        let world_from_base = physics.world_from_link(model, base);
        let [base_ahead, base_up] = [DVec3::X, DVec3::Z].map(|axis| world_from_base.transform_vector(axis));
        // The axes of the ground: gravity has no component along a level floor, however the base leans on its casters.
        let mut normals = DVec3::ZERO;
        let mut touching = 0.0;
        for wheel in &self.wheels {
            if let Some(normal) = physics.ground_normal(model, wheel.link, base_up) {
                normals += normal;
                touching += 1.0;
            }
        }
        let up = normals.try_normalize().unwrap_or(base_up);
        let ahead = base_ahead.reject_from_normalized(up).normalize_or(base_ahead);
        let left = up.cross(ahead);
        let Some((mass_kg, centre, inertia)) = physics.body_mass(model, base, up) else { return };
        // The limit of one wheel's friction, from its part of the weight.
        let count = self.wheels.len() as f64;
        let gravity = physics.gravity();
        let friction_n = self.friction / count * physics.model_mass(model) * (-gravity.dot(up)).max(0.0);
        let motor_n = self.torque_n_m / self.radius_m;

        // The force and torque at the centre of mass that would give the base the commanded motion within this step,
        // while holding its weight.
        let axle = world_from_base.transform_point(self.centre);
        let (origin_m_s, turn) = physics.link_velocity(model, base);
        let velocity = |point: DVec3| origin_m_s + turn.cross(point - world_from_base.translation());
        let wanted = ahead * command.linear_m_s + (up * command.angular_rad_s).cross(centre - axle);
        let force = ((wanted - velocity(centre)) / step_s - gravity) * mass_kg;
        let torque = (command.angular_rad_s - turn.dot(up)) / step_s * inertia;

        // Forward the force comes from the motors, sideways from the tyres.
        let grip_n = friction_n * touching;
        let push_n = motor_n.min(friction_n) * touching;
        let forward_n = force.dot(ahead).clamp(-push_n, push_n);
        let sideways_n = force.dot(left).clamp(-grip_n, grip_n);
        let most_n_m = self.yaw_arm_m * push_n;
        let torque_n_m = torque.clamp(-most_n_m, most_n_m);
        physics.push(model, base, ahead * forward_n + left * sideways_n, up * torque_n_m);

        for wheel in &self.wheels {
            let arm_m = [-0.5, 0.5][wheel.side] * self.separation_m;
            let force_n = forward_n / count + torque_n_m / (count * arm_m);
            let stalled = touching > 0.0 && motor_n < friction_n && force_n.abs() >= 0.999 * motor_n;
            let rim_m_s =
                if stalled { velocity(axle - left * arm_m).dot(ahead) } else { rims_m_s[wheel.side] };
            let (rate, effort) = (rim_m_s / self.radius_m, force_n * self.radius_m);
            physics.roll_joint(model, wheel.joint, wheel.sign * rate, wheel.sign * effort);
        }
    }

    /// Returns the forward rotation of the left and right wheels at a time between the last two steps, in rad.
    pub(super) fn turned_rad(&self, physics: &Physics, model: ModelIndex, stamp_ns: u64) -> [f64; 2] {
        [0, 1].map(|side| {
            let wheels = self.wheels.iter().filter(|wheel| wheel.side == side);
            let turned = wheels.clone().map(|wheel| {
                let state = physics.joint_state_at(model, wheel.joint, stamp_ns).unwrap_or_default();
                wheel.sign * state.position
            });
            turned.sum::<f64>() / wheels.count() as f64
        })
    }
}

/// Returns the radius of a wheel's shape about the wheel's axis, or `None` for a shape that cannot be a wheel.
fn radius_about(axis: DVec3, pivot: DVec3, shape: &Collision) -> Option<f64> {
    match &shape.geometry {
        Geometry::Cylinder { radius, .. } | Geometry::Sphere { radius } => Some(*radius),
        Geometry::Mesh(mesh) => mesh
            .positions
            .iter()
            .map(|point| shape.link_from_collision.transform_point(DVec3::from(point.map(f64::from))))
            .map(|point| (point - pivot).reject_from_normalized(axis).length())
            .filter(|radius| radius.is_finite())
            .reduce(f64::max),
        _ => None,
    }
}
