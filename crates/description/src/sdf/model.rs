//! `<model>` and `<include>`. A nested model is merged into the outer one: its links and joints are named
//! `inner::name`, as in Gazebo.

use super::frames::{Frames, WrittenPose};
use super::names::Names;
use super::resources::Resolved;
use super::{Loader, Scope, Version, canonical, name_of, resources};
use crate::diagnostics::Source;
use crate::label::label;
use crate::model::{Joint, JointIndex, JointKind, Light, Link, LinkIndex, Model, ModelPlugin, Sensor};
use crate::plugin;
use crate::suggestion::{did_you_mean, nearest};
use crate::values::{child_bool, child_text};
use crate::xml::{Element, Weight};
use std::path::{Path, PathBuf};

/// A model whose pose in its parent is not resolved yet.
pub(super) struct ParsedModel {
    pub(super) model: Model,
    pub(super) pose: WrittenPose,
    /// Lights on its links; their poses are in the model frame.
    pub(super) lights: Vec<Light>,
    /// `<include merge="true">`: its links and joints become the outer model's own, and keep their names.
    pub(super) is_merged: bool,
    /// The frames that poses in the model, and in its parent, can be relative to.
    pub(super) frames: Frames,
}

/// The models and lights that an `<include>` brings in.
#[derive(Default)]
pub(super) struct Included {
    pub(super) models: Vec<ParsedModel>,
    /// Each light with its pose in the including model or world.
    pub(super) lights: Vec<(Light, WrittenPose)>,
}

/// Cost of opening a file, in elements.
const A_FILE: usize = 20;

/// The parts of a model while it is put together.
#[derive(Default)]
pub(super) struct Parts {
    pub(super) links: Vec<Link>,
    /// The names of its own links.
    pub(super) link_names: Names,
    pub(super) joints: Vec<Joint>,
    /// Joints with `<mimic>`, resolved last because it may name later joints.
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
        let (mut nested, mut parts) = (Vec::new(), Parts { link_names, ..Parts::default() });
        for child in element.elements() {
            match child.name.as_str() {
                "model" => match self.model(child, scope) {
                    Some(inner) => nested.push(inner),
                    None => parts.lacks = true,
                },
                "include" => match self.include(child, scope) {
                    Some(mut included) => {
                        if matches!(child.attribute("merge"), Some("true" | "1")) {
                            included.models.iter_mut().for_each(|inner| inner.is_merged = true);
                        }
                        nested.extend(included.models);
                    }
                    None => parts.lacks = true,
                },
                "gripper" => self.ignored(child, "it is not simulated"),
                _ => {}
            }
        }

