//! Small files of the binary formats, and the repair of their checksums.

use belvedere::recording::{Attachment, Compression, Profile, RecordedStream, RecordingWriter};
use belvedere_bridge::{Encoding, FrameHeader, Kind};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Cursor;
use std::path::Path;

/// A tetrahedron.
const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const FACES: [[u16; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];

fn floats(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

pub(crate) fn stl() -> Vec<Vec<u8>> {
    let mut binary = vec![b' '; 80];
    binary.extend(4_u32.to_le_bytes());
    let mut text = "solid a\n".to_owned();
    for face in FACES {
        let corners = face.map(|corner| CORNERS[usize::from(corner)]);
        binary.extend(floats(&[0.0; 3]));
        binary.extend(floats(corners.as_flattened()));
        binary.extend([0, 0]);
        let line = |[x, y, z]: [f32; 3]| format!("vertex {x} {y} {z}\n");
        let _ =
            writeln!(text, "facet normal 0 0 1\nouter loop\n{}endloop\nendfacet", corners.map(line).concat());
    }
    text += "endsolid a\n";
    vec![binary, text.into_bytes()]
}

pub(crate) fn ply() -> Vec<Vec<u8>> {
    let header = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\ncomment TextureFile p.png\nelement vertex 4\nproperty float x\nproperty float y\n\
             property float z\nproperty uchar red\nelement face 4\nproperty list uchar int vertex_indices\n\
             property list uchar float texcoord\nend_header\n"
        )
    };
    let mut text = header("ascii");
    let mut little = header("binary_little_endian").into_bytes();
    let mut big = header("binary_big_endian").into_bytes();
    for corner in CORNERS {
        let [x, y, z] = corner;
        let _ = writeln!(text, "{x} {y} {z} 255");
        little.extend(floats(&corner));
        big.extend(corner.iter().flat_map(|number| number.to_be_bytes()));
        little.push(255);
        big.push(255);
    }
    for face in FACES {
        let [a, b, c] = face;
        let _ = writeln!(text, "3 {a} {b} {c} 2 0.5 1");
        little.push(3);
        big.push(3);
        for corner in face {
            little.extend(i32::from(corner).to_le_bytes());
            big.extend(i32::from(corner).to_be_bytes());
        }
        little.push(0);
        big.push(0);
    }
    vec![text.into_bytes(), little, big]
}

/// A glTF model with all that is read, and its buffer.
fn gltf_parts() -> (Value, Vec<u8>) {
    let mut buffer = floats(CORNERS.as_flattened());
    buffer.extend(FACES.as_flattened().iter().flat_map(|corner| corner.to_le_bytes()));
    buffer.extend(floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0]));
    buffer.extend(floats(&[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]));
    buffer.extend([[0_u8; 4]; 4].as_flattened());
    buffer.extend(floats(&[1.0, 0.0, 0.0, 0.0].repeat(4)));
    buffer.extend([1, 0, 0, 0]);
    buffer.extend(floats(&[0.5, 0.5, 0.5]));
    let picture = pictures(image::ImageFormat::Png).swap_remove(0);
    let picture_at = buffer.len();
    buffer.extend(&picture);
    let views = [
        [0, 48],
        [48, 24],
        [72, 32],
        [104, 64],
        [168, 16],
        [184, 64],
        [248, 4],
        [252, 12],
        [picture_at, picture.len()],
    ]
    .map(|[at, len]| json!({ "buffer": 0, "byteOffset": at, "byteLength": len }));
    let json = json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0, 2] }],
        "bufferViews": views,
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4,
              "sparse": { "count": 1, "indices": { "bufferView": 6, "componentType": 5121 }, "values": { "bufferView": 7 } } },
            { "bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 12 },
            { "bufferView": 2, "componentType": 5126, "type": "VEC2", "count": 4 },
            { "bufferView": 3, "componentType": 5126, "type": "MAT4", "count": 1 },
            { "bufferView": 4, "componentType": 5121, "type": "VEC4", "count": 4 },
            { "bufferView": 5, "componentType": 5126, "type": "VEC4", "count": 4 }
        ],
        "images": [{ "bufferView": 8, "mimeType": "image/png" }, { "uri": "p.png" }],
        "textures": [{ "source": 0 }, { "source": 1 }],
        "materials": [{ "alphaMode": "MASK", "alphaCutoff": 0.5, "emissiveFactor": [0, 0, 1], "pbrMetallicRoughness": {
            "baseColorFactor": [1, 0, 0, 1], "baseColorTexture": { "index": 0, "texCoord": 0,
            "extensions": { "KHR_texture_transform": { "scale": [2, 2] } } }, "metallicFactor": 0.5 } }],
        "meshes": [{ "name": "m", "primitives": [
            { "attributes": { "POSITION": 0, "TEXCOORD_0": 2, "JOINTS_0": 4, "WEIGHTS_0": 5 }, "indices": 1, "material": 0 },
            { "attributes": { "POSITION": 0 }, "mode": 5 }, { "attributes": { "POSITION": 0 }, "mode": 6 }] }],
        "nodes": [{ "name": "a", "children": [1], "translation": [1, 0, 0], "rotation": [0, 0, 0, 1], "scale": [1, 1, 2] },
            { "mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] }, { "mesh": 0, "skin": 0 }],
        "skins": [{ "joints": [1], "inverseBindMatrices": 3 }],
        "buffers": [{ "byteLength": buffer.len() }]
    });
    (json, buffer)
}

