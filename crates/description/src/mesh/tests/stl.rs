//! STL.

use super::{Files, area, bounds};

fn facet(x: f64) -> String {
    format!(
        "facet normal 0 0 1\n outer loop\n vertex {x} 0 0\n vertex {} 0 0\n vertex {x} 1 0\n endloop\nendfacet\n",
        x + 1.0
    )
}

pub(super) fn binary(said: u32, triangles: usize, more: usize) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(said.to_le_bytes());
    for at in 0..triangles {
        bytes.extend([0; 12]);
        let corners = [[at as f32, 0.0, 0.0], [at as f32 + 1.0, 0.0, 0.0], [at as f32, 1.0, 0.0]];
        bytes.extend(corners.as_flattened().iter().flat_map(|number| number.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes.resize(bytes.len() + more, 0);
    bytes
}

#[test]
fn each_solid_is_a_part() {
    let files = Files::new();
    files.write(
        "a.stl",
        format!("solid left one\n{}endsolid left one\n\nSOLID right\n{}endsolid\n", facet(0.0), facet(4.0)),
    );
    assert!((area(&files.meshes("a.stl")) - 1.0).abs() < 1e-9);
    assert_eq!(bounds(&files.part("a.stl", "right")), [[4.0, 0.0, 0.0], [5.0, 1.0, 0.0]]);
    assert_eq!(bounds(&files.part("a.stl", "left one")), [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    // A byte-order mark, as editors on Windows write it.
    files.write("a.stl", format!("\u{feff}solid a\n{}endsolid a\n", facet(2.0)));
    assert_eq!(bounds(&files.meshes("a.stl")), [[2.0, 0.0, 0.0], [3.0, 1.0, 0.0]]);
    // All in one line.
    files.write("a.stl", format!("solid a {} endsolid a", facet(2.0).replace('\n', " ")));
    assert_eq!(bounds(&files.meshes("a.stl")), [[2.0, 0.0, 0.0], [3.0, 1.0, 0.0]]);
}

#[test]
fn wrong_counts_are_reported() {
    let files = Files::new();
    files.write("a.stl", binary(3, 2, 0));
    let error = files.error("a.stl");
    assert!(error.contains("it declares 3 triangles, and has 2"), "{error}");
    files.write("a.stl", binary(u32::MAX, 2, 7));
    assert!(files.error("a.stl").contains("4294967295 triangles"));
    // A binary file that begins like text.
    let mut bytes = binary(3, 2, 0);
    bytes[..9].copy_from_slice(b"solid box");
    bytes[9..80].fill(0);
    files.write("a.stl", bytes);
    assert!(files.error("a.stl").contains("3 triangles"));
    for (said, triangles, more, words) in [
        (1, 2, 0, "declares 1 triangles, and has bytes for 2: the others are left out"),
        (2, 2, 4, "has 4 bytes after its 2 triangles: they are left out"),
    ] {
        files.write("a.stl", binary(said, triangles, more));
        let (meshes, problems) = files.load("a.stl");
        assert!((area(&meshes.unwrap()) - f64::from(said) / 2.0).abs() < 1e-9);
        assert!(
            problems.len() == 1 && problems[0].contains(&format!(": warning: the mesh a.stl {words}")),
            "{problems:?}"
        );
    }
}

#[test]
fn broken_text_names_its_line() {
    let files = Files::new();
    let whole = format!("solid a\n{}endsolid a\n", facet(0.0));
    for (from, to, words) in [
        (
            "vertex 1 0 0",
            "vertex 1 x 0",
            "a.stl:5: error: the mesh a.stl cannot be read: 'x' is not a number",
        ),
        ("vertex 1 0 0", "vertex 1 0", "a.stl:5: "),
        (" vertex 1 0 0\n", "", "a.stl:6: error: the mesh a.stl cannot be read: a facet has 2 corners"),
        (" endloop\nendfacet\nendsolid a\n", "", "within a facet"),
    ] {
        files.write("a.stl", whole.replace(from, to));
        let error = files.error("a.stl");
        assert!(error.contains(words), "{error}");
    }
    files.write("a.stl", whole.replace("endsolid a\n", ""));
    let (meshes, problems) = files.load("a.stl");
    assert!(
        meshes.is_some() && problems.len() == 1 && problems[0].contains("without endsolid"),
        "{problems:?}"
    );
    files.write("a.stl", b"<html>not found</html>");
    assert!(files.error("a.stl").contains("text that begins with 'solid'"));
}
