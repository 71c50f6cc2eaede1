//! PLY (Stanford): vertices and polygons, in text or binary form.
//!
//! Colours of vertices are ignored; Gazebo does not draw these colours either. Elements other than
//! vertices, faces and strips of triangles are ignored.

mod header;

use super::faces::{Cutter, SHORT_FACE};
use super::look::Look;
use super::part::{Part, Unreadable};
use crate::diagnostics::{Diagnostics, Source};
use glam::{DVec3, Vec3};
use header::{Element, Form, Number};
use std::path::Path;

/// Reads a file as one part.
pub(super) fn parse(
    bytes: &[u8],
    path: &Path,
    diagnostics: &mut Diagnostics,
) -> Result<Vec<Part>, Unreadable> {
    let header = header::read(bytes)?;
    let mut numbers =
        Numbers { form: header.form, rest: &bytes[header.bytes..], line: header.lines, words: Vec::new() };
    let look = Look { texture: header.texture.map(Into::into), ..Look::default() };
    let mut mesh =
        Reader { part: Part { material: look.material(), ..Part::default() }, ..Reader::default() };
    for element in &header.elements {
        mesh.element(element, &mut numbers)?;
    }
    if mesh.has_short_faces {
        let what = format!("the mesh {}: {SHORT_FACE}: it is left out", path.display());
        diagnostics.warning(&Source::new(path, 0), what, "export the mesh again");
    }
    if !mesh.corner_uvs.is_empty() {
        mesh.part.uvs = mesh.corner_uvs;
    }
    Ok(vec![mesh.part])
}

#[derive(Default)]
struct Reader {
    part: Part,
    /// The texture coordinates of the corners of faces. Their vertices are not shared.
    corner_uvs: Vec<[f32; 2]>,
    cutter: Cutter,
    has_short_faces: bool,
}

/// The vertices that faces with separate corners name.
#[derive(Default)]
struct Shared {
    positions: Vec<[f32; 3]>,
    /// As many as positions, or none.
    normals: Vec<[f32; 3]>,
}

