//! `<include>`: finds the file, and applies name, pose and other overrides to the model or light in it.

use super::model::ParsedModel;
use super::pose::WrittenPose;
use super::resources::Resolved;
use super::{A_FILE, Loader, Scope, Version, canonical};
use crate::file;
use crate::model::Light;
use crate::plugin;
use crate::suggestion::nearest;
use crate::values::{child_bool, child_text};
use crate::xml::{Element, Weight};
use std::path::{Path, PathBuf};

/// What to do about a model on a server.
const DOWNLOAD: &str = "download it with `gz fuel download -u`, or put its folder into GAZEBO_MODEL_PATH; write model://NAME otherwise";

fn is_on_a_server(uri: &str) -> bool {
    ["https://", "http://", "fuel://"].iter().any(|scheme| uri.starts_with(scheme))
}

/// The content of an `<include>`.
#[derive(Default)]
pub(super) struct Included {
    pub(super) models: Vec<ParsedModel>,
    /// Each with its pose in the including model or world.
    pub(super) lights: Vec<(Light, WrittenPose)>,
}

impl Loader<'_> {
    /// Reads an `<include>`: the models and lights of another file, with name, pose and static overridden.
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
        if self.open_files.contains(&key) && is_on_a_server(&uri) {
            // A model that extends the one of its name on Fuel, of which there is no copy here.
            self.missing(
                &element.source,
                format!("'{uri}' cannot be fetched, and the only model with its name here includes it"),
                DOWNLOAD,
            );
            return None;
        }
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
        let (mut root, version) = self.read_root(path)?;
        let Weight { elements, bytes, .. } = root.weight();
        let spent = self.budget.take(elements + A_FILE, bytes);
        self.afford(spent, &element.source)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        self.alter(element, &mut root, folder)?;
        let scope = Scope { folder, version };
        let name = child_text(element, "name");
        let is_static = child_bool(element, "static", self.diagnostics);
        let pose = element.child("pose").is_some().then(|| self.pose(element, outer.version));

        let mut included = Included::default();
        for child in root.elements() {
            match child.name.as_str() {
                "model" => {
                    self.check_outermost(child, version);
                    let model = self.model(child, scope);
                    included.models.extend(model.map(|mut model| {
                        model.pose.relative_to = None;
                        model
                    }));
                }
                "actor" => included.models.extend(self.actor(child, scope)),
                // A file that is one <include> stands for another one.
                "include" => {
                    let inner = self.include(child, scope)?;
                    included.models.extend(inner.models);
                    included.lights.extend(inner.lights);
                }
                "light" => {
                    let pose = self.pose(child, version);
                    included.lights.extend(self.light(child, pose.pose).map(|light| (light, pose)));
                }
                _ => {}
            }
        }
        if let Some(placement) = element.child("placement_frame").filter(|_| element.child("pose").is_none())
        {
            self.diagnostics.error(
                &placement.source,
                "<placement_frame> without <pose> in this <include>",
                "write the <pose> that the frame is to have",
            );
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
                // As in libsdformat, the model keeps its own frame if this <include> names none.
                let own = || Some(root.child("model")?.attribute("placement_frame")?.to_owned());
                let placement = child_text(element, "placement_frame").or_else(own);
                let placement = placement.filter(|frame| !frame.is_empty());
                self.place_by(placement.as_deref(), &parsed.frames, &mut parsed.pose, &element.source);
            }
        } else if let Some((light, light_pose)) = included.lights.first_mut() {
            if let Some(name) = name {
                light.name = name;
            }
            if let Some(pose) = pose {
                *light_pose = pose;
            }
        } else if root.elements().any(|child| matches!(child.name.as_str(), "model" | "include")) {
            // It is made of what is missing, which has been reported.
            return None;
        } else if !self.diagnostics.has_errors() {
            self.diagnostics.error(
                &root.source,
                "no <model> and no <light> in this file",
                "an included file holds one of them inside <sdf>",
            );
        }
        Some(included)
    }

    /// Returns the SDF file that the URI of an `<include>` refers to: the file itself, or the file that the folder's
    /// `model.config` names, or its `model.sdf`.
    pub(super) fn included_file(&mut self, element: &Element, uri: &str, folder: &Path) -> Option<PathBuf> {
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
                    format!("there is no model '{uri}': looked for {}", file::list(&places)),
                    format!("{meant}add the folder that contains it to GAZEBO_MODEL_PATH or --package-path"),
                );
                return None;
            }
            Resolved::UnknownScheme(scheme) => {
                self.missing(
                    &element.source,
                    format!("'{uri}' cannot be fetched: '{scheme}://' is not read"),
                    DOWNLOAD,
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

    /// Returns the `<sdf>` with the highest version in a `model.config`.
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
            file::lacking(&file),
            "correct the <sdf> element",
        );
        None
    }
}
