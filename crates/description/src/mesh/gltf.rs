//! glTF 2.0 (`.gltf` and `.glb`): the triangles of the scene, and their materials.
//!
//! The parser supports nodes with all their transforms, triangles, strips and fans, sparse accessors, and numbers of
//! any type. Skins are in their rest pose; morph targets are not applied. If a file requires an extension that is not
//! supported, that is an error.
//!
//! In glTF, y is up. Gazebo uses the coordinates unchanged, so that a model's y becomes the link's y. [`parse`] does
//! the same; [`parse_upright`] rotates y to z.

mod accessor;
mod container;
mod look;
mod means;
pub(crate) mod picture;
mod skin;

use super::normals;
use super::part::{Part, Unreadable};
use crate::budget::Budget;
use crate::diagnostics::{Diagnostics, Source};
use accessor::{Accessors, Table};
use container::{Container, unsupported};
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};
use look::{numbers, surface};
use means::Means;
use serde_json::Value;
use skin::{Bound, Skin, affine};
use std::collections::{BTreeSet, HashMap};
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;

/// Reads a file with unchanged coordinates.
pub(super) fn parse(
    bytes: &[u8],
    path: &Path,
    diagnostics: &mut Diagnostics,
) -> Result<Vec<Part>, Unreadable> {
    read(bytes, path, DMat3::IDENTITY, diagnostics)
}

/// Reads a file and rotates its up axis, y, to z.
pub(super) fn parse_upright(
    bytes: &[u8],
    path: &Path,
    diagnostics: &mut Diagnostics,
) -> Result<Vec<Part>, Unreadable> {
    // The columns are the images of the file's x, y and z axes.
    read(bytes, path, DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y), diagnostics)
}

fn read(
    bytes: &[u8],
    path: &Path,
    turn: DMat3,
    diagnostics: &mut Diagnostics,
) -> Result<Vec<Part>, Unreadable> {
    let container = Container::open(bytes, path)?;
    for buffer in container.json["buffers"].as_array().into_iter().flatten() {
        if let Some(uri) = buffer["uri"].as_str().filter(|uri| !uri.contains(':')) {
            diagnostics.opened(&container.beside(uri));
        }
    }
    let mut scene = Scene {
        container: &container,
        accessors: Accessors::new(&container),
        budget: Budget::default(),
        poses: Vec::new(),
        placed: Vec::new(),
        skins: HashMap::new(),
        parts: Vec::new(),
        left_out: BTreeSet::new(),
        posed: BTreeSet::new(),
        means: Means::new(),
    };
    scene.read(DAffine3::from_mat3(turn))?;
    let whole = Source::new(path, 0);
    for what in &scene.posed {
        diagnostics.warning(&whole, format!("the mesh {} has {what}", path.display()), "");
    }
    if !scene.left_out.is_empty() {
        let list: Vec<&str> = scene.left_out.iter().map(String::as_str).collect();
        let what = format!("parts of the mesh {} are not drawn: {}", path.display(), list.join(", "));
        diagnostics.note(&whole, what, "");
    }
    Ok(scene.parts)
}

/// What the budget counts for each primitive of each node, in bytes: primitives take time, even those without triangles.
const PRIMITIVE: usize = 64;

struct Scene<'a> {
    container: &'a Container<'a>,
    accessors: Accessors<'a>,
    budget: Budget,
    /// The pose of each node of the scene.
    poses: Vec<DAffine3>,
    /// The nodes with a mesh, in order, with their name, or that of the nearest ancestor with a name.
    placed: Vec<(&'a Value, &'a str, DAffine3)>,
    /// The skins that have been read, by their numbers.
    skins: HashMap<u64, Rc<Skin>>,
    parts: Vec<Part>,
    /// Features that are not drawn.
    left_out: BTreeSet<String>,
    /// Features that could be animated, and are not.
    posed: BTreeSet<&'static str>,
    means: Means,
}

impl<'a> Scene<'a> {
    fn read(&mut self, scene_from_root: DAffine3) -> Result<(), String> {
        let json = &self.container.json;
        let nodes = json["nodes"].as_array().map_or(0, Vec::len);
        self.poses = vec![scene_from_root; nodes];
        let scene = if json["scene"].is_null() {
            &json["scenes"][0]
        } else {
            self.container.entry("scenes", &json["scene"])?
        };
        if scene.is_null() {
            // Without a scene, the nodes that are not below any other.
            let lists = json["nodes"].as_array().into_iter().flatten();
            let below: BTreeSet<u64> = lists
                .filter_map(|node| node["children"].as_array())
                .flatten()
                .filter_map(Value::as_u64)
                .collect();
            for root in (0..nodes as u64).filter(|root| !below.contains(root)) {
                self.node(&root.into(), scene_from_root, "")?;
            }
        } else {
            for root in scene["nodes"].as_array().into_iter().flatten() {
                self.node(root, scene_from_root, "")?;
            }
        }
        // A skin needs the poses of all nodes, so meshes are read after all nodes.
        for (node, name, scene_from_node) in std::mem::take(&mut self.placed) {
            self.mesh(node, name, scene_from_node)?;
        }
        Ok(())
    }

