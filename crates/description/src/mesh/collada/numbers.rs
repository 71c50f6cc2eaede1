//! Numbers of a Collada file: sources, indices of polygons, transforms.

use super::{Outcome, wrong};
use crate::xml::Element;
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};
use std::str::FromStr;

/// A corner with more indices than this is a mistake.
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
            None => wrong(self.element, format!("entry {index} is asked for, of {}", self.count)),
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

/// The indices of a primitive, a list for each polygon.
pub(super) fn polygons(primitive: &Element) -> Outcome<Vec<Vec<usize>>> {
    let mut stride = 1;
    for input in primitive.elements_named("input") {
        stride = stride.max(offset(input)? + 1);
    }
    let corner = |list: &[usize], at: usize| list[at * stride..(at + 1) * stride].to_vec();
    let mut polygons = Vec::new();
    let sizes = primitive.child("vcount").map(list::<usize>).transpose()?;
    for element in primitive.elements_named("p") {
        let indices = list::<usize>(element)?;
        if indices.len() % stride != 0 {
            return wrong(element, format!("{} indices are no multiple of {stride}", indices.len()));
        }
        let corners = indices.len() / stride;
        match primitive.name.as_str() {
            "polygons" => polygons.push(indices),
            "trifans" => {
                polygons.extend(
                    (2..corners).map(|i| {
                        [corner(&indices, 0), corner(&indices, i - 1), corner(&indices, i)].concat()
                    }),
                );
            }
            // Every second triangle of a strip runs the other way round.
            "tristrips" => polygons.extend((2..corners).map(|i| {
                let (a, b) = if i % 2 == 0 { (i - 2, i - 1) } else { (i - 1, i - 2) };
                [corner(&indices, a), corner(&indices, b), corner(&indices, i)].concat()
            })),
            "polylist" => {
                let mut rest = &indices[..];
                for size in sizes.iter().flatten() {
                    let Some((polygon, after)) =
                        size.checked_mul(stride).and_then(|length| rest.split_at_checked(length))
                    else {
                        return wrong(element, "<vcount> asks for more corners than <p> has");
                    };
                    polygons.push(polygon.to_vec());
                    rest = after;
                }
            }
            _ => polygons.extend(indices.chunks_exact(3 * stride).map(<[usize]>::to_vec)),
        }
    }
    Ok(polygons)
}

/// The place of an `<input>` among the indices of a corner.
pub(super) fn offset(input: &Element) -> Outcome<usize> {
    match input.attribute("offset").unwrap_or("0").trim().parse() {
        Ok(offset) if offset < MAX_INPUTS => Ok(offset),
        _ => wrong(input, "the offset of <input> is not a small number"),
    }
}

/// The transform that an element of a node stands for, if it does.
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
                // libm, not the platform's functions: the same bits on every machine.
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
        // Where the eye is, what it looks at along its −z, and where its y points as far as it may.
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

/// The numbers of an element's text.
pub(super) fn list<T: FromStr>(element: &Element) -> Outcome<Vec<T>> {
    element
        .text()
        .split_whitespace()
        .map(|word| match word.parse() {
            Ok(value) => Ok(value),
            Err(_) => wrong(element, format!("'{word}' in <{}> is not a number", element.name)),
        })
        .collect()
}
