//! Normals of vertices, from every format that has them.

use super::gltf::Model;
use super::{Files, UpAxis};
use crate::diagnostics::{Diagnostics, Source};
use crate::mesh::{load_mesh, load_mesh_parts};
use crate::model::Mesh;
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// The corners of two triangles of a roof with its ridge along y, and the normals of a round roof.
const CORNERS: [[f32; 3]; 4] = [[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 0.0, 0.0]];
const NORMALS: [[f32; 3]; 4] = [[-2.0, 0.0, 0.0], [0.0, 0.0, 0.5], [0.0, 0.0, 3.0], [1.0, 0.0, 0.0]];
const FACES: [[u32; 3]; 2] = [[0, 1, 2], [1, 3, 2]];

fn words(rows: &[[f32; 3]]) -> String {
    rows.as_flattened().iter().map(|number| number.to_string() + " ").collect()
}

fn lines(keyword: &str, rows: &[[f32; 3]]) -> String {
    rows.iter().map(|row| format!("{keyword} {}", words(&[*row]))).collect::<Vec<_>>().join("\n") + "\n"
}

fn obj() -> String {
    format!("{}{}f 1//1 2//2 3//3\nf 2//2 4//4 3//3\n", lines("v", &CORNERS), lines("vn", &NORMALS))
}

fn ply() -> String {
    let rows = CORNERS.iter().zip(&NORMALS).map(|(corner, normal)| words(&[*corner, *normal]) + "\n");
    let floats: String =
        ["x", "y", "z", "nx", "ny", "nz"].map(|name| format!("property float {name}\n")).concat();
    format!(
        "ply\nformat ascii 1.0\nelement vertex 4\n{floats}element face 2\nproperty list uchar int \
         vertex_indices\nend_header\n{}3 0 1 2\n3 1 3 2\n",
        rows.collect::<String>()
    )
}

/// A Collada file whose node has a transform.
fn dae(transform: &str, normals: &str) -> String {
    let source = |id: &str, numbers: &str| {
        let count = numbers.split_whitespace().count();
        format!(
            "<source id='{id}'><float_array id='{id}a' count='{count}'>{numbers}</float_array><technique_common>\
             <accessor source='#{id}a' count='{}' stride='3'/></technique_common></source>",
            count / 3
        )
    };
    format!(
        "<COLLADA version='1.4.1'><library_geometries><geometry id='g'><mesh>{}{}<vertices id='v'><input \
         semantic='POSITION' source='#p'/></vertices><triangles count='2'><input semantic='VERTEX' source='#v' \
         offset='0'/><input semantic='NORMAL' source='#n' offset='1'/><p>0 0 1 1 2 2 1 1 3 3 2 2</p></triangles>\
         </mesh></geometry></library_geometries><library_visual_scenes><visual_scene id='s'><node>{transform}\
         <instance_geometry url='#g'/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene \
         url='#s'/></scene></COLLADA>",
        source("p", &words(&CORNERS)),
        source("n", normals)
    )
}

fn glb(scale: [f64; 3]) -> Vec<u8> {
    let mut model = Model::new();
    let position = model.floats(CORNERS.as_flattened(), "VEC3", 4);
    let normal = model.floats(NORMALS.as_flattened(), "VEC3", 4);
    let indices = model.shorts(&FACES.as_flattened().iter().map(|index| *index as u16).collect::<Vec<_>>());
    model.json["meshes"] = serde_json::json!([{ "primitives": [{
        "attributes": { "POSITION": position, "NORMAL": normal }, "indices": indices }] }]);
    model.json["nodes"] = serde_json::json!([{ "mesh": 0, "scale": scale }]);
    model.json["scenes"] = serde_json::json!([{ "nodes": [0] }]);
    model.glb()
}

/// Returns the normals of the corners of each triangle.
fn normals(meshes: &[Arc<Mesh>]) -> Vec<[DVec3; 3]> {
    let corner = |mesh: &Mesh, at: u32| Vec3::from_array(mesh.normals[at as usize]).as_dvec3();
    let of = |mesh: &Arc<Mesh>| {
        assert_eq!(mesh.normals.len(), mesh.positions.len());
        mesh.triangles.iter().map(|triangle| triangle.map(|at| corner(mesh, at))).collect::<Vec<_>>()
    };
    meshes.iter().flat_map(of).collect()
}

#[track_caller]
fn assert_near(found: &[[DVec3; 3]], expected: &[[DVec3; 3]]) {
    let near = |(a, b): (&[DVec3; 3], &[DVec3; 3])| a.iter().zip(b).all(|(a, b)| a.abs_diff_eq(*b, 1e-6));
    assert!(found.len() == expected.len() && found.iter().zip(expected).all(near), "{found:?} {expected:?}");
}

const ROUND: [[DVec3; 3]; 2] = [[DVec3::NEG_X, DVec3::Z, DVec3::Z], [DVec3::Z, DVec3::X, DVec3::Z]];

