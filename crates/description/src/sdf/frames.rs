//! The frames of a model or world, which poses are relative to.
//!
//! `relative_to`, `attached_to`, `placement_frame` and the ends of joints may name a link, joint, frame or nested model, or
//! one of those inside a nested model (`arm::gripper::tip`).

mod check;

use super::pose::WrittenPose;
use super::{Loader, Version};
use crate::diagnostics::{Diagnostics, Source};
use crate::xml::Element;
use belvedere_sensors::Pose;
use std::cell::{Cell, OnceCell};
use std::collections::BTreeMap;

/// The most names that are compared with an unknown one for a suggestion.
const MOST_COMPARED: usize = 1000;

/// The frame or link that a frame moves with.
enum Attachment {
    /// The frame is a link itself.
    Link,
    /// The frame is that of a nested model.
    Model,
    /// It moves with the frame of this name.
    To(String),
}

/// Whether the pose of a frame has been computed.
#[derive(Clone, Copy)]
enum Progress {
    New,
    /// The frame is in the chain that is being followed. If it comes again, the chain is a circle.
    Begun,
    /// The pose in the root.
    Known(Pose),
    /// It has no pose, and an error was reported.
    Failed,
}

struct Frame {
    parent: String,
    /// The parent if there is none of that name, before SDF 1.7.
    other_parent: Option<String>,
    attachment: Attachment,
    /// Pose in the parent.
    pose: Pose,
    source: Source,
    progress: Cell<Progress>,
    /// The name of the link that it moves with; computed at the first use.
    link: OnceCell<Option<String>>,
}

impl Frame {
    /// Creates a frame. `default` is the frame that its pose is relative to if the pose names none.
    fn new(default: &str, attachment: Attachment, written: &WrittenPose) -> Self {
        Self {
            parent: written.relative_to.as_deref().unwrap_or(default).to_owned(),
            other_parent: written.is_old.then(|| default.to_owned()),
            attachment,
            pose: written.pose,
            source: written.source.clone(),
            progress: Cell::new(Progress::New),
            link: OnceCell::new(),
        }
    }
}

/// The frames of one model or world.
pub(super) struct Frames {
    root: &'static str,
    own: BTreeMap<String, Frame>,
    /// The frames of joints. If a link, frame or model has the same name, the name refers to that one, as in libsdformat
    /// before SDF 1.7.
    joints: BTreeMap<String, Frame>,
    /// The frames of nested models, by the models' names.
    nested: BTreeMap<String, Frames>,
    /// The frame that the root moves with: that of the canonical link, or of the nested model that contains it.
    canonical: Option<String>,
}

/// A step of a chain from a frame to the root.
struct Step<'f> {
    name: &'f str,
    /// `None` for the step from a nested model to the outer one.
    frame: Option<&'f Frame>,
    /// The pose relative to the next step.
    pose: Pose,
}

impl Frames {
    /// Creates frames without content. `root` is the name of the root frame: `__model__` or `world`.
    pub(super) fn new(root: &'static str) -> Self {
        Self { root, own: BTreeMap::new(), joints: BTreeMap::new(), nested: BTreeMap::new(), canonical: None }
    }

    /// Adds the frame of a link.
    pub(super) fn add_link(&mut self, name: &str, written: &WrittenPose) {
        self.own.insert(name.to_owned(), Frame::new(self.root, Attachment::Link, written));
    }

    /// Adds a `<frame>`. Without `relative_to`, its pose is relative to the frame that it is attached to.
    pub(super) fn add(&mut self, name: &str, written: &WrittenPose, attached_to: Option<&str>) {
        let attached_to = attached_to.unwrap_or(self.root).to_owned();
        let frame = Frame::new(&attached_to, Attachment::To(attached_to.clone()), written);
        self.own.insert(name.to_owned(), frame);
    }

    /// Adds a joint's frame. Without `relative_to`, its pose is relative to the joint's child. Of several with the same name,
    /// the first is kept.
    pub(super) fn add_joint(&mut self, name: &str, written: &WrittenPose, child: Option<&str>) {
        let child = child.unwrap_or(self.root);
        let frame = || Frame::new(child, Attachment::To(child.to_owned()), written);
        self.joints.entry(name.to_owned()).or_insert_with(frame);
    }

    /// Adds the frame of a nested model, and the frames inside it as `model::frame`.
    pub(super) fn add_model(&mut self, name: &str, written: &WrittenPose, inside: Frames) {
        self.own.insert(name.to_owned(), Frame::new(self.root, Attachment::Model, written));
        self.nested.insert(name.to_owned(), inside);
    }