    fn node(&mut self, index: &Value, scene_from_parent: DAffine3, above: &'a str) -> Result<(), String> {
        let spent = self.budget.take(1, 0).and_then(|()| self.budget.enter(1));
        spent.map_err(|spent| spent.to_string())?;
        let node = self.container.entry("nodes", index)?;
        let scene_from_node = scene_from_parent * transform(node);
        if !scene_from_node.is_finite() {
            return Err(format!("the transform of node {index} is not finite"));
        }
        let at = index.as_u64().unwrap_or_default() as usize;
        self.poses[at] = scene_from_node;
        let name = node["name"].as_str().unwrap_or(above);
        if !node["mesh"].is_null() {
            self.placed.push((node, name, scene_from_node));
        }
        for child in node["children"].as_array().into_iter().flatten() {
            self.node(child, scene_from_node, name)?;
        }
        self.budget.leave(1);
        Ok(())
    }

    fn mesh(&mut self, node: &'a Value, name: &str, scene_from_node: DAffine3) -> Result<(), String> {
        let mesh = self.container.entry("meshes", &node["mesh"])?;
        let skin = match &node["skin"] {
            Value::Null => None,
            index => {
                self.posed.insert("a skin, which stays in its rest pose");
                Some(self.skin(index)?)
            }
        };
        let title: Arc<str> = mesh["name"].as_str().unwrap_or_default().into();
        let name = if name.is_empty() { title.clone() } else { name.into() };
        for primitive in mesh["primitives"].as_array().into_iter().flatten() {
            self.budget.take(0, PRIMITIVE).map_err(|spent| spent.to_string())?;
            let part = self.primitive(primitive, skin.as_deref(), scene_from_node);
            let Some(mut part) = part.map_err(|what| format!("mesh '{title}': {what}"))? else { continue };
            part.name = name.clone();
            part.aliases.push(title.clone());
            let bytes = size_of_val(&part.positions[..]) + size_of_val(&part.triangles[..]);
            let bytes = bytes + size_of_val(&part) + part.strings_len();
            self.budget.take(0, bytes).map_err(|spent| spent.to_string())?;
            self.parts.push(part);
        }
        Ok(())
    }

    /// Returns a skin, which is read only once: many nodes may have the same.
    fn skin(&mut self, index: &Value) -> Result<Rc<Skin>, String> {
        if let Some(known) = index.as_u64().and_then(|index| self.skins.get(&index)) {
            return Ok(known.clone());
        }
        let skin = Rc::new(Skin::read(self.container, &self.accessors, index, &self.poses)?);
        self.skins.extend(index.as_u64().map(|index| (index, skin.clone())));
        Ok(skin)
    }

    /// Reads a primitive; `None` if it has no triangles.
    fn primitive(
        &mut self,
        primitive: &Value,
        skin: Option<&Skin>,
        scene_from_node: DAffine3,
    ) -> Result<Option<Part>, String> {
        let mode = primitive["mode"].as_u64().unwrap_or(TRIANGLES);
        if !(TRIANGLES..=FAN).contains(&mode) {
            self.left_out.insert("points and lines".into());
            return Ok(None);
        }
        let attributes = &primitive["attributes"];
        if attributes["POSITION"].is_null() {
            return Err("a primitive has no POSITION".into());
        }
        let draco = "KHR_draco_mesh_compression";
        let position = self.container.entry("accessors", &attributes["POSITION"])?;
        if !primitive["extensions"][draco].is_null() && position["bufferView"].is_null() {
            return Err(unsupported(draco));
        }
        if !primitive["targets"].is_null() {
            self.posed.insert("morph targets, which are not applied");
        }
        if !attributes["COLOR_0"].is_null() {
            self.left_out.insert("colours of vertices".into());
        }
        let vertices: Table<'_, 3> = self.accessors.open(&attributes["POSITION"])?;
        let count = vertices.len();
        let indices: Vec<u32> = match &primitive["indices"] {
            Value::Null => (0..count as u32).collect(),
            accessor => self.accessors.read(accessor)?.iter().map(|[index]| *index as u32).collect(),
        };
        let mirrored = skin.is_none() && scene_from_node.matrix3.determinant() < 0.0;
        let triangles =
            triangles(mode, &indices).map(|[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] });
        let mut triangles: Vec<[u32; 3]> = triangles.collect();
        let used = take_used(&mut triangles, count);
        let points = used.iter().map(|vertex| DVec3::from_array(vertices.get(*vertex)));
        let positions: Vec<DVec3> = match skin {
            None => points.map(|point| scene_from_node.transform_point3(point)).collect(),
            Some(skin) => {
                let bound = self.bound(attributes, count)?;
                let bound = bound.ok_or("its vertices, joints and weights differ in number")?;
                let placed = |(point, vertex): (DVec3, &usize)| skin.place(point, bound.of(*vertex));
                points.zip(&used).map(placed).collect::<Result<_, _>>()?
            }
        };
        let normals = self.normals(attributes, skin, scene_from_node, (&used, count));
        let surface = surface(self.container, &primitive["material"], &mut self.left_out, &mut self.means)?;
        let uvs: Option<Table<'_, 2>> = match &attributes[format!("TEXCOORD_{}", surface.uv_set)] {
            Value::Null => None,
            accessor => self.accessors.of_vertices(accessor, count)?,
        };
        let uvs =
            uvs.map_or_else(Vec::new, |uvs| used.iter().map(|vertex| surface.uv(uvs.get(*vertex))).collect());
        Ok(Some(Part {
            triangles,
            positions: positions.iter().map(|point: &DVec3| point.as_vec3().to_array()).collect(),
            uvs,
            normals,
            material: surface.material,
            ..Part::default()
        }))
    }

    /// Returns the normals of the `used` ones of `count` vertices; none if they are damaged, as the triangles can be drawn
    /// without them.
    fn normals(
        &self,
        attributes: &Value,
        skin: Option<&Skin>,
        scene_from_node: DAffine3,
        (used, count): (&[usize], usize),
    ) -> Vec<[f32; 3]> {
        let normals: Option<Table<'_, 3>> = match &attributes["NORMAL"] {
            Value::Null => None,
            accessor => self.accessors.of_vertices(accessor, count).ok().flatten(),
        };
        let Some(normals) = normals else { return Vec::new() };
        let normals = used.iter().map(|vertex| DVec3::from_array(normals.get(*vertex)));
        let Some(skin) = skin else {
            let matrix = normals::matrix(scene_from_node.matrix3);
            return normals.map(|normal| normals::unit(matrix * normal)).collect();
        };
        let Ok(Some(bound)) = self.bound(attributes, count) else { return Vec::new() };
        normals.zip(used).map(|(normal, vertex)| skin.turn(normal, bound.of(*vertex))).collect()
    }

    /// Returns the joints of the vertices and their weights; `None` if there are not as many as vertices.
    fn bound(&self, attributes: &Value, count: usize) -> Result<Option<Bound<'a>>, String> {
        let joints = self.accessors.of_vertices(&attributes["JOINTS_0"], count)?;
        let weights = self.accessors.of_vertices(&attributes["WEIGHTS_0"], count)?;
        Ok(joints.zip(weights).map(|(joints, weights)| Bound { joints, weights }))
    }
}