#[test]
fn every_format_gives_the_same_normals() {
    let files = Files::new();
    files.write("a.obj", obj());
    files.write("a.ply", ply());
    files.write("a.dae", dae("", &words(&NORMALS)));
    files.write("a.glb", glb([1.0; 3]));
    for name in ["a.obj", "a.ply", "a.dae", "a.glb"] {
        assert_near(&normals(&files.meshes(name)), &ROUND);
    }
    // Corners with the same normal share their vertex.
    assert_eq!(files.meshes("a.obj")[0].positions.len(), 4);
}

#[test]
fn stretched_and_mirrored_nodes_transform_normals_by_the_inverse_transpose() {
    let files = Files::new();
    let slope = "0 0 1  1 0 1  0 1 1  -1 0 1";
    files.write("a.dae", dae("<scale>-2 1 0.5</scale>", slope));
    let turned = |x: f64, y: f64| DVec3::new(x / -2.0, y, 2.0).normalize();
    let (a, b, c, d) = (turned(0.0, 0.0), turned(1.0, 0.0), turned(0.0, 1.0), turned(-1.0, 0.0));
    // The mirrored triangles run the other way round.
    assert_near(&normals(&files.meshes("a.dae")), &[[a, c, b], [b, c, d]]);
    files.write("a.glb", glb([-2.0, 1.0, 0.5]));
    let mirrored = [[DVec3::X, DVec3::Z, DVec3::Z], [DVec3::Z, DVec3::Z, DVec3::NEG_X]];
    assert_near(&normals(&files.meshes("a.glb")), &mirrored);
    // The scale of a description does the same.
    let path = files.write("b.obj", obj());
    let (scale, source, mut diagnostics) =
        (DVec3::new(-2.0, 1.0, 0.5), Source::new("w.sdf", 7), Diagnostics::default());
    let scaled = load_mesh_parts(&path, None, scale, UpAxis::Ignored, &source, &mut diagnostics).unwrap();
    assert_near(&normals(&scaled), &mirrored);
    let flat = load_mesh(&path, DVec3::new(1.0, 1.0, 1e-30), UpAxis::Ignored, &source, &mut diagnostics);
    assert!(flat.unwrap().normals.iter().flatten().all(|value| value.is_finite()));
}

#[test]
fn a_cube_with_a_normal_per_corner_keeps_its_edges() {
    let files = Files::new();
    let corner = |index: usize| [index & 1, index >> 1 & 1, index >> 2].map(|bit| bit as f32);
    let corners: Vec<_> = (0..8).map(corner).collect();
    let sides = [[0, 0, -1], [0, 0, 1], [0, -1, 0], [0, 1, 0], [-1, 0, 0], [1, 0, 0]]
        .map(|side| side.map(|x| x as f32));
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let face = |(at, face): (usize, &[usize; 4])| {
        let words = face.map(|corner| format!(" {}//{}", corner + 1, at + 1)).concat();
        format!("f{words}\n")
    };
    let faces: String = faces.iter().enumerate().map(face).collect();
    files.write("cube.obj", lines("v", &corners) + &lines("vn", &sides) + &faces);
    let meshes = files.meshes("cube.obj");
    assert_eq!((meshes[0].positions.len(), meshes[0].triangles.len()), (24, 12));
    for (triangle, normals) in super::triangles(&meshes).iter().zip(normals(&meshes)) {
        let [a, b, c] = *triangle;
        let flat = (b - a).cross(c - a).normalize();
        assert!(normals.iter().all(|normal| normal.abs_diff_eq(flat, 1e-6)), "{normals:?} {flat}");
    }
}

#[test]
fn what_has_no_normals_is_flat() {
    let files = Files::new();
    files.write("a.obj", obj().replace("//1", "").replace("//2", "").replace("//3", "").replace("//4", ""));
    assert!(files.meshes("a.obj")[0].normals.is_empty());
    // The second face has none, so it keeps its own, and the first is round.
    files.write("a.obj", obj().replace("f 2//2 4//4 3//3", "f 2 4 3"));
    let flat = [DVec3::new(1.0, 0.0, 1.0).normalize(); 3];
    assert_near(&normals(&files.meshes("a.obj")), &[ROUND[0], flat]);
    // Numbers that are no normals leave their triangles flat, and do not prevent the file from being read.
    for bad in ["0 0 0", "nan 0 1", "1 0"] {
        files.write("a.obj", obj().replace("vn 1 0 0", &format!("vn {bad}")));
        assert_near(&normals(&files.meshes("a.obj")), &[ROUND[0], flat]);
    }
    files.write("a.obj", obj().replace("4//4", "4//9"));
    assert_near(&normals(&files.meshes("a.obj")), &[ROUND[0], flat]);
    files.write("a.dae", dae("", "0 0 1"));
    let left = [DVec3::new(-1.0, 0.0, 1.0).normalize(); 3];
    assert_near(&normals(&files.meshes("a.dae")), &[left, flat]);
}
