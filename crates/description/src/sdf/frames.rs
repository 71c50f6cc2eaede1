//! `<pose>`, and the frames that poses are relative to.
//!
//! Up to SDF 1.6 a pose is relative to its parent element (a joint's to its child link). From 1.7 on
//! `relative_to` may name any frame of the same model or world: links, joints, frames and nested models.

use super::{Loader, Version};
use crate::diagnostics::{Diagnostics, Source};
use crate::suggestion::did_you_mean;
use crate::values::parse_pose;
use crate::xml::Element;
use belvedere_sensors::Pose;
use std::collections::HashMap;

/// A pose as the file writes it.
pub(super) struct WrittenPose {
    pub(super) pose: Pose,
    /// The frame that the pose is relative to; none for the default of the element's kind.
    pub(super) relative_to: Option<String>,
    pub(super) source: Source,
}

impl Loader<'_> {
    /// Reads the `<pose>` inside `parent`; the identity if there is none.
    pub(super) fn pose(&mut self, parent: &Element, version: Version) -> WrittenPose {
        let Some(element) = parent.child("pose") else {
            return WrittenPose { pose: Pose::IDENTITY, relative_to: None, source: parent.source.clone() };
        };
        let mut relative_to = element.attribute("relative_to").filter(|name| !name.is_empty());
        if version < (1, 7) {
            // SDF 1.5 and 1.6 had `frame`, whose meaning was never settled; Gazebo ignores it.
            if let Some(name) = relative_to.take().or(element.attribute("frame").filter(|f| !f.is_empty())) {
                self.diagnostics.warning(
                    &element.source,
                    format!("the frame '{name}' of <pose> is ignored in SDF {}.{}", version.0, version.1),
                    "write <sdf version=\"1.7\"> and relative_to",
                );
            }
        }
        WrittenPose {
            pose: parse_pose(element, self.rules.gazebo_compat, self.diagnostics).unwrap_or(Pose::IDENTITY),
            relative_to: relative_to.map(str::to_owned),
            source: element.source.clone(),
        }
    }

    /// Reads the pose of a part of a link (visual, collision, sensor, …) in that link.
    pub(super) fn pose_in_link(
        &mut self,
        part: &Element,
        version: Version,
        link: &str,
        frames: &Frames,
    ) -> Pose {
        let written = self.pose(part, version);
        let Some(frame) = &written.relative_to else { return written.pose };
        let model_from_frame = frames.resolve(frame, &written.source, self.diagnostics);
        let model_from_link = frames.resolve(link, &part.source, self.diagnostics);
        match (model_from_link, model_from_frame) {
            (Some(model_from_link), Some(model_from_frame)) => {
                model_from_link.inverse() * model_from_frame * written.pose
            }
            _ => written.pose,
        }
    }
}

struct Frame {
    parent: String,
    /// The frame that it moves with.
    attached_to: String,
    /// Pose in the parent frame.
    pose: Pose,
    source: Source,
}

/// Prefix of the names under which the frames of joints are stored; no XML name can contain it.
const JOINT: char = '\0';

fn joint_key(name: &str) -> String {
    format!("{JOINT}{name}")
}

/// The frames of one model or world.
pub(super) struct Frames {
    root: &'static str,
    own: HashMap<String, Frame>,
    /// The frames of nested models, by the models' names.
    nested: HashMap<String, Frames>,
}

impl Frames {
    /// Creates the frames of a model or world; `root` is the frame that all others hang on: `__model__` or `world`.
    pub(super) fn new(root: &'static str) -> Self {
        Self { root, own: HashMap::new(), nested: HashMap::new() }
    }

    /// Adds a frame with the pose `written`, which is relative to `default_parent` if it names no frame.
    pub(super) fn add(&mut self, name: &str, written: &WrittenPose, default_parent: Option<&str>) {
        let attached_to = default_parent.unwrap_or(self.root).to_owned();
        let parent = written.relative_to.clone().unwrap_or_else(|| attached_to.clone());
        let frame = Frame { parent, attached_to, pose: written.pose, source: written.source.clone() };
        self.own.insert(name.to_owned(), frame);
    }

    /// Adds the frames of a nested model, to be named as `model::frame`.
    pub(super) fn add_nested(&mut self, model: &str, frames: Frames) {
        self.nested.insert(model.to_owned(), frames);
    }

