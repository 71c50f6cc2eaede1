//! Files of every format, checked by areas, bounds and rays that were computed by hand.

mod collada;
mod gltf;
mod gltf_look;
mod normals;
mod obj;
mod ply;
mod stl;

use super::{Submesh, UpAxis, load_mesh_parts};
use crate::diagnostics::{Diagnostics, Source};
use crate::model::Mesh;
use glam::DVec3;
use std::sync::Arc;

/// Files in a temporary folder.
struct Files(tempfile::TempDir);

impl Files {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) -> std::path::PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, content).unwrap();
        path
    }

    /// Loads a file as one mesh per material, and returns the problems as text.
    fn load_as(
        &self,
        name: &str,
        submesh: Option<&str>,
        up: UpAxis,
    ) -> (Option<Vec<Arc<Mesh>>>, Vec<String>) {
        let mut diagnostics = Diagnostics::default();
        let submesh = submesh.map(|name| Submesh { name: name.into(), is_centred: false });
        let (path, source) = (self.0.path().join(name), Source::new("w.sdf", 7));
        let meshes = load_mesh_parts(&path, submesh.as_ref(), DVec3::ONE, up, &source, &mut diagnostics);
        assert_eq!(meshes.is_none(), diagnostics.has_errors());
        let folder = format!("{}/", self.0.path().display());
        let words = |problem: &crate::diagnostics::Problem| problem.to_string().replace(&folder, "");
        (meshes, diagnostics.problems().iter().map(words).collect())
    }

    fn load(&self, name: &str) -> (Option<Vec<Arc<Mesh>>>, Vec<String>) {
        self.load_as(name, None, UpAxis::Ignored)
    }

    /// Loads a file that has no problems.
    #[track_caller]
    fn meshes(&self, name: &str) -> Vec<Arc<Mesh>> {
        let (meshes, problems) = self.load(name);
        assert!(problems.is_empty(), "{problems:?}");
        meshes.unwrap()
    }

    /// Loads a part of a file that has no problems.
    #[track_caller]
    fn part(&self, name: &str, part: &str) -> Vec<Arc<Mesh>> {
        let (meshes, problems) = self.load_as(name, Some(part), UpAxis::Ignored);
        assert!(problems.is_empty(), "{problems:?}");
        meshes.unwrap()
    }

    /// Loads a file with an error, and returns the error.
    #[track_caller]
    fn error(&self, name: &str) -> String {
        let (meshes, mut problems) = self.load(name);
        assert!(meshes.is_none() && problems.len() == 1, "{problems:?}");
        problems.remove(0)
    }
}

/// Returns the corners of each triangle.
fn triangles(meshes: &[Arc<Mesh>]) -> Vec<[DVec3; 3]> {
    let corner = |mesh: &Mesh, at: u32| DVec3::from_array(mesh.positions[at as usize].map(f64::from));
    let of = |mesh: &Arc<Mesh>| {
        mesh.triangles.iter().map(|triangle| triangle.map(|at| corner(mesh, at))).collect::<Vec<_>>()
    };
    meshes.iter().flat_map(of).collect()
}

fn area(meshes: &[Arc<Mesh>]) -> f64 {
    triangles(meshes).iter().map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0).sum()
}

/// Returns the volume that a closed surface encloses, positive if it faces outwards.
fn volume(meshes: &[Arc<Mesh>]) -> f64 {
    triangles(meshes).iter().map(|[a, b, c]| a.dot(b.cross(*c)) / 6.0).sum()
}

/// Returns the corners of the box around the triangles.
fn bounds(meshes: &[Arc<Mesh>]) -> [[f64; 3]; 2] {
    let corners = || triangles(meshes).into_iter().flatten();
    let low = corners().fold(DVec3::INFINITY, DVec3::min);
    [low, corners().fold(DVec3::NEG_INFINITY, DVec3::max)]
        .map(|corner| (corner * 1e6).round().to_array().map(|it| it / 1e6))
}

