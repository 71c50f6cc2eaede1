//! Adds models as bodies, joints and colliders of rapier.

mod colliders;

use super::convert::{from_rapier, to_rapier};
use super::joint::{JointState, Motion, MovingJoint};
use super::lump::{BodyMass, Lumps, joints_in, root_above, tree_order};
use super::rest::Rest;
use super::{
    Body, Follows, ModelIndex, MovingLink, Physics, PlacedLink, PlacedModel, Placement, SUBSTEPS, place,
    resist, start,
};
use crate::description::diagnostics::{Problem, Severity};
use crate::description::inertia::is_positive_definite;
use crate::description::model::{
    Collision, Geometry, Inertial, Joint, JointDynamics, JointKind, Link, LinkIndex, Model, Trajectory,
};
use belvedere_sensors::Pose;
use glam::{DMat3, DVec3};
use rapier3d_f64::dynamics::{MassProperties, RigidBodyBuilder, RigidBodyHandle};
use std::sync::Arc;

impl Physics {
    /// Adds a model's bodies, joints and shapes, at the index of a removed model or at the next one.
    pub(super) fn add(&mut self, index: ModelIndex, placement: &Placement<'_>) {
        let Placement { model, ref world_from_model, ref carried, stays_awake } = *placement;
        self.notes.extend(place::too_far(model, world_from_model));
        let order = tree_order(model);
        let rest = model.rest_poses();
        let start = start::link_poses(model, &order, carried);
        let (first_body, mut joints) = (self.bodies.len(), Vec::new());
        joints.resize_with(model.joints.len(), || None);
        let mut leading = None;
        let mut links: Vec<PlacedLink> = rest
            .iter()
            .map(|model_from_link| PlacedLink {
                body: None,
                body_from_link: *world_from_model * *model_from_link,
                model_from_link: *model_from_link,
                colliders: Vec::new(),
                numbers: Vec::new(),
                shapes: Vec::new(),
            })
            .collect();
        if let Some(trajectory) = &model.trajectory {
            leading = Some(self.insert_actor(index, trajectory, world_from_model, &mut links));
        } else if !model.is_static {
            leading = self.insert_lumps(index, placement, &order, &start, &mut links, &mut joints);
        }
        // A sleeping robot would ignore its motors. Gazebo never disables a model with joints.
        let has_joints = model.joints.iter().any(|joint| joint.kind != JointKind::Fixed);
        if !stays_awake && model.may_sleep && !has_joints {
            for body in &mut self.bodies[first_body..] {
                if let Follows::Dynamics = body.follows {
                    body.rest = Some(Rest::new(body.current, self.time_ns));
                }
            }
        }
        for link in order {
            self.add_colliders(model, index, link, &mut links[link]);
        }
        // rapier does this only in the next step. Until then a body would have no mass, and its centre would be at the origin of
        // the world, so a model that is given a velocity at once would get a wrong one.
        for body in &self.bodies[first_body..] {
            self.rapier.bodies[body.handle].recompute_mass_properties_from_colliders(&self.rapier.colliders);
        }
        let placed = PlacedModel {
            world_from_model: *world_from_model,
            links,
            joints,
            gauges: Vec::new(),
            first_body,
            end_body: self.bodies.len(),
            leading,
        };
        match self.models.get_mut(index) {
            Some(place) => *place = placed,
            None => self.models.push(placed),
        }
        self.add_gauges(index, model, carried);
    }

    /// Adds the bodies of a model that moves by its joints, and the joints between them. Returns the body that leads the
    /// model.
    fn insert_lumps(
        &mut self,
        index: ModelIndex,
        placement: &Placement<'_>,
        order: &[LinkIndex],
        start: &[Pose],
        links: &mut [PlacedLink],
        joints: &mut [Option<MovingJoint>],
    ) -> Option<usize> {
        let Placement { model, ref world_from_model, ref carried, .. } = *placement;
        let first_body = self.bodies.len();
        let lumps = Lumps::of(model, order, carried, &mut self.notes);
        let wheel_of = |root: LinkIndex| {
            carried.iter().copied().find(|joint| lumps.root[model.joints[*joint].child] == root)
        };
        // The body that finally carries a link: a wheel may be on a steered link, which is on the base.
        let carrier_of = |link: LinkIndex| {
            let mut root = lumps.root[link];
            // A tree has fewer steps to its root than links.
            for _ in 0..model.links.len() {
                let Some(joint) = wheel_of(root) else { break };
                root = lumps.root[model.joints[joint].parent];
            }
            root
        };
        let roots: Vec<LinkIndex> = order.iter().copied().filter(|link| lumps.root[*link] == *link).collect();
        for root in roots.iter().copied().filter(|root| wheel_of(*root).is_none()) {
            let carries = |link: &LinkIndex| carrier_of(*link) == root;
            let members: Vec<LinkIndex> = lumps
                .links(root)
                .chain((0..model.links.len()).filter(|link| lumps.root[*link] != root).filter(carries))
                .collect();
            if let Some(handle) = self.insert_body(model, root, &members, &(*world_from_model * start[root]))
            {
                let is_fixed = self.rapier.bodies[handle].is_fixed();
                let follows = if is_fixed { Follows::Nothing } else { Follows::Dynamics };
                self.place_links(model, index, &lumps, root, &start[root], handle, follows, links);
            }
        }
        for root in roots {
            let Some(joint) = wheel_of(root) else { continue };
            if let Some(carrier) = links[model.joints[joint].parent].body {
                let handle = self.bodies[carrier].handle;
                let follows = Follows::Carried(carrier, index, joint);
                self.place_links(model, index, &lumps, root, &start[root], handle, follows, links);
            }
        }
        for number in joints_in(order, model) {
            let joint = &model.joints[number];
            let dynamics =
                JointDynamics { initial_position: start::position(model, number), ..joint.dynamics };
            let joint = Joint { dynamics, ..joint.clone() };
            joints[number] = self.join(&joint, links, carried.contains(&number));
        }
        root_above(model, model.canonical_link)
            .and_then(|root| links[root].body)
            .or_else(|| (first_body..self.bodies.len()).find(|body| !self.bodies[*body].is_carried()))
    }

