//! `<geometry>`.

use super::Loader;
use crate::mesh::{load_mesh_parts, merge_parts};
use crate::model::{Geometry, Material, Mesh};
use crate::values::numbers;
use crate::xml::Element;
use glam::DVec3;
use std::sync::Arc;

enum Shape {
    Primitive(Geometry),
    Mesh(Vec<Arc<Mesh>>),
}

impl Loader<'_> {
    /// Reads the geometry of a `<visual>` with the material from its own file: several for a mesh of several
    /// materials, none after an error.
    pub(super) fn visual_geometry(&mut self, visual: &Element) -> Vec<(Geometry, Option<Material>)> {
        match self.shape(visual) {
            Some(Shape::Primitive(geometry)) => vec![(geometry, None)],
            Some(Shape::Mesh(parts)) => parts
                .into_iter()
                .map(|part| {
                    let material = part.material.clone();
                    (Geometry::Mesh(part), material)
                })
                .collect(),
            None => Vec::new(),
        }
    }

    /// Reads the geometry of a `<collision>`.
    pub(super) fn collision_geometry(&mut self, collision: &Element) -> Option<Geometry> {
        match self.shape(collision)? {
            Shape::Primitive(geometry) => Some(geometry),
            Shape::Mesh(parts) => merge_parts(&parts).map(Geometry::Mesh),
        }
    }

    fn shape(&mut self, parent: &Element) -> Option<Shape> {
        let shape = parent.child("geometry").and_then(|geometry| geometry.elements().next());
        let Some(shape) = shape else {
            self.diagnostics.error(
                &parent.source,
                format!("<{}> has no shape in a <geometry>", parent.name),
                "write <geometry> with a box, cylinder, sphere, capsule or mesh in it",
            );
            return None;
        };
        Some(Shape::Primitive(match shape.name.as_str() {
            "box" => Geometry::Box { size: DVec3::from_array(self.lengths::<3>(shape, "size")?) },
            "cylinder" => {
                let (radius, length) = self.radius_and_length(shape);
                Geometry::Cylinder { radius: radius?, length: length? }
            }
            "capsule" => {
                let (radius, length) = self.radius_and_length(shape);
                Geometry::Capsule { radius: radius?, length: length? }
            }
            "sphere" => {
                let [radius] = self.lengths(shape, "radius")?;
                Geometry::Sphere { radius }
            }
            "mesh" => return self.mesh(shape).map(Shape::Mesh),
            other => {
                self.diagnostics.error(
                    &shape.source,
                    format!("<{other}> is not a shape"),
                    "use a box, cylinder, sphere, capsule or mesh",
                );
                return None;
            }
        }))
    }

    fn radius_and_length(&mut self, shape: &Element) -> (Option<f64>, Option<f64>) {
        let mut length = |name: &str| self.lengths(shape, name).map(|[length]| length);
        (length("radius"), length("length"))
    }

    /// Reads N lengths above 0 in a required attribute. Gazebo accepts 0; nothing can see or touch such a shape.
    fn lengths<const N: usize>(&mut self, shape: &Element, name: &str) -> Option<[f64; N]> {
        let text = self.required(shape, name)?;
        let what = format!("attribute '{name}' of <{}>", shape.name);
        let values = numbers::<N>(text, &what, &shape.source, self.diagnostics)?;
        if values.iter().all(|value| *value > 0.0) {
            return Some(values);
        }
        if values.iter().all(|value| *value >= 0.0) {
            let what = format!("{what} is '{text}', so the shape is left out");
            self.diagnostics.warning(&shape.source, what, "lengths must be above 0");
        } else {
            self.diagnostics.error(&shape.source, format!("{what} is '{text}'"), "lengths must be above 0");
        }
        None
    }

    fn mesh(&mut self, shape: &Element) -> Option<Vec<Arc<Mesh>>> {
        let name = self.required(shape, "filename")?;
        let scale = match shape.attribute("scale") {
            None => DVec3::ONE,
            Some(text) => {
                let what = "attribute 'scale' of <mesh>";
                let scale = numbers::<3>(text, what, &shape.source, self.diagnostics)?;
                if scale.contains(&0.0) {
                    self.diagnostics.error(
                        &shape.source,
                        format!("{what} is '{text}'"),
                        "write three factors other than 0",
                    );
                    return None;
                }
                DVec3::from_array(scale)
            }
        };
        let path = self.file(shape, name, "mesh")?;
        let key = (path, scale.to_array().map(f64::to_bits));
        if let Some(known) = self.meshes.get(&key) {
            return known.clone();
        }
        let parts = load_mesh_parts(&key.0, None, scale, self.rules.up_axis, &shape.source, self.diagnostics);
        self.meshes.insert(key, parts.clone());
        parts
    }
}
