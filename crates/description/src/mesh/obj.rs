//! Wavefront OBJ: polygons with their groups, objects and materials.

mod material;

use super::faces::{Cutter, SHORT_FACE};
use super::normals::MISSING;
use super::part::{Part, Unreadable, text};
use crate::diagnostics::{Diagnostics, Source};
use crate::file;
use crate::model::Material;
use glam::{DVec3, Vec3};
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The name of a group without a name.
const DEFAULT: &str = "default";

/// Reads a file. Each sequence of faces with the same group, object and material becomes a part.
pub(super) fn parse(
    bytes: &[u8],
    path: &Path,
    diagnostics: &mut Diagnostics,
) -> Result<Vec<Part>, Unreadable> {
    let text = text(bytes);
    let mut reader = Reader::new(path, diagnostics);
    for (line, statement) in statements(&text) {
        reader.line = line;
        reader.statement(&statement).map_err(|what| Unreadable::at(line, what))?;
    }
    Ok(reader.parts)
}

/// Splits a file into statements with the numbers of their first lines. A line that ends with `\` continues on the
/// next.
fn statements(text: &str) -> impl Iterator<Item = (u32, Cow<'_, str>)> {
    let mut lines = (1..).zip(text.lines());
    std::iter::from_fn(move || {
        let (number, line) = lines.next()?;
        let mut line = line.trim();
        if !line.ends_with('\\') {
            return Some((number, Cow::Borrowed(line)));
        }
        let mut statement = String::new();
        while let Some(begin) = line.strip_suffix('\\') {
            statement.push_str(begin);
            statement.push(' ');
            line = lines.next().map_or("", |(_, line)| line.trim());
        }
        statement.push_str(line);
        Some((number, Cow::Owned(statement)))
    })
}

struct Reader<'a> {
    path: &'a Path,
    diagnostics: &'a mut Diagnostics,
    line: u32,
    positions: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    object: Arc<str>,
    group: Arc<str>,
    material: String,
    /// The materials of the libraries, as far as they are given.
    materials: HashMap<String, Option<Material>>,
    /// The libraries that were read.
    libraries: HashSet<PathBuf>,
    /// True if a library is missing, for which there was a warning.
    lacks_library: bool,
    /// The keys of the warnings so far.
    warned: HashSet<String>,
    parts: Vec<Part>,
    /// The vertices of the last part, by the indices of their position and, plus 1, of their texture coordinates and of
    /// their normal.
    vertices: HashMap<(u32, u32, u32), u32>,
    /// True if further faces belong to the last part.
    is_open: bool,
    cutter: Cutter,
    face: Vec<(u32, u32, u32)>,
    corners: Vec<DVec3>,
}

impl<'a> Reader<'a> {
    fn new(path: &'a Path, diagnostics: &'a mut Diagnostics) -> Self {
        Self {
            path,
            diagnostics,
            line: 0,
            positions: Vec::new(),
            uvs: Vec::new(),
            normals: Vec::new(),
            object: Arc::default(),
            group: Arc::default(),
            material: String::new(),
            materials: HashMap::new(),
            libraries: HashSet::new(),
            lacks_library: false,
            warned: HashSet::new(),
            parts: Vec::new(),
            vertices: HashMap::new(),
            is_open: false,
            cutter: Cutter::default(),
            face: Vec::new(),
            corners: Vec::new(),
        }
    }

    /// Reads a statement.
    ///
    /// # Errors
    /// A description of the error.
    fn statement(&mut self, statement: &str) -> Result<(), String> {
        let (keyword, rest) = statement.split_once(char::is_whitespace).unwrap_or((statement, ""));
        let rest = rest.trim();
        match keyword {
            "v" => self.vertex(rest)?,
            "vt" => {
                let ([u, v, _], _) = numbers(rest, 1)?;
                self.uvs.push([u, v]);
            }
            // A damaged normal leaves its faces flat.
            "vn" => self.normals.push(numbers(rest, 3).map_or(MISSING, |(normal, _)| normal)),
            "f" | "fo" => self.face(rest)?,
            "g" => {
                self.group = rest.into();
                self.is_open = false;
            }
            "o" => {
                self.object = rest.into();
                self.group = Arc::default();
                self.is_open = false;
            }
            "usemtl" if rest != self.material => {
                rest.clone_into(&mut self.material);
                self.is_open = false;
            }
            "mtllib" => self.library(rest),
            "surf" => self.warn("surf", "free-form surfaces are left out", "export polygons"),
            _ => {}
        }
        Ok(())
    }

    /// Adds a warning about the current statement, once for each `key`.
    fn warn(&mut self, key: &str, what: &str, remedy: impl Into<String>) {
        if self.warned.insert(key.to_owned()) {
            self.diagnostics.warning(&Source::new(self.path, self.line), what, remedy);
        }
    }

    fn vertex(&mut self, rest: &str) -> Result<(), String> {
        let (mut point, more) = numbers(rest, 3)?;
        match more.len() {
            // The fourth number is a weight.
            1 if more[0] != 0.0 => point = (Vec3::from(point) / more[0]).to_array(),
            1 => return Err("the weight of the vertex is 0".into()),
            _ => {}
        }
        self.positions.push(point);
        Ok(())
    }