    /// Adds a joint between two bodies. Returns none if neither moves, or if the joint has no position.
    fn join(&mut self, joint: &Joint, links: &[PlacedLink], is_rolled: bool) -> Option<MovingJoint> {
        let sides = [joint.parent, joint.child].map(|link| (links[link].body, links[link].body_from_link));
        let [(Some(parent), parent_from_link), (Some(child), child_from_link)] = sides else {
            return None;
        };
        let bodies = [parent, child];
        if parent == child || bodies.iter().all(|body| matches!(self.bodies[*body].follows, Follows::Nothing))
        {
            return None;
        }
        let child_from_joint = start::child_from_joint(joint);
        let body_from_joint = [
            parent_from_link * joint.parent_from_child * child_from_joint,
            child_from_link * child_from_joint,
        ];
        let handles = bodies.map(|body| self.bodies[body].handle);
        if joint.kind == JointKind::Ball {
            self.rapier.insert_impulse_joint(handles[0], handles[1], MovingJoint::ball(&body_from_joint));
            return None;
        }
        let (constraint, axis, wide_limits) = MovingJoint::constraint(joint, &body_from_joint)?;
        let motion = if is_rolled {
            Motion::Rolled { rate: 0.0, effort: 0.0 }
        } else {
            for resisting in resist::joints(&joint.dynamics, axis, &body_from_joint) {
                self.rapier.insert_impulse_joint(handles[0], handles[1], resisting);
            }
            Motion::Forces(self.rapier.insert_impulse_joint(handles[0], handles[1], constraint))
        };
        let position = if is_rolled { 0.0 } else { joint.dynamics.initial_position };
        let state = JointState { position, ..JointState::default() };
        Some(MovingJoint {
            motion,
            bodies,
            body_from_joint,
            axis,
            wide_limits,
            limits: joint.kind.limits(),
            dynamics: joint.dynamics,
            previous: state,
            current: state,
        })
    }

    /// Adds the body of these links, in the frame of its root. Returns none if there is nothing to move.
    fn insert_body(
        &mut self,
        model: &Model,
        root: LinkIndex,
        members: &[LinkIndex],
        world_from_root: &Pose,
    ) -> Option<RigidBodyHandle> {
        let links = || members.iter().map(|link| &model.links[*link]);
        let collisions = || links().flat_map(|link| &link.collisions);
        let root = &model.links[root];
        let pose = to_rapier(world_from_root);
        let endless =
            |shape: &&Collision| matches!(shape.geometry, Geometry::Plane { .. } | Geometry::HeightMap(_));
        let plane = collisions().find(endless);
        if let Some(plane) = plane {
            self.notes.push(Problem {
                severity: Severity::Note,
                source: plane.source.clone(),
                what: format!(
                    "link '{}' of model '{}' never moves: it has an infinite plane or a height map",
                    root.name, model.name
                ),
                remedy: "write <static>true</static>, or use a box".into(),
            });
        }
        if plane.is_some() || links().any(|link| link.is_static) {
            return Some(self.rapier.insert_body(RigidBodyBuilder::fixed().pose(pose)));
        }
        let body_from_model = root.model_from_link.inverse();
        let masses: Vec<(Pose, Inertial, bool)> = links()
            .filter_map(|link| Some((body_from_model * link.model_from_link, link.inertial?, link.gravity)))
            .collect();
        // A link without mass and shapes is only a frame.
        let mass = BodyMass::of(masses.iter().copied())
            .or_else(|| collisions().next().map(|_| BodyMass::sdf_default(root.gravity)))?;
        let properties = MassProperties::with_inertia_matrix(mass.centre, mass.mass_kg, inertia_of(&mass));
        if links().any(|link| link.is_kinematic) {
            return Some(self.rapier.insert_body(RigidBodyBuilder::kinematic_velocity_based().pose(pose)));
        }
        let [linear, angular] = self.damping(&links());
        let body = RigidBodyBuilder::dynamic()
            .pose(pose)
            .linear_damping(linear)
            .angular_damping(angular)
            .additional_mass_properties(properties)
            .gravity_scale(mass.gravity_share)
            // `Rest` allows it once the body has been at rest.
            .can_sleep(false);
        Some(self.rapier.insert_body(body))
    }

