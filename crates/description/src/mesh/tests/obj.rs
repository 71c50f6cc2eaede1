//! Wavefront OBJ.

use super::{Files, L, area, assert_l, bounds};

#[test]
fn concave_faces_keep_their_notch() {
    let files = Files::new();
    let vertices = L.map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat();
    // From every corner, and by indices that count backwards.
    for first in 0..6 {
        let face: Vec<String> = (0..6).map(|at| ((first + at) % 6 + 1).to_string()).collect();
        files.write("l.obj", format!("{vertices}f {}\n", face.join(" ")));
        assert_l(&files.meshes("l.obj"));
    }
    files.write("l.obj", format!("{vertices}f -6 -5 -4 -3 -2 -1\n"));
    assert_l(&files.meshes("l.obj"));
}

#[test]
fn statements_continue_after_a_backslash() {
    let files = Files::new();
    files.write("a.obj", "v 0 0 \\\n 0\r\nv 2 0 0 \\\r\n\nv 0 3 0 # a corner\nf 1 \\\n 2 \\\n 3\n");
    assert!((area(&files.meshes("a.obj")) - 3.0).abs() < 1e-9);
    files.write("a.obj", "v 0 0 0\nv 2 \\\n x 0\n");
    assert!(
        files
            .error("a.obj")
            .starts_with("a.obj:2: error: the mesh a.obj cannot be read: 'x' is not a number")
    );
}

/// Colours of vertices are ignored, as in Gazebo; a single fourth number is a weight.
#[test]
fn additional_numbers_of_a_vertex() {
    let files = Files::new();
    files.write("a.obj", "v 0 0 0 1 0 0\nv 2 0 0 0.5 0.5 0.5\nv 0 6 0 2\nf 1 2 3\n");
    assert!((area(&files.meshes("a.obj")) - 3.0).abs() < 1e-9);
    files.write("a.obj", "v 0 0 0 0\n");
    assert!(files.error("a.obj").contains("a.obj:1: "));
}

#[test]
fn groups_and_objects_are_parts() {
    let files = Files::new();
    let triangle = |x: f64| format!("v {x} 0 0\nv {} 0 0\nv {x} 1 0\nf -3 -2 -1\n", x + 1.0);
    let text = format!("o arm\n{}g hand\n{}o leg\n{}", triangle(0.0), triangle(2.0), triangle(4.0));
    files.write("a.obj", text);
    assert_eq!(bounds(&files.part("a.obj", "arm")), [[0.0, 0.0, 0.0], [3.0, 1.0, 0.0]]);
    assert_eq!(bounds(&files.part("a.obj", "hand")), [[2.0, 0.0, 0.0], [3.0, 1.0, 0.0]]);
    assert_eq!(bounds(&files.part("a.obj", "leg")), [[4.0, 0.0, 0.0], [5.0, 1.0, 0.0]]);
}

#[test]
fn materials_hold_across_groups_and_files() {
    let files = Files::new();
    files.write("my paint.mtl", "newmtl red\nKd 1 0 0\nnewmtl grey\nKd 0.5\nTr 0.25\n");
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0.25 0.75\n";
    files.write(
        "a.obj",
        format!("mtllib my paint.mtl\n{corners}usemtl red\ng a\nf 1 2 3\ng b\nf 2/1 4/1 3\nusemtl grey\nf 1/1 4 2\n"),
    );
    let meshes = files.meshes("a.obj");
    let looks: Vec<_> = meshes.iter().map(|mesh| mesh.material.clone().unwrap()).collect();
    assert_eq!((looks[0].diffuse, looks[1].diffuse, looks[1].alpha), ([1.0, 0.0, 0.0], [0.5; 3], 0.75));
    assert_eq!((meshes[0].triangles.len(), meshes[1].triangles.len(), looks.len()), (2, 1, 2));
    assert_eq!(meshes[0].uvs, [[0.0; 2], [0.0; 2], [0.0; 2], [0.25, 0.75], [0.25, 0.75], [0.0; 2]]);
    assert_eq!(meshes[1].uvs, [[0.25, 0.75], [0.0; 2], [0.0; 2]]);
}

#[test]
fn each_missing_item_gives_one_warning() {
    let files = Files::new();
    files.write("paint.mtl", "newmtl red\nKd 1 0 0\nmap_Kd -s 2 2 1 gone.png\n");
    let faces = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    for (text, words) in [
        (
            format!("\nmtllib gone.mtl\nusemtl a\n{faces}usemtl b\nf 1 2 3\n"),
            "a.obj:2: warning: the materials in gone.mtl",
        ),
        (format!("mtllib paint.mtl\nusemtl rd\n{faces}g x\nf 1 2 3\n"), "did you mean 'red'"),
        (format!("mtllib paint.mtl\nusemtl red\n{faces}g x\nf 1 2 3\n"), "there is no texture gone.png"),
        (
            format!("{faces}f 1 2\nf 3\n"),
            "a.obj:5: warning: a face of fewer than three corners: it is left out",
        ),
        (format!("{faces}surf 0 1 0 1 1 2 3\nsurf 0 1 0 1 1 2 3\n"), "a.obj:5: warning: free-form surfaces"),
    ] {
        files.write("a.obj", text);
        let (meshes, problems) = files.load("a.obj");
        assert!(meshes.is_some() && problems.len() == 1 && problems[0].contains(words), "{problems:?}");
    }
}

#[test]
fn indices_of_faces_are_checked() {
    let files = Files::new();
    for (face, words) in [
        ("1 2 4", "a.obj:4: error: the mesh a.obj cannot be read: the face names vertex 4, but there are 3"),
        ("1 2 0", "vertex 0, but there are 3"),
        ("1 2 -4", "vertex -4, but there are 3"),
        ("1/1 2 3", "texture coordinate 1, but there are 0"),
        ("1 2 x", "'x' is not the number of a vertex"),
    ] {
        files.write("a.obj", format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf {face}\n"));
        let error = files.error("a.obj");
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn utf_16_and_windows_line_ends_are_read() {
    let files = Files::new();
    let text = "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n";
    for mark in ["", "\u{feff}"] {
        for in_bytes in [u16::to_le_bytes, u16::to_be_bytes] {
            let wide: Vec<u8> = format!("{mark}{text}").encode_utf16().flat_map(in_bytes).collect();
            files.write("a.obj", wide);
            assert!((area(&files.meshes("a.obj")) - 0.5).abs() < 1e-9);
        }
    }
    files.write("a.obj", format!("\u{feff}{text}"));
    assert!((area(&files.meshes("a.obj")) - 0.5).abs() < 1e-9);
}
