//! The links on one side of a joint, whose motion gives the wrench of the joint.

use super::{ModelIndex, Physics};
use crate::description::inertia::{of_a_body, tensor};
use crate::description::model::{Collision, Geometry, JointIndex, JointKind, Link, LinkIndex, Model};
use glam::{DMat3, DVec3};
use rapier3d_f64::dynamics::RigidBodyHandle;
use std::collections::HashMap;

/// A link with a mass.
pub(super) struct Piece {
    pub(super) link: LinkIndex,
    /// Centre of mass and inertia about it, along the link's axes.
    pub(super) centre: DVec3,
    pub(super) mass_kg: f64,
    pub(super) inertia: DMat3,
    pub(super) gravity: bool,
}

impl Physics {
    /// Returns, for each link, the links that a joint connects to it, with the joint.
    pub(super) fn neighbours(&self, index: ModelIndex, model: &Model) -> Vec<Vec<(JointIndex, LinkIndex)>> {
        let links = &self.models[index].links;
        let mut near = vec![Vec::new(); links.len()];
        for (number, joint) in model.joints.iter().enumerate() {
            // A link without a body is only a frame, which a movable joint does not hold.
            let holds = match joint.kind {
                JointKind::Fixed => true,
                JointKind::Floating => false,
                _ => [joint.parent, joint.child].iter().all(|link| links[*link].body.is_some()),
            };
            if holds {
                near[joint.parent].push((number, joint.child));
                near[joint.child].push((number, joint.parent));
            }
        }
        near
    }

    /// Returns the links on the side of a joint that nothing else holds, with 1 for the child's side or −1 for the parent's.
    pub(super) fn side(
        model: &Model,
        joint: JointIndex,
        near: &[Vec<(JointIndex, LinkIndex)>],
    ) -> Result<(f64, Vec<LinkIndex>), &'static str> {
        let ends = [model.joints[joint].child, model.joints[joint].parent];
        let [child, parent] = ends.map(|end| {
            let (mut seen, mut reached) = (vec![false; near.len()], vec![end]);
            seen[end] = true;
            let mut at = 0;
            while let Some(link) = reached.get(at) {
                let next = near[*link].iter().filter(|(by, _)| *by != joint).map(|(_, next)| *next);
                let new: Vec<LinkIndex> =
                    next.filter(|next| !std::mem::replace(&mut seen[*next], true)).collect();
                reached.extend(new);
                at += 1;
            }
            reached
        });
        if child.contains(&ends[1]) {
            return Err("it is part of a loop of joints");
        }
        let stands = model.is_static && !model.links.iter().any(|link| link.is_static);
        let is_held = |side: &[LinkIndex]| stands || side.iter().any(|link| is_held(&model.links[*link]));
        let is_world = |side: &[LinkIndex]| {
            side.iter().all(|link| {
                let link = &model.links[*link];
                link.name.rsplit("::").next() == Some("world") && link.collisions.is_empty()
            })
        };
        if !is_held(&child) || is_world(&parent) {
            Ok((1.0, child))
        } else if !is_held(&parent) || is_world(&child) {
            Ok((-1.0, parent))
        } else {
            Err("both of its sides stand still")
        }
    }

    /// Returns, for each body of a model, the link at which [`Physics::push`] acts: a wheel on it, or else its root.
    pub(super) fn pushed_links(&self, index: ModelIndex) -> Vec<LinkIndex> {
        let mut first: HashMap<RigidBodyHandle, (u8, LinkIndex)> = HashMap::new();
        for (number, link) in self.models[index].links.iter().enumerate() {
            let Some(body) = link.body.map(|body| &self.bodies[body]) else { continue };
            let rank = match (body.is_carried(), link.model_from_link == body.model_at_rest) {
                (true, _) => 0,
                (_, true) => 1,
                _ => 2,
            };
            let first = first.entry(body.handle).or_insert((rank, number));
            *first = (*first).min((rank, number));
        }
        let mut links: Vec<LinkIndex> = first.into_values().map(|(_, link)| link).collect();
        links.sort_unstable();
        links
    }

    /// Returns those of the links that have a mass. A body without any has 1 kg in rapier, but that is at the root of a robot, which no joint
    /// bears.
    pub(super) fn pieces(model: &Model, links: &[LinkIndex]) -> Vec<Piece> {
        let piece = |link: &LinkIndex| {
            let inertial = model.links[*link].inertial.filter(|inertial| inertial.mass_kg > 0.0)?;
            let turn = inertial.link_from_inertial.rotation_matrix();
            Some(Piece {
                link: *link,
                centre: inertial.link_from_inertial.translation(),
                mass_kg: inertial.mass_kg,
                inertia: turn * of_a_body(tensor(inertial.inertia)) * turn.transpose(),
                gravity: model.links[*link].gravity,
            })
        };
        links.iter().filter_map(piece).collect()
    }
}

/// Returns true if something other than joints holds a link, or moves it.
fn is_held(link: &Link) -> bool {
    let is_endless =
        |shape: &Collision| matches!(shape.geometry, Geometry::Plane { .. } | Geometry::HeightMap(_));
    link.is_static || link.is_kinematic || link.collisions.iter().any(is_endless)
}