        self.make_names_unique(&mut nested);
        let mut frames = self.model_frames(element, &nested, scope.version);
        for child in element.elements_named("link") {
            self.link(child, scope, &mut frames, is_static, &mut parts);
        }
        if child_bool(element, "self_collide", self.diagnostics) == Some(true) {
            parts.links.iter_mut().for_each(|link| link.self_collide = true);
        }
        for inner in nested {
            let (name, inner_frames) = self.dissolve(inner, &frames, &mut parts);
            frames.add_nested(&name, inner_frames);
        }
        if parts.links.is_empty() && parts.lacks {
            // All its parts were left out, which has been reported already.
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
        for child in element.elements_named("joint") {
            self.joint(child, scope, &frames, &mut parts);
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
        let canonical_link = self.canonical_link(element, &parts.links);
        let source = element.source.clone();
        let mut model = Model {
            canonical_link,
            is_static: is_static || stands,
            may_sleep: child_bool(element, "allow_auto_disable", self.diagnostics).unwrap_or(true),
            links: parts.links,
            joints: parts.joints,
            sensors: parts.sensors,
            plugins: parts.plugins,
            ..Model::empty(name, source)
        };
        plugin::read(element, &mut model, self.rules, self.diagnostics);
        Some(ParsedModel { model, pose, lights: parts.lights, is_merged: false, frames })
    }

    /// Returns the link that `canonical_link` names, or the first one.
    fn canonical_link(&mut self, element: &Element, links: &[Link]) -> LinkIndex {
        let Some(name) = element.attribute("canonical_link").filter(|name| !name.is_empty()) else {
            return 0;
        };
        let found = links.iter().position(|link| link.name == name);
        if found.is_none() {
            let meant = did_you_mean(name, links.iter().map(|link| link.name.as_str()));
            self.missing(
                &element.source,
                format!("canonical_link is '{name}', which is no link of this model"),
                meant.unwrap_or_else(|| "name one of its links".to_owned()),
            );
        }
        found.unwrap_or(0)
    }

    /// Applies `placement_frame`: the pose is that of this frame of the model, not of the model's own.
    fn place_by(&mut self, frame: Option<&str>, frames: &Frames, pose: &mut WrittenPose, source: &Source) {
        if let Some(frame) = frame
            && let Some(model_from_frame) = frames.resolve(frame, source, self.diagnostics)
        {
            pose.pose = pose.pose * model_from_frame.inverse();
        }
    }

    /// Collects the frames that poses of this model can be relative to.
    fn model_frames(&mut self, element: &Element, nested: &[ParsedModel], version: Version) -> Frames {
        let mut frames = Frames::new("__model__");
        for inner in nested {
            frames.add(&inner.model.name, &inner.pose, None);
            for link in &inner.model.links {
                let name = inner.naming()(&link.name);
                frames.add_known(name, &inner.model.name, link.model_from_link, &link.source);
            }
        }
        for child in element.elements() {
            let parent = match child.name.as_str() {
                "link" => None,
                "frame" => child.attribute("attached_to").filter(|name| !name.is_empty()),
                _ => continue,
            };
            let pose = self.pose(child, version);
            // If two have the same name, it means the first.
            if !frames.has(&name_of(child)) {
                frames.add(&name_of(child), &pose, parent);
            }
        }
        for child in element.elements_named("joint") {
            let pose = self.pose(child, version);
            frames.add_joint(&name_of(child), &pose, child_text(child, "child").as_deref());
        }
        frames
    }

    /// Reads `<include>`: the models and lights of another file, with name, pose and static overridden.
    pub(super) fn include(&mut self, element: &Element, scope: Scope<'_>) -> Option<Included> {
        let spent = self.budget.take(1, 0);
        self.afford(spent, &element.source)?;
        let Some(uri) = child_text(element, "uri") else {
            self.diagnostics.error(
                &element.source,
                "<include> has no <uri>",
                "write <include><uri>model://NAME</uri></include>",
            );
            return None;
        };
        let path = self.included_file(element, &uri, scope.folder)?;
        let key = canonical(&path);
        if self.open_files.contains(&key) {
            let chain: Vec<String> =
                self.open_files.iter().chain([&key]).map(|file| file.display().to_string()).collect();
            self.diagnostics.error(
                &element.source,
                format!("'{uri}' includes itself: {}", chain.join(" → ")),
                "remove one <include> of this circle",
            );
            return None;
        }
        let spent = self.budget.enter(1);
        self.afford(spent, &element.source)?;
        self.open_files.push(key);
        let included = self.read_included(element, &path, scope);
        self.open_files.pop();
        self.budget.leave(1);
        included
    }

    fn read_included(&mut self, element: &Element, path: &Path, outer: Scope<'_>) -> Option<Included> {
        let (root, version) = self.read_root(path)?;
        let Weight { elements, bytes, .. } = root.weight();
        let spent = self.budget.take(elements + A_FILE, bytes);
        self.afford(spent, &element.source)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let scope = Scope { folder, version };
        let name = child_text(element, "name");
        let is_static = child_bool(element, "static", self.diagnostics);
        let pose = element.child("pose").is_some().then(|| self.pose(element, outer.version));

        let mut included = Included::default();
        for child in root.elements() {
            match child.name.as_str() {
                "model" => included.models.extend(self.model(child, scope)),
                "actor" => included.models.extend(self.actor(child, scope)),
                "light" => {
                    let pose = self.pose(child, version);
                    included.lights.extend(self.light(child, pose.pose).map(|light| (light, pose)));
                }
                _ => {}
            }
        }
        // The format allows one model or light per file.
        if let Some(parsed) = included.models.first_mut() {
            plugin::read(element, &mut parsed.model, self.rules, self.diagnostics);
            if let Some(name) = &name {
                parsed.model.name.clone_from(name);
            }
            if let Some(is_static) = is_static {
                parsed.model.is_static = is_static;
            }
            if let Some(pose) = pose {
                parsed.pose = pose;
                let placement = child_text(element, "placement_frame");
                self.place_by(placement.as_deref(), &parsed.frames, &mut parsed.pose, &element.source);
            }
        } else if let Some((light, light_pose)) = included.lights.first_mut() {
            if let Some(name) = name {
                light.name = name;
            }
            if let Some(pose) = pose {
                *light_pose = pose;
            }
        } else if !self.diagnostics.has_errors() {
            self.diagnostics.error(
                &root.source,
                "no <model> and no <light> in this file",
                "an included file holds one of them inside <sdf>",
            );
        }
        Some(included)
    }

    /// Returns the SDF file that the URI of an `<include>` refers to: the file itself, or in a folder the file that
    /// `model.config` names, else `model.sdf`.
    fn included_file(&mut self, element: &Element, uri: &str, folder: &Path) -> Option<PathBuf> {
        let uri = uri.trim_end_matches('/');
        let path = match self.resources.resolve(uri, folder) {
            Resolved::Found(path) => path,
            Resolved::NotFound(places) => {
                let name = uri.rsplit('/').next().unwrap_or(uri);
                let names = self.resources.model_names();
                let near = nearest(name, names.iter().map(String::as_str));
                let meant = near.map_or_else(String::new, |near| format!("did you mean 'model://{near}'? "));
                self.missing(
                    &element.source,
                    format!("there is no model '{uri}': looked for {}", resources::list(&places)),
                    format!("{meant}Add the folder that contains it to GAZEBO_MODEL_PATH or --package-path"),
                );
                return None;
            }
            Resolved::UnknownScheme(scheme) => {
                self.missing(
                    &element.source,
                    format!("'{uri}' cannot be fetched: '{scheme}://' is unsupported"),
                    "download it with `gz fuel download -u`, or put its folder into GAZEBO_MODEL_PATH; write model://NAME otherwise",
                );
                return None;
            }
        };
        if path.is_file() {
            return Some(path);
        }
        let config = path.join("model.config");
        if config.is_file() {
            return self.file_of_config(&config);
        }
        let file = path.join("model.sdf");
        if file.is_file() {
            return Some(file);
        }
        self.missing(
            &element.source,
            format!("the folder {} holds neither model.config nor model.sdf", path.display()),
            "check the <uri>",
        );
        None
    }

    /// Returns the `<sdf>` file of the highest version that a `model.config` names.
    fn file_of_config(&mut self, config: &Path) -> Option<PathBuf> {
        self.diagnostics.opened(config);
        let root = match Element::parse_file(config) {
            Ok(root) => root,
            Err(problem) => {
                self.diagnostics.add(problem);
                return None;
            }
        };
        let version = |sdf: &&Element| -> Option<Version> {
            let (major, minor) = sdf.attribute("version")?.split_once('.')?;
            Some((major.parse().ok()?, minor.parse().ok()?))
        };
        let sdf = root.elements_named("sdf").max_by_key(version);
        let file = config.with_file_name(sdf.map_or_else(|| "model.sdf".into(), Element::text));
        if file.is_file() {
            return Some(file);
        }
        self.missing(
            sdf.map_or(&root.source, |sdf| &sdf.source),
            format!("there is no file {}", file.display()),
            "correct the <sdf> element",
        );
        None
    }
}

/// Returns true if each group of links that joints connect contains a static link.
fn is_one_body(parts: &Parts) -> bool {
    let mut body: Vec<usize> = (0..parts.links.len()).collect();
    for joint in &parts.joints {
        let (keep, drop) = (body[joint.parent], body[joint.child]);
        body.iter_mut().filter(|of| **of == drop).for_each(|of| *of = keep);
    }
    let stands = |of: usize| parts.links.iter().zip(&body).any(|(link, body)| *body == of && link.is_static);
    body.iter().all(|of| stands(*of))
}