impl Reader {
    /// Reads the rows of an element.
    fn element(&mut self, element: &Element, numbers: &mut Numbers<'_>) -> Result<(), Unreadable> {
        if element.properties.is_empty() {
            return Ok(());
        }
        let place = |names: &[&str]| element.place(names);
        let point = [place(&["x"]), place(&["y"]), place(&["z"])];
        let normal = [place(&["nx"]), place(&["ny"]), place(&["nz"])];
        let uv = [place(&["s", "u", "texture_u"]), place(&["t", "v", "texture_v"])];
        let indices = place(&["vertex_indices", "vertex_index"]);
        let corner_uvs = place(&["texcoord"]);
        // The vertices that faces name, without those created for texture coordinates of corners.
        let shared = match (element.name.as_str(), corner_uvs) {
            ("face", Some(_)) => Shared {
                positions: std::mem::take(&mut self.part.positions),
                normals: std::mem::take(&mut self.part.normals),
            },
            _ => Shared::default(),
        };
        let mut row: Vec<Vec<f64>> = element.properties.iter().map(|_| Vec::new()).collect();
        for _ in 0..element.count {
            numbers.row(element, &mut row)?;
            let wrong = |what: String| Unreadable { line: numbers.text_line(), what };
            let first = |place: Option<usize>| place.and_then(|place| row[place].first()).copied();
            match element.name.as_str() {
                "vertex" => match point.map(first) {
                    [Some(x), Some(y), Some(z)] => {
                        self.part.positions.push([x as f32, y as f32, z as f32]);
                        if let [Some(x), Some(y), Some(z)] = normal.map(first) {
                            self.part.normals.push([x as f32, y as f32, z as f32]);
                        }
                        if let [Some(u), Some(v)] = uv.map(first) {
                            self.part.uvs.push([u as f32, v as f32]);
                        }
                    }
                    _ => return Err("its vertices have no x, y and z".into()),
                },
                "face" => {
                    let Some(corners) = indices.map(|place| &row[place]) else {
                        return Err("its faces have no vertex_indices".into());
                    };
                    self.has_short_faces |= corners.len() < 3;
                    match corner_uvs.map(|place| &row[place]) {
                        Some(uvs) => self.separate_face(corners, uvs, &shared).map_err(wrong)?,
                        None => self.face(corners).map_err(wrong)?,
                    }
                }
                "tristrips" => {
                    for strip in indices.map_or(&[][..], |place| &row[place]).split(|index| *index == -1.0) {
                        for (at, corners) in strip.windows(3).enumerate() {
                            let [a, b, c] = [corners[0], corners[1], corners[2]];
                            // Every second triangle of a strip has the opposite winding.
                            self.face(&if at % 2 == 0 { [a, b, c] } else { [b, a, c] }).map_err(wrong)?;
                        }
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Divides a face into triangles.
    ///
    /// # Errors
    /// If the face names a vertex that does not exist.
    fn face(&mut self, corners: &[f64]) -> Result<(), String> {
        let (indices, points) = points(corners, &self.part.positions)?;
        let cut = self.cutter.cut(&points, &[]);
        self.part
            .triangles
            .extend(cut.iter().map(|triangle| triangle.map(|corner| indices[corner as usize])));
        Ok(())
    }

    /// Divides a face whose corners have their own texture coordinates.
    fn separate_face(&mut self, corners: &[f64], uvs: &[f64], shared: &Shared) -> Result<(), String> {
        let (indices, points) = points(corners, &shared.positions)?;
        let first = self.part.positions.len() as u32;
        self.part.positions.extend(indices.iter().map(|index| shared.positions[*index as usize]));
        let normals = indices.iter().filter_map(|index| shared.normals.get(*index as usize));
        self.part.normals.extend(normals);
        let uv = |corner: usize| {
            uvs.get(2 * corner..2 * corner + 2).map_or([0.0; 2], |uv| [uv[0] as f32, uv[1] as f32])
        };
        self.corner_uvs.extend((0..corners.len()).map(uv));
        let cut = self.cutter.cut(&points, &[]);
        self.part.triangles.extend(cut.iter().map(|triangle| triangle.map(|corner| first + corner)));
        Ok(())
    }
}

/// Returns the vertices that a face names, and their positions.
fn points(corners: &[f64], positions: &[[f32; 3]]) -> Result<(Vec<u32>, Vec<DVec3>), String> {
    let mut found = (Vec::with_capacity(corners.len()), Vec::with_capacity(corners.len()));
    for &corner in corners {
        let position = (corner >= 0.0).then(|| positions.get(corner as usize)).flatten();
        let Some(position) = position else {
            return Err(format!("a face names vertex {corner}, but there are {}", positions.len()));
        };
        found.0.push(corner as u32);
        found.1.push(Vec3::from(*position).as_dvec3());
    }
    Ok(found)
}

/// The numbers after a header.
struct Numbers<'a> {
    form: Form,
    rest: &'a [u8],
    line: u32,
    /// The remaining words of a line of text, the last first.
    words: Vec<&'a str>,
}

impl Numbers<'_> {
    /// Returns the number of the current line, if the file has lines.
    fn text_line(&self) -> Option<u32> {
        (self.form == Form::Text).then_some(self.line)
    }

    /// Reads the properties of one entry.
    fn row(&mut self, element: &Element, row: &mut [Vec<f64>]) -> Result<(), Unreadable> {
        for (property, values) in element.properties.iter().zip(row) {
            values.clear();
            let length = match property.length {
                None => 1,
                Some(length) => match self.next(length)? {
                    length if length >= 0.0 => length as usize,
                    length => {
                        let what = format!("a list has {length} entries");
                        return Err(Unreadable { line: self.text_line(), what });
                    }
                },
            };
            for _ in 0..length {
                values.push(self.next(property.number)?);
            }
        }
        Ok(())
    }

    fn next(&mut self, number: Number) -> Result<f64, Unreadable> {
        if self.form == Form::Text {
            return self.word();
        }
        let Some((bytes, rest)) = self.rest.split_at_checked(number.size()) else {
            return Err("the file ends before its last element".into());
        };
        self.rest = rest;
        // Convert to big endian, with padding after the bytes of a shorter number.
        let mut all = [0; 8];
        all[..bytes.len()].copy_from_slice(bytes);
        if self.form == Form::LittleEndian {
            all[..bytes.len()].reverse();
        }
        let [a, b, c, d, ..] = all;
        Ok(match number {
            Number::I8 => f64::from(a.cast_signed()),
            Number::U8 => f64::from(a),
            Number::I16 => f64::from(i16::from_be_bytes([a, b])),
            Number::U16 => f64::from(u16::from_be_bytes([a, b])),
            Number::I32 => f64::from(i32::from_be_bytes([a, b, c, d])),
            Number::U32 => f64::from(u32::from_be_bytes([a, b, c, d])),
            Number::F32 => f64::from(f32::from_be_bytes([a, b, c, d])),
            Number::F64 => f64::from_be_bytes(all),
        })
    }

    fn word(&mut self) -> Result<f64, Unreadable> {
        while self.words.is_empty() {
            if self.rest.is_empty() {
                return Err(Unreadable::at(self.line, "the file ends before its last element"));
            }
            let end = self.rest.iter().position(|byte| *byte == b'\n').map_or(self.rest.len(), |end| end + 1);
            let (line, rest) = self.rest.split_at(end);
            self.rest = rest;
            self.line += 1;
            let line = std::str::from_utf8(line).map_err(|_| Unreadable::at(self.line, "it is not text"))?;
            self.words.extend(line.split_whitespace().rev());
        }
        let word = self.words.pop().unwrap_or_default();
        word.parse().map_err(|_| Unreadable::at(self.line, format!("'{word}' is not a number")))
    }
}