pub(crate) fn gltf() -> Vec<Vec<u8>> {
    const LETTERS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let (mut json, buffer) = gltf_parts();
    let mut text = "data:application/octet-stream;base64,".to_owned();
    for three in buffer.chunks(3) {
        let bits =
            three.iter().fold(0_u32, |bits, byte| bits << 8 | u32::from(*byte)) << (8 * (3 - three.len()));
        for at in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * at)) as usize & 63];
            text.push(if at > three.len() { '=' } else { char::from(letter) });
        }
    }
    json["buffers"][0]["uri"] = text.into();
    vec![serde_json::to_string_pretty(&json).unwrap().into_bytes(), json.to_string().into_bytes()]
}

pub(crate) fn glb() -> Vec<Vec<u8>> {
    let (json, mut buffer) = gltf_parts();
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    buffer.resize(buffer.len().next_multiple_of(4), 0);
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((text.len() as u32 + buffer.len() as u32 + 28).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &buffer)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    vec![bytes]
}

/// Pictures of several kinds of pixels in a format.
pub(crate) fn pictures(format: image::ImageFormat) -> Vec<Vec<u8>> {
    let wide = image::DynamicImage::from(image::RgbaImage::from_fn(9, 5, |x, y| {
        image::Rgba([x as u8 * 20, y as u8 * 40, 9, 200])
    }));
    let kinds = [
        wide.to_rgb8().into(),
        wide.clone(),
        wide.to_luma8().into(),
        wide.to_rgb16().into(),
        image::DynamicImage::from(image::GrayImage::new(200, 1)),
    ];
    let write = |picture: &image::DynamicImage| {
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, format).ok().map(|()| bytes.into_inner())
    };
    kinds.iter().filter_map(write).collect()
}

/// A picture in each compressed form of DDS.
pub(crate) fn dds() -> Vec<Vec<u8>> {
    let file = |form: &[u8; 4], block: usize| {
        let mut words = [0_u32; 31];
        // The size of the header, its flags, height, width, and the size of the description of pixels, with its flag.
        (words[0], words[1], words[2], words[3], words[18], words[19]) = (124, 0x1007, 8, 8, 32, 4);
        words[20] = u32::from_le_bytes(*form);
        words[26] = 0x1000;
        let mut bytes = b"DDS ".to_vec();
        bytes.extend(words.iter().flat_map(|word| word.to_le_bytes()));
        bytes.extend((0..4 * block).map(|at| at as u8));
        bytes
    };
    vec![file(b"DXT1", 8), file(b"DXT3", 16), file(b"DXT5", 16)]
}

