//! `<geometry>`.

use super::fuel::FuelUri;
use super::resources::Resolved;
use super::{Loader, Scope, TEXTURE};
use crate::file;
use crate::mesh::{MESH_FORMATS, Submesh, load_mesh_parts, merge_parts};
use crate::model::{Geometry, Material, Mesh};
use crate::values::{child_bool, child_text, numbers};
use crate::xml::Element;
use glam::DVec3;
use std::path::Path;
use std::sync::Arc;

/// Default length of shapes, in metres (sdf/1.12).
const DEFAULT_LENGTH_M: f64 = 1.0;
const CAPSULE_RADIUS_M: f64 = 0.5;

impl Geometry {
    /// Returns the material that the geometry's own file gives it.
    pub(super) fn own_material(&self) -> Option<Material> {
        match self {
            Self::Mesh(mesh) => mesh.material.clone(),
            Self::HeightMap(map) => map.material.as_deref().cloned(),
            _ => None,
        }
    }
}

impl Loader<'_> {
    /// Reads the geometry of a `<visual>`: several for a mesh of several materials, none after an error.
    pub(super) fn visual_geometry(&mut self, parent: &Element, scope: Scope<'_>) -> Vec<Geometry> {
        match self.shape(parent, scope) {
            Some(Shape::Primitive(geometry)) => vec![geometry],
            Some(Shape::Mesh(parts)) => parts.into_iter().map(Geometry::Mesh).collect(),
            None => Vec::new(),
        }
    }

    /// Reads the geometry of a `<collision>`.
    pub(super) fn collision_geometry(&mut self, parent: &Element, scope: Scope<'_>) -> Option<Geometry> {
        match self.shape(parent, scope)? {
            Shape::Primitive(geometry) => Some(geometry),
            Shape::Mesh(parts) => merge_parts(&parts).map(Geometry::Mesh),
        }
    }

    fn shape(&mut self, parent: &Element, scope: Scope<'_>) -> Option<Shape> {
        let Some(element) = parent.child("geometry") else {
            self.diagnostics.error(
                &parent.source,
                format!("<{}> has no <geometry>", parent.name),
                "give it a box, cylinder, sphere, capsule, ellipsoid, cone, plane, polyline, heightmap or mesh",
            );
            return None;
        };
        let shape = element.elements().next()?;
        let geometry = match shape.name.as_str() {
            "box" => Geometry::Box { size: DVec3::from_array(self.lengths(shape, "size")?) },
            "cylinder" => Geometry::Cylinder {
                radius: self.length(shape, "radius")?,
                length: self.length(shape, "length")?,
            },
            "capsule" => Geometry::Capsule {
                radius: self.length_or(shape, "radius", CAPSULE_RADIUS_M)?,
                length: self.length(shape, "length")?,
            },
            "sphere" => Geometry::Sphere { radius: self.length(shape, "radius")? },
            "ellipsoid" => Geometry::Ellipsoid { radii: DVec3::from_array(self.lengths(shape, "radii")?) },
            "cone" => Geometry::Cone {
                radius: self.length(shape, "radius")?,
                length: self.length(shape, "length")?,
            },
            "plane" => self.plane(shape)?,
            "polyline" => return self.polylines(element).map(|mesh| Shape::Mesh(vec![mesh])),
            "heightmap" => self.height_map(shape, scope)?,
            "mesh" => return self.mesh(shape, scope).map(Shape::Mesh),
            "empty" => return None,
            _ => {
                self.ignored(shape, "this shape is unsupported; use a mesh");
                return None;
            }
        };
        Some(Shape::Primitive(geometry))
    }

    fn plane(&mut self, shape: &Element) -> Option<Geometry> {
        let normal = match self.vector(shape, "normal") {
            None if shape.child("normal").is_some() => return None,
            None => DVec3::Z,
            Some(vector) => {
                let Some(unit) = vector.try_normalize() else {
                    self.diagnostics.error(
                        &shape.source,
                        "the <normal> of a plane is 0 0 0",
                        "write its direction, such as 0 0 1",
                    );
                    return None;
                };
                unit
            }
        };
        // A collision plane has no <size>: it is infinite.
        let size = if shape.child("size").is_some() { self.lengths(shape, "size")? } else { [1.0; 2] };
        Some(Geometry::Plane { normal, size })
    }

    fn mesh(&mut self, shape: &Element, scope: Scope<'_>) -> Option<Vec<Arc<Mesh>>> {
        let Some(uri) = child_text(shape, "uri") else {
            self.diagnostics.error(&shape.source, "<mesh> has no <uri>", "write <uri>model://…</uri>");
            return None;
        };
        let part = match shape.child("submesh") {
            None => None,
            Some(submesh) => Some(self.submesh(submesh)?),
        };
        let scale = match self.vector(shape, "scale") {
            None if shape.child("scale").is_some() => return None,
            scale => scale.unwrap_or(DVec3::ONE),
        };
        self.mesh_file(shape, &uri, part.as_ref(), scale, scope)
    }

    /// Reads the part of a file that `<submesh>` names.
    fn submesh(&mut self, element: &Element) -> Option<Submesh> {
        let Some(name) = child_text(element, "name") else {
            self.diagnostics.error(
                &element.source,
                "<submesh> has no <name>",
                "write the name of a part of the mesh, or remove <submesh> for the whole mesh",
            );
            return None;
        };
        let is_centred = child_bool(element, "center", self.diagnostics).unwrap_or(false);
        Some(Submesh { name, is_centred })
    }

    /// Reads the parts of a mesh's file, each of one material; none after an error.
    pub(super) fn mesh_file(
        &mut self,
        shape: &Element,
        uri: &str,
        submesh: Option<&Submesh>,
        scale: DVec3,
        scope: Scope<'_>,
    ) -> Option<Vec<Arc<Mesh>>> {
        let path = self.existing_file(shape, uri, scope.folder, "mesh")?;
        let key = (path.clone(), submesh.cloned(), scale.to_array().map(f64::to_bits));
        if let Some(known) = self.meshes.get(&key) {
            return known.clone();
        }
        let up_axis = self.rules.up_axis;
        let parts = load_mesh_parts(&path, submesh, scale, up_axis, &shape.source, self.diagnostics);
        self.meshes.insert(key, parts.clone());
        parts
    }

    /// Returns the existing file that a URI refers to; `what` names the kind of file in problems.
    pub(super) fn existing_file(
        &mut self,
        element: &Element,
        uri: &str,
        folder: &Path,
        what: &str,
    ) -> Option<std::path::PathBuf> {
        let (problem, remedy) = match self.resources.resolve(uri, folder) {
            Resolved::Found(path) if !path.is_dir() => return Some(path),
            Resolved::Found(path) => {
                (format!("the {what} '{uri}' is a folder: {}", path.display()), "name a file in it".to_owned())
            }
            Resolved::NotFound(places) => (
                format!("there is no {what} '{uri}': looked for {}", file::list(&places)),
                "correct the path, or add the folder that holds the model to GAZEBO_MODEL_PATH or --package-path"
                    .to_owned(),
            ),
            Resolved::UnknownScheme(scheme) => (
                format!("the {what} '{uri}' cannot be fetched: '{scheme}://' is unsupported"),
                match what {
                    _ if FuelUri::of(uri).is_some() => {
                        "download its model with `gz fuel download -u`, or put the model's folder into GAZEBO_MODEL_PATH"
                            .to_owned()
                    }
                    "mesh" => format!("download it and name the file (meshes: {MESH_FORMATS})"),
                    _ => "download it and name the file".to_owned(),
                },
            ),
        };
        if what == TEXTURE {
            self.missing_picture(&element.source, &problem, remedy);
        } else {
            self.missing(&element.source, problem, remedy);
        }
        None
    }

    fn length(&mut self, shape: &Element, name: &str) -> Option<f64> {
        self.length_or(shape, name, DEFAULT_LENGTH_M)
    }

    /// Reads a length above 0; the format's default if it is absent.
    fn length_or(&mut self, shape: &Element, name: &str, default: f64) -> Option<f64> {
        self.lengths_or(shape, name, [default]).map(|[length]| length)
    }

    fn lengths<const N: usize>(&mut self, shape: &Element, name: &str) -> Option<[f64; N]> {
        self.lengths_or(shape, name, [DEFAULT_LENGTH_M; N])
    }

    fn lengths_or<const N: usize>(
        &mut self,
        shape: &Element,
        name: &str,
        defaults: [f64; N],
    ) -> Option<[f64; N]> {
        let Some(child) = shape.child(name) else {
            let taken = defaults.map(|length| length.to_string()).join(" ");
            self.diagnostics.warning(
                &shape.source,
                format!("<{}> has no <{name}>: {taken} is assumed", shape.name),
                format!("write <{name}> in metres"),
            );
            return Some(defaults);
        };
        let values = numbers(&child.text(), &format!("<{name}>"), &child.source, self.diagnostics)?;
        self.positive(shape, name, values)
    }

    pub(super) fn positive<const N: usize>(
        &mut self,
        shape: &Element,
        name: &str,
        values: [f64; N],
    ) -> Option<[f64; N]> {
        if values.iter().all(|value| *value > 0.0) {
            return Some(values);
        }
        let child = shape.child(name).unwrap_or(shape);
        let article = if shape.name.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
        let what = format!("<{name}> of {article} {} is '{}'", shape.name, child.text());
        // Gazebo accepts 0 and continues; nothing can see or touch such a shape.
        if values.iter().all(|value| *value >= 0.0) {
            let what = format!("{what}, so the shape is left out");
            self.diagnostics.warning(&child.source, what, "lengths must be above 0");
        } else {
            self.diagnostics.error(&child.source, what, "lengths must be above 0");
        }
        None
    }
}

enum Shape {
    Primitive(Geometry),
    Mesh(Vec<Arc<Mesh>>),
}
