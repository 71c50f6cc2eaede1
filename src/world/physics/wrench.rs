//! The wrench of a joint: the force and the torque that it transmits from one of its sides to the other.
//!
//! It is computed from the motion of the links on one side, by the laws of Newton and Euler: the joint transmits everything
//! that accelerates them except gravity, contacts and the drive of a base. This works for fixed joints, whose links form one
//! body, as well as for movable ones, whether motors, springs, limits or dry friction act in them. Forces are means over a
//! step.

mod part;

use super::{ModelIndex, Physics};
use crate::description::diagnostics::{Problem, Severity};
use crate::description::model::{JointIndex, LinkIndex, Model, Sensor, SensorKind};
use belvedere_sensors::Pose;
use glam::DVec3;
use part::Piece;
use rapier3d_f64::dynamics::RigidBody;
use rapier3d_f64::geometry::{ColliderHandle, ContactData, ContactManifold, SolverContact};
use rapier3d_f64::utils::OrthonormalBasis;
use std::collections::HashSet;

/// A force and a torque in N and N·m, or their integrals over time in N·s and N·m·s.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wrench {
    /// The force.
    pub force: DVec3,
    /// The torque about the origin of the frame.
    pub torque: DVec3,
}

impl Wrench {
    fn add(&mut self, force: DVec3, at: DVec3) {
        self.force += force;
        self.torque += at.cross(force);
    }

    /// Returns the mean wrench in N and N·m, if this is the integral now and `earlier` was the integral a period ago.
    #[must_use]
    pub fn mean_since(&self, earlier: &Self, period_s: f64) -> Self {
        let mean = |now: DVec3, earlier: DVec3| (now - earlier) / period_s;
        Self { force: mean(self.force, earlier.force), torque: mean(self.torque, earlier.torque) }
    }

    /// Interpolates between two wrenches.
    fn to(self, other: Self, fraction: f64) -> Self {
        let between = |one: DVec3, other: DVec3| one + (other - one) * fraction;
        Self { force: between(self.force, other.force), torque: between(self.torque, other.torque) }
    }
}

/// The measurement of a joint for one sensor.
pub(super) struct Gauge {
    /// The link of the frame in which it measures.
    link: LinkIndex,
    link_from_sensor: Pose,
    /// The links on one side of the joint, which only the joint holds; and those of them that have a mass.
    links: Vec<LinkIndex>,
    part: Vec<Piece>,
    /// 1 if they are on the child's side of the joint, −1 if they are on the parent's.
    sign: f64,
    /// Those of them at which the drive of a base pushes their bodies.
    pushed: Vec<LinkIndex>,
    /// The pose of the frame, and the motion of each piece, before the step.
    world_from_sensor: Pose,
    before: Vec<Motion>,
    /// The integral of the wrench of the parent on the child, up to the last step but one and up to the last.
    passed: [Wrench; 2],
    /// True after the first step.
    has_measured: bool,
}

/// The motion of a link in the world: its centre of mass, the centre's velocity, and the angular momentum about it.
#[derive(Clone, Copy)]
struct Motion {
    centre: DVec3,
    velocity: DVec3,
    spin: DVec3,
}

impl Physics {
    /// Creates the gauges of a model that has been placed: one for each force-torque sensor, in their order.
    pub(super) fn add_gauges(&mut self, index: ModelIndex, model: &Model, carried: &[JointIndex]) {
        let joint_of = |sensor: &Sensor| match &sensor.kind {
            SensorKind::ForceTorque(it) => Some(it.joint),
            _ => None,
        };
        let mut sensors =
            model.sensors.iter().filter_map(|sensor| Some((sensor, joint_of(sensor)?))).peekable();
        if sensors.peek().is_none() {
            return;
        }
        let near = self.neighbours(index, model);
        let pushed = self.pushed_links(index);
        let mut gauges = Vec::new();
        for (sensor, joint) in sensors {
            let side = if carried.contains(&joint) {
                Err("it is that of a wheel, which is part of its base here")
            } else {
                Self::side(model, joint, &near)
            };
            gauges.push(match side {
                Ok((sign, links)) => {
                    let is_there: HashSet<LinkIndex> = links.iter().copied().collect();
                    Some(Gauge {
                        link: sensor.link,
                        link_from_sensor: sensor.link_from_sensor,
                        pushed: pushed.iter().copied().filter(|link| is_there.contains(link)).collect(),
                        part: Self::pieces(model, &links),
                        links,
                        sign,
                        world_from_sensor: Pose::IDENTITY,
                        before: Vec::new(),
                        passed: [Wrench::default(); 2],
                        has_measured: false,
                    })
                }
                Err(why) => {
                    self.notes.push(Problem {
                        severity: Severity::Warning,
                        source: sensor.source.clone(),
                        what: format!(
                            "the sensor '{}' cannot measure the joint '{}': {why}. It is left out",
                            sensor.name, model.joints[joint].name
                        ),
                        remedy: "put it on another joint".into(),
                    });
                    None
                }
            });
        }
        self.models[index].gauges = gauges;
    }

