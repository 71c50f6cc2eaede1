//! Materials of glTF and GLB, and the placement of pictures on surfaces.

use super::Files;
use super::gltf::{Model, encoded};
use crate::image_file;
use crate::model::PbrMaps;
use crate::pbr_picture;
use belvedere_sensors::scene::{Pbr, TextureAlpha};
use serde_json::{Value, json};
use std::io::Cursor;

/// A picture of one colour, as a file.
fn png(color: [u8; 4]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image::RgbaImage::from_pixel(2, 1, image::Rgba(color))
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}

/// The box with a material, and texture coordinates of its corners in bytes, as fractions of 255.
fn painted(material: &Value) -> Model {
    let mut model = Model::block();
    let bytes: Vec<u8> = (0..8_u8).flat_map(|at| [51 * (at % 4), 255 - 51 * (at / 2), 0, 0]).collect();
    let uvs = model.accessor(&bytes, 5121, "VEC2", 8);
    model.json["accessors"][uvs]["normalized"] = true.into();
    model.json["bufferViews"][2]["byteStride"] = 4.into();
    model.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = uvs.into();
    model.json["meshes"][0]["primitives"][0]["material"] = 0.into();
    model.json["materials"] = json!([material]);
    model
}

#[test]
fn materials_are_read() {
    let look = |material: &Value| painted(material).meshes()[0].material.clone().unwrap();
    // Half the light is displayed as 0.735 (sRGB).
    let plain = look(
        &json!({ "pbrMetallicRoughness": { "baseColorFactor": [0.5, 1, 0, 0.25] }, "emissiveFactor": [0, 0, 1] }),
    );
    assert!((plain.diffuse[0] - 0.735_357).abs() < 1e-5, "{:?}", plain.diffuse);
    assert_eq!((plain.diffuse[1], plain.diffuse[2], plain.alpha), (1.0, 0.0, 1.0));
    assert_eq!((plain.texture_alpha, plain.emissive), (TextureAlpha::Ignored, [0.0, 0.0, 1.0]));
    let glass = look(
        &json!({ "alphaMode": "BLEND", "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1, 0.25] } }),
    );
    assert_eq!((glass.alpha, glass.texture_alpha), (0.25, TextureAlpha::Blended));
    let leaf = look(&json!({ "alphaMode": "MASK", "alphaCutoff": 0.75 }));
    assert_eq!((leaf.alpha, leaf.texture_alpha), (1.0, TextureAlpha::CutOut { least: 0.75 }));
    assert_eq!(look(&json!({ "alphaMode": "MASK" })).texture_alpha, TextureAlpha::CutOut { least: 0.5 });
    let old =
        json!({ "extensions": { "KHR_materials_pbrSpecularGlossiness": { "diffuseFactor": [0, 1, 0, 1] } } });
    assert_eq!(look(&old).diffuse, [0.0, 1.0, 0.0]);
    assert!(Model::block().meshes()[0].material.is_none());
    let pbr = |roughness, metalness| Some(Pbr { roughness, metalness, ..Pbr::default() });
    assert_eq!((plain.pbr, look(&old).pbr), (pbr(1.0, 1.0), pbr(0.0, 0.0)));
    let rough = look(&json!({ "pbrMetallicRoughness": { "roughnessFactor": 0.25, "metallicFactor": 0.5 } }));
    assert_eq!(rough.pbr, pbr(0.25, 0.5));
    assert_eq!(look(&json!({ "extensions": { "KHR_materials_unlit": {} } })).pbr, None);
}

/// Green is the roughness and blue the metalness. If the base colour has other texture coordinates, the mean of the map
/// is used.
#[test]
fn metallic_roughness_maps() {
    let material = json!({ "metallicRoughnessTexture": { "index": 0 }, "metallicFactor": 0.5 });
    let mut model = painted(&json!({ "pbrMetallicRoughness": material }));
    model.json["textures"] = json!([{ "source": 0 }]);
    let uri = format!("data:image/png;base64,{}", encoded(&png([9, 51, 204, 255])));
    model.json["images"] = json!([{ "uri": uri }]);
    let files = Files::new();
    files.write("m.glb", model.glb());
    let (meshes, problems) = files.load("m.glb");
    assert!(problems.is_empty(), "{problems:?}");
    let look = meshes.unwrap()[0].material.clone().unwrap();
    assert_eq!(look.pbr, Some(Pbr { roughness: 1.0, metalness: 0.5, ..Pbr::default() }));
    let path = files.0.path().join("m.glb#image0");
    assert_eq!(look.pbr_maps, PbrMaps::of_gltf(&path));
    assert_eq!(
        pbr_picture::picture(&look.pbr_maps, |_, error| panic!("{error}")).unwrap().get_pixel(1, 0).0,
        [255, 51, 204, 255]
    );

    model.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] =
        json!({ "index": 0, "extensions": { "KHR_texture_transform": { "scale": [2, 2] } } });
    files.write("m.glb", model.glb());
    let (meshes, problems) = files.load("m.glb");
    assert!(
        matches!(&problems[..], [note] if note.contains("the patterns of metallic-roughness maps whose texture")),
        "{problems:?}"
    );
    let pbr = meshes.unwrap()[0].material.as_ref().unwrap().pbr.unwrap();
    assert!((pbr.roughness - 0.2).abs() < 1e-6 && (pbr.metalness - 0.4).abs() < 1e-6, "{pbr:?}");
}

#[test]
fn pictures_are_inside_beside_or_in_uris() {
    let files = Files::new();
    let mut model = painted(&json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }));
    model.json["textures"] = json!([{ "source": 1 }]);
    let view = model.view(&png([9, 8, 7, 255]));
    files.write("blue paint.png", png([1, 2, 3, 255]));
    let inside = json!({ "bufferView": view, "mimeType": "image/png" });
    let data = json!({ "uri": format!("data:image/png;base64,{}", encoded(&png([4, 5, 6, 255]))) });
    for (picture, color) in
        [(inside, [9, 8, 7]), (data, [4, 5, 6]), (json!({ "uri": "blue%20paint.png" }), [1, 2, 3])]
    {
        model.json["images"] = json!([{ "uri": "other.png" }, picture]);
        files.write("m.glb", model.glb());
        let meshes = files.meshes("m.glb");
        let texture = meshes[0].material.as_ref().unwrap().texture.clone().unwrap();
        assert_eq!(image_file::open(&texture).unwrap().into_rgb8().get_pixel(1, 0).0, color);
        // v is down in the file, and up in the mesh.
        assert!(
            (meshes[0].uvs[5][0] - 0.2).abs() < 1e-6 && (meshes[0].uvs[5][1] - 0.4).abs() < 1e-6,
            "{:?}",
            meshes[0].uvs
        );
    }
    for (picture, words) in [("gone.png", "there is no texture"), ("https://example.org/a.png", "is remote")]
    {
        model.json["images"] = json!([{}, { "uri": picture }]);
        files.write("m.glb", model.glb());
        let (meshes, problems) = files.load("m.glb");
        assert!(meshes.unwrap()[0].material.as_ref().unwrap().texture.is_none());
        assert!(problems.len() == 1 && problems[0].contains(words), "{problems:?}");
    }
    assert!(image_file::open(&files.0.path().join("m.glb#image7")).is_err());
}

