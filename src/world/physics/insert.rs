//! Models become bodies, joints and colliders of rapier.

use super::convert::{from_rapier, to_rapier, vector};
use super::joint::{JointState, Motion, MovingJoint};
use super::lump::{BodyMass, Lumps};
use super::{Body, JointIndex, ModelIndex, MovingLink, Physics, PlacedLink, PlacedModel, shape};
use crate::description::diagnostics::{Problem, Severity};
use crate::description::model::{Geometry, Inertial, LinkIndex, Model};
use crate::robot::kobuki::Wheels;
use belvedere_sensors::Pose;
use glam::DVec3;
use rapier3d::dynamics::{CoefficientCombineRule, MassProperties, RigidBodyBuilder, RigidBodyHandle};
use rapier3d::geometry::ColliderBuilder;
use rapier3d::math::Matrix;
use rapier3d::pipeline::ActiveHooks;

/// ODE's and SDF's coefficient of friction where a file gives none.
const DEFAULT_FRICTION: f64 = 1.0;

impl Physics {
    /// Adds a model's bodies, joints and shapes.
    pub(super) fn add(&mut self, model: &Model, world_from_model: &Pose, is_robot: bool) {
        let index = self.models.len();
        let rest = model.rest_poses();
        let (first_body, mut joints) = (self.bodies.len(), Vec::new());
        let mut links: Vec<PlacedLink> = rest
            .iter()
            .map(|model_from_link| PlacedLink {
                body: None,
                body_from_link: *world_from_model * *model_from_link,
                model_from_link: *model_from_link,
                colliders: Vec::new(),
                shapes: Vec::new(),
            })
            .collect();
        if model.is_static {
            joints.resize_with(model.joints.len(), || None);
        } else {
            let rolled: Vec<JointIndex> =
                if is_robot { Wheels::of(model).map(|wheels| wheels.joints()).ok() } else { None }
                    .map_or_else(Vec::new, Vec::from);
            let lumps = Lumps::of(model, &rolled, &mut self.notes);
            let wheel_of = |root: LinkIndex| {
                rolled.iter().copied().find(|joint| lumps.root[model.joints[*joint].child] == root)
            };
            let roots: Vec<LinkIndex> =
                (0..model.links.len()).filter(|link| lumps.root[*link] == *link).collect();
            for root in roots.iter().copied().filter(|root| wheel_of(*root).is_none()) {
                let carried = rolled.iter().map(|joint| &model.joints[*joint]);
                let carried = carried.filter(|joint| lumps.root[joint.parent] == root);
                let members: Vec<LinkIndex> = lumps
                    .links(root)
                    .chain(carried.flat_map(|joint| lumps.links(lumps.root[joint.child])))
                    .collect();
                if let Some(handle) = self.insert_body(model, &members, world_from_model, is_robot) {
                    self.place_links(model, index, &lumps, root, handle, None, &mut links);
                }
            }
            for root in roots {
                let Some(joint) = wheel_of(root) else { continue };
                if let Some(carrier) = links[model.joints[joint].parent].body {
                    let handle = self.bodies[carrier].handle;
                    let carrier = Some((carrier, index, joint));
                    self.place_links(model, index, &lumps, root, handle, carrier, &mut links);
                }
            }
            joints.extend(model.joints.iter().enumerate().map(|(number, joint)| {
                let sides =
                    [joint.parent, joint.child].map(|link| (links[link].body, links[link].body_from_link));
                let [(Some(parent), parent_from_link), (Some(child), child_from_link)] = sides else {
                    return None;
                };
                if parent == child {
                    return None;
                }
                let child_from_joint = Pose::new(DVec3::ZERO, MovingJoint::x_onto(joint.axis));
                let body_from_joint = [
                    parent_from_link * joint.parent_from_child * child_from_joint,
                    child_from_link * child_from_joint,
                ];
                let (constraint, axis) = MovingJoint::constraint(joint, &body_from_joint)?;
                let bodies = [parent, child];
                let state = JointState::default();
                if rolled.contains(&number) {
                    let motion = Motion::Rolled { rate: 0.0, effort: 0.0 };
                    return Some(MovingJoint {
                        motion,
                        bodies,
                        body_from_joint,
                        axis,
                        previous: state,
                        current: state,
                    });
                }
                let [first, second] = bodies.map(|body| self.bodies[body].handle);
                let motion = Motion::Forces(self.rapier.insert_impulse_joint(first, second, constraint));
                Some(MovingJoint { motion, bodies, body_from_joint, axis, previous: state, current: state })
            }));
        }
        for (link, placed) in links.iter_mut().enumerate() {
            self.add_colliders(model, index, link, placed);
        }
        self.models.push(PlacedModel {
            world_from_model: *world_from_model,
            links,
            joints,
            first_body,
            end_body: self.bodies.len(),
        });
    }

