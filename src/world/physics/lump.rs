//! Combines links that are connected by fixed joints into one rigid body, as Gazebo does.

use super::JointIndex;
use crate::description::diagnostics::{Problem, Severity};
use crate::description::inertia::{of_a_body, tensor};
use crate::description::model::{Inertial, JointKind, LinkIndex, Model};
use belvedere_sensors::Pose;
use glam::{DMat3, DVec3};

/// The links of a model sorted into rigid bodies.
pub(super) struct Lumps {
    /// For each link, the root of its body: the body's frame is that link's frame.
    pub(super) root: Vec<LinkIndex>,
    /// The links in the order of [`tree_order`].
    order: Vec<LinkIndex>,
}

/// Returns all links, parents before their children and otherwise by name, so that the order of the file has no effect.
/// Links in a loop are at the end.
pub(super) fn tree_order(model: &Model) -> Vec<LinkIndex> {
    let mut children = vec![Vec::new(); model.links.len()];
    let mut is_child = vec![false; model.links.len()];
    for joint in &model.joints {
        children[joint.parent].push(joint.child);
        is_child[joint.child] = true;
    }
    // The last one is processed first.
    let by_name = |links: &mut Vec<LinkIndex>| {
        links.sort_by(|one, other| model.links[*other].name.cmp(&model.links[*one].name));
    };
    children.iter_mut().for_each(by_name);
    let mut loops: Vec<LinkIndex> = (0..model.links.len()).collect();
    by_name(&mut loops);
    let mut open: Vec<LinkIndex> = loops.iter().copied().filter(|link| !is_child[*link]).collect();
    loops.append(&mut open);
    let (mut order, mut seen) = (Vec::with_capacity(model.links.len()), vec![false; model.links.len()]);
    while let Some(link) = loops.pop() {
        open.push(link);
        while let Some(link) = open.pop() {
            if !std::mem::replace(&mut seen[link], true) {
                order.push(link);
                open.extend(&children[link]);
            }
        }
    }
    order
}

/// Returns all joints in the order of their children; joints with the same child by name.
pub(super) fn joints_in(order: &[LinkIndex], model: &Model) -> Vec<JointIndex> {
    let mut place = vec![0; order.len()];
    for (number, link) in order.iter().enumerate() {
        place[*link] = number;
    }
    let mut joints: Vec<JointIndex> = (0..model.joints.len()).collect();
    joints.sort_by_key(|joint| (place[model.joints[*joint].child], &model.joints[*joint].name));
    joints
}

/// Returns the root of a link's tree; `None` in a model without links.
pub(super) fn root_above(model: &Model, link: LinkIndex) -> Option<LinkIndex> {
    let mut at = (link < model.links.len()).then_some(link)?;
    // A path with more steps than links is a loop.
    for _ in 0..model.links.len() {
        let Some(joint) = model.joint_above(at) else { break };
        at = joint.parent;
    }
    Some(at)
}

impl Lumps {
    /// Combines links across fixed joints. It also does so, with a note, across joints whose child has no mass, because no
    /// force could move that child. `rolled` joints are left alone: their wheels are carried.
    pub(super) fn of(
        model: &Model,
        order: &[LinkIndex],
        rolled: &[JointIndex],
        notes: &mut Vec<Problem>,
    ) -> Self {
        let mut lumps = Self { root: (0..model.links.len()).collect(), order: order.to_vec() };
        let joints = joints_in(order, model);
        for joint in joints.iter().map(|joint| &model.joints[*joint]) {
            if joint.kind == JointKind::Fixed {
                lumps.weld(joint.parent, joint.child);
            }
        }
        for index in joints {
            let joint = &model.joints[index];
            if joint.kind == JointKind::Fixed || rolled.contains(&index) {
                continue;
            }
            let root = lumps.root[joint.child];
            if root != lumps.root[joint.parent]
                && lumps.mass_kg(model, root) <= 0.0
                && !lumps.links(root).any(|link| model.links[link].is_static)
            {
                notes.push(Problem {
                    severity: Severity::Note,
                    source: joint.source.clone(),
                    what: format!(
                        "joint '{}' cannot move: its child link '{}' has no mass",
                        joint.name, model.links[joint.child].name
                    ),
                    remedy: "give the link an <inertial> if the joint is to move".into(),
                });
                lumps.weld(joint.parent, joint.child);
            }
        }
        lumps
    }

