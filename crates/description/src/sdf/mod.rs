//! SDF world files, versions 1.4 to 1.12: the part of the format that describes where things stand, how they look
//! and how they are lit.
//!
//! | file | reads |
//! |---|---|
//! | `world` | `<world>`: scene, physics, models, lights, `<state>` |
//! | `model` | `<model>` with nested models flattened |
//! | `include` | `<include>` |
//! | `params` | `<experimental:params>` of an `<include>` |
//! | `nested` | models inside of models |
//! | `link`, `joint`, `light` | those elements |
//! | `geometry`, `polyline`, `height_map`, `material` | shapes and their looks |
//! | `pose` | `<pose>`, and `relative_to` from SDF 1.7 on |
//! | `frames` | what the names of frames mean |
//! | `names`, `siblings` | names that come again, and those that must not |
//! | `fuel` | models that Gazebo's tools have downloaded |
//! | `resources` | resolution of `model://` and other URIs |
//!
//! Elements without any effect here (`<gui>`, `<audio>`, solver parameters) are ignored silently. Elements from which
//! a user may expect an effect give a warning.

mod actor;
mod frames;
mod fuel;
mod geometry;
mod height_map;
mod include;
mod joint;
mod light;
mod link;
mod material;
mod model;
mod names;
mod nested;
mod params;
mod polyline;
mod pose;
mod resources;
mod scene;
mod siblings;
mod world;

use super::budget::{Budget, Spent};
use super::concave::warn_of_hulls;
use super::diagnostics::{Diagnostics, Source};
use super::elements;
use super::mesh::Submesh;
use super::model::{Heights, Mesh, Model, World};
use super::ogre_material::{Library, OgreMaterial};
use super::package::PackagePath;
use super::rules::Rules;
use super::values::{child_number, child_text, numbers};
use super::xml::{Element, Node};
use resources::Resources;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// SDF version as (major, minor): `frame` semantics came with 1.7, joint axes in the joint's frame with 1.5.
type Version = (u32, u32);

/// The word for the image of a surface in problems.
const TEXTURE: &str = "texture";

/// Opening a file takes as long as so many elements.
const A_FILE: usize = 20;

/// What is taken for a file that names no version.
const ASSUMED_VERSION: Version = (1, 6);

/// Meshes already read, by file, part and scale.
type MeshCache = HashMap<(PathBuf, Option<Submesh>, [u64; 3]), Option<Vec<Arc<Mesh>>>>;

/// State of one load.
struct Loader<'a> {
    resources: Resources<'a>,
    rules: Rules,
    diagnostics: &'a mut Diagnostics,
    /// False for a model alone, whose lights are left out.
    is_world: bool,
    /// Limit on the size of included files.
    budget: Budget,
    /// Files being read, outermost first: a file in here that is included again is a cycle.
    open_files: Vec<PathBuf>,
    meshes: MeshCache,
    /// Height maps already read, by file and size.
    heights: HashMap<(PathBuf, [u64; 3]), Option<Arc<Heights>>>,
    material_scripts: HashMap<PathBuf, Arc<Vec<OgreMaterial>>>,
    /// The materials of lists of scripts.
    libraries: HashMap<Vec<PathBuf>, Arc<Library>>,
    /// Files whose elements have been compared with the table.
    compared: HashSet<PathBuf>,
}

/// The context in which an element is read.
#[derive(Clone, Copy)]
struct Scope<'a> {
    /// Folder of the file, to which relative URIs refer.
    folder: &'a Path,
    version: Version,
}

/// Loads the first `<world>` of a file.
pub(super) fn load_world_file(
    path: &Path,
    packages: &PackagePath,
    rules: Rules,
    diagnostics: &mut Diagnostics,
) -> Option<World> {
    diagnostics.opened(path);
    match Element::parse_file(path) {
        Ok(root) => load_world(&root, packages, rules, diagnostics),
        Err(problem) => {
            diagnostics.add(problem);
            None
        }
    }
}

/// Reads the first `<world>` of parsed SDF.
pub(super) fn load_world(
    root: &Element,
    packages: &PackagePath,
    rules: Rules,
    diagnostics: &mut Diagnostics,
) -> Option<World> {
    let path = root.source.file.clone();
    let mut loader = Loader::new(&path, packages, rules, diagnostics);
    let version = loader.version(root)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let scope = Scope { folder, version };
    let Some(world) = root.child("world") else {
        if let Some(world) = world_of_parts(root) {
            if let Some(model) = root.child("model") {
                loader.diagnostics.warning(
                    &model.source,
                    format!(
                        "this file has no <world>: the world contains only its model '{}'",
                        name_of(model)
                    ),
                    "write --robot instead of --world if the model is to be in another world",
                );
            }
            let world = loader.world(&world, scope);
            warn_of_hulls(&world.models, loader.diagnostics);
            return Some(world);
        }
        loader.diagnostics.error(
            &root.source,
            "no <world> in this file",
            "put the models into a <world name=\"…\">",
        );
        return None;
    };
    if let Some(second) = root.elements_named("world").nth(1) {
        loader.diagnostics.warning(&second.source, "only the first <world> is loaded", "");
    }
    if let Some(include) = root.child("include") {
        loader.ignored(include, "it stands beside the <world>, and not in it");
    }
    let world = loader.world(world, scope);
    warn_of_hulls(&world.models, loader.diagnostics);
    Some(world)
}