    /// Makes the body of some links, the first of which gives it its frame; none if it cannot move.
    fn insert_body(
        &mut self,
        model: &Model,
        members: &[LinkIndex],
        world_from_model: &Pose,
        is_robot: bool,
    ) -> Option<RigidBodyHandle> {
        let links = || members.iter().map(|link| &model.links[*link]);
        let collisions = || links().flat_map(|link| &link.collisions);
        let root = links().next()?;
        if let Some(plane) = collisions().find(|shape| matches!(shape.geometry, Geometry::Plane { .. })) {
            self.notes.push(Problem {
                severity: Severity::Note,
                source: plane.source.clone(),
                what: format!(
                    "link '{}' of model '{}' never moves: it has an infinite plane",
                    root.name, model.name
                ),
                remedy: "write <static>true</static>, or use a box".into(),
            });
            return None;
        }
        let body_from_model = root.model_from_link.inverse();
        let masses: Vec<(Pose, Inertial, bool)> = links()
            .filter_map(|link| Some((body_from_model * link.model_from_link, link.inertial?, link.gravity)))
            .collect();
        // Without mass and shapes it is a mere frame in space: there is nothing to move.
        let mass = BodyMass::of(masses.iter().copied())
            .or_else(|| collisions().next().map(|_| BodyMass::sdf_default(root.gravity)))?;
        let properties =
            MassProperties::with_inertia_matrix(vector(mass.centre), mass.mass_kg as f32, narrow(&mass));
        let body = RigidBodyBuilder::dynamic()
            .pose(to_rapier(&(*world_from_model * root.model_from_link)))
            .additional_mass_properties(properties)
            .gravity_scale(mass.gravity_share as f32)
            // A sleeping robot would ignore its motors; things in the world may rest.
            .can_sleep(!is_robot);
        Some(self.rapier.insert_body(body))
    }

    /// Places the links lumped to `root` in a new body of ours.
    #[expect(clippy::too_many_arguments, reason = "one step of `add`, split off because it is done twice")]
    fn place_links(
        &mut self,
        model: &Model,
        index: ModelIndex,
        lumps: &Lumps,
        root: LinkIndex,
        handle: RigidBodyHandle,
        carrier: Option<(usize, ModelIndex, JointIndex)>,
        links: &mut [PlacedLink],
    ) {
        let model_from_body = model.links[root].model_from_link;
        let body = self.bodies.len();
        for link in lumps.links(root) {
            let body_from_link = model_from_body.inverse() * model.links[link].model_from_link;
            (links[link].body, links[link].body_from_link) = (Some(body), body_from_link);
            self.moving.push(MovingLink { model: index, link, body, body_from_link });
        }
        let current = match carrier {
            None => from_rapier(self.rapier.bodies[handle].position()),
            Some((carrier, ..)) => {
                let carrier = &self.bodies[carrier];
                carrier.current * carrier.model_at_rest.inverse() * model_from_body
            }
        };
        self.bodies.push(Body {
            handle,
            carrier,
            model_at_rest: model_from_body,
            previous: current,
            current,
        });
    }

    fn add_colliders(&mut self, model: &Model, index: ModelIndex, link: LinkIndex, placed: &mut PlacedLink) {
        for collision in &model.links[link].collisions {
            let (shape, collision_from_shape) = match shape::shape(&collision.geometry, placed.body.is_some())
            {
                Ok(shape) => shape,
                Err(why) => {
                    self.notes.push(Problem {
                        severity: Severity::Warning,
                        source: collision.source.clone(),
                        what: format!(
                            "the collision '{}' of link '{}' touches nothing: {why}",
                            collision.name, model.links[link].name
                        ),
                        remedy: "correct its <geometry>".into(),
                    });
                    continue;
                }
            };
            // A wheel's shapes are fixed to the body that carries it.
            let rapier_from_body = placed.body.map_or(Pose::IDENTITY, |body| {
                let body = &self.bodies[body];
                body.carrier.map_or(Pose::IDENTITY, |(carrier, ..)| {
                    self.bodies[carrier].model_at_rest.inverse() * body.model_at_rest
                })
            });
            let link_from_shape = collision.link_from_collision * collision_from_shape;
            let pose = rapier_from_body * placed.body_from_link * link_from_shape;
            let collider = ColliderBuilder::new(shape)
                .position(to_rapier(&pose))
                // Mass and inertia come from <inertial> alone.
                .density(0.0)
                .friction(collision.friction.unwrap_or(DEFAULT_FRICTION) as f32)
                .friction_combine_rule(CoefficientCombineRule::Min)
                .user_data(index as u128)
                .active_hooks(if placed.body.is_some() {
                    ActiveHooks::FILTER_CONTACT_PAIRS
                } else {
                    ActiveHooks::empty()
                });
            let parent = placed.body.map(|body| self.bodies[body].handle);
            placed.colliders.push(self.rapier.insert_collider(collider, parent));
            placed.shapes.push(link_from_shape);
        }
    }
}

/// The inertia in single precision, with at least that of a ball of 1 cm of the same mass: a body without
/// inertia would count as one that cannot turn at all.
fn narrow(mass: &BodyMass) -> Matrix {
    const BALL_INERTIA_PER_KG: f64 = 0.4 * 0.01 * 0.01;
    let least = mass.mass_kg * BALL_INERTIA_PER_KG;
    let mut inertia = mass.inertia;
    for axis in 0..3 {
        let moment = &mut inertia.col_mut(axis)[axis];
        *moment = moment.max(least);
    }
    inertia.as_mat3()
}