    /// Adds the frames of a merged model under their own names, and its root frame as `name`. Returns the names that were
    /// already taken; they keep their meaning.
    pub(super) fn merge(&mut self, name: &str, written: &WrittenPose, inside: Frames) -> Vec<String> {
        let canonical = inside.canonical.as_deref().unwrap_or(self.root);
        let root = Frame::new(self.root, Attachment::To(canonical.to_owned()), written);
        let mut taken = Vec::new();
        let outwards = |mut frame: Frame| {
            let attached_to = match &mut frame.attachment {
                Attachment::To(to) => Some(to),
                _ => None,
            };
            for to in [&mut frame.parent].into_iter().chain(&mut frame.other_parent).chain(attached_to) {
                if to == inside.root {
                    name.clone_into(to);
                }
            }
            // Earlier results are relative to the merged model's own root.
            Frame { progress: Cell::new(Progress::New), link: OnceCell::new(), ..frame }
        };
        for (key, frame) in inside.own {
            if self.has(&key) {
                taken.push(key);
                continue;
            }
            self.own.insert(key, outwards(frame));
        }
        for (key, frame) in inside.joints {
            if self.joints.contains_key(&key) {
                taken.push(key);
                continue;
            }
            self.joints.insert(key, outwards(frame));
        }
        for (key, frames) in inside.nested {
            self.nested.entry(key).or_insert(frames);
        }
        self.own.insert(name.to_owned(), root);
        taken
    }

    /// Sets the frame that the root moves with.
    pub(super) fn set_canonical(&mut self, name: Option<String>) {
        self.canonical = name;
    }

    /// Returns true if a link, frame or nested model has this name.
    pub(super) fn has(&self, name: &str) -> bool {
        self.own.contains_key(name)
    }

    fn get(&self, name: &str) -> Option<&Frame> {
        self.own.get(name).or_else(|| self.joints.get(name))
    }