    fn face(&mut self, rest: &str) -> Result<(), String> {
        self.face.clear();
        self.corners.clear();
        for word in rest.split_whitespace().take_while(|word| !word.starts_with('#')) {
            let mut indices = word.split('/');
            let vertex = index(indices.next().unwrap_or_default(), self.positions.len(), "vertex")?;
            let uv = match indices.next().unwrap_or_default() {
                "" => 0,
                uv => index(uv, self.uvs.len(), "texture coordinate")? + 1,
            };
            let normal = index(indices.next().unwrap_or_default(), self.normals.len(), "normal");
            self.face.push((vertex, uv, normal.map_or(0, |normal| normal + 1)));
            self.corners.push(Vec3::from(self.positions[vertex as usize]).as_dvec3());
        }
        if self.face.len() < 3 {
            self.warn("f", &format!("{SHORT_FACE}: it is left out"), "export the mesh again");
            return Ok(());
        }
        if !self.is_open {
            self.open();
        }
        let Some(part) = self.parts.last_mut() else { return Ok(()) };
        for triangle in self.cutter.cut(&self.corners, &[]) {
            let triangle = triangle.map(|corner| {
                let (vertex, uv, normal) = self.face[corner as usize];
                *self.vertices.entry((vertex, uv, normal)).or_insert_with(|| {
                    // If a part has texture coordinates, each of its vertices has them.
                    if uv != 0 {
                        part.uvs.resize(part.positions.len(), [0.0; 2]);
                        part.uvs.push(self.uvs[uv as usize - 1]);
                    }
                    if normal != 0 {
                        part.normals.resize(part.positions.len(), MISSING);
                        part.normals.push(self.normals[normal as usize - 1]);
                    }
                    part.positions.push(self.positions[vertex as usize]);
                    part.positions.len() as u32 - 1
                })
            });
            part.triangles.push(triangle);
        }
        if !part.uvs.is_empty() {
            part.uvs.resize(part.positions.len(), [0.0; 2]);
        }
        if !part.normals.is_empty() {
            part.normals.resize(part.positions.len(), MISSING);
        }
        Ok(())
    }

    /// Begins a part.
    fn open(&mut self) {
        self.is_open = true;
        self.vertices.clear();
        let mut names = [&self.group, &self.object].into_iter().filter(|name| !name.is_empty()).cloned();
        let name = names.next().unwrap_or_else(|| DEFAULT.into());
        let aliases = names.collect();
        let material = self.materials.get(&self.material).cloned();
        if material.is_none() && !self.material.is_empty() && !self.lacks_library {
            let known = self.materials.keys().map(String::as_str);
            let remedy =
                self.diagnostics.did_you_mean_or(&self.material, known, "name its library in mtllib");
            let what = format!("the material '{}' is not defined: its faces have no colour", self.material);
            self.warn(&format!("usemtl {}", self.material), &what, remedy);
        }
        self.parts.push(Part { name, aliases, material: material.flatten(), ..Part::default() });
    }

    /// Reads libraries of materials. `names` is one name with spaces, if there is such a file, and otherwise a list of
    /// names.
    fn library(&mut self, names: &str) {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let whole = folder.join(names.replace('\\', "/"));
        let files = if whole.is_file() {
            vec![whole]
        } else {
            names.split_whitespace().map(|name| folder.join(name.replace('\\', "/"))).collect()
        };
        for path in files {
            if !self.libraries.insert(path.clone()) {
                continue;
            }
            self.diagnostics.opened(&path);
            match file::read(&path) {
                // The first material with a name is used.
                Ok(bytes) => {
                    for (name, look) in material::parse(&text(&bytes), path.parent().unwrap_or(folder)) {
                        self.materials.entry(name).or_insert_with(|| look.material());
                    }
                }
                Err(error) => {
                    self.lacks_library = true;
                    let what = format!(
                        "the materials in {} cannot be read: {error}: faces have no colour",
                        path.display()
                    );
                    self.warn(names, &what, "put the file beside the mesh, or remove mtllib");
                }
            }
        }
    }
}

/// Reads three numbers, of which the first `required` are mandatory and the others default to 0, and all further
/// numbers.
fn numbers(rest: &str, required: usize) -> Result<([f32; 3], Vec<f32>), String> {
    let (mut three, mut more, mut count) = ([0.0; 3], Vec::new(), 0);
    for word in rest.split_whitespace().take_while(|word| !word.starts_with('#')) {
        let number = word.parse().map_err(|_| format!("'{word}' is not a number"))?;
        match three.get_mut(count) {
            Some(place) => *place = number,
            None => more.push(number),
        }
        count += 1;
    }
    if count < required {
        return Err(format!("there are {count} numbers, but {required} are needed"));
    }
    Ok((three, more))
}

/// Returns the position in a list for an index of a face, which counts from 1, or backwards from the end.
fn index(word: &str, length: usize, what: &str) -> Result<u32, String> {
    let index: i64 = word.parse().map_err(|_| format!("'{word}' is not the number of a {what}"))?;
    let place = if index < 0 { index + length as i64 } else { index - 1 };
    match usize::try_from(place) {
        Ok(place) if place < length && index != 0 => Ok(place as u32),
        _ => Err(format!("the face names {what} {index}, but there are {length}")),
    }
}