/// Counts the intersections of a ray with the triangles, front and back.
fn hits(meshes: &[Arc<Mesh>], origin: [f64; 3], direction: [f64; 3]) -> usize {
    let (origin, direction) = (DVec3::from(origin), DVec3::from(direction));
    let meets = |[a, b, c]: &[DVec3; 3]| {
        let normal = (b - a).cross(c - a);
        let turn = direction.dot(normal).signum();
        let before = (a - origin).dot(normal) / direction.dot(normal);
        // The ray is on the same side of each edge.
        let passes =
            |from: &DVec3, to: &DVec3| direction.dot((from - origin).cross(to - origin)) * turn > 0.0;
        before > 0.0 && passes(a, b) && passes(b, c) && passes(c, a)
    };
    triangles(meshes).iter().filter(|triangle| meets(triangle)).count()
}

/// The outline of an L in the plane z = 1, whose notch is from (1, 1) to (2, 2).
const L: [[f64; 3]; 6] =
    [[2.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 2.0, 1.0], [0.0, 2.0, 1.0], [0.0, 0.0, 1.0], [2.0, 0.0, 1.0]];

/// Asserts that a mesh is the L: a ray into its notch hits nothing.
#[track_caller]
fn assert_l(meshes: &[Arc<Mesh>]) {
    assert!((area(meshes) - 3.0).abs() < 1e-6, "{}", area(meshes));
    let down = [0.0, 0.0, -1.0];
    assert_eq!(hits(meshes, [1.4, 1.3, 5.0], down), 0);
    for (x, y) in [(0.4, 1.7), (0.3, 0.2), (1.7, 0.6)] {
        assert_eq!(hits(meshes, [x, y, 5.0], down), 1, "{x} {y}");
    }
    assert!(triangles(meshes).iter().all(|[a, b, c]| (b - a).cross(c - a).z > 0.0));
}

#[test]
fn a_remote_texture_is_a_warning() {
    let files = Files::new();
    files.write("m.mtl", "newmtl a\nmap_Kd https://example.org/wood.png\n");
    files.write("m.obj", "mtllib m.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let (meshes, problems) = files.load("m.obj");
    assert!(meshes.unwrap()[0].material.as_ref().unwrap().texture.is_none());
    let [problem] = &problems[..] else { panic!("{problems:?}") };
    assert!(
        problem.contains("w.sdf:7: warning: the texture https://example.org/wood.png, which the mesh m.obj names, is remote"),
        "{problem}"
    );
    assert!(problem.contains("download it"), "{problem}");
}

/// Random bytes of a file are changed: it is read or refused, and nothing panics.
#[test]
fn damaged_files_are_read_or_refused() {
    let files = Files::new();
    let faces = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 1 0\nvt 0 0\ng a\nf 1/1 2/1 3/1 4/1\nf -4 -3 -2\n";
    let solid = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
    let head = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let ply = format!("{head}0 0 0\n2 0 0\n2 2 0\n1 0.5 0\n4 0 1 2 3\n");
    let mut binary = head.replace("ascii", "binary_big_endian").into_bytes();
    binary.extend(
        [[0.0_f32, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [1.0, 0.5, 0.0]]
            .as_flattened()
            .iter()
            .flat_map(|number| number.to_be_bytes()),
    );
    binary.extend([4, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3]);
    let originals: [(&str, Vec<u8>); 7] = [
        ("a.obj", faces.into()),
        ("a.stl", solid.into()),
        ("b.stl", stl::binary(2, 2, 0)),
        ("a.ply", ply.into()),
        ("b.ply", binary),
        ("a.dae", collada::with_a_hole().into()),
        ("a.glb", gltf::Model::block().glb()),
    ];
    // Knuth's generator, whose high bits are good enough.
    let mut state = 1_u64;
    let mut below = |count: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % count
    };
    for (name, original) in originals {
        files.write(name, &original);
        files.meshes(name);
        for _ in 0..300 {
            let mut bytes = original.clone();
            for _ in 0..=below(3) {
                let at = below(bytes.len());
                match below(4) {
                    0 => bytes[at] = below(256) as u8,
                    1 => bytes[at] = b'0' + below(10) as u8,
                    2 => bytes.truncate(at + 1),
                    _ => {
                        bytes.remove(at);
                        bytes.push(b' ');
                    }
                }
            }
            files.write(name, bytes);
            // If the file is refused, there must be an error, which `load_as` asserts.
            files.load(name);
        }
    }
}
