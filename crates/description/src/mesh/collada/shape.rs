//! Geometries of a Collada file: the triangles of each primitive in the geometry's own axes.

use super::numbers::{Values, offset, polygons, values};
use super::{Document, Outcome, wrong};
use crate::mesh::normals::MISSING;
use crate::xml::Element;
use glam::DVec3;
use std::rc::Rc;

/// An `<input>` of a primitive.
struct Input<'a> {
    offset: usize,
    values: Rc<Values<'a>>,
}

/// The inputs of a primitive that are read.
struct Inputs<'a> {
    vertex: Input<'a>,
    texture: Option<Input<'a>>,
    normal: Option<Input<'a>>,
}

/// The triangles of a primitive in the axes of its geometry.
#[derive(Default)]
pub(super) struct Shape<'a> {
    /// The symbol to which an instance binds its material.
    pub(super) symbol: Option<&'a str>,
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) uvs: Vec<[f32; 2]>,
    pub(super) normals: Vec<[f32; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl<'a> Document<'a> {
    /// Reads a geometry as triangles in its own axes, separately for each primitive.
    pub(super) fn shapes(&mut self, geometry: &'a Element) -> Outcome<Vec<Shape<'a>>> {
        let mut shapes = Vec::new();
        for primitive in geometry.child("mesh").iter().flat_map(|mesh| mesh.elements()) {
            if matches!(
                primitive.name.as_str(),
                "triangles" | "polylist" | "polygons" | "trifans" | "tristrips"
            ) {
                shapes.push(self.triangulate(primitive)?);
            }
        }
        Ok(shapes)
    }

    /// Returns the numbers of a source, which is read only once.
    fn values(&mut self, source: &'a Element) -> Outcome<Rc<Values<'a>>> {
        if let Some(known) = self.values.get(&std::ptr::from_ref(source)) {
            return Ok(known.clone());
        }
        let values = Rc::new(values(source)?);
        self.values.insert(source, values.clone());
        Ok(values)
    }

    fn inputs(&mut self, primitive: &'a Element) -> Outcome<Inputs<'a>> {
        let (mut vertex, mut texture, mut normal) = (None, None, None);
        for input in primitive.elements_named("input") {
            let offset = offset(input)?;
            let source = self.referenced(input, "source")?;
            match input.attribute("semantic") {
                Some("VERTEX") => {
                    // Its source is <vertices>, which refers to the source of the positions, and to others with the
                    // same indices.
                    for inner in source.elements_named("input") {
                        let semantic = inner.attribute("semantic");
                        if semantic == Some("NORMAL") {
                            normal = self.normals(inner, offset);
                        }
                        if !matches!(semantic, Some("POSITION" | "TEXCOORD")) {
                            continue;
                        }
                        let source = self.referenced(inner, "source")?;
                        let values = Some(Input { offset, values: self.values(source)? });
                        if semantic == Some("POSITION") { vertex = values } else { texture = values }
                    }
                }
                Some("NORMAL") if normal.is_none() => normal = self.normals(input, offset),
                Some("TEXCOORD") if texture.is_none() => {
                    texture = Some(Input { offset, values: self.values(source)? });
                }
                _ => {}
            }
        }
        match vertex {
            Some(vertex) => Ok(Inputs { vertex, texture, normal }),
            None => wrong(primitive, format!("<{}> has no positions", primitive.name)),
        }
    }

    /// Returns an input of normals; none if it is damaged, as the triangles can be read without it.
    fn normals(&mut self, input: &'a Element, offset: usize) -> Option<Input<'a>> {
        let source = self.referenced(input, "source").ok()?;
        Some(Input { offset, values: self.values(source).ok()? })
    }

    /// Divides the polygons of a primitive into triangles with a separate vertex for each corner.
    fn triangulate(&mut self, primitive: &'a Element) -> Outcome<Shape<'a>> {
        let Inputs { vertex, texture, normal } = self.inputs(primitive)?;
        let polygons = polygons(primitive)?;
        let mut shape = Shape { symbol: primitive.attribute("material"), ..Shape::default() };
        let mut corners = Vec::new();
        for polygon in &polygons.outlines {
            let first = shape.positions.len() as u32;
            corners.clear();
            let range = polygon.corners.start * polygons.stride..polygon.corners.end * polygons.stride;
            for corner in polygons.indices[range].chunks_exact(polygons.stride) {
                let position: [f32; 3] = vertex.values.get(corner[vertex.offset])?;
                corners.push(DVec3::from_array(position.map(f64::from)));
                shape.positions.push(position);
                if let Some(normal) = &normal {
                    let found = normal.values.get(corner[normal.offset]);
                    shape.normals.push(found.unwrap_or(MISSING));
                }
                if let Some(texture) = &texture {
                    shape.uvs.push(texture.values.get(corner[texture.offset])?);
                }
            }
            let cut = self.cutter.cut(&corners, &polygon.holes);
            shape.triangles.extend(cut.iter().map(|triangle| triangle.map(|corner| first + corner)));
        }
        Ok(shape)
    }
}