/// The example of the extension's specification: the lower left quarter of the picture, rotated clockwise.
#[test]
fn textures_are_transformed_by_the_extension() {
    let transform = json!({ "offset": [0, 1], "rotation": std::f64::consts::FRAC_PI_2, "scale": [0.5, 0.5] });
    let texture = json!({ "index": 0, "extensions": { "KHR_texture_transform": transform } });
    let mut model = painted(&json!({ "pbrMetallicRoughness": { "baseColorTexture": texture } }));
    model.json["extensionsRequired"] = json!(["KHR_texture_transform"]);
    let view = model.view(&png([9, 8, 7, 255]));
    model.json["textures"] = json!([{ "source": 0 }]);
    model.json["images"] = json!([{ "bufferView": view, "mimeType": "image/png" }]);
    for [u, v] in &model.meshes()[0].uvs {
        assert!((-1e-6..=0.500_001).contains(u) && (-1e-6..=0.500_001).contains(v), "{u} {v}");
    }
    // Corner 3 has (0.6, 0.8): rotated by a quarter turn counter-clockwise as seen, half as large, and from the lower
    // edge.
    let [u, v] = model.meshes()[0].uvs[3];
    assert!((u - 0.4).abs() < 1e-6 && (v - 0.3).abs() < 1e-6, "{u} {v}");
}

#[test]
fn emissive_maps() {
    let material = json!({ "emissiveFactor": [1, 0, 1], "emissiveTexture": { "index": 0 } });
    let mut model = painted(&material);
    let view = model.view(&png([9, 8, 7, 255]));
    model.json["textures"] = json!([{ "source": 0 }]);
    model.json["images"] = json!([{ "bufferView": view, "mimeType": "image/png" }]);
    let files = Files::new();
    files.write("m.glb", model.glb());
    let look = files.meshes("m.glb")[0].material.clone().unwrap();
    assert_eq!(look.emissive, [1.0, 0.0, 1.0]);
    let map = image_file::open(&look.emissive_map.unwrap()).unwrap().into_rgb8();
    assert_eq!(map.get_pixel(1, 0).0, [9, 8, 7]);
}

#[test]
fn undrawn_features_give_a_note() {
    let files = Files::new();
    let mut model = painted(
        &json!({ "doubleSided": true, "emissiveFactor": [1, 1, 1], "emissiveTexture": { "index": 0 } }),
    );
    model.json["textures"] = json!([{ "source": 0 }]);
    model.json["images"] = json!([{ "uri": "gone.png" }]);
    model.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": 0 }]);
    files.write("m.glb", model.glb());
    let (meshes, problems) = files.load("m.glb");
    assert_eq!(meshes.unwrap()[0].material.as_ref().unwrap().emissive, [0.0; 3]);
    let [pose, note] = &problems[..] else { panic!("{problems:?}") };
    assert!(pose.contains("m.glb: warning: the mesh m.glb has morph targets"), "{pose}");
    assert!(
        note.contains("note: parts of the mesh m.glb are not drawn: emissive maps whose pictures are missing, the insides of"),
        "{note}"
    );
}