    /// Splits a name that begins with that of a nested model. Returns the model's frames, its name, and the rest.
    fn inside<'n>(&self, name: &'n str) -> Option<(&Frames, &'n str, &'n str)> {
        let mut cuts = name.match_indices("::").map(|(at, _)| (&name[..at], &name[at + 2..]));
        cuts.find_map(|(model, rest)| Some((self.nested.get(model)?, model, rest)))
    }

    /// Returns true if a frame has this name, which may begin with the names of nested models.
    fn knows(&self, name: &str) -> bool {
        name == self.root
            || self.get(name).is_some()
            || self.inside(name).is_some_and(|(inner, _, rest)| inner.knows(rest))
    }

    /// Returns the pose of a joint's frame in the root.
    pub(super) fn resolve_joint(
        &self,
        name: &str,
        source: &Source,
        diagnostics: &mut Diagnostics,
    ) -> Option<Pose> {
        let (name, frame) = self.joints.get_key_value(name)?;
        self.follow(name, Some(frame), source, diagnostics)
    }

    /// Returns the pose in the root of an element of the world or model itself.
    pub(super) fn place(&self, written: &WrittenPose, diagnostics: &mut Diagnostics) -> Pose {
        let frame = self.named_by(written, diagnostics);
        let outer = frame.and_then(|frame| self.resolve(frame, &written.source, diagnostics));
        outer.map_or(written.pose, |root_from_frame| root_from_frame * written.pose)
    }

    /// Returns the frame that a pose is relative to, if it names one. Before SDF 1.7, one that does not exist is ignored
    /// with a warning.
    pub(super) fn named_by<'w>(
        &self,
        written: &'w WrittenPose,
        diagnostics: &mut Diagnostics,
    ) -> Option<&'w str> {
        let frame = written.relative_to.as_deref()?;
        if written.is_old && !self.knows(frame) {
            self.tell_unknown(frame, &written.source, true, diagnostics);
            return None;
        }
        Some(frame)
    }

    /// Returns the pose of a frame in the root. `source` is the element that refers to it, for errors.
    pub(super) fn resolve(&self, name: &str, source: &Source, diagnostics: &mut Diagnostics) -> Option<Pose> {
        self.follow(name, None, source, diagnostics)
    }

    /// Follows the chain from a frame to the root. Each frame on the way stores its pose, so no chain is followed twice.
    fn follow<'f>(
        &'f self,
        mut name: &'f str,
        first: Option<&'f Frame>,
        source: &'f Source,
        diagnostics: &mut Diagnostics,
    ) -> Option<Pose> {
        let mut source = source;
        let mut steps: Vec<Step<'f>> = Vec::new();
        let mut frame = first.or_else(|| self.get(name));
        let end = loop {
            if let Some(frame) = frame {
                match frame.progress.get() {
                    Progress::Known(pose) => break Some(pose),
                    Progress::Failed => break None,
                    Progress::Begun => {
                        tell_circle(&steps, frame, diagnostics);
                        break None;
                    }
                    Progress::New => {}
                }
                frame.progress.set(Progress::Begun);
                steps.push(Step { name, frame: Some(frame), pose: frame.pose });
                (name, source) = (&frame.parent, &frame.source);
            } else if name == self.root {
                break Some(Pose::IDENTITY);
            } else if let Some((inner, model, rest)) =
                self.inside(name).filter(|(inner, _, rest)| inner.knows(rest))
            {
                let Some(pose) = inner.resolve(rest, source, diagnostics) else { break None };
                steps.push(Step { name, frame: None, pose });
                name = model;
            } else if let Some(other) = steps.last().and_then(|step| step.frame?.other_parent.as_deref())
                && other != name
            {
                self.tell_unknown(name, source, true, diagnostics);
                name = other;
            } else {
                self.tell_unknown(name, source, false, diagnostics);
                break None;
            }
            frame = self.get(name);
        };
        let mut pose = end;
        for step in steps.iter().rev() {
            pose = pose.map(|pose| pose * step.pose);
            if let Some(frame) = step.frame {
                frame.progress.set(pose.map_or(Progress::Failed, Progress::Known));
            }
        }
        pose
    }

    fn tell_unknown(&self, name: &str, source: &Source, is_ignored: bool, diagnostics: &mut Diagnostics) {
        let mut known = vec![self.root.to_owned()];
        if !diagnostics.is_crowded() {
            self.collect_names("", &mut known);
        }
        let meant = diagnostics.did_you_mean(name, known.iter().map(String::as_str));
        let remedy = format!(
            "name a link, joint, frame or nested model of the same model{}",
            meant.map(|meant| format!(" ({meant})")).unwrap_or_default()
        );
        if is_ignored {
            let what = format!("there is no frame '{name}' here: the <pose> is read as if it named none");
            diagnostics.warning(source, what, remedy);
        } else {
            diagnostics.error(source, format!("there is no frame '{name}' here"), remedy);
        }
    }

    /// Appends the names of the frames, up to the number that is compared with an unknown one.
    fn collect_names(&self, before: &str, names: &mut Vec<String>) {
        let left = MOST_COMPARED.saturating_sub(names.len());
        let own = self.own.keys().chain(self.joints.keys()).take(left);
        names.extend(own.map(|name| format!("{before}{name}")));
        for (model, inside) in &self.nested {
            if names.len() >= MOST_COMPARED {
                return;
            }
            inside.collect_names(&format!("{before}{model}::"), names);
        }
    }

    /// Returns the link that a frame moves with, by its name in this model.
    pub(super) fn link_of(&self, name: &str) -> Option<String> {
        let mut name = name;
        let mut chain: Vec<&Frame> = Vec::new();
        let link = loop {
            if name == self.root {
                let Some(canonical) = &self.canonical else { break None };
                name = canonical;
            }
            let Some(frame) = self.get(name) else {
                break self.inside(name).and_then(|(inner, model, rest)| inner.link_called(rest, model));
            };
            if let Some(found) = frame.link.get() {
                break found.clone();
            }
            match &frame.attachment {
                Attachment::Link => break Some(name.to_owned()),
                Attachment::Model => {
                    break self.nested.get(name).and_then(|inner| inner.link_called(inner.root, name));
                }
                Attachment::To(to) => {
                    chain.push(frame);
                    // A chain longer than there are frames goes in a circle.
                    if chain.len() > self.own.len() + self.joints.len() + 1 {
                        break None;
                    }
                    name = to;
                }
            }
        };
        for frame in chain {
            // A frame that comes again in a circle already has its result: no link.
            let _ = frame.link.set(link.clone());
        }
        link
    }

    /// Returns the link that a frame of a nested model moves with, by its name in the outer model.
    fn link_called(&self, name: &str, model: &str) -> Option<String> {
        self.link_of(name).map(|link| format!("{model}::{link}"))
    }
}

impl Loader<'_> {
    /// Returns the pose of a part of a link (visual, collision, sensor, …) in that link.
    pub(super) fn pose_in_link(
        &mut self,
        part: &Element,
        version: Version,
        link: &str,
        frames: &Frames,
    ) -> Pose {
        let written = self.pose(part, version);
        let Some(frame) = frames.named_by(&written, self.diagnostics) else { return written.pose };
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

/// Reports a circle of frames, which the last step closes at `again`. The error names the frame of the circle that comes
/// first in the file, wherever the circle was entered.
fn tell_circle(steps: &[Step<'_>], again: &Frame, diagnostics: &mut Diagnostics) {
    let begin = steps.iter().position(|step| step.frame.is_some_and(|frame| std::ptr::eq(frame, again)));
    let circle = steps[begin.unwrap_or(0)..].iter().filter_map(|step| Some((step.name, step.frame?)));
    let first = circle.min_by_key(|(name, frame)| (frame.source.line, *name));
    if let Some((name, frame)) = first {
        diagnostics.error(
            &frame.source,
            format!("the frame '{name}' is relative to itself"),
            "break the circle of relative_to and attached_to",
        );
    }
}