/// Sets the checksum of each chunk of a PNG.
pub(crate) fn repair_png(bytes: &mut [u8]) {
    let mut at = 8;
    while let Some(&[a, b, c, d]) = bytes.get(at..at + 4) {
        let end = at + 8 + u32::from_be_bytes([a, b, c, d]) as usize;
        if end + 4 > bytes.len() {
            return;
        }
        let mut sum = u32::MAX;
        for &byte in &bytes[at + 4..end] {
            sum ^= u32::from(byte);
            for _ in 0..8 {
                sum = if sum & 1 == 1 { (sum >> 1) ^ 0xedb8_8320 } else { sum >> 1 };
            }
        }
        bytes[end..end + 4].copy_from_slice(&(!sum).to_be_bytes());
        at = end + 4;
    }
}

/// Deletes the checksums of a recording; 0 means that there is none.
fn without_checksums(mut bytes: Vec<u8>) -> Vec<u8> {
    let mut at = 8;
    while at + 9 < bytes.len() - 8 {
        let len = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
        let sum = match bytes[at] {
            0x02 => Some(16),
            0x06 => Some(24),
            0x09 => Some(len - 4),
            0x0f => Some(0),
            _ => None,
        };
        if let Some(sum) = sum {
            bytes[at + 9 + sum..][..4].fill(0);
        }
        at += 9 + len;
    }
    bytes
}

pub(crate) fn mcap() -> Vec<Vec<u8>> {
    let record = |profile, compression, frames: u64| {
        let mut bytes = Vec::new();
        let about = BTreeMap::from([("world".to_owned(), "w".to_owned())]);
        let mut writer = RecordingWriter::new(&mut bytes, profile, compression, &about).unwrap();
        let data = b"<robot/>".to_vec();
        writer.attach(&Attachment { name: "r.urdf".into(), media_type: "text/xml".into(), data }).unwrap();
        let stream = |topic: &str, kind, encoding, len| RecordedStream {
            topic: topic.into(),
            kind,
            encoding,
            frame_id: "camera".into(),
            rate_hz: Some(30.0),
            layers: None,
            max_payload_len: len,
        };
        let picture = writer.add(&stream("picture", Kind::Image, Encoding::Mono8, 12)).unwrap();
        let clock = writer.add(&stream("clock", Kind::Clock, Encoding::Struct, 8)).unwrap();
        for number in 0..frames {
            let mut header = FrameHeader::new(Kind::Image, Encoding::Mono8);
            (header.stamp_ns, header.seq) = (number * 300_000_000, number);
            header.payload_len = header.set_packed(4, 3) as u64;
            writer.write(picture, &header, &[number as u8; 12]).unwrap();
            let mut ticks = FrameHeader::new(Kind::Clock, Encoding::Struct);
            (ticks.stamp_ns, ticks.seq, ticks.payload_len) = (header.stamp_ns, number, 8);
            writer.write(clock, &ticks, &header.stamp_ns.to_le_bytes()).unwrap();
            writer.flush().unwrap();
        }
        writer.finish().unwrap();
        bytes
    };
    let uncompressed = |profile, frames| record(profile, Compression::None, frames);
    let whole = [
        uncompressed(Profile::Ros1, 6),
        uncompressed(Profile::Ros2, 6),
        record(Profile::Ros1, Compression::Lz4, 3),
        uncompressed(Profile::Ros1, 0),
    ];
    whole.into_iter().flat_map(|bytes| [without_checksums(bytes.clone()), bytes]).collect()
}

/// A mesh, a picture and a model for robots and worlds.
pub(crate) fn beside_models(folder: &Path) {
    std::fs::write(folder.join("m.stl"), &stl()[0]).unwrap();
    std::fs::write(folder.join("p.png"), &pictures(image::ImageFormat::Png)[0]).unwrap();
    std::fs::create_dir_all(folder.join("m")).unwrap();
    let model = "<sdf version='1.9'><model name='m'><link name='l'><sensor name='s' type='camera'/></link></model></sdf>";
    std::fs::write(folder.join("m/model.sdf"), model).unwrap();
}
