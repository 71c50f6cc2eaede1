//! Numbers of a Collada file: sources, indices of polygons, transforms.

use super::{Outcome, wrong};
use crate::xml::Element;
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};
use std::ops::Range;
use std::str::FromStr;

/// The greatest number of indices of a corner; more are an error in the file.
const MAX_INPUTS: usize = 64;

/// The numbers of a `<source>`.
pub(super) struct Values<'a> {
    numbers: Vec<f32>,
    stride: usize,
    first: usize,
    count: usize,
    element: &'a Element,
}

impl Values<'_> {
    /// The first N numbers of an entry.
    pub(super) fn get<const N: usize>(&self, index: usize) -> Outcome<[f32; N]> {
        let start = (index < self.count).then(|| self.first + index * self.stride);
        let entry = start.and_then(|start| self.numbers.get(start..start + N));
        match entry.and_then(|entry| entry.try_into().ok()) {
            Some(entry) => Ok(entry),
            None => wrong(self.element, format!("entry {index} is requested, but there are {}", self.count)),
        }
    }
}

/// The numbers of a `<source>` as its accessor arranges them.
pub(super) fn values(source: &Element) -> Outcome<Values<'_>> {
    let Some(array) = source.child("float_array") else {
        return wrong(source, "<source> has no <float_array>");
    };
    let numbers = list::<f32>(array)?;
    let accessor = source.child("technique_common").and_then(|technique| technique.child("accessor"));
    let number = |name: &str, default: usize| -> Outcome<usize> {
        match accessor.and_then(|accessor| accessor.attribute(name)) {
            None => Ok(default),
            Some(text) => match text.trim().parse() {
                Ok(value) if value <= numbers.len() => Ok(value),
                _ => wrong(source, format!("the accessor's {name} is '{text}'")),
            },
        }
    };
    let stride = number("stride", 1)?.max(1);
    let count = number("count", numbers.len() / stride)?;
    Ok(Values { first: number("offset", 0)?, stride, count, element: source, numbers })
}

/// The polygons of a primitive, given by the indices of their corners.
#[derive(Default)]
pub(super) struct Polygons {
    /// The number of indices per corner, one for each input.
    pub(super) stride: usize,
    pub(super) indices: Vec<usize>,
    pub(super) outlines: Vec<Polygon>,
}

/// One of the [`Polygons`].
pub(super) struct Polygon {
    /// Its corners: those of the outline, followed by those of its holes.
    pub(super) corners: Range<usize>,
    /// The first corner of each hole, counted from the first corner of the outline.
    pub(super) holes: Vec<u32>,
}

impl Polygons {
    fn push(&mut self, corners: Range<usize>) {
        self.outlines.push(Polygon { corners, holes: Vec::new() });
    }

    /// Adds a triangle of existing corners.
    fn triangle(&mut self, corners: [usize; 3]) {
        let first = self.corners();
        for corner in corners {
            self.indices.extend_from_within(corner * self.stride..(corner + 1) * self.stride);
        }
        self.push(first..first + 3);
    }

    fn corners(&self) -> usize {
        self.indices.len() / self.stride
    }

    /// Adds the corners of an element's text.
    fn append(&mut self, element: &Element) -> Outcome<Range<usize>> {
        let (first, begin) = (self.corners(), self.indices.len());
        append(element, &mut self.indices)?;
        let count = self.indices.len() - begin;
        if !count.is_multiple_of(self.stride) {
            return wrong(element, format!("{count} indices are not a multiple of {}", self.stride));
        }
        Ok(first..self.corners())
    }
}

/// Reads the polygons of a primitive.
pub(super) fn polygons(primitive: &Element) -> Outcome<Polygons> {
    let mut found = Polygons { stride: 1, ..Polygons::default() };
    for input in primitive.elements_named("input") {
        found.stride = found.stride.max(offset(input)? + 1);
    }
    let sizes = primitive.child("vcount").map(list::<usize>).transpose()?.unwrap_or_default();
    let mut sizes = sizes.into_iter();
    for element in primitive.elements() {
        match (primitive.name.as_str(), element.name.as_str()) {
            ("polygons", "ph") => with_holes(element, &mut found)?,
            (_, "p") => {
                let corners = found.append(element)?;
                cut_up(primitive, element, corners, &mut sizes, &mut found)?;
            }
            _ => {}
        }
    }
    Ok(found)
}