    /// Finds the nested model that a name begins with; returns its frames, its name and the rest of the name.
    fn nested<'n>(&self, name: &'n str) -> Option<(&Frames, &'n str, &'n str)> {
        let (model, rest) = name.split_once("::")?;
        Some((self.nested.get(model)?, model, rest))
    }

    /// Adds a joint's frame. If a link or frame has the same name, the name means that one, as in libsdformat;
    /// [`Frames::resolve_joint`] still finds the joint's own frame.
    pub(super) fn add_joint(&mut self, name: &str, written: &WrittenPose, child: Option<&str>) {
        if !self.own.contains_key(name) {
            self.add_known(name.to_owned(), &joint_key(name), Pose::IDENTITY, &written.source);
        }
        self.add(&joint_key(name), written, child);
    }

    /// Returns the pose of a joint's frame in the root.
    pub(super) fn resolve_joint(
        &self,
        name: &str,
        source: &Source,
        diagnostics: &mut Diagnostics,
    ) -> Option<Pose> {
        self.resolve(&joint_key(name), source, diagnostics)
    }

    /// Returns the pose in the root of a pose that was written in the world or model itself.
    pub(super) fn place(&self, written: &WrittenPose, diagnostics: &mut Diagnostics) -> Pose {
        let outer = written
            .relative_to
            .as_deref()
            .and_then(|frame| self.resolve(frame, &written.source, diagnostics));
        outer.map_or(written.pose, |root_from_frame| root_from_frame * written.pose)
    }

    /// Returns true if there is a frame of that name.
    pub(super) fn has(&self, name: &str) -> bool {
        self.own.contains_key(name)
    }

    /// Returns the link that a frame moves with: the first frame in its chain of attachments that `link` knows as a link.
    pub(super) fn link_of<T>(&self, name: &str, link: &dyn Fn(&str) -> Option<T>) -> Option<T> {
        let mut name = name;
        // A chain that is longer than the number of frames is a circle.
        for _ in 0..=self.own.len() {
            if let Some(found) = link(name) {
                return Some(found);
            }
            if let Some(frame) = self.own.get(name) {
                name = &frame.attached_to;
                continue;
            }
            let (inner, model, rest) = self.nested(name)?;
            return inner.link_of(rest, &|name: &str| link(&format!("{model}::{name}")));
        }
        None
    }

    /// Adds a frame whose pose in another frame is known.
    pub(super) fn add_known(&mut self, name: String, parent: &str, pose: Pose, source: &Source) {
        let frame = Frame { parent: parent.into(), attached_to: parent.into(), pose, source: source.clone() };
        self.own.insert(name, frame);
    }

    /// Returns the pose of a frame in the root. `source` is the place that refers to the frame.
    pub(super) fn resolve(&self, name: &str, source: &Source, diagnostics: &mut Diagnostics) -> Option<Pose> {
        let mut root_from_frame = Pose::IDENTITY;
        let (mut name, mut source) = (name, source);
        // A chain that is longer than the number of frames is a circle.
        for _ in 0..=self.own.len() {
            if name == self.root {
                return Some(root_from_frame);
            }
            if !self.own.contains_key(name)
                && let Some((inner, model, rest)) = self.nested(name)
            {
                root_from_frame = inner.resolve(rest, source, diagnostics)? * root_from_frame;
                name = model;
                continue;
            }
            let Some(frame) = self.own.get(name) else {
                let known = self.own.keys().map(String::as_str).filter(|key| !key.starts_with(JOINT));
                let meant = did_you_mean(name, known.chain([self.root]));
                diagnostics.error(
                    source,
                    format!("there is no frame '{name}' here"),
                    format!(
                        "name a link, joint, frame or nested model of the same model{}",
                        meant.map(|meant| format!(" ({meant})")).unwrap_or_default()
                    ),
                );
                return None;
            };
            root_from_frame = frame.pose * root_from_frame;
            (name, source) = (&frame.parent, &frame.source);
        }
        let (name, source) = self.first_of_circle(name, source);
        diagnostics.error(
            source,
            format!("the frame '{}' is relative to itself", name.trim_start_matches(JOINT)),
            "break the circle of relative_to and attached_to",
        );
        None
    }

    /// Returns the first frame of a circle in the order of the file, and its place. It is the same wherever the circle is
    /// entered, so the problem is reported once for all frames that depend on it.
    fn first_of_circle<'f>(&'f self, name: &'f str, source: &'f Source) -> (&'f str, &'f Source) {
        let mut first = (name, source);
        let mut next = name;
        for place in 0..=self.own.len() {
            let Some(frame) = self.own.get(next) else { return first };
            if place == 0 || (frame.source.line, next) < (first.1.line, first.0) {
                first = (next, &frame.source);
            }
            next = &frame.parent;
            if next == name {
                break;
            }
        }
        first
    }
}
