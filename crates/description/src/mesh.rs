//! Triangle meshes from files: STL, Wavefront OBJ and Collada.
//!
//! STL and OBJ are read by the crate `mesh-loader`, and taken as they are: metres, z up. Collada says its unit and its
//! up axis, and is read by the module `collada`: `mesh-loader` keeps one instance of each geometry, and panics on an
//! index out of range.

mod collada;
mod obj;

use super::diagnostics::{Diagnostics, Source};
use super::model::{Material, Mesh};
use super::suggestion::did_you_mean;
use belvedere_sensors::scene::{MAX_SHININESS, TextureAlpha};
use glam::{DVec3, Vec3};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The formats that are read, for error messages.
pub const MESH_FORMATS: &str = "stl, obj, dae (Collada)";

/// What becomes of Collada's `<up_axis>`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum UpAxis {
    /// Nothing: the numbers are taken as they stand, as Gazebo and rviz do, and as their models are made for.
    #[default]
    Ignored,
    /// The mesh is turned so that the file's up is z, as the standard says.
    Applied,
}

/// A part of a file that stands for the whole: `<submesh>` of SDF.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Submesh {
    /// What the file calls it: a node or a geometry of Collada, a group of OBJ.
    pub name: String,
    /// Whether the middle of its box comes to the origin.
    pub is_centred: bool,
}

/// Triangles of one material as a file gives them.
#[derive(Debug, Default)]
struct Part {
    /// Name in the file, for errors.
    name: String,
    /// What else the file calls it.
    aliases: Vec<String>,
    positions: Vec<[f32; 3]>,
    /// As many as positions, or none.
    uvs: Vec<[f32; 2]>,
    triangles: Vec<[u32; 3]>,
    material: Option<Material>,
}

/// Loads a mesh (STL, Collada, OBJ) and applies `up_axis` and `scale`. `source` is where the description asks for it.
///
/// If the file has several materials, that of most triangles stands for all: see [`load_mesh_parts`].
///
/// # Errors
/// Adds one error to `diagnostics` and returns none if the file cannot be read, is broken, or holds no triangles.
pub fn load_mesh(
    path: &Path,
    scale: DVec3,
    up_axis: UpAxis,
    source: &Source,
    diagnostics: &mut Diagnostics,
) -> Option<Arc<Mesh>> {
    merge_parts(&load_mesh_parts(path, None, scale, up_axis, source, diagnostics)?)
}