    /// Combines the bodies of two links; the parent's root becomes the root of both.
    fn weld(&mut self, parent: LinkIndex, child: LinkIndex) {
        let (keep, drop) = (self.root[parent], self.root[child]);
        for root in &mut self.root {
            if *root == drop {
                *root = keep;
            }
        }
    }

    /// Returns the links of the body with this root.
    pub(super) fn links(&self, root: LinkIndex) -> impl Iterator<Item = LinkIndex> + '_ {
        self.order.iter().copied().filter(move |link| self.root[*link] == root)
    }

    fn mass_kg(&self, model: &Model, root: LinkIndex) -> f64 {
        self.links(root).filter_map(|link| model.links[link].inertial).map(|inertial| inertial.mass_kg).sum()
    }
}

/// Mass properties of a whole body in its own frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BodyMass {
    pub(super) mass_kg: f64,
    pub(super) centre: DVec3,
    /// The inertia about the centre of mass, along the axes of the body's frame.
    pub(super) inertia: DMat3,
    /// The share of the mass that gravity acts on, in [0, 1].
    pub(super) gravity_share: f64,
}

impl BodyMass {
    /// Adds up the links of a body. Returns `None` if they have no mass at all. Inertias are rotated into the body's axes
    /// and shifted to the common centre of mass by the parallel axis theorem, I = R·I'·Rᵀ + m·(d²·1 − d·dᵀ).
    pub(super) fn of(links: impl Iterator<Item = (Pose, Inertial, bool)> + Clone) -> Option<Self> {
        let (mut mass_kg, mut moment, mut attracted_kg) = (0.0, DVec3::ZERO, 0.0);
        for (body_from_link, inertial, gravity) in links.clone() {
            let centre = (body_from_link * inertial.link_from_inertial).translation();
            mass_kg += inertial.mass_kg;
            moment += centre * inertial.mass_kg;
            attracted_kg += if gravity { inertial.mass_kg } else { 0.0 };
        }
        if mass_kg <= 0.0 {
            return None;
        }
        let centre = moment / mass_kg;
        let mut inertia = DMat3::ZERO;
        for (body_from_link, inertial, _) in links {
            let body_from_inertial = body_from_link * inertial.link_from_inertial;
            let turn = body_from_inertial.rotation_matrix();
            let own = of_a_body(tensor(inertial.inertia));
            let d = body_from_inertial.translation() - centre;
            let outer = DMat3::from_cols(d * d.x, d * d.y, d * d.z);
            inertia += turn * own * turn.transpose();
            inertia += (DMat3::from_diagonal(DVec3::splat(d.length_squared())) - outer) * inertial.mass_kg;
        }
        Some(Self { mass_kg, centre, inertia, gravity_share: attracted_kg / mass_kg })
    }

    /// SDF's default for a link without `<inertial>`: 1 kg and 1 kg·m² about every axis.
    pub(super) fn sdf_default(gravity: bool) -> Self {
        Self {
            mass_kg: 1.0,
            centre: DVec3::ZERO,
            inertia: DMat3::IDENTITY,
            gravity_share: if gravity { 1.0 } else { 0.0 },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two point masses of 1 kg, 2 m apart along the body's x, the second link turned by 90° about z.
    #[test]
    fn inertia_is_turned_and_shifted() {
        let inertial = Inertial {
            link_from_inertial: Pose::IDENTITY,
            mass_kg: 1.0,
            inertia: [1.0, 2.0, 3.0, 0.0, 0.0, 0.0],
        };
        let turned = Pose::from_xyz_rpy(DVec3::X * 2.0, DVec3::Z * std::f64::consts::FRAC_PI_2);
        let links = [(Pose::IDENTITY, inertial, true), (turned, inertial, false)];
        let body = BodyMass::of(links.into_iter()).expect("it has mass");
        assert!((body.mass_kg - 2.0).abs() < 1e-12 && (body.gravity_share - 0.5).abs() < 1e-12);
        assert!((body.centre - DVec3::X).length() < 1e-12);
        let expected = DMat3::from_diagonal(DVec3::new(1.0 + 2.0, 2.0 + 1.0 + 2.0, 3.0 + 3.0 + 2.0));
        assert!(body.inertia.abs_diff_eq(expected, 1e-12), "{}", body.inertia);
    }
}
