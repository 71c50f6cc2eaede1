//! PLY.

use super::{Files, L, area, assert_l, bounds};

fn header(format: &str, more: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment made by hand\nelement vertex 6\nproperty float x\nproperty float y\n\
         property double z\nproperty uchar red\n{more}element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    )
}

#[test]
fn text_and_binary_of_both_byte_orders_are_equal() {
    let files = Files::new();
    let rows = L.map(|[x, y, z]| format!("{x} {y} {z} 255\n")).concat();
    files.write("text.ply", format!("{}{rows}6 0 1 2 3 4 5\n", header("ascii", "")));
    assert_l(&files.meshes("text.ply"));
    for (format, little) in [("binary_little_endian", true), ("binary_big_endian", false)] {
        let mut bytes = header(format, "").into_bytes();
        let mut put = |number: &[u8]| {
            let mut number = number.to_vec();
            if !little {
                number.reverse();
            }
            bytes.extend(number);
        };
        for [x, y, z] in L {
            put(&(x as f32).to_le_bytes());
            put(&(y as f32).to_le_bytes());
            put(&z.to_le_bytes());
            put(&[255]);
        }
        put(&[6]);
        (0..6_i32).for_each(|corner| put(&corner.to_le_bytes()));
        files.write("bytes.ply", &bytes);
        assert_l(&files.meshes("bytes.ply"));
        files.write("bytes.ply", &bytes[..bytes.len() - 1]);
        assert!(
            files
                .error("bytes.ply")
                .contains("w.sdf:7: error: the mesh bytes.ply cannot be read: the file ends")
        );
    }
}

#[test]
fn texture_coordinates_belong_to_vertices_or_corners() {
    let files = Files::new();
    files.write("wood.png", b"");
    let head = "ply\nformat ascii 1.0\ncomment TextureFile wood.png\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
    let list = "element face 2\nproperty list uchar uint vertex_index\n";
    let text = format!(
        "{head}property float s\nproperty float t\n{list}end_header\n\
         0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n3 0 1 2\n3 0 2 3\n"
    );
    files.write("a.ply", text);
    let meshes = files.meshes("a.ply");
    assert_eq!(meshes[0].uvs, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    assert!(meshes[0].material.as_ref().unwrap().texture.as_ref().unwrap().ends_with("wood.png"));
    let text = format!(
        "{head}{list}property list uchar float texcoord\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n\
         3 0 1 2 6 0 0 .5 0 .5 .5\n3 0 2 3 6 0 0 1 1 0 1\n"
    );
    files.write("a.ply", text);
    let meshes = files.meshes("a.ply");
    assert_eq!(meshes[0].uvs, [[0.0, 0.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    assert!((area(&meshes) - 1.0).abs() < 1e-9);
}

#[test]
fn strips_are_read_and_unknown_elements_ignored() {
    let files = Files::new();
    let text = "ply\nformat ascii 1.0\nelement camera 1\nproperty float f\nproperty list uchar float k\nelement vertex 4\n\
                property float x\nproperty float y\nproperty float z\nelement tristrips 1\n\
                property list int int vertex_indices\nend_header\n7 2 1 1\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 2 1 3\n";
    files.write("a.ply", text);
    let meshes = files.meshes("a.ply");
    assert_eq!(bounds(&meshes), [[0.0; 3], [1.0, 1.0, 0.0]]);
    let up = super::triangles(&meshes);
    assert!(up.iter().all(|[a, b, c]| (b - a).cross(c - a).z > 0.0), "{up:?}");
    assert_eq!(up.len(), 3);
}

#[test]
fn faces_of_fewer_than_three_corners_are_a_warning() {
    let files = Files::new();
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                element face 3\nproperty list uchar int vertex_indices\nend_header\n\
                0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n2 0 1\n0\n";
    files.write("a.ply", text);
    let (meshes, problems) = files.load("a.ply");
    assert!((area(&meshes.unwrap()) - 0.5).abs() < 1e-9);
    let [problem] = &problems[..] else { panic!("{problems:?}") };
    assert!(
        problem.contains("warning: the mesh a.ply: a face of fewer than three corners: it is left out"),
        "{problem}"
    );
}

#[test]
fn broken_files_name_their_line() {
    let files = Files::new();
    let rows = L.map(|[x, y, z]| format!("{x} {y} {z} 255\n")).concat();
    let whole = format!("{}{rows}6 0 1 2 3 4 5\n", header("ascii", ""));
    for (from, to, words) in [
        ("ply\n", "plx\n", "a.ply:1: "),
        ("ascii", "binary", "a.ply:2: error: the mesh a.ply cannot be read: the format is 'binary'"),
        ("uchar red", "colour red", "a.ply:8: "),
        ("end_header", "end", "the header has no end_header"),
        (
            "6 0 1 2 3 4 5",
            "6 0 1 2 3 4 6",
            "a.ply:18: error: the mesh a.ply cannot be read: a face names vertex 6, but there are 6",
        ),
        ("6 0 1 2 3 4 5", "6 0 1 2", "the file ends before"),
        ("6 0 1 2 3 4 5", "-1", "a list has -1 entries"),
        ("2 1 1 255", "2 one 1 255", "a.ply:12: error: the mesh a.ply cannot be read: 'one' is not a number"),
        ("float x", "float a", "no x, y and z"),
        ("vertex_indices", "corners", "no vertex_indices"),
        ("element face 1", "element face 4000000000", "the file ends before"),
    ] {
        files.write("a.ply", whole.replacen(from, to, 1));
        let error = files.error("a.ply");
        assert!(error.contains(words), "{from}: {error}");
    }
}
