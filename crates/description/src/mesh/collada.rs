//! Collada 1.4 and 1.5 (`.dae`): the triangles of the visual scene in metres, and their colours.
//!
//! The parser supports units and, on request, the up axis, nodes with all their transforms and instances, `triangles`,
//! `polylist`, `polygons`, `trifans`, `tristrips`, diffuse as a colour or picture, emission, specular, shininess, and
//! transparency if its meaning is given (`opaque="…"`), as in Gazebo. Skins are in the pose in which they were bound.
//! Lines, splines, skeletons, animation, lights and cameras are ignored, with the nodes that contain nothing else.
//! Materials that are missing or invalid give a warning, and the mesh is loaded without them.

mod look;
mod numbers;
mod scene;
mod shape;

use super::UpAxis;
use super::faces::Cutter;
use super::normals;
use super::part::Part;
use crate::budget::Budget;
use crate::diagnostics::{Diagnostics, Source};
use crate::model::Material;
use crate::xml::Element;
use glam::{DAffine3, DMat3, DVec3};
use numbers::Values;
use scene::Known;
use shape::{Shape, Vertices};
use std::cell::RefCell;
use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap};
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;

/// An error: its place in the file, and a description.
struct Wrong(Source, String);

type Outcome<T> = Result<T, Wrong>;

fn wrong<T>(element: &Element, what: impl Into<String>) -> Outcome<T> {
    Err(Wrong(element.source.clone(), what.into()))
}

/// Reads the file. After an error, which is added to `diagnostics`, the result is `None`.
pub(super) fn load(path: &Path, up_axis: UpAxis, diagnostics: &mut Diagnostics) -> Option<Vec<Part>> {
    let root = match Element::parse_file(path) {
        Ok(root) => root,
        Err(problem) => {
            diagnostics.add(problem);
            return None;
        }
    };
    let mut document = Document::new(&root, up_axis);
    let parts = document.parts();
    for Wrong(source, what) in document.left_out {
        diagnostics.warning(&source, format!("{what}: it is left out"), "export the mesh again");
    }
    for id in document.ambiguous.take() {
        let (first, second) = (&document.by_id[&*id].source, &document.repeated[&*id].source);
        let what = format!("the id '{id}' occurs again: the element at {first} is used");
        diagnostics.warning(second, what, "give each element its own id");
    }
    match parts {
        Ok(parts) => Some(parts),
        Err(Wrong(source, what)) => {
            diagnostics.error(&source, format!("broken Collada: {what}"), "export the mesh again");
            None
        }
    }
}

/// Collects elements by their ids. The first element with an id is used.
fn collect<'a>(
    element: &'a Element,
    by_id: &mut HashMap<&'a str, &'a Element>,
    repeated: &mut HashMap<&'a str, &'a Element>,
) {
    if let Some(id) = element.attribute("id") {
        match by_id.entry(id) {
            Entry::Vacant(place) => {
                place.insert(element);
            }
            Entry::Occupied(_) => {
                repeated.entry(id).or_insert(element);
            }
        }
    }
    for child in element.elements() {
        collect(child, by_id, repeated);
    }
}

struct Document<'a> {
    root: &'a Element,
    up_axis: UpAxis,
    /// The transform from the file's unit and, on request, up axis to metres with z up.
    world_from_file: DAffine3,
    by_id: HashMap<&'a str, &'a Element>,
    /// Elements whose id is already used by another.
    repeated: HashMap<&'a str, &'a Element>,
    /// The repeated ids that are referred to.
    ambiguous: RefCell<BTreeSet<String>>,
    budget: Budget,
    cutter: Cutter,
    /// Sources that have been read; `None` for damaged ones.
    values: HashMap<*const Element, Option<Rc<Values<'a>>>>,
    /// `<vertices>` that have been read.
    vertices: HashMap<*const Element, Vertices<'a>>,
    /// Geometries that have been read.
    geometries: HashMap<*const Element, Rc<[Shape<'a>]>>,
    /// What has been read of the scene.
    known: Known<'a>,
    /// Errors in parts that the mesh can be loaded without.
    left_out: Vec<Wrong>,
}

impl<'a> Document<'a> {
    fn new(root: &'a Element, up_axis: UpAxis) -> Self {
        let (mut by_id, mut repeated) = (HashMap::new(), HashMap::new());
        collect(root, &mut by_id, &mut repeated);
        Self {
            root,
            up_axis,
            world_from_file: DAffine3::IDENTITY,
            by_id,
            repeated,
            ambiguous: RefCell::default(),
            budget: Budget::default(),
            cutter: Cutter::default(),
            values: HashMap::new(),
            vertices: HashMap::new(),
            geometries: HashMap::new(),
            known: Known::default(),
            left_out: Vec::new(),
        }
    }

