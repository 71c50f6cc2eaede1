//! Geometries of a Collada file: the triangles of each primitive in the geometry's own axes.

use super::numbers::{Values, offset, polygons, values};
use super::{Document, Outcome, Wrong, wrong};
use crate::mesh::faces::SHORT_FACE;
use crate::mesh::normals::MISSING;
use crate::xml::Element;
use glam::DVec3;
use std::rc::Rc;

/// An `<input>` of a primitive.
struct Input<'a> {
    offset: usize,
    values: Rc<Values<'a>>,
}

/// The sources that a `<vertices>` refers to, which have the same indices.
#[derive(Clone, Default)]
pub(super) struct Vertices<'a> {
    position: Option<Rc<Values<'a>>>,
    texture: Option<Rc<Values<'a>>>,
    normal: Option<Rc<Values<'a>>>,
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

    /// Returns the numbers of a source, which is read only once if it is good.
    fn values(&mut self, source: &'a Element) -> Outcome<Rc<Values<'a>>> {
        if let Some(Some(known)) = self.values.get(&std::ptr::from_ref(source)) {
            return Ok(known.clone());
        }
        let values = Rc::new(values(source)?);
        self.values.insert(source, Some(values.clone()));
        Ok(values)
    }

    /// Returns the numbers of the normals that an input refers to; none if they are damaged, as the triangles can be read
    /// without them.
    fn normals(&mut self, input: &Element) -> Option<Rc<Values<'a>>> {
        let source = self.referenced(input, "source").ok()?;
        // Many primitives may refer to the same damaged source, which is read only once, too.
        let known = self.values.get(&std::ptr::from_ref(source)).cloned();
        known.unwrap_or_else(|| {
            let read = self.values(source).ok();
            self.values.insert(source, read.clone());
            read
        })
    }

    /// Returns the sources of a `<vertices>`, which is read only once.
    fn vertices(&mut self, element: &'a Element) -> Outcome<Vertices<'a>> {
        if let Some(known) = self.vertices.get(&std::ptr::from_ref(element)) {
            return Ok(known.clone());
        }
        let mut vertices = Vertices::default();
        for input in element.elements_named("input") {
            match input.attribute("semantic") {
                Some("POSITION") => {
                    vertices.position = Some(self.values(self.referenced(input, "source")?)?);
                }
                Some("TEXCOORD") => {
                    vertices.texture = Some(self.values(self.referenced(input, "source")?)?);
                }
                Some("NORMAL") => vertices.normal = self.normals(input),
                _ => {}
            }
        }
        self.vertices.insert(element, vertices.clone());
        Ok(vertices)
    }

    fn inputs(&mut self, primitive: &'a Element) -> Outcome<Inputs<'a>> {
        let (mut vertex, mut texture, mut normal) = (None, None, None);
        for input in primitive.elements_named("input") {
            let offset = offset(input)?;
            let source = self.referenced(input, "source")?;
            let at_offset = |values| Input { offset, values };
            match input.attribute("semantic") {
                Some("VERTEX") => {
                    let vertices = self.vertices(source)?;
                    vertex = vertices.position.map(at_offset).or(vertex);
                    texture = vertices.texture.map(at_offset).or(texture);
                    normal = vertices.normal.map(at_offset).or(normal);
                }
                Some("NORMAL") if normal.is_none() => normal = self.normals(input).map(at_offset),
                Some("TEXCOORD") if texture.is_none() => texture = Some(at_offset(self.values(source)?)),
                _ => {}
            }
        }
        match vertex {
            Some(vertex) => Ok(Inputs { vertex, texture, normal }),
            None => wrong(primitive, format!("<{}> has no positions", primitive.name)),
        }
    }

    /// Divides the polygons of a primitive into triangles with a separate vertex for each corner.
    fn triangulate(&mut self, primitive: &'a Element) -> Outcome<Shape<'a>> {
        let Inputs { vertex, texture, normal } = self.inputs(primitive)?;
        let polygons = polygons(primitive)?;
        let mut shape = Shape { symbol: primitive.attribute("material"), ..Shape::default() };
        let mut corners = Vec::new();
        let mut is_whole = true;
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
            is_whole &= corners.len() >= 3;
            let cut = self.cutter.cut(&corners, &polygon.holes);
            shape.triangles.extend(cut.iter().map(|triangle| triangle.map(|corner| first + corner)));
        }
        if !is_whole {
            self.left_out.push(Wrong(primitive.source.clone(), SHORT_FACE.into()));
        }
        Ok(shape)
    }
}