/// Returns the vertices that triangles use, of `count`, in ascending order, and numbers the corners by them. Exporters
/// often write one accessor that all primitives share, of which each uses a part. A corner that names no vertex still
/// does so afterwards.
fn take_used(triangles: &mut [[u32; 3]], count: usize) -> Vec<usize> {
    let corners = triangles.as_flattened_mut();
    let mut used: Vec<usize> = Vec::new();
    if corners.len() >= count {
        let mut places = vec![None; count];
        for corner in &*corners {
            if let Some(place) = places.get_mut(*corner as usize) {
                *place = Some(0);
            }
        }
        for (vertex, place) in places.iter_mut().enumerate().filter(|(_, place)| place.is_some()) {
            *place = Some(used.len() as u32);
            used.push(vertex);
        }
        for corner in corners {
            *corner = places.get(*corner as usize).copied().flatten().unwrap_or(u32::MAX);
        }
    } else {
        used.extend(corners.iter().map(|corner| *corner as usize).filter(|corner| *corner < count));
        used.sort_unstable();
        used.dedup();
        for corner in corners {
            let place = used.binary_search(&(*corner as usize));
            *corner = place.map_or(u32::MAX, |place| place as u32);
        }
    }
    used
}

/// The `mode` of triangles, and the last of the supported modes; between them are strips.
const TRIANGLES: u64 = 4;
const STRIP: u64 = 5;
const FAN: u64 = 6;

/// Returns the triangles that a list of indices represents.
fn triangles(mode: u64, indices: &[u32]) -> Box<dyn Iterator<Item = [u32; 3]> + '_> {
    match mode {
        // Every second triangle of a strip has the opposite winding.
        STRIP => Box::new(indices.windows(3).enumerate().map(|(at, corners)| {
            let [a, b, c] = [corners[0], corners[1], corners[2]];
            if at % 2 == 0 { [a, b, c] } else { [b, a, c] }
        })),
        FAN => {
            Box::new(indices.iter().skip(1).zip(indices.iter().skip(2)).map(|(b, c)| [indices[0], *b, *c]))
        }
        _ => Box::new(indices.as_chunks::<3>().0.iter().copied()),
    }
}

/// Returns the transform of a node relative to its parent.
fn transform(node: &Value) -> DAffine3 {
    if !node["matrix"].is_null() {
        return affine(&numbers(&node["matrix"], DMat4::IDENTITY.to_cols_array()));
    }
    let rotation = DQuat::from_array(numbers(&node["rotation"], [0.0, 0.0, 0.0, 1.0]));
    let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY };
    DAffine3::from_scale_rotation_translation(
        numbers(&node["scale"], [1.0; 3]).into(),
        rotation,
        numbers(&node["translation"], [0.0; 3]).into(),
    )
}
