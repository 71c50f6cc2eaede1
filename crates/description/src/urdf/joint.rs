//! `<joint>`.

use super::{Loader, nearest_link};
use crate::model::{Joint, JointKind, LinkIndex, Model};
use crate::values::{child_origin, numbers};
use crate::xml::Element;
use glam::DVec3;

impl Loader<'_> {
    pub(super) fn joints(&mut self, robot: &Element, model: &mut Model) {
        for element in robot.elements_named("joint") {
            let taken = model.joints.iter().map(|joint| (joint.name.as_str(), &joint.source));
            let Some(name) = self.unique_name(element, taken) else { continue };
            let parent = self.joint_end(element, &name, "parent", model);
            let child = self.joint_end(element, &name, "child", model);
            let kind = self.joint_kind(element, &name);
            let axis = self.axis(element, &name);
            let (Some(parent), Some(child), Some(kind), Some(axis)) = (parent, child, kind, axis) else {
                continue;
            };
            if let Some(mimic) = element.child("mimic") {
                self.diagnostics.warning(
                    &mimic.source,
                    format!("the joint '{name}' does not follow another: <mimic> is not simulated"),
                    "it moves freely, as in Gazebo",
                );
            }
            let parent_from_child = child_origin(element, self.diagnostics);
            let source = element.source.clone();
            let pivot = DVec3::ZERO;
            model.joints.push(Joint { name, kind, parent, child, parent_from_child, axis, pivot, source });
        }
    }

    /// The link named in `<parent link>` or `<child link>`.
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
        let found = model.link_named(name);
        if found.is_none() {
            self.diagnostics.error(
                &child.source,
                format!("the joint '{joint}' names the {end} link '{name}', which does not exist"),
                nearest_link(name, &model.links),
            );
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

    /// `<limit lower upper>`, each 0 if not given.
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
            return Some([lower, upper]);
        }
        self.diagnostics.error(
            &limit.source,
            format!("the joint '{joint}' has the limits lower {lower} and upper {upper}"),
            "the lower limit must not be above the upper one",
        );
        None
    }

    /// The unit axis in the joint's frame, which is the child's; x if none is given.
    fn axis(&mut self, element: &Element, joint: &str) -> Option<DVec3> {
        let Some((axis, text)) = element.child("axis").and_then(|axis| Some((axis, axis.attribute("xyz")?)))
        else {
            return Some(DVec3::X);
        };
        let xyz = numbers::<3>(text, "attribute 'xyz' of <axis>", &axis.source, self.diagnostics)?;
        let unit = DVec3::from_array(xyz).try_normalize();
        // Files give a fixed joint an axis of 0 0 0.
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
