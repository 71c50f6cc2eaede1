//! Exports models as a binary glTF 2.0 file, for the page and for other programs.
//!
//! Each link is a node with `extras.link` = `model::link`, as in `simulation/link_states`, whose children are the
//! link's visuals. All links are children of one node, `world`, which converts z up to glTF's y up.

mod file;
mod look;
mod shapes;

use crate::description::model::{Geometry, Model};
use belvedere_sensors::Pose;
use file::File;
use look::Looks;
use serde_json::{Map, Value, json};
use shapes::Triangles;
use std::collections::HashMap;
use std::sync::Arc;

/// A model with its pose.
#[derive(Debug, Clone, Copy)]
pub struct Thing<'a> {
    /// Its name in the world.
    pub name: &'a str,
    /// Its description.
    pub model: &'a Model,
    /// Pose of its frame; all joints are at zero.
    pub world_from_model: Pose,
    /// True if it is a robot, whose links get `extras.robot`.
    pub is_robot: bool,
}

/// Writes these models. Textures that cannot be read are omitted; the renderer has already warned about them.
pub fn write<'a>(things: impl IntoIterator<Item = Thing<'a>>) -> Vec<u8> {
    let (mut file, mut looks, mut meshes) = (File::default(), Looks::default(), Meshes::default());
    let mut links = Vec::new();
    for thing in things {
        for link in &thing.model.links {
            let mut visuals = Vec::new();
            for visual in &link.visuals {
                let look = looks.add(&mut file, &visual.material);
                let mesh = meshes.add(&mut file, &visual.geometry, look);
                let mut node = pose(&visual.link_from_visual);
                node.insert("mesh".into(), mesh.into());
                visuals.push(file.add("nodes", Value::Object(node)));
            }
            let name = format!("{}::{}", thing.name, link.name);
            let mut node = pose(&(thing.world_from_model * link.model_from_link));
            node.insert("name".into(), name.clone().into());
            let extras =
                if thing.is_robot { json!({ "link": name, "robot": true }) } else { json!({ "link": name }) };
            node.insert("extras".into(), extras);
            // glTF allows no empty lists.
            if !visuals.is_empty() {
                node.insert("children".into(), visuals.into());
            }
            links.push(file.add("nodes", Value::Object(node)));
        }
    }
    // A quarter turn about x: z up becomes y up.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let mut world = json!({ "name": "world", "rotation": [-half, 0.0, 0.0, half] });
    if !links.is_empty() {
        world["children"] = links.into();
    }
    let world = file.add("nodes", world);
    file.add("scenes", json!({ "nodes": [world] }));
    file.finish()
}

fn pose(pose: &Pose) -> Map<String, Value> {
    let mut node = Map::new();
    node.insert("translation".into(), json!(pose.translation().to_array()));
    node.insert("rotation".into(), json!(pose.rotation().to_array()));
    node
}

/// The meshes that were written. A mesh from a file is written once for each material.
#[derive(Default)]
struct Meshes {
    from_files: HashMap<(*const crate::description::model::Mesh, usize), usize>,
}

impl Meshes {
    fn add(&mut self, file: &mut File, geometry: &Geometry, look: usize) -> usize {
        let key = match geometry {
            Geometry::Mesh(mesh) => Some((Arc::as_ptr(mesh), look)),
            _ => None,
        };
        if let Some(&known) = key.and_then(|key| self.from_files.get(&key)) {
            return known;
        }
        let index = write_mesh(file, &Triangles::of(geometry), look);
        if let Some(key) = key {
            self.from_files.insert(key, index);
        }
        index
    }
}

fn write_mesh(file: &mut File, triangles: &Triangles<'_>, look: usize) -> usize {
    let mut attributes = Map::new();
    attributes.insert("POSITION".into(), file.positions(&triangles.positions).into());
    if !triangles.normals.is_empty() {
        attributes.insert("NORMAL".into(), file.vectors(&triangles.normals).into());
    }
    if !triangles.uvs.is_empty() {
        // glTF counts v from the top.
        let uvs: Vec<[f32; 2]> = triangles.uvs.iter().map(|[u, v]| [*u, 1.0 - v]).collect();
        attributes.insert("TEXCOORD_0".into(), file.pairs(&uvs).into());
    }
    let indices = file.indices(&triangles.corners);
    file.add(
        "meshes",
        json!({ "primitives": [{ "attributes": attributes, "indices": indices, "material": look }] }),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::Diagnostics;
    use crate::description::Rules;
    use crate::description::load::load_world;
    use crate::description::models::package_path;

    fn parts(glb: &[u8]) -> (Value, &[u8]) {
        let word = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((&glb[..4], word(4), word(8)), (&b"glTF"[..], 2, glb.len()));
        let len = word(12);
        assert_eq!((&glb[16..20], len % 4), (&b"JSON"[..], 0));
        let rest = 20 + len;
        assert_eq!((&glb[rest + 4..rest + 8], word(rest) % 4), (&b"BIN\0"[..], 0));
        (serde_json::from_slice(&glb[20..rest]).unwrap(), &glb[rest + 8..])
    }

    #[test]
    fn a_world_is_a_file_with_valid_references() {
        let packages = package_path([], None);
        let world =
            load_world("tag_ceiling", &packages, Rules::default(), &mut Diagnostics::default()).unwrap();
        let things = world.models.iter().map(|model| Thing {
            name: &model.name,
            model,
            world_from_model: model.world_from_model,
            is_robot: false,
        });
        let glb = write(things);
        let (json, data) = parts(&glb);
        let len = |list: &str| json[list].as_array().map_or(0, Vec::len) as u64;
        let links: usize = world.models.iter().map(|model| model.links.len()).sum();
        let named =
            json["nodes"].as_array().unwrap().iter().filter(|node| node["extras"]["link"].is_string());
        assert_eq!(named.count(), links);
        assert_eq!(json["buffers"][0]["byteLength"].as_u64().unwrap(), data.len() as u64);
        for view in json["bufferViews"].as_array().unwrap() {
            let end = view["byteOffset"].as_u64().unwrap() + view["byteLength"].as_u64().unwrap();
            assert!(end <= data.len() as u64);
        }
        for mesh in json["meshes"].as_array().unwrap() {
            let primitive = &mesh["primitives"][0];
            assert!(primitive["indices"].as_u64().unwrap() < len("accessors"));
            assert!(primitive["material"].as_u64().unwrap() < len("materials"));
        }
        for image in json["images"].as_array().unwrap() {
            assert!(image["bufferView"].as_u64().unwrap() < len("bufferViews"));
        }
        assert!(len("images") > 30, "the tags are textures");
    }
}
