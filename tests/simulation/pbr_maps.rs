//! `<roughness_map>`, `<metalness_map>` and `<emissive_map>` of SDF, and their like in a GLB: each pixel of a wall looks
//! as on a wall that has the values of its place on the maps everywhere.

use crate::sdf::Folder;
use belvedere::rig::FrameBuf;
use belvedere::simulation::Simulation;
use serde_json::{Value, json};
use std::io::Cursor;

/// Pixels of the camera, which the wall more than fills, and texels of the maps along an edge.
const PIXELS: usize = 96;
const TEXELS: u32 = 64;
/// Pixels beside the borders of the quarters, where texels of two of them are mixed.
const MARGIN: usize = 4;

/// Roughness, metalness and emitted red of the quarters: top left, top right, bottom left, bottom right.
const VALUES: [[u8; 3]; 4] = [[51, 255, 51], [204, 255, 0], [51, 0, 102], [204, 0, 26]];

/// A PNG image whose quarters have these colours.
fn png(edge: u32, of: impl Fn([u8; 3]) -> [u8; 3]) -> Vec<u8> {
    let picture = image::RgbImage::from_fn(edge, edge, |x, y| {
        let quarter = usize::from(x >= edge / 2) + 2 * usize::from(y >= edge / 2);
        image::Rgb(of(VALUES[quarter]))
    });
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// What a camera sees of a visual 1 m ahead, under a lamp.
fn seen(folder: &Folder, visual: &str) -> Vec<u8> {
    let camera = format!(
        "<sensor name='s' type='camera'><topic>eye</topic><update_rate>10</update_rate><camera>
         <horizontal_fov>0.8</horizontal_fov><image><width>{PIXELS}</width><height>{PIXELS}</height></image>
         <clip><near>0.1</near><far>20</far></clip></camera></sensor>"
    );
    let lamp =
        "<light name='lamp' type='point'><pose>0.4 0.1 1.05 0 0 0</pose><diffuse>0.3 0.3 0.3 1</diffuse>
         <specular>0.4 0.4 0.4 1</specular><attenuation><range>20</range></attenuation></light>";
    let content = format!(
        "<scene><ambient>0.2 0.2 0.2 1</ambient></scene>{lamp}
         <model name='wall'><static>1</static><link name='l'><visual name='v'><pose>1.5 0 1 0 0 0</pose>{visual}</visual></link></model>
         <model name='eye'><static>1</static><pose>0 0 1 0 0 0</pose><link name='l'>{camera}</link></model>"
    );
    let (world, problems) = folder.load("1.9", &content, false);
    assert!(problems.is_empty(), "{problems:#?}");
    let mut simulation = Simulation::builder(world.unwrap()).build().unwrap();
    let mut frame = FrameBuf::default();
    simulation.render("eye", &mut frame).unwrap();
    frame.view().payload().to_vec()
}

/// Compares a wall with maps with four walls of one material.
fn compare(mapped: &[u8], plain: &[Vec<u8>; 4]) {
    let pixel = |picture: &[u8], at: usize| <[u8; 3]>::try_from(&picture[3 * at..3 * at + 3]).unwrap();
    let mut differ = 0;
    for at in 0..PIXELS * PIXELS {
        let (x, y) = (at % PIXELS, at / PIXELS);
        if x.abs_diff(PIXELS / 2) <= MARGIN || y.abs_diff(PIXELS / 2) <= MARGIN {
            continue;
        }
        let quarter = usize::from(x >= PIXELS / 2) + 2 * usize::from(y >= PIXELS / 2);
        let (found, expected) = (pixel(mapped, at), pixel(&plain[quarter], at));
        let near = found.iter().zip(expected).all(|(value, expected)| value.abs_diff(expected) <= 1);
        assert!(near, "pixel {x}, {y}: {found:?} is not {expected:?}");
        differ += usize::from((0..4).all(|other| other == quarter || pixel(&plain[other], at) != expected));
    }
    // Elsewhere, the comparison would say nothing.
    assert!(differ > PIXELS * PIXELS / 2, "{differ}");
}

#[test]
fn maps_of_sdf() {
    let folder = Folder::new();
    folder.write("rough.png", png(TEXELS, |[roughness, ..]| [roughness, 0, 255]));
    // A map of another size.
    folder.write("metal.png", png(2 * TEXELS, |[_, metalness, _]| [metalness, 77, 0]));
    folder.write("glow.png", png(TEXELS, |[.., red]| [red, 0, 0]));
    let wall = |metal: &str, emissive: &str| {
        let look = format!("<diffuse>0.6 0.6 0.6 1</diffuse>{emissive}<pbr><metal>{metal}</metal></pbr>");
        let shape = "<geometry><box><size>1 2 2</size></box></geometry>";
        seen(&folder, &format!("{shape}<material>{look}</material>"))
    };
    // As in gz-sim, a map is multiplied by the number, which is 0.5 by default.
    for (number, factor) in [("", 0.5), ("<roughness>0.8</roughness><metalness>0.8</metalness>", 0.8)] {
        let maps = "<roughness_map>rough.png</roughness_map><metalness_map>metal.png</metalness_map>
                    <emissive_map>glow.png</emissive_map>";
        let mapped = wall(&format!("{maps}{number}"), "");
        let plain = VALUES.map(|values| {
            let [roughness, metalness, red] = values.map(|value| f64::from(value) / 255.0);
            let (roughness, metalness) = (factor * roughness, factor * metalness);
            let numbers = format!("<roughness>{roughness}</roughness><metalness>{metalness}</metalness>");
            wall(&numbers, &format!("<emissive>{red} 0 0 1</emissive>"))
        });
        compare(&mapped, &plain);
    }
}

/// A square of 2 m in a GLB, seen from −x, with a material and images.
fn glb(material: &Value, images: &[Vec<u8>]) -> Vec<u8> {
    let mut bin = Vec::new();
    let mut views = Vec::new();
    let mut add = |bytes: &[u8]| {
        views.push(json!({ "buffer": 0, "byteOffset": bin.len(), "byteLength": bytes.len() }));
        bin.extend(bytes);
        bin.resize(bin.len().next_multiple_of(4), 0);
        views.len() - 1
    };
    // The corners of the left edge, then of the right one, as seen.
    let corners = [[-0.5, 1.0, 1.0], [-0.5, 1.0, -1.0], [-0.5, -1.0, 1.0], [-0.5, -1.0, -1.0_f32]];
    let uvs = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0_f32]];
    let positions = add(bytemuck::cast_slice(&corners));
    let uvs = add(bytemuck::cast_slice(&uvs));
    let triangles = add(bytemuck::cast_slice(&[0_u16, 1, 2, 2, 1, 3]));
    let images: Vec<Value> =
        images.iter().map(|png| json!({ "bufferView": add(png), "mimeType": "image/png" })).collect();
    let textures: Vec<Value> = (0..images.len()).map(|source| json!({ "source": source })).collect();
    let mut file = json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2, "material": 0 }] }],
        "accessors": [
            { "bufferView": positions, "componentType": 5126, "count": 4, "type": "VEC3",
              "min": [-0.5, -1, -1], "max": [-0.5, 1, 1] },
            { "bufferView": uvs, "componentType": 5126, "count": 4, "type": "VEC2" },
            { "bufferView": triangles, "componentType": 5123, "count": 6, "type": "SCALAR" },
        ],
        "materials": [material], "bufferViews": views, "buffers": [{ "byteLength": bin.len() }],
    });
    if !images.is_empty() {
        (file["images"], file["textures"]) = (images.into(), textures.into());
    }
    let mut text = file.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut glb = Vec::new();
    for word in [0x4654_6c67, 2, 28 + text.len() + bin.len(), text.len(), 0x4e4f_534a] {
        glb.extend((word as u32).to_le_bytes());
    }
    glb.extend(text);
    glb.extend((bin.len() as u32).to_le_bytes());
    glb.extend(0x004e_4942_u32.to_le_bytes());
    glb.extend(bin);
    glb
}