    /// rapier's damping in 1/s for a body of such links. A link loses a share of its velocity in each step, as in ODE,
    /// whatever the step; rapier divides by 1 + damping · time in each part of a step.
    fn damping<'l>(&self, links: &(impl Iterator<Item = &'l Link> + Clone)) -> [f64; 2] {
        let mass = |link: &Link| link.inertial.map_or(0.0, |inertial| inertial.mass_kg);
        let mass_kg: f64 = links.clone().map(mass).sum();
        [0, 1].map(|part| {
            let decays = links.clone().map(|link| {
                let weight = if mass_kg > 0.0 { mass(link) / mass_kg } else { 1.0 };
                link.velocity_decay[part] * weight
            });
            // A link that loses all of its velocity keeps a millionth, so that the damping is finite.
            let kept = (1.0 - decays.sum::<f64>()).max(1e-6);
            let part_s = self.step_s() / SUBSTEPS as f64;
            (libm::pow(kept, -1.0 / SUBSTEPS as f64) - 1.0) / part_s
        })
    }

    /// Adds a body of ours with the links that are lumped to `root`.
    #[expect(clippy::too_many_arguments, reason = "one step of `add`, split off because it is done twice")]
    fn place_links(
        &mut self,
        model: &Model,
        index: ModelIndex,
        lumps: &Lumps,
        root: LinkIndex,
        model_at_start: &Pose,
        handle: RigidBodyHandle,
        follows: Follows,
        links: &mut [PlacedLink],
    ) {
        let model_from_body = model.links[root].model_from_link;
        let body = self.bodies.len();
        let moves = !matches!(follows, Follows::Nothing);
        for link in lumps.links(root) {
            let body_from_link = model_from_body.inverse() * model.links[link].model_from_link;
            (links[link].body, links[link].body_from_link) = (Some(body), body_from_link);
            if moves {
                self.moving.push(MovingLink { model: index, link, body, body_from_link });
            }
        }
        let current = match follows {
            Follows::Carried(carrier, ..) => {
                let carrier = &self.bodies[carrier];
                carrier.current * carrier.model_at_rest.inverse() * model_from_body
            }
            _ => from_rapier(self.rapier.bodies[handle].position()),
        };
        self.bodies.push(Body {
            handle,
            follows,
            model_at_rest: model_from_body,
            model_at_start: *model_at_start,
            previous: current,
            current,
            rest: None,
        });
    }

    /// Adds the body of an actor, and returns its index.
    fn insert_actor(
        &mut self,
        index: ModelIndex,
        trajectory: &Trajectory,
        world_from_model: &Pose,
        links: &mut [PlacedLink],
    ) -> usize {
        let current = trajectory.pose_at(self.time_ns).unwrap_or(*world_from_model);
        let rigid = RigidBodyBuilder::kinematic_position_based().pose(to_rapier(&current));
        let body = self.bodies.len();
        for (link, placed) in links.iter_mut().enumerate() {
            (placed.body, placed.body_from_link) = (Some(body), placed.model_from_link);
            self.moving.push(MovingLink { model: index, link, body, body_from_link: placed.model_from_link });
        }
        self.bodies.push(Body {
            handle: self.rapier.insert_body(rigid),
            follows: Follows::Path(Arc::new(trajectory.clone())),
            model_at_rest: Pose::IDENTITY,
            model_at_start: Pose::IDENTITY,
            previous: current,
            current,
            rest: None,
        });
        body
    }
}

/// Returns the inertia, raised to at least that of a ball of 1 cm with the same mass about every axis. rapier treats a body
/// without inertia as one that cannot turn.
fn inertia_of(mass: &BodyMass) -> DMat3 {
    const BALL_INERTIA_PER_KG: f64 = 0.4 * 0.01 * 0.01;
    let least = DMat3::from_diagonal(DVec3::splat(mass.mass_kg * BALL_INERTIA_PER_KG));
    let is_enough = is_positive_definite(mass.inertia - least);
    if is_enough { mass.inertia } else { mass.inertia + least }
}