/// Like [`load_mesh`], with a mesh for each material; of `submesh` alone, if one is given.
///
/// # Errors
/// As [`load_mesh`], and if the file has no such part.
pub fn load_mesh_parts(
    path: &Path,
    submesh: Option<&Submesh>,
    scale: DVec3,
    up_axis: UpAxis,
    source: &Source,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Arc<Mesh>>> {
    if !(scale.is_finite() && scale.x * scale.y * scale.z != 0.0) {
        diagnostics.error(
            source,
            format!("the scale of the mesh {} is '{scale}'", path.display()),
            "write three finite numbers other than 0",
        );
        return None;
    }
    diagnostics.opened(path);
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let mut parts = match extension.to_ascii_lowercase().as_str() {
        "dae" => collada::load(path, up_axis, diagnostics)?,
        "stl" | "obj" => match mesh_loader::Loader::default()
            .load_with_reader(path, |file| obj_or_stl(file, diagnostics))
        {
            Ok(scene) => scene.meshes.into_iter().zip(scene.materials).map(from_scene).collect(),
            Err(error) => {
                diagnostics.error(
                    source,
                    format!("the mesh {} cannot be read: {error}", path.display()),
                    "check the file, or export it again",
                );
                return None;
            }
        },
        _ => {
            diagnostics.error(
                source,
                format!("the mesh {} is of a kind that is not read", path.display()),
                format!("convert it to one of {MESH_FORMATS}"),
            );
            return None;
        }
    };
    if let Some(submesh) = submesh {
        parts = select(parts, submesh, path, source, diagnostics)?;
    }
    let mut meshes: Vec<Mesh> = Vec::new();
    for mut part in parts {
        check_texture(&mut part, path, source, diagnostics);
        let mesh = finish(part, path, scale, source, diagnostics)?;
        if mesh.triangles.is_empty() {
            continue;
        }
        match meshes.iter_mut().find(|other| other.material == mesh.material) {
            Some(other) => append(other, &mesh),
            None => meshes.push(mesh),
        }
    }
    if meshes.is_empty() {
        diagnostics.error(
            source,
            format!("the mesh {} holds no triangles", path.display()),
            "export it with its faces",
        );
        return None;
    }
    Some(meshes.into_iter().map(Arc::new).collect())
}

/// The parts that a submesh means; none after an error.
fn select(
    parts: Vec<Part>,
    submesh: &Submesh,
    path: &Path,
    source: &Source,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Part>> {
    let names = |part: &Part| std::iter::once(&part.name).chain(&part.aliases).cloned().collect::<Vec<_>>();
    let known: Vec<String> = parts.iter().flat_map(names).filter(|name| !name.is_empty()).collect();
    let mut chosen: Vec<Part> =
        parts.into_iter().filter(|part| names(part).contains(&submesh.name)).collect();
    if chosen.is_empty() {
        let meant = did_you_mean(&submesh.name, known.iter().map(String::as_str));
        diagnostics.error(
            source,
            format!("the mesh {} has no part '{}'", path.display(), submesh.name),
            meant.unwrap_or_else(|| "correct <submesh>, or take it out for the whole mesh".into()),
        );
        return None;
    }
    if submesh.is_centred {
        let points = || chosen.iter().flat_map(|part| &part.positions).map(|point| Vec3::from(*point));
        let low = points().fold(Vec3::INFINITY, Vec3::min);
        let middle = (low + points().fold(Vec3::NEG_INFINITY, Vec3::max)) * 0.5;
        for point in chosen.iter_mut().flat_map(|part| &mut part.positions) {
            *point = (Vec3::from(*point) - middle).to_array();
        }
    }
    Some(chosen)
}

/// All parts as one mesh, with the material of most triangles.
pub fn merge_parts(parts: &[Arc<Mesh>]) -> Option<Arc<Mesh>> {
    if let [only] = parts {
        return Some(only.clone());
    }
    let largest = parts.iter().max_by_key(|part| part.triangles.len())?;
    let mut merged = Mesh {
        path: largest.path.clone(),
        positions: Vec::new(),
        uvs: Vec::new(),
        triangles: Vec::new(),
        material: largest.material.clone(),
    };
    for part in parts {
        append(&mut merged, part);
    }
    Some(Arc::new(merged))
}

/// Appends triangles. Texture coordinates are filled up with zeros where only one side has them.
fn append(mesh: &mut Mesh, more: &Mesh) {
    let first = mesh.positions.len() as u32;
    if !more.uvs.is_empty() || !mesh.uvs.is_empty() {
        mesh.uvs.resize(mesh.positions.len(), [0.0; 2]);
        mesh.uvs.extend(&more.uvs);
        mesh.uvs.resize(mesh.positions.len() + more.positions.len(), [0.0; 2]);
    }
    mesh.positions.extend(&more.positions);
    mesh.triangles.extend(more.triangles.iter().map(|triangle| triangle.map(|index| index + first)));
}

/// A mesh of `mesh-loader` with its material.
fn from_scene((mesh, material): (mesh_loader::Mesh, mesh_loader::Material)) -> Part {
    let [uvs, _] = mesh.texcoords;
    let rgb = |[r, g, b, _]: [f32; 4]| [r, g, b];
    let texture: Option<PathBuf> = material.texture.diffuse;
    let look = Look {
        diffuse: if texture.is_some() { Some([1.0; 3]) } else { material.color.diffuse.map(rgb) },
        emissive: material.color.emissive.map(rgb),
        specular: material.color.specular.map(rgb),
        shininess: material.shininess,
        alpha: material.opacity,
        texture_alpha: TextureAlpha::Ignored,
        texture,
    };
    Part {
        name: mesh.name,
        aliases: Vec::new(),
        uvs: if uvs.len() == mesh.vertices.len() { uvs } else { Vec::new() },
        positions: mesh.vertices,
        triangles: mesh.faces,
        material: look.material(),
    }
}

/// A file's look, as far as it says.
#[derive(Default)]
struct Look {
    diffuse: Option<[f32; 3]>,
    emissive: Option<[f32; 3]>,
    specular: Option<[f32; 3]>,
    shininess: Option<f32>,
    alpha: Option<f32>,
    texture_alpha: TextureAlpha,
    texture: Option<PathBuf>,
}

impl Look {
    /// Exporters leave the ambient colour black or at odds with the diffuse one, so the diffuse colour stands for both.
    /// What is beyond its range counts as its end.
    fn material(self) -> Option<Material> {
        let diffuse = self.diffuse.or(self.texture.is_some().then_some([1.0; 3]))?;
        let within = |value: f32, most: f32| if value.is_nan() { 0.0 } else { value.clamp(0.0, most) };
        Some(Material {
            diffuse,
            ambient: diffuse,
            emissive: self.emissive.unwrap_or([0.0; 3]),
            specular: self.specular.unwrap_or([0.0; 3]),
            shininess: within(self.shininess.unwrap_or(0.0), MAX_SHININESS),
            alpha: within(self.alpha.unwrap_or(1.0), 1.0),
            texture_alpha: self.texture_alpha,
            texture: self.texture,
            normal_map: None,
            texture_repeat: [1.0; 2],
        })
    }
}

/// Reads a file for `mesh-loader`.
fn obj_or_stl(path: &Path, diagnostics: &mut Diagnostics) -> std::io::Result<Vec<u8>> {
    // The materials that an OBJ names as well.
    diagnostics.opened(path);
    let is_stl = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("stl"));
    if !is_stl {
        return obj::read(path);
    }
    let mut bytes = std::fs::read(path)?;
    if is_binary_stl(&bytes) {
        // Some headers begin with the word by which text is known.
        bytes[..STL_HEADER].fill(0);
    }
    Ok(bytes)
}

/// Bytes of a binary STL before the number of its triangles.
const STL_HEADER: usize = 80;

/// Whether an STL is as long as its number of triangles says.
fn is_binary_stl(bytes: &[u8]) -> bool {
    let count = bytes.get(STL_HEADER..).and_then(<[u8]>::first_chunk);
    count.is_some_and(|count| {
        bytes.len() as u64 == STL_HEADER as u64 + 4 + 50 * u64::from(u32::from_le_bytes(*count))
    })
}

/// The picture that a mesh in `folder` names: there, or in the `materials/textures` of its model, where Gazebo looks
/// too. Folders of the machine that the mesh was made on are left off.
pub fn find_texture(name: &str, folder: &Path) -> Option<PathBuf> {
    let name = name.replace('\\', "/");
    let file = name.rsplit('/').next().filter(|file| !file.is_empty())?;
    let model = folder.ancestors().take(4).map(|above| above.join("materials/textures"));
    let places: Vec<PathBuf> = std::iter::once(folder.to_path_buf()).chain(model).collect();
    let found = |name: &str| places.iter().map(|place| place.join(name)).find(|path| path.is_file());
    found(&name).or_else(|| found(file))
}

/// Finds the picture that a mesh names. Without it the mesh is drawn in its colour, as in Gazebo.
fn check_texture(part: &mut Part, path: &Path, source: &Source, diagnostics: &mut Diagnostics) {
    let Some(texture) = part.material.as_mut().and_then(|material| material.texture.as_mut()) else { return };
    let folder = path.parent().unwrap_or(Path::new(""));
    if let Some(found) = find_texture(&texture.to_string_lossy(), folder) {
        *texture = found;
        return;
    }
    let what = format!(
        "there is no texture {}, which the mesh {} names: it is drawn in one colour",
        texture.display(),
        path.display()
    );
    let remedy = "put it beside the mesh, or into materials/textures of its model";
    diagnostics.warning(source, what, remedy);
    if let Some(material) = &mut part.material {
        material.texture = None;
    }
}

/// Checks every number, applies the scale, and leaves out triangles without area.
fn finish(
    part: Part,
    path: &Path,
    scale: DVec3,
    source: &Source,
    diagnostics: &mut Diagnostics,
) -> Option<Mesh> {
    let Part { name, mut positions, mut uvs, mut triangles, material, .. } = part;
    let mut fail = |what: String| {
        let name = if name.is_empty() { String::new() } else { format!(" of '{name}'") };
        diagnostics.error(source, format!("the mesh {}: {what}{name}", path.display()), "export it again");
        None
    };
    for (index, position) in positions.iter_mut().enumerate() {
        *position = (Vec3::from(*position).as_dvec3() * scale).as_vec3().to_array();
        if !position.iter().all(|value| value.is_finite()) {
            return fail(format!("vertex {index} is not finite"));
        }
    }
    if uvs.iter().flatten().any(|value| !value.is_finite()) {
        return fail("a texture coordinate is not finite".into());
    }
    if uvs.len() != positions.len() {
        uvs.clear();
    }
    if let Some((index, _)) = triangles
        .iter()
        .enumerate()
        .find(|(_, triangle)| triangle.iter().any(|vertex| *vertex as usize >= positions.len()))
    {
        return fail(format!("triangle {index} names a vertex that is not there"));
    }
    triangles.retain(|triangle| {
        let [a, b, c] = triangle.map(|vertex| Vec3::from(positions[vertex as usize]).as_dvec3());
        (b - a).cross(c - a) != DVec3::ZERO
    });
    // A mirror turns the outside in.
    if scale.x * scale.y * scale.z < 0.0 {
        for triangle in &mut triangles {
            triangle.swap(1, 2);
        }
    }
    Some(Mesh { path: path.to_path_buf(), positions, uvs, triangles, material })
}