    /// Stores the motion of all measured links before a step.
    pub(super) fn begin_gauges(&mut self) {
        self.for_each_gauge(|physics, index, gauge| {
            gauge.world_from_sensor = physics.world_from_sensor(index, gauge);
            gauge.before.clear();
            gauge.before.extend(gauge.part.iter().map(|piece| physics.motion(index, piece)));
        });
    }

    /// Adds the wrenches of the last step to the integrals.
    pub(super) fn end_gauges(&mut self) {
        self.for_each_gauge(|physics, index, gauge| {
            let passed = physics.passed_in_step(index, gauge);
            gauge.has_measured = true;
            gauge.passed[0] = gauge.passed[1];
            gauge.passed[1].force += passed.force;
            gauge.passed[1].torque += passed.torque;
        });
    }

    fn for_each_gauge(&mut self, act: impl Fn(&Self, ModelIndex, &mut Gauge)) {
        for index in 0..self.models.len() {
            if self.models[index].gauges.is_empty() {
                continue;
            }
            let mut gauges = std::mem::take(&mut self.models[index].gauges);
            gauges.iter_mut().flatten().for_each(|gauge| act(self, index, gauge));
            self.models[index].gauges = gauges;
        }
    }

    /// Returns the integral of the wrench of a joint's parent on its child up to a time between the last two steps, in N·s and
    /// N·m·s, along the axes of the sensor's frame and about its origin. `sensor` is the index among the model's force-torque
    /// sensors. Returns `None` for a joint that cannot be measured.
    pub fn passed_at(&self, model: ModelIndex, sensor: usize, stamp_ns: u64) -> Option<Wrench> {
        let [from, to] = self.models[model].gauges.get(sensor)?.as_ref()?.passed;
        Some(from.to(to, self.fraction(stamp_ns)))
    }

    /// Returns the mean wrench of the last step, in N and N·m; `None` before the first step, and for a joint that cannot be
    /// measured.
    pub fn wrench(&self, model: ModelIndex, sensor: usize) -> Option<Wrench> {
        let gauge = self.models[model].gauges.get(sensor)?.as_ref()?;
        let [from, to] = gauge.passed;
        gauge.has_measured.then(|| to.mean_since(&from, self.step_s()))
    }

    fn world_from_sensor(&self, index: ModelIndex, gauge: &Gauge) -> Pose {
        self.world_from_link(index, gauge.link) * gauge.link_from_sensor
    }

    fn motion(&self, index: ModelIndex, piece: &Piece) -> Motion {
        let world_from_link = self.world_from_link(index, piece.link);
        let centre = world_from_link.transform_point(piece.centre);
        let body = self.models[index].links[piece.link].body;
        let still = Motion { centre, velocity: DVec3::ZERO, spin: DVec3::ZERO };
        body.map_or(still, |body| {
            let rigid = &self.rapier.bodies[self.bodies[body].handle];
            let turn = world_from_link.rotation_matrix();
            let spin = turn * (piece.inertia * (turn.transpose() * rigid.angvel()));
            Motion { centre, velocity: rigid.velocity_at_point(centre), spin }
        })
    }

