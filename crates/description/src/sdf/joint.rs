//! `<joint>`.

use super::frames::Frames;
use super::model::Parts;
use super::{Loader, Scope, Version, name_of};
use crate::diagnostics::Source;
use crate::model::{Joint, JointDynamics, JointKind, Link, LinkIndex, Mimic};
use crate::sensor::{JointMount, parse_joint_sensor};
use crate::values::{NO_LIMIT, child_bool, child_number, child_text, not_negative};
use crate::xml::Element;
use belvedere_sensors::Pose;
use glam::DVec3;
use std::collections::HashMap;

/// The name of the world in a joint's `<parent>`.
const WORLD: &str = "world";

/// Returns a link that stands for the world, for joints whose parent is the world.
fn world_link(source: &Source) -> Link {
    Link { is_static: true, ..Link::empty(WORLD.into(), source.clone()) }
}

impl Loader<'_> {
    pub(super) fn joint(
        &mut self,
        element: &Element,
        scope: Scope<'_>,
        frames: &mut Frames,
        parts: &mut Parts,
    ) {
        let Parts { joint_sources, joint_names, .. } = parts;
        let first = |index: usize| &joint_sources[index];
        let Some(name) = self.own_name(element, joint_names, joint_sources.len(), first) else { return };
        joint_sources.push(element.source.clone());
        if name != name_of(element) {
            let pose = self.pose(element, scope.version);
            frames.add_joint(&name, &pose, child_text(element, "child").as_deref());
        }
        let kind_name = element.attribute("type").unwrap_or_default();
        let Some(child) = self.joint_end(element, "child", frames, parts) else { return };
        if child_text(element, "parent").as_deref() == Some(WORLD) {
            if kind_name == "fixed" {
                parts.links[child].is_static = true;
                // What the world does to the link is of interest only if it is measured.
                if element.child("sensor").is_none() {
                    return;
                }
            }
            if !parts.by_name.contains_key(WORLD) {
                parts.by_name.insert(WORLD.into(), parts.links.len());
                parts.links.push(world_link(&element.source));
            }
        }
        let Some(parent) = self.joint_end(element, "parent", frames, parts) else { return };
        if parent == child {
            let what = format!(
                "<parent> and <child> of the joint '{name}' both belong to the link '{}'",
                parts.links[child].name
            );
            self.diagnostics.error(&element.source, what, "name two links, or frames of two links");
            return;
        }

        let model_from_joint =
            frames.resolve_joint(&name, &element.source, self.diagnostics).unwrap_or(Pose::IDENTITY);
        let model_from_parent = parts.links[parent].model_from_link;
        let model_from_child = parts.links[child].model_from_link;
        let axis_in_model = self.axis_in_model(element, scope.version, frames, model_from_joint);
        let Some(kind) = self.joint_kind(element, kind_name) else { return };
        let dynamics = self.dynamics(element);
        if let Some(mimic) = element.child("axis").and_then(|axis| axis.child("mimic")) {
            parts.mimics.push((parts.joints.len(), mimic.clone()));
        }
        let source = element.source.clone();
        let joint = Joint {
            name,
            kind,
            parent,
            child,
            parent_from_child: model_from_parent.inverse() * model_from_child,
            axis: model_from_child.inverse().transform_vector(axis_in_model),
            pivot: (model_from_child.inverse() * model_from_joint).translation(),
            dynamics,
            source,
        };
        let child_from_joint = model_from_child.inverse() * model_from_joint;
        let mount = JointMount { joint: &joint, index: parts.joints.len(), child_from_joint };
        for sensor in element.elements_named("sensor") {
            let pose = self.pose_in_joint(sensor, scope.version, model_from_joint, frames);
            parts.sensors.extend(parse_joint_sensor(sensor, &mount, pose, self.rules, self.diagnostics));
        }
        parts.joints.push(joint);
    }

    /// The pose of a sensor in the frame of its joint.
    fn pose_in_joint(
        &mut self,
        sensor: &Element,
        version: Version,
        model_from_joint: Pose,
        frames: &Frames,
    ) -> Pose {
        let written = self.pose(sensor, version);
        let frame = frames.named_by(&written, self.diagnostics);
        let model_from_frame = frame.and_then(|name| frames.resolve(name, &written.source, self.diagnostics));
        model_from_frame.map_or(written.pose, |frame| model_from_joint.inverse() * frame * written.pose)
    }

    /// Reads damping, friction and spring from `<dynamics>`, the limits of the motor, and the initial position.
    fn dynamics(&mut self, joint: &Element) -> JointDynamics {
        let mut dynamics = JointDynamics::default();
        let Some(axis) = joint.child("axis") else { return dynamics };
        if let Some(written) = axis.child("dynamics") {
            let mut resistance = |name: &str| {
                let value = child_number(written, name, self.diagnostics).unwrap_or(0.0);
                not_negative(value, &format!("<{name}>"), &written.source, self.diagnostics)
            };
            dynamics.damping = resistance("damping");
            dynamics.friction = resistance("friction");
            dynamics.spring_stiffness = resistance("spring_stiffness");
            dynamics.spring_reference =
                child_number(written, "spring_reference", self.diagnostics).unwrap_or(0.0);
        }
        if let Some(limit) = axis.child("limit") {
            // A value below 0, or 1e16, means no limit.
            let mut most = |name| match child_text(limit, name).as_deref().map(str::parse) {
                None | Some(Ok(f64::INFINITY)) => f64::INFINITY,
                Some(_) => child_number(limit, name, self.diagnostics)
                    .filter(|most| (0.0..NO_LIMIT).contains(most))
                    .unwrap_or(f64::INFINITY),
            };
            (dynamics.max_effort, dynamics.max_velocity) = (most("effort"), most("velocity"));
        }
        dynamics.initial_position = child_number(axis, "initial_position", self.diagnostics).unwrap_or(0.0);
        dynamics
    }

    /// Resolves `<mimic>`: makes each such joint of a model follow the joint that it names.
    pub(super) fn follow(&mut self, parts: &mut Parts) {
        let mimics = std::mem::take(&mut parts.mimics);
        let mut named: HashMap<String, usize> = HashMap::new();
        if !mimics.is_empty() {
            for (index, joint) in parts.joints.iter().enumerate() {
                named.entry(joint.name.clone()).or_insert(index);
            }
        }
        for (follower, mimic) in mimics {
            let name = mimic.attribute("joint").unwrap_or_default();
            let Some(leader) = named.get(name).copied() else {
                let names = parts.joints.iter().map(|joint| joint.name.as_str());
                let what = format!(
                    "<mimic> of the joint '{}' names the joint '{name}', which does not exist",
                    parts.joints[follower].name
                );
                let meant = self.diagnostics.did_you_mean(name, names);
                self.diagnostics.error(&mimic.source, what, meant.unwrap_or_default());
                continue;
            };
            if mimic.attribute("axis").is_some_and(|axis| axis != "axis") {
                let what = "<mimic> names another axis than 'axis': the first one is followed";
                self.diagnostics.warning(&mimic.source, what, "write axis=\"axis\"");
            }
            let mut number = |name, usual| child_number(&mimic, name, self.diagnostics).unwrap_or(usual);
            let (multiplier, offset, reference) =
                (number("multiplier", 1.0), number("offset", 0.0), number("reference", 0.0));
            let offset = offset - multiplier * reference;
            parts.joints[follower].dynamics.mimic = Some(Mimic { leader, multiplier, offset });
        }
        crate::mimic::break_loops(&mut parts.joints, self.diagnostics);
    }

    /// Returns the link that `<parent>` or `<child>` names, or the link of the frame named there.
    fn joint_end(&mut self, joint: &Element, end: &str, frames: &Frames, parts: &Parts) -> Option<LinkIndex> {
        let links = &parts.links;
        let Some(name) = child_text(joint, end) else {
            self.diagnostics.error(
                &joint.source,
                format!("the joint '{}' has no <{end}>", name_of(joint)),
                format!("write <{end}>NAME OF A LINK</{end}>"),
            );
            return None;
        };
        if end == "child" && name == WORLD {
            let what = format!("the joint '{}' has the world as its <child>", name_of(joint));
            self.diagnostics.error(&joint.source, what, "write the world as the <parent>");
            return None;
        }
        let name_in = |name: &str| parts.by_name.get(name).copied();
        let found = match name.as_str() {
            WORLD => name_in(WORLD),
            _ => frames.link_of(&name).and_then(|link| name_in(&link)),
        };
        if found.is_none() && parts.lacks {
            let what = format!("the joint '{}' is left out with its {end} '{name}'", name_of(joint));
            self.diagnostics.warning(&joint.source, what, "get the models that are missing");
        } else if found.is_none() {
            let names = links.iter().map(|link| link.name.as_str());
            let meant = self.diagnostics.did_you_mean(&name, names);
            self.diagnostics.error(
                &joint.source,
                format!("the joint '{}' names the {end} '{name}', which is no link", name_of(joint)),
                meant.unwrap_or_else(|| "name a link, or a frame that moves with one".to_owned()),
            );
        }
        found
    }

    fn joint_kind(&mut self, element: &Element, kind: &str) -> Option<JointKind> {
        let limit = element.child("axis").and_then(|axis| axis.child("limit"));
        let mut bound = |name: &str, default: f64| {
            let text = limit.and_then(|limit| child_text(limit, name)).unwrap_or_default();
            match text.parse::<f64>() {
                Ok(unbounded) if unbounded.is_infinite() => unbounded,
                _ => limit.and_then(|limit| child_number(limit, name, self.diagnostics)).unwrap_or(default),
            }
        };
        let (lower, upper) = (bound("lower", -NO_LIMIT), bound("upper", NO_LIMIT));
        let lower = if lower <= -NO_LIMIT { f64::NEG_INFINITY } else { lower };
        let upper = if upper >= NO_LIMIT { f64::INFINITY } else { upper };
        if lower > upper {
            self.diagnostics.error(
                limit.map_or(&element.source, |limit| &limit.source),
                format!("<lower> is {lower} and <upper> is {upper}"),
                "the lower limit must not be above the upper one",
            );
            return None;
        }
        match kind {
            "fixed" => Some(JointKind::Fixed),
            "continuous" => Some(JointKind::Continuous),
            "revolute" if lower == f64::NEG_INFINITY && upper == f64::INFINITY => Some(JointKind::Continuous),
            "revolute" => Some(JointKind::Revolute { lower, upper }),
            "ball" => Some(JointKind::Ball),
            "prismatic" => Some(JointKind::Prismatic { lower, upper }),
            "universal" | "revolute2" => {
                self.other_kind(element, "the link turns about any axis, as on a ball joint");
                Some(JointKind::Ball)
            }
            "screw" => {
                self.other_kind(element, "the link turns, and does not move along the axis");
                Some(JointKind::Revolute { lower, upper })
            }
            "gearbox" => {
                self.other_kind(element, "it is left out, and both joints that it couples move freely");
                None
            }
            other => {
                self.missing(
                    &element.source,
                    format!("joints of type '{other}' are not known"),
                    "use fixed, revolute, continuous, prismatic, ball, universal, revolute2, screw or gearbox",
                );
                // With --gazebo-compat the link stays where it is.
                self.rules.gazebo_compat.then_some(JointKind::Fixed)
            }
        }
    }

    /// Adds a warning for a joint of a kind that is not simulated as such.
    fn other_kind(&mut self, joint: &Element, difference: &str) {
        let kind = joint.attribute("type").unwrap_or_default();
        let what = format!(
            "the joint '{}' is of type '{kind}', which is not simulated: {difference}",
            name_of(joint)
        );
        self.diagnostics.warning(&joint.source, what, "");
    }

    /// Returns the unit axis of a joint in the model frame. The file writes it in the joint's frame, up to SDF 1.4 in the
    /// model's, unless `use_parent_model_frame` (1.5, 1.6) or `expressed_in` (from 1.7) names another.
    fn axis_in_model(
        &mut self,
        element: &Element,
        version: Version,
        frames: &Frames,
        model_from_joint: Pose,
    ) -> DVec3 {
        let Some(axis) = element.child("axis") else { return model_from_joint.transform_vector(DVec3::Z) };
        let written = self.vector(axis, "xyz").unwrap_or(DVec3::Z);
        let Some(unit) = written.try_normalize() else {
            self.diagnostics.error(
                &axis.source,
                format!("the axis of the joint '{}' is 0 0 0", name_of(element)),
                "write its direction, such as 0 0 1",
            );
            return DVec3::Z;
        };
        let in_model_frame =
            version < (1, 5) || child_bool(axis, "use_parent_model_frame", self.diagnostics).unwrap_or(false);
        if in_model_frame {
            return unit;
        }
        let xyz = axis.child("xyz");
        let frame = xyz.and_then(|xyz| xyz.attribute("expressed_in")).filter(|frame| !frame.is_empty());
        match (frame, xyz) {
            (Some(frame), Some(xyz)) if version >= (1, 7) => frames
                .resolve(frame, &xyz.source, self.diagnostics)
                .map_or(unit, |model_from_frame| model_from_frame.transform_vector(unit)),
            _ => model_from_joint.transform_vector(unit),
        }
    }
}