/// Returns true if a file holds a model, also one that it only includes.
pub(super) fn has_model(root: &Element) -> bool {
    root.child("model").or_else(|| root.child("include")).is_some()
}

/// The world that stands for a file of lights and actors, or of one model, as Gazebo makes one: with nothing else in it.
fn world_of_parts(root: &Element) -> Option<Element> {
    let is_part = |child: &&Element| matches!(child.name.as_str(), "light" | "actor" | "model" | "include");
    let children: Vec<Node> = root.elements().filter(is_part).cloned().map(Node::Element).collect();
    let attributes = vec![("name".into(), "default".into())];
    let is_alone = match root.elements_named("model").chain(root.elements_named("include")).count() {
        0 => !children.is_empty(),
        1 => children.len() == 1,
        _ => false,
    };
    is_alone.then(|| Element { name: "world".into(), attributes, children, source: root.source.clone() })
}

/// Reads the `<model>` of parsed SDF; its `<pose>` is its pose in the world.
pub(super) fn load_model(
    root: &Element,
    packages: &PackagePath,
    rules: Rules,
    diagnostics: &mut Diagnostics,
) -> Option<Model> {
    let path = root.source.file.clone();
    let mut loader = Loader::new(&path, packages, rules, diagnostics);
    loader.is_world = false;
    let version = loader.version(root)?;
    let models: Vec<&Element> = root.elements_named("model").chain(root.elements_named("include")).collect();
    let [element] = models[..] else {
        let (what, remedy) = if models.is_empty() && root.child("world").is_some() {
            (
                "this file has a <world>, which is not a robot or an object".into(),
                "give the world with --world",
            )
        } else {
            let what = format!("this file has {} <model> elements", models.len());
            (what, "put exactly one <model name=\"…\"> into the <sdf>")
        };
        loader.diagnostics.error(&root.source, what, remedy);
        return None;
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    let scope = Scope { folder, version };
    let parsed = if element.name == "include" {
        loader.include(element, scope).and_then(|included| included.models.into_iter().next())
    } else {
        loader.check_outermost(element, version);
        loader.model(element, scope)
    };
    let Some(parsed) = parsed else {
        if !diagnostics.has_errors() {
            diagnostics.error(
                &element.source,
                format!("the model '{}' has no parts left", named_or_included(element)),
                "install the models that it includes",
            );
        }
        return None;
    };
    for light in &parsed.lights {
        loader.diagnostics.warning(
            &light.source,
            format!("the light '{}' is left out: lights belong to the world, not to a robot", light.name),
            "put the <light> into the world file where it is to shine",
        );
    }
    let model = Model { world_from_model: parsed.pose.pose, ..parsed.model };
    warn_of_hulls([&model], loader.diagnostics);
    Some(model)
}

/// Returns the name of a `<model>`, or what an `<include>` names.
fn named_or_included(element: &Element) -> String {
    let included = || child_text(element, "name").or_else(|| child_text(element, "uri")).unwrap_or_default();
    if element.name == "include" { included() } else { name_of(element) }
}

impl<'a> Loader<'a> {
    fn new(path: &Path, packages: &'a PackagePath, rules: Rules, diagnostics: &'a mut Diagnostics) -> Self {
        Self {
            resources: Resources::new(packages, path),
            rules,
            diagnostics,
            is_world: true,
            budget: Budget::default(),
            open_files: vec![canonical(path)],
            meshes: HashMap::new(),
            heights: HashMap::new(),
            material_scripts: HashMap::new(),
            libraries: HashMap::new(),
            compared: HashSet::new(),
        }
    }
}

impl Loader<'_> {
    /// Reads a file up to its `<sdf>` element and version.
    fn read_root(&mut self, path: &Path) -> Option<(Element, Version)> {
        self.diagnostics.opened(path);
        let root = match Element::parse_file(path) {
            Ok(root) => root,
            Err(problem) => {
                self.diagnostics.add(problem);
                return None;
            }
        };
        let version = self.version(&root)?;
        Some((root, version))
    }

    /// Reads the version of an `<sdf>` element; none for another element.
    fn version(&mut self, root: &Element) -> Option<Version> {
        // Gazebo's files from before SDF had its own name begin with <gazebo>.
        if root.name != "sdf" && root.name != "gazebo" {
            self.diagnostics.error(
                &root.source,
                format!("this is not an SDF file: its root element is <{}>", root.name),
                "a world begins with <sdf version=\"1.6\"><world name=\"…\">",
            );
            return None;
        }
        let version = match root.attribute("version") {
            None => {
                self.diagnostics.note(&root.source, "<sdf> has no version", "1.6 is assumed");
                ASSUMED_VERSION
            }
            Some(text) => {
                let parsed = text.trim().split_once('.').and_then(|(major, minor)| {
                    let minor = minor.split('.').next()?;
                    Some((major.parse().ok()?, minor.parse().ok()?))
                });
                let Some(version @ (1, _)) = parsed else {
                    self.diagnostics.error(
                        &root.source,
                        format!("SDF version '{text}' is not known"),
                        "versions 1.4 to 1.12 are read",
                    );
                    return None;
                };
                version
            }
        };
        if self.compared.insert(root.source.file.to_path_buf()) {
            elements::report([(root, "root")], self.diagnostics);
            self.check_every_name(root, version);
        }
        Some(version)
    }

    /// Adds an error if the budget for included files is spent.
    fn afford(&mut self, spent: Result<(), Spent>, source: &Source) -> Option<()> {
        spent.map_err(|spent| self.diagnostics.error(source, spent.to_string(), Spent::REMEDY)).ok()
    }

    /// Adds a problem that Gazebo tolerates: an error here, a warning with `--gazebo-compat` or `--skip-missing`.
    fn missing(&mut self, source: &Source, what: impl Into<String>, remedy: impl Into<String>) {
        if self.rules.gazebo_compat || self.rules.skip_missing {
            self.diagnostics.warning(source, what, remedy);
        } else {
            self.diagnostics.error(source, what, remedy);
        }
    }

    /// Like `missing`, but for images: always a warning, because the surface itself is still there.
    fn missing_picture(&mut self, source: &Source, what: &str, remedy: impl Into<String>) {
        self.diagnostics.warning(source, format!("{what}; the surface is drawn without it"), remedy);
    }

    /// Adds a warning for an element that is ignored although the user may expect an effect.
    fn ignored(&mut self, element: &Element, why: &str) {
        self.diagnostics.warning(&element.source, format!("<{}> is ignored: {why}", element.name), "");
    }

    /// Reads the number from 0 to `most` in the child element `name`.
    fn within(&mut self, parent: &Element, name: &str, most: f32) -> Option<f32> {
        let value = child_number(parent, name, self.diagnostics)?;
        if (0.0..=f64::from(most)).contains(&value) {
            return Some(value as f32);
        }
        let source = &parent.child(name).unwrap_or(parent).source;
        let remedy = format!("write a number from 0 to {most}");
        if self.rules.gazebo_compat {
            let value = (value as f32).clamp(0.0, most);
            self.diagnostics.warning(source, format!("<{name}> is out of range: it is {value}"), remedy);
            return Some(value);
        }
        self.diagnostics.error(source, format!("<{name}> is {value}"), remedy);
        None
    }

    /// Reads the colour `r g b` or `r g b a` in the child element `name`; alpha is dropped.
    fn color(&mut self, parent: &Element, name: &str) -> Option<[f32; 3]> {
        let [r, g, b, _] = self.rgba(parent, name)?;
        Some([r, g, b])
    }

    /// Reads the colour `r g b` or `r g b a` in the child element `name`; opaque if alpha is absent.
    fn rgba(&mut self, parent: &Element, name: &str) -> Option<[f32; 4]> {
        let element = parent.child(name)?;
        let text = element.text();
        let what = format!("<{name}>");
        let rgba = if text.split_whitespace().count() == 4 {
            numbers::<4>(&text, &what, &element.source, self.diagnostics)?
        } else {
            let [r, g, b] = numbers::<3>(&text, &what, &element.source, self.diagnostics)?;
            [r, g, b, 1.0]
        };
        if rgba.iter().any(|value| *value < 0.0) {
            self.diagnostics.error(
                &element.source,
                format!("<{name}> is '{text}': a colour cannot be negative"),
                "write red, green and blue between 0 and 1",
            );
            return None;
        }
        Some(rgba.map(|value| value as f32))
    }
}

/// Returns the canonical path, for comparing files.
fn canonical(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_path_buf())
}

/// Returns the `name` attribute, or an empty name.
fn name_of(element: &Element) -> String {
    element.attribute("name").unwrap_or_default().to_owned()
}
