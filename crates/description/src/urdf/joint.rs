//! `<joint>`.

use super::Loader;
use crate::mimic;
use crate::model::{Joint, JointDynamics, JointKind, LinkIndex, Mimic, Model};
use crate::values::{NO_LIMIT, child_origin, not_negative, numbers};
use crate::xml::Element;
use glam::DVec3;

impl Loader<'_> {
    pub(super) fn joints(&mut self, robot: &Element, model: &mut Model) {
        for element in robot.elements_named("joint") {
            let taken = |loader: &Self, name: &str| {
                loader.joint_names.get(name).map(|first| &model.joints[*first].source)
            };
            let Some(name) = self.unique_name(element, taken) else { continue };
            let parent = self.joint_end(element, &name, "parent", model);
            let child = self.joint_end(element, &name, "child", model);
            let kind = self.joint_kind(element, &name);
            let axis = self.axis(element, &name);
            let (Some(parent), Some(child), Some(kind), Some(axis)) = (parent, child, kind, axis) else {
                continue;
            };
            let parent_from_child = child_origin(element, self.diagnostics);
            let source = element.source.clone();
            let pivot = DVec3::ZERO;
            let dynamics = self.dynamics(element, &name);
            self.joint_names.insert(name.clone(), model.joints.len());
            model.joints.push(Joint {
                name,
                kind,
                parent,
                child,
                parent_from_child,
                axis,
                pivot,
                dynamics,
                source,
            });
        }
        for element in robot.elements_named("joint") {
            self.follow(element, &mut model.joints);
        }
        mimic::break_loops(&mut model.joints, self.diagnostics);
    }

    /// Reads `<dynamics>`, and the limits of the joint's motor.
    fn dynamics(&mut self, element: &Element, joint: &str) -> JointDynamics {
        let mut dynamics = JointDynamics::default();
        if let Some(written) = element.child("dynamics") {
            let mut resistance = |name: &str| {
                let Some(value) = written.attribute(name).and_then(|_| self.attribute_number(written, name))
                else {
                    return 0.0;
                };
                let what = format!("attribute '{name}' of the joint '{joint}'");
                not_negative(value, &what, &written.source, self.diagnostics)
            };
            (dynamics.damping, dynamics.friction) = (resistance("damping"), resistance("friction"));
        }
        if let Some(limit) = element.child("limit") {
            // A value below 0 means no limit, as in Gazebo.
            let mut most = |name: &str| match limit.attribute(name).map(|text| text.trim().parse()) {
                None | Some(Ok(f64::INFINITY)) => f64::INFINITY,
                Some(_) => {
                    self.attribute_number(limit, name).filter(|most| *most >= 0.0).unwrap_or(f64::INFINITY)
                }
            };
            (dynamics.max_effort, dynamics.max_velocity) = (most("effort"), most("velocity"));
        }
        dynamics
    }

    /// Resolves `<mimic joint multiplier offset>`.
    fn follow(&mut self, element: &Element, joints: &mut [Joint]) {
        let name = element.attribute("name").unwrap_or_default();
        let Some(mimic) = element.child("mimic") else { return };
        let Some(follower) = self.joint_names.get(name).copied() else { return };
        let Some(followed) = self.required(mimic, "joint") else { return };
        let Some(leader) = self.joint_names.get(followed).copied() else {
            let what =
                format!("<mimic> of the joint '{name}' names the joint '{followed}', which does not exist");
            let names = joints.iter().map(|joint| joint.name.as_str());
            let meant = self.diagnostics.did_you_mean(followed, names);
            self.diagnostics.error(&mimic.source, what, meant.unwrap_or_default());
            return;
        };
        let mut number = |name: &str, usual: f64| {
            mimic.attribute(name).and_then(|_| self.attribute_number(mimic, name)).unwrap_or(usual)
        };
        let (multiplier, offset) = (number("multiplier", 1.0), number("offset", 0.0));
        joints[follower].dynamics.mimic = Some(Mimic { leader, multiplier, offset });
    }

    /// Returns the link named in `<parent link>` or `<child link>`.
    fn joint_end(&mut self, element: &Element, joint: &str, end: &str, model: &Model) -> Option<LinkIndex> {
        let Some(child) = element.child(end) else {
            self.diagnostics.error(
                &element.source,
                format!("the joint '{joint}' has no <{end}>"),
                format!("write <{end} link=\"NAME OF A LINK\"/>"),
            );
            return None;
        };
        let name = self.required(child, "link")?;
        let found = self.link_names.get(name).copied();
        if found.is_none() {
            let links = model.links.iter().map(|link| link.name.as_str());
            let near = self.diagnostics.did_you_mean(name, links).unwrap_or_default();
            let what = format!("the joint '{joint}' names the {end} link '{name}', which does not exist");
            self.diagnostics.error(&child.source, what, near);
        }
        found
    }

    fn joint_kind(&mut self, element: &Element, joint: &str) -> Option<JointKind> {
        match element.attribute("type").unwrap_or_default() {
            "fixed" => Some(JointKind::Fixed),
            "continuous" => Some(JointKind::Continuous),
            "floating" => Some(JointKind::Floating),
            "revolute" => {
                self.limits(element, joint).map(|[lower, upper]| JointKind::Revolute { lower, upper })
            }
            "prismatic" => {
                self.limits(element, joint).map(|[lower, upper]| JointKind::Prismatic { lower, upper })
            }
            other => {
                self.diagnostics.error(
                    &element.source,
                    format!("the joint '{joint}' is of type '{other}', which is not simulated"),
                    "use fixed, continuous, revolute, prismatic or floating",
                );
                None
            }
        }
    }

    /// Reads `<limit lower upper>`; each defaults to 0.
    fn limits(&mut self, element: &Element, joint: &str) -> Option<[f64; 2]> {
        let Some(limit) = element.child("limit") else {
            self.diagnostics.error(
                &element.source,
                format!("the joint '{joint}' has no <limit>"),
                "write <limit lower=\"…\" upper=\"…\"/>, or make it continuous",
            );
            return None;
        };
        let mut bound = |name: &str| {
            if limit.attribute(name).is_some() { self.attribute_number(limit, name) } else { Some(0.0) }
        };
        let (lower, upper) = (bound("lower"), bound("upper"));
        let (lower, upper) = (lower?, upper?);
        if lower <= upper {
            // As in SDF, into which Gazebo converts URDF, 1e16 means no limit.
            let open = |limit: f64| if limit.abs() >= NO_LIMIT { limit * f64::INFINITY } else { limit };
            return Some([lower, upper].map(open));
        }
        self.diagnostics.error(
            &limit.source,
            format!("the joint '{joint}' has the limits lower {lower} and upper {upper}"),
            "the lower limit must not be above the upper one",
        );
        None
    }

    /// Reads the unit axis in the joint's frame, which is the child's; x if none is given.
    fn axis(&mut self, element: &Element, joint: &str) -> Option<DVec3> {
        let Some((axis, text)) = element.child("axis").and_then(|axis| Some((axis, axis.attribute("xyz")?)))
        else {
            return Some(DVec3::X);
        };
        let xyz = numbers::<3>(text, "attribute 'xyz' of <axis>", &axis.source, self.diagnostics)?;
        let unit = DVec3::from_array(xyz).try_normalize();
        // Some files give a fixed joint an axis of 0 0 0.
        if unit.is_none() && element.attribute("type") == Some("fixed") {
            return Some(DVec3::X);
        }
        if unit.is_none() {
            self.diagnostics.error(
                &axis.source,
                format!("the axis of the joint '{joint}' is '{text}'"),
                "write its direction, such as 0 0 1",
            );
        }
        unit
    }
}