/// Creates polygons from the corners of a `<p>`; those of a `<polylist>`, which has only one, take all `sizes`.
fn cut_up(
    primitive: &Element,
    p: &Element,
    corners: Range<usize>,
    sizes: &mut impl Iterator<Item = usize>,
    found: &mut Polygons,
) -> Outcome<()> {
    let (first, end) = (corners.start, corners.end);
    match primitive.name.as_str() {
        "polygons" => found.push(corners),
        "trifans" => (first + 2..end).for_each(|i| found.triangle([first, i - 1, i])),
        // Every second triangle of a strip has the opposite winding.
        "tristrips" => (first + 2..end).for_each(|i| {
            let (a, b) = if (i - first) % 2 == 0 { (i - 2, i - 1) } else { (i - 1, i - 2) };
            found.triangle([a, b, i]);
        }),
        "polylist" => {
            let mut next = first;
            for size in sizes {
                if size > end - next {
                    return wrong(p, "<vcount> asks for more corners than <p> has");
                }
                found.push(next..next + size);
                next += size;
            }
        }
        _ => (first..end).step_by(3).filter(|i| i + 3 <= end).for_each(|i| found.push(i..i + 3)),
    }
    Ok(())
}

/// Reads a `<ph>`: a polygon with holes.
fn with_holes(element: &Element, found: &mut Polygons) -> Outcome<()> {
    let Some(outline) = element.child("p") else { return wrong(element, "<ph> has no <p>") };
    let mut corners = found.append(outline)?;
    let mut holes = Vec::new();
    for hole in element.elements_named("h") {
        let start = (corners.end - corners.start) as u32;
        let hole = found.append(hole)?;
        // A hole with fewer corners has no area.
        if hole.len() >= 3 {
            holes.push(start);
            corners.end = hole.end;
        } else {
            found.indices.truncate(corners.end * found.stride);
        }
    }
    found.outlines.push(Polygon { corners, holes });
    Ok(())
}

/// Returns the offset of an `<input>` within the indices of a corner.
pub(super) fn offset(input: &Element) -> Outcome<usize> {
    match input.attribute("offset").unwrap_or("0").trim().parse() {
        Ok(offset) if offset < MAX_INPUTS => Ok(offset),
        _ => wrong(input, "the offset of <input> is not a small number"),
    }
}

/// Returns the transform that an element of a node represents, if it is one.
pub(super) fn transform(element: &Element) -> Outcome<Option<DAffine3>> {
    if !matches!(
        element.name.as_str(),
        "matrix" | "bind_shape_matrix" | "translate" | "rotate" | "scale" | "lookat"
    ) {
        return Ok(None);
    }
    let numbers = list::<f64>(element)?;
    let transform = match (element.name.as_str(), &numbers[..]) {
        ("matrix" | "bind_shape_matrix", numbers) if numbers.len() == 16 => {
            let mut rows = [0.0; 16];
            rows.copy_from_slice(numbers);
            DAffine3::from_mat4(DMat4::from_cols_array(&rows).transpose())
        }
        ("translate", &[x, y, z]) => DAffine3::from_translation(DVec3::new(x, y, z)),
        ("scale", &[x, y, z]) => DAffine3::from_scale(DVec3::new(x, y, z)),
        ("rotate", &[x, y, z, degrees]) => match DVec3::new(x, y, z).try_normalize() {
            Some(axis) => {
                // libm instead of the platform's functions, so that the bits are the same on every machine.
                let half = belvedere_sensors::Pose::from_xyz_rpy(
                    DVec3::ZERO,
                    DVec3::new(degrees.to_radians(), 0.0, 0.0),
                )
                .rotation();
                let axis = axis * half.x;
                DAffine3::from_quat(DQuat::from_xyzw(axis.x, axis.y, axis.z, half.w))
            }
            None => DAffine3::IDENTITY,
        },
        // The position of the eye, the target in the direction of its −z, and the direction that its y should have as
        // far as possible.
        ("lookat", &[ex, ey, ez, x, y, z, ux, uy, uz]) => {
            let eye = DVec3::new(ex, ey, ez);
            let back = (eye - DVec3::new(x, y, z)).normalize_or_zero();
            let right = DVec3::new(ux, uy, uz).cross(back).normalize_or_zero();
            if right == DVec3::ZERO {
                return wrong(element, "<lookat> has no direction, or looks along its up");
            }
            DAffine3::from_mat3_translation(DMat3::from_cols(right, back.cross(right), back), eye)
        }
        _ => return wrong(element, format!("<{}> has {} numbers", element.name, numbers.len())),
    };
    if !transform.is_finite() {
        return wrong(element, format!("<{}> is not finite", element.name));
    }
    Ok(Some(transform))
}

/// Returns the numbers of an element's text.
pub(super) fn list<T: FromStr>(element: &Element) -> Outcome<Vec<T>> {
    let mut numbers = Vec::new();
    append(element, &mut numbers)?;
    Ok(numbers)
}

/// Appends the numbers of an element's text.
fn append<T: FromStr>(element: &Element, numbers: &mut Vec<T>) -> Outcome<()> {
    for word in element.text().split_whitespace() {
        match word.parse() {
            Ok(value) => numbers.push(value),
            Err(_) => return wrong(element, format!("'{word}' in <{}> is not a number", element.name)),
        }
    }
    Ok(())
}
