//! `<model>`. A model inside a model is dissolved into its outer one: its links and joints go by
//! `inner::name`, as Gazebo calls them.

use super::frames::Frames;
use super::names::Names;
use super::pose::WrittenPose;
use super::{Loader, Scope, Version, name_of};
use crate::diagnostics::Source;
use crate::label::label;
use crate::model::{Joint, JointIndex, JointKind, Light, Link, LinkIndex, Model, ModelPlugin, Sensor};
use crate::plugin;
use crate::values::{child_bool, child_text};
use crate::xml::Element;
use std::collections::HashMap;

/// A model whose pose in its parent is not resolved yet.
pub(super) struct ParsedModel {
    pub(super) model: Model,
    pub(super) pose: WrittenPose,
    /// Lights on its links; their poses are in the model frame.
    pub(super) lights: Vec<Light>,
    /// `<include merge="true">`: its links and joints become the outer model's own, and keep their names.
    pub(super) is_merged: bool,
    /// Its place among the elements of the outer model.
    pub(super) place: usize,
    /// The first of its links in the order of the file, with those of merged models and without those of nested ones.
    pub(super) first_link: Option<String>,
    /// The frames that poses in the model, and in its parent, can be relative to.
    pub(super) frames: Frames,
}

/// The parts of a model while it is put together.
#[derive(Default)]
pub(super) struct Parts {
    pub(super) links: Vec<Link>,
    /// The names of its own links.
    pub(super) link_names: Names,
    /// All links, those of nested models too, once they are complete.
    pub(super) by_name: HashMap<String, LinkIndex>,
    pub(super) joints: Vec<Joint>,
    /// The names of its own joints.
    pub(super) joint_names: Names,
    pub(super) joint_sources: Vec<Source>,
    /// `<mimic>` of joints, which may name later ones.
    pub(super) mimics: Vec<(JointIndex, Element)>,
    pub(super) sensors: Vec<Sensor>,
    pub(super) plugins: Vec<ModelPlugin>,
    pub(super) lights: Vec<Light>,
    /// True if an included model was left out.
    pub(super) lacks: bool,
}