    /// Returns the integral of the wrench of the parent on the child over the last step, in N·s and N·m·s, along the axes of
    /// the gauge.
    fn passed_in_step(&self, index: ModelIndex, gauge: &Gauge) -> Wrench {
        let step_s = self.step_s();
        let world_from_sensor =
            gauge.world_from_sensor.interpolate(&self.world_from_sensor(index, gauge), 0.5);
        let origin = world_from_sensor.translation();
        let mut passed = Wrench::default();
        for (piece, before) in gauge.part.iter().zip(&gauge.before) {
            let after = self.motion(index, piece);
            let [linear, angular] = self.damping_of(index, piece.link);
            let way = after.centre - before.centre;
            // Damping by air is not a force of the joint.
            let gained = after.velocity - before.velocity + way * linear;
            let fallen = if piece.gravity { self.gravity() * step_s } else { DVec3::ZERO };
            let arm = 0.5 * (before.centre + after.centre) - origin;
            passed.add((gained - fallen) * piece.mass_kg, arm);
            passed.torque += after.spin - before.spin;
            passed.torque += 0.5 * (before.spin + after.spin) * (angular * step_s);
        }
        let links = gauge.links.iter().map(|link| &self.models[index].links[*link]);
        for (impulse, at) in links.flat_map(|link| &link.colliders).flat_map(|of| self.contacts_of(*of)) {
            passed.add(-impulse, at - origin);
        }
        for link in &gauge.pushed {
            let Some(body) = self.models[index].links[*link].body else { continue };
            let rigid = &self.rapier.bodies[self.bodies[body].handle];
            passed.add(-rigid.user_force() * step_s, self.centre_in_step(rigid) - origin);
            passed.torque -= rigid.user_torque() * step_s;
        }
        let sensor_from_world = world_from_sensor.inverse();
        Wrench {
            force: sensor_from_world.transform_vector(passed.force) * gauge.sign,
            torque: sensor_from_world.transform_vector(passed.torque) * gauge.sign,
        }
    }

    /// Returns rapier's linear and angular damping of a link's body, in 1/s.
    fn damping_of(&self, index: ModelIndex, link: LinkIndex) -> [f64; 2] {
        let body = self.models[index].links[link].body;
        body.map_or([0.0; 2], |body| {
            let rigid = &self.rapier.bodies[self.bodies[body].handle];
            [rigid.linear_damping(), rigid.angular_damping()]
        })
    }

    /// Returns the centre of mass of a body in the middle of the last step.
    fn centre_in_step(&self, rigid: &RigidBody) -> DVec3 {
        rigid.center_of_mass() - rigid.linvel() * (0.5 * self.step_s())
    }

    /// Returns the impulses of contacts on a collider in the last step, in N·s, with their points.
    fn contacts_of(&self, collider: ColliderHandle) -> impl Iterator<Item = (DVec3, DVec3)> + '_ {
        let pairs = self.rapier.narrow_phase.contact_pairs_with(collider);
        pairs.filter_map(|pair| Some((pair, pair.rigid()?))).flat_map(move |(pair, contacts)| {
            // rapier's impulses are those on the first body.
            let sign = if pair.collider1 == collider { 1.0 } else { -1.0 };
            contacts.solver_manifolds().iter().flat_map(move |manifold| {
                let points = manifold.data.solver_contacts.iter().flat_map(SolverContact::contact_indices);
                points.filter_map(move |point| {
                    let contact = &manifold.points.get(point as usize)?.data;
                    Some((impulse(manifold, contact) * sign, self.place(manifold, contact)?))
                })
            })
        })
    }

    /// Returns the position of a contact in the last step. rapier stores it relative to the centre of a moving body.
    fn place(&self, manifold: &ContactManifold, contact: &ContactData) -> Option<DVec3> {
        let arms = [contact.solver_dp1, contact.solver_dp2];
        let bodies = [manifold.data.rigid_body1, manifold.data.rigid_body2];
        bodies.into_iter().zip(arms).find_map(|(body, arm)| {
            let rigid = self.rapier.bodies.get(body?).filter(|rigid| rigid.is_dynamic())?;
            Some(self.centre_in_step(rigid) + arm)
        })
    }
}

/// Returns the impulse of a contact on the first of its bodies in the last step, in N·s: along the normal, and by friction
/// along the two tangents that rapier derives from it.
pub(super) fn impulse(manifold: &ContactManifold, contact: &ContactData) -> DVec3 {
    let push = -manifold.data.normal;
    let tangent = push.orthonormal_vector();
    let [along, across] = [contact.tangent_impulse.x, contact.tangent_impulse.y];
    push * contact.impulse + tangent * along + push.cross(tangent) * across
}
