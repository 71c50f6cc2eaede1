//! What passes through a joint: the force and the torque by which one side of it moves the other.
//!
//! It follows from how the links on one side move, by Newton and Euler: what accelerates them besides gravity, contacts and
//! the drive of a base has come through the joint. So it holds for fixed joints, which join links into one body, as for
//! those that move, and whatever moves them: motors, springs, limits, dry friction. Forces are means of a step.

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

/// A force and a torque, or what they have given in a time: N and N·m, or N·s and N·m·s.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wrench {
    /// The force.
    pub force: DVec3,
    /// The torque about the origin of the frame in which they are.
    pub torque: DVec3,
}

impl Wrench {
    fn add(&mut self, force: DVec3, at: DVec3) {
        self.force += force;
        self.torque += at.cross(force);
    }

    /// The mean wrench, in N and N·m, that has given this since it had given `earlier`.
    #[must_use]
    pub fn mean_since(&self, earlier: &Self, period_s: f64) -> Self {
        let mean = |now: DVec3, earlier: DVec3| (now - earlier) / period_s;
        Self { force: mean(self.force, earlier.force), torque: mean(self.torque, earlier.torque) }
    }

    /// From here to another one.
    fn to(self, other: Self, fraction: f64) -> Self {
        let between = |one: DVec3, other: DVec3| one + (other - one) * fraction;
        Self { force: between(self.force, other.force), torque: between(self.torque, other.torque) }
    }
}

/// What measures a joint, for a sensor.
pub(super) struct Gauge {
    /// The frame in which it measures.
    link: LinkIndex,
    link_from_sensor: Pose,
    /// The links on one side of the joint, which nothing but the joint holds, and what of them has a mass.
    links: Vec<LinkIndex>,
    part: Vec<Piece>,
    /// 1 if they are on the side of its child, −1 if on that of its parent.
    sign: f64,
    /// Those of them at which their bodies are pushed.
    pushed: Vec<LinkIndex>,
    /// Before the step: where the frame was, and how each piece moved.
    world_from_sensor: Pose,
    before: Vec<Motion>,
    /// What has passed from the parent to the child, until the last step but one and until the last.
    passed: [Wrench; 2],
    /// A step has been made.
    has_measured: bool,
}

/// How a link moves, in the world: its centre of mass, that one's velocity, and its spin.
#[derive(Clone, Copy)]
struct Motion {
    centre: DVec3,
    velocity: DVec3,
    spin: DVec3,
}

impl Physics {
    /// Makes the gauges of a model that has been placed: one for each force-torque sensor, in their order.
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

    /// Notes how everything moves that is measured, before a step.
    pub(super) fn begin_gauges(&mut self) {
        self.for_each_gauge(|physics, index, gauge| {
            gauge.world_from_sensor = physics.world_from_sensor(index, gauge);
            gauge.before.clear();
            gauge.before.extend(gauge.part.iter().map(|piece| physics.motion(index, piece)));
        });
    }

    /// Adds up what has passed through joints, after a step.
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

    /// What has passed from the parent to the child of a joint until a time between the last two steps, in N·s and N·m·s, as
    /// a sensor measures it: along the axes of its frame and about its origin. The sensor is the force-torque sensor of that
    /// number in its model. None for a joint that cannot be measured.
    pub fn passed_at(&self, model: ModelIndex, sensor: usize, stamp_ns: u64) -> Option<Wrench> {
        let [from, to] = self.models[model].gauges.get(sensor)?.as_ref()?.passed;
        Some(from.to(to, self.fraction(stamp_ns)))
    }

    /// The mean wrench of the last step, in N and N·m; none before the first step, and for a joint that cannot be measured.
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

    /// What has passed in the last step, in N·s and N·m·s along the axes of the gauge, from the parent to the child.
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
            // What the air has taken is not missing.
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

    /// rapier's linear and angular damping of a link's body, in 1/s.
    fn damping_of(&self, index: ModelIndex, link: LinkIndex) -> [f64; 2] {
        let body = self.models[index].links[link].body;
        body.map_or([0.0; 2], |body| {
            let rigid = &self.rapier.bodies[self.bodies[body].handle];
            [rigid.linear_damping(), rigid.angular_damping()]
        })
    }

    /// The centre of mass of a body in the middle of the last step.
    fn centre_in_step(&self, rigid: &RigidBody) -> DVec3 {
        rigid.center_of_mass() - rigid.linvel() * (0.5 * self.step_s())
    }

    /// The impulses in N·s that a collider has got in the last step by contacts, with the points where.
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

    /// Where a contact was in the last step. rapier keeps it relative to the centre of a body that moves.
    fn place(&self, manifold: &ContactManifold, contact: &ContactData) -> Option<DVec3> {
        let arms = [contact.solver_dp1, contact.solver_dp2];
        let bodies = [manifold.data.rigid_body1, manifold.data.rigid_body2];
        bodies.into_iter().zip(arms).find_map(|(body, arm)| {
            let rigid = self.rapier.bodies.get(body?).filter(|rigid| rigid.is_dynamic())?;
            Some(self.centre_in_step(rigid) + arm)
        })
    }
}

/// The impulse in N·s that a contact has given to the first of its bodies in the last step: along the normal, and by friction
/// along the two tangents that rapier derives from it.
fn impulse(manifold: &ContactManifold, contact: &ContactData) -> DVec3 {
    let push = -manifold.data.normal;
    let tangent = push.orthonormal_vector();
    let [along, across] = [contact.tangent_impulse.x, contact.tangent_impulse.y];
    push * contact.impulse + tangent * along + push.cross(tangent) * across
}