#[test]
fn maps_of_glb() {
    let folder = Folder::new();
    let wall = |name: &str, material: &Value, images: &[Vec<u8>]| {
        folder.write(name, glb(material, images));
        seen(&folder, &format!("<geometry><mesh><uri>{name}</uri></mesh></geometry>"))
    };
    let base = [0.3, 0.3, 0.3, 1.0];
    // Red is not used.
    let both = png(TEXELS, |[roughness, metalness, _]| [99, roughness, metalness]);
    let glow = png(TEXELS, |[.., red]| [red, 0, 0]);
    let surface = json!({
        "baseColorFactor": base, "metallicRoughnessTexture": { "index": 1 },
        "roughnessFactor": 0.5, "metallicFactor": 0.75,
    });
    let material = json!({
        "pbrMetallicRoughness": surface, "emissiveTexture": { "index": 0 }, "emissiveFactor": [1, 1, 1],
    });
    let mapped = wall("mapped.glb", &material, &[glow, both]);
    let mut at = 0;
    let plain = VALUES.map(|values| {
        let [roughness, metalness, red] = values.map(|value| f64::from(value) / 255.0);
        let surface = json!({
            "baseColorFactor": base, "roughnessFactor": 0.5 * roughness, "metallicFactor": 0.75 * metalness,
        });
        // A factor is linear light, and a picture is in sRGB.
        let linear = if red <= 0.04045 { red / 12.92 } else { ((red + 0.055) / 1.055_f64).powf(2.4) };
        at += 1;
        wall(
            &format!("plain{at}.glb"),
            &json!({ "pbrMetallicRoughness": surface, "emissiveFactor": [linear, 0.0, 0.0] }),
            &[],
        )
    });
    compare(&mapped, &plain);
}