    fn parts(&mut self) -> Outcome<Vec<Part>> {
        if self.root.name != "COLLADA" {
            return wrong(self.root, format!("the root element is <{}>", self.root.name));
        }
        self.world_from_file = self.read_axes()?;
        let world_from_file = self.world_from_file;
        let mut parts = Vec::new();
        let scene = self.root.child("scene").and_then(|scene| scene.child("instance_visual_scene"));
        if let Some(instance) = scene {
            let scene = self.referenced(instance, "url")?;
            for node in scene.elements_named("node") {
                self.node(node, world_from_file, &[], &mut parts)?;
            }
        } else {
            let geometries = self.root.elements_named("library_geometries");
            for geometry in geometries.flat_map(|library| library.elements_named("geometry")) {
                self.geometry(geometry, world_from_file, &HashMap::new(), &mut parts)?;
            }
        }
        Ok(parts)
    }

    /// Returns the transform from the file's unit and, on request, up axis to metres with z up.
    fn read_axes(&self) -> Outcome<DAffine3> {
        let asset = self.root.child("asset");
        let unit = asset.and_then(|asset| asset.child("unit"));
        let metre = match unit.and_then(|unit| Some((unit, unit.attribute("meter")?))) {
            None => 1.0,
            Some((element, text)) => match text.trim().parse::<f64>() {
                Ok(metre) if metre.is_finite() && metre > 0.0 => metre,
                _ => return wrong(element, format!("the unit is '{text}' metres")),
            },
        };
        let axis = asset.and_then(|asset| asset.child("up_axis"));
        let axis = axis.filter(|_| self.up_axis == UpAxis::Applied);
        let turn = match axis.map(Element::text).as_deref() {
            // The columns are the images of the file's x, y and z axes.
            None | Some("Z_UP") => DMat3::IDENTITY,
            Some("Y_UP") => DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y),
            Some("X_UP") => DMat3::from_cols(DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y),
            Some(other) => return wrong(axis.unwrap_or(self.root), format!("<up_axis> is '{other}'")),
        };
        Ok(DAffine3::from_mat3(turn * metre))
    }

    /// Returns the element that an attribute `#id` refers to.
    fn referenced(&self, element: &Element, attribute: &str) -> Outcome<&'a Element> {
        let Some(reference) = element.attribute(attribute) else {
            return wrong(element, format!("<{}> has no '{attribute}'", element.name));
        };
        let id = reference.trim_start_matches('#');
        if self.repeated.contains_key(id) {
            self.ambiguous.borrow_mut().insert(id.to_owned());
        }
        match self.by_id.get(id) {
            Some(found) => Ok(found),
            None => wrong(element, format!("there is nothing with the id '{reference}'")),
        }
    }

    /// Places a copy of a geometry's parts.
    fn geometry(
        &mut self,
        geometry: &'a Element,
        world_from_geometry: DAffine3,
        materials: &HashMap<&str, Rc<Material>>,
        parts: &mut Vec<Part>,
    ) -> Outcome<()> {
        let shapes = if let Some(known) = self.geometries.get(&std::ptr::from_ref(geometry)) {
            let known = known.clone();
            let bytes = |shape: &Shape<'_>| {
                size_of_val(&shape.positions[..])
                    + size_of_val(&shape.uvs[..])
                    + size_of_val(&shape.normals[..])
                    + size_of::<Part>()
            };
            self.take(geometry, known.iter().map(bytes).sum())?;
            known
        } else {
            let shapes: Rc<[Shape<'a>]> = self.shapes(geometry)?.into();
            self.geometries.insert(geometry, shapes.clone());
            shapes
        };
        let matrix = normals::matrix(world_from_geometry.matrix3);
        let mirrored = world_from_geometry.matrix3.determinant() < 0.0;
        let [id, name] = ["id", "name"].map(|attribute| geometry.attribute(attribute));
        self.take(geometry, [id, name].into_iter().flatten().map(str::len).sum())?;
        let id: Arc<str> = id.unwrap_or_default().into();
        let aliases: Vec<Arc<str>> = name.map(Arc::from).into_iter().collect();
        for shape in &*shapes {
            let place = |position: &[f32; 3]| {
                let point = DVec3::from_array(position.map(f64::from));
                world_from_geometry.transform_point3(point).as_vec3().to_array()
            };
            let triangles =
                shape.triangles.iter().map(|&[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] });
            let part = Part {
                name: id.clone(),
                aliases: aliases.clone(),
                positions: shape.positions.iter().map(place).collect(),
                uvs: shape.uvs.clone(),
                normals: shape.normals.iter().map(|normal| normals::turned(&matrix, *normal)).collect(),
                triangles: triangles.collect(),
                material: shape.symbol.and_then(|symbol| materials.get(symbol)).map(|look| (**look).clone()),
            };
            self.take(geometry, part.strings_len())?;
            parts.push(part);
        }
        Ok(())
    }

    /// Counts bytes that the file expands to.
    fn take(&mut self, element: &Element, bytes: usize) -> Outcome<()> {
        self.budget.take(0, bytes).or_else(|spent| wrong(element, spent.to_string()))
    }
}
