//! The names that Gazebo gives a URDF's collisions, and the collisions that contact sensors name by them.
//!
//! Gazebo converts a URDF to SDF. It names a collision `LINK_collision`, or `NAME_collision` if it has a name, and lumps the
//! links that fixed joints join: a collision of another link becomes `ROOT_fixed_joint_lump__LINK_collision` of the uppermost
//! link. From the second collision of a link on, a number follows: `LINK_collision_1`.

use super::Loader;
use crate::model::{JointKind, LinkIndex, Model, SensorKind};
use crate::sensor::Known;
use crate::values::child_bool;
use crate::xml::Element;
use std::collections::HashSet;

const COLLISION: &str = "_collision";
const LUMP: &str = "_fixed_joint_lump__";

impl Loader<'_> {
    /// Names the collisions as Gazebo does, and looks up those that contact sensors watch. Links and joints form a tree.
    pub(super) fn name_collisions(&mut self, robot: &Element, model: &mut Model) {
        let root_of = self.lump_collisions(robot, model);
        let Model { links, sensors, .. } = model;
        for sensor in sensors {
            let SensorKind::Contact(contact) = &mut sensor.kind else { continue };
            let root = root_of[sensor.link];
            let mut known = Vec::new();
            for link in (0..links.len()).filter(|link| root_of[*link] == root) {
                known.extend(links[link].collisions.iter().enumerate().map(|(index, collision)| {
                    let name = collision.scoped_name.as_deref().unwrap_or(&collision.name);
                    let name = name.rsplit("::").next().unwrap_or(name).to_owned();
                    Known { name, place: (link, index) }
                }));
            }
            // The names that the collisions of the sensor's link have before links are lumped.
            let own = &links[sensor.link];
            if sensor.link != root {
                known.extend(own.collisions.iter().enumerate().map(|(index, collision)| {
                    let name = plain_name(&collision.name, &own.name, index);
                    Known { name, place: (sensor.link, index) }
                }));
            }
            contact.look_up((&sensor.name, &sensor.source), &known, self.diagnostics);
        }
    }

    /// Names all collisions, and returns the link into which each link is lumped.
    fn lump_collisions(&mut self, robot: &Element, model: &mut Model) -> Vec<LinkIndex> {
        let kept: HashSet<&str> = robot
            .elements_named("gazebo")
            .filter(|extension| {
                ["preserveFixedJoint", "disableFixedJointLumping"]
                    .iter()
                    .any(|name| child_bool(extension, name, self.diagnostics) == Some(true))
            })
            .filter_map(|extension| extension.attribute("reference"))
            .collect();
        // Gazebo reads the joints in the order of their names.
        let mut joints: Vec<_> = model
            .joints
            .iter()
            .filter(|joint| joint.kind == JointKind::Fixed && !kept.contains(joint.name.as_str()))
            .filter(|joint| model.links[joint.parent].name != "world")
            .collect();
        joints.sort_by(|one, other| other.name.cmp(&one.name));
        let mut lumped = vec![Vec::new(); model.links.len()];
        let mut is_root = vec![true; model.links.len()];
        for joint in joints {
            lumped[joint.parent].push(joint.child);
            is_root[joint.child] = false;
        }
        let mut root_of: Vec<LinkIndex> = (0..model.links.len()).collect();
        for root in (0..model.links.len()).filter(|link| is_root[*link]) {
            let root_name = model.links[root].name.clone();
            let (mut open, mut count) = (vec![root], 0);
            while let Some(link) = open.pop() {
                root_of[link] = root;
                let own = &mut model.links[link];
                for collision in &mut own.collisions {
                    let name = plain_name(&collision.name, &own.name, count);
                    let lump = if name.starts_with(&root_name) { "" } else { LUMP };
                    let before = if lump.is_empty() { "" } else { &root_name };
                    collision.scoped_name = Some(format!("{root_name}::{before}{lump}{name}"));
                    count += 1;
                }
                open.append(&mut lumped[link]);
            }
        }
        root_of
    }
}

/// Returns the name of the collision with this index in a link, before the link is lumped.
fn plain_name(collision: &str, link: &str, index: usize) -> String {
    let name = if collision.is_empty() { link } else { collision };
    if index == 0 { format!("{name}{COLLISION}") } else { format!("{name}{COLLISION}_{index}") }
}