impl Loader<'_> {
    pub(super) fn model(&mut self, element: &Element, scope: Scope<'_>) -> Option<ParsedModel> {
        let spent = self.budget.enter(1);
        self.afford(spent, &element.source)?;
        let parsed = self.model_inside(element, scope);
        self.budget.leave(1);
        parsed
    }

    fn model_inside(&mut self, element: &Element, scope: Scope<'_>) -> Option<ParsedModel> {
        let name = name_of(element);
        if name.is_empty() {
            self.diagnostics.error(&element.source, "<model> has no name", "write <model name=\"…\">");
            return None;
        }
        let is_static = child_bool(element, "static", self.diagnostics).unwrap_or(false);
        let link_names = Names::of(element.elements_named("link").map(name_of));
        let joint_names = Names::of(element.elements_named("joint").map(name_of));
        let mut parts = Parts { link_names, joint_names, ..Parts::default() };
        let mut nested = self.inside(element, scope, &mut parts);
        self.make_names_unique(&mut nested);
        self.check_names(element, &nested, scope.version);
        let first_link = first_link(element, &nested);
        let mut frames = self.model_frames(element, &mut nested, scope.version, first_link.as_deref());
        for child in element.elements_named("link") {
            self.link(child, scope, &mut frames, is_static, &mut parts);
        }
        if child_bool(element, "self_collide", self.diagnostics) == Some(true) {
            parts.links.iter_mut().for_each(|link| link.self_collide = true);
        }
        for inner in nested {
            self.dissolve(inner, &frames, &mut parts);
        }
        if parts.links.is_empty() && parts.lacks {
            // Its content was left out, which was already reported.
            return None;
        }
        if parts.links.is_empty() {
            self.missing(
                &element.source,
                format!("the model '{name}' has no link"),
                "give it a <link> with a <visual> or a <collision>",
            );
            return None;
        }
        for (index, link) in parts.links.iter().enumerate() {
            parts.by_name.entry(link.name.clone()).or_insert(index);
        }
        for child in element.elements_named("joint") {
            self.joint(child, scope, &mut frames, &mut parts);
        }
        if !parts.lacks {
            frames.check(self.diagnostics);
        }
        self.follow(&mut parts);
        let stands = parts.links.iter().any(|link| link.is_static)
            && parts.joints.iter().all(|joint| joint.kind == JointKind::Fixed)
            && is_one_body(&parts);

        let mut pose = self.pose(element, scope.version);
        let placement = element.attribute("placement_frame").filter(|frame| !frame.is_empty());
        self.place_by(placement, &frames, &mut pose, &element.source);
        if let Some(label) = label(element, self.diagnostics) {
            for visual in parts.links.iter_mut().flat_map(|link| &mut link.visuals) {
                visual.label.get_or_insert(label);
            }
        }
        let canonical_link = frames.link_of("__model__").and_then(|link| parts.by_name.get(&link).copied());
        let source = element.source.clone();
        let mut model = Model {
            canonical_link: canonical_link.unwrap_or(0),
            is_static: is_static || stands,
            may_sleep: child_bool(element, "allow_auto_disable", self.diagnostics).unwrap_or(true),
            links: parts.links,
            joints: parts.joints,
            sensors: parts.sensors,
            plugins: parts.plugins,
            ..Model::empty(name, source)
        };
        plugin::read(element, &mut model, self.rules, self.diagnostics);
        Some(ParsedModel {
            model,
            pose,
            lights: parts.lights,
            is_merged: false,
            place: 0,
            first_link,
            frames,
        })
    }

    /// Reads the models inside a model, including those of `<include>`.
    fn inside(&mut self, element: &Element, scope: Scope<'_>, parts: &mut Parts) -> Vec<ParsedModel> {
        let mut nested = Vec::new();
        for (place, child) in element.elements().enumerate() {
            match child.name.as_str() {
                "model" => match self.model(child, scope) {
                    Some(inner) => nested.push(ParsedModel { place, ..inner }),
                    None => parts.lacks = true,
                },
                "include" => match self.include(child, scope) {
                    Some(mut included) => {
                        if matches!(child.attribute("merge"), Some("true" | "1")) {
                            included.models.iter_mut().for_each(|inner| inner.is_merged = true);
                        }
                        nested
                            .extend(included.models.into_iter().map(|inner| ParsedModel { place, ..inner }));
                    }
                    None => parts.lacks = true,
                },
                "gripper" => self.ignored(child, "it is not simulated"),
                _ => {}
            }
        }
        nested
    }

    /// Returns the frame that a model moves with: the `canonical_link`, or the first link, or else the first nested model.
    fn canonical(
        &mut self,
        element: &Element,
        nested: &[ParsedModel],
        frames: &Frames,
        first_link: Option<&str>,
    ) -> Option<String> {
        let is_link = |name: &str| frames.link_of(name).is_some_and(|link| link == name);
        if let Some(name) = element.attribute("canonical_link").filter(|name| !name.is_empty()) {
            if is_link(name) {
                return Some(name.to_owned());
            }
            let links = element.elements_named("link").map(name_of).filter(|link| is_link(link));
            let links: Vec<String> = links.take(1000).collect();
            let meant = self.diagnostics.did_you_mean(name, links.iter().map(String::as_str));
            self.missing(
                &element.source,
                format!("canonical_link is '{name}', which is no link of this model"),
                meant.unwrap_or_else(|| "name one of its links".to_owned()),
            );
        }
        first_link.filter(|name| is_link(name)).map(str::to_owned).or_else(|| {
            nested
                .iter()
                .map(|inner| inner.frame_name().into_owned())
                .find(|name| frames.link_of(name).is_some())
        })
    }

    /// Applies `placement_frame`: the pose is that of this frame of the model instead of the model's own frame.
    pub(super) fn place_by(
        &mut self,
        frame: Option<&str>,
        frames: &Frames,
        pose: &mut WrittenPose,
        source: &Source,
    ) {
        if let Some(frame) = frame
            && let Some(model_from_frame) = frames.resolve(frame, source, self.diagnostics)
        {
            pose.pose = pose.pose * model_from_frame.inverse();
        }
    }

    /// Collects the frames that poses of this model can be relative to.
    fn model_frames(
        &mut self,
        element: &Element,
        nested: &mut [ParsedModel],
        version: Version,
        first_link: Option<&str>,
    ) -> Frames {
        let mut frames = Frames::new("__model__");
        for inner in nested.iter_mut().filter(|inner| !inner.is_merged) {
            self.add_frames(inner, &mut frames);
        }
        for child in element.elements() {
            match child.name.as_str() {
                // If two have the same name, the first is used.
                "link" if !frames.has(&name_of(child)) => {
                    let pose = self.pose(child, version);
                    frames.add_link(&name_of(child), &pose);
                }
                "frame" => self.add_frame(child, version, &mut frames),
                "joint" => {
                    let pose = self.pose(child, version);
                    frames.add_joint(&name_of(child), &pose, child_text(child, "child").as_deref());
                }
                _ => {}
            }
        }
        for inner in nested.iter_mut().filter(|inner| inner.is_merged) {
            self.add_frames(inner, &mut frames);
        }
        let canonical = self.canonical(element, nested, &frames, first_link);
        frames.set_canonical(canonical);
        frames
    }

    /// Adds a `<frame>`, unless something else has its name.
    pub(super) fn add_frame(&mut self, element: &Element, version: Version, frames: &mut Frames) {
        let name = name_of(element);
        if !frames.has(&name) {
            let pose = self.pose(element, version);
            frames.add(&name, &pose, element.attribute("attached_to").filter(|name| !name.is_empty()));
        }
    }
}

/// Returns the first link of a model in the order of the file. The links of a merged model stand where it is included.
fn first_link(element: &Element, nested: &[ParsedModel]) -> Option<String> {
    let merged: HashMap<usize, &ParsedModel> =
        nested.iter().filter(|inner| inner.is_merged).map(|inner| (inner.place, inner)).collect();
    element.elements().enumerate().find_map(|(place, child)| match child.name.as_str() {
        "link" => Some(name_of(child)).filter(|name| !name.is_empty()),
        "include" => merged.get(&place)?.first_link.clone(),
        _ => None,
    })
}

/// Returns true if each group of links that joints connect contains a static link.
fn is_one_body(parts: &Parts) -> bool {
    let mut above: Vec<LinkIndex> = (0..parts.links.len()).collect();
    for joint in &parts.joints {
        let (parent, child) = (top(&mut above, joint.parent), top(&mut above, joint.child));
        above[child] = parent;
    }
    let body: Vec<LinkIndex> = (0..parts.links.len()).map(|link| top(&mut above, link)).collect();
    let mut stands = vec![false; body.len()];
    for (link, body) in parts.links.iter().zip(&body) {
        stands[*body] |= link.is_static;
    }
    body.iter().all(|body| stands[*body])
}

/// Returns the link that represents the body of another one, and halves the path to it (union–find).
fn top(above: &mut [LinkIndex], mut link: LinkIndex) -> LinkIndex {
    while above[link] != link {
        above[link] = above[above[link]];
        link = above[link];
    }
    link
}
