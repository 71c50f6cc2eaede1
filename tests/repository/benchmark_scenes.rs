//! The scenes of the benchmarks are exactly as recorded.
//!
//! With `RAYCAST_DATA=DIR` they are also compared with the files of a benchmark of several ray casters (`.scn`:
//! `SCN1`, counts of vertices and triangles, both as arrays; `.ray`: `RAY1`, count, width, height, whether the
//! origin is shared, origins, directions; 32 bits each, little-endian).

#![allow(clippy::unreadable_literal, reason = "sums, as another program printed them")]

#[path = "../../benches/scenes/mod.rs"]
mod scenes;

use scenes::{RAYS, RaySet, SCENES, Scene};
use std::path::Path;

/// Counts, and sums over all coordinates with vector i weighted by 1 + i mod 7, computed by an independent program in
/// another language.
struct Expected {
    name: &'static str,
    vertices: usize,
    triangles: usize,
    vertex_sum: [f64; 3],
    /// Σ i·index over the indices of all triangles in their order, wrapping.
    index_sum: u64,
    /// The sums of the directions of R1, R3 and R5.
    direction_sums: [[f64; 3]; 3],
    random_origin_sum: [f64; 3],
}

const EXPECTED: [Expected; 4] = [
    Expected {
        name: "S1",
        vertices: 1_108,
        triangles: 2_112,
        vertex_sum: [26066.201902, 15679.412752, 3405.612137],
        index_sum: 15_026_063_364,
        direction_sums: [
            [995659.25238, 543931.659044, -90959.01784],
            [-4.205321, -2.287906, -0.74377],
            [1552.286467, 72.540238, 2000.442091],
        ],
        random_origin_sum: [20013160.50791, 16002682.200337, 5995139.648053],
    },
    Expected {
        name: "S2",
        vertices: 66_928,
        triangles: 100_392,
        vertex_sum: [8235619.691433, 5624451.766775, 1061973.873941],
        index_sum: 2_023_594_675_505_634,
        direction_sums: [
            [1128590.931268, 136085.215286, 56884.651674],
            [-4.753974, -0.564853, -0.74377],
            [-4846.334343, -2260.133411, 4775.923028],
        ],
        random_origin_sum: [124135096.997729, 84051916.214146, 17987996.722622],
    },
    Expected {
        name: "S3",
        vertices: 502_215,
        triangles: 997_376,
        vertex_sum: [-44523.389037, 7034.632509, 6463171.899749],
        index_sum: 1_493_367_259_987_523_072,
        direction_sums: [
            [1123425.738478, 181298.31133, 22761.194193],
            [-4.727577, -0.754497, -0.74377],
            [949.556935, -2534.998961, 1241.647345],
        ],
        random_origin_sum: [31737.459458, -14873.609492, 16010369.627442],
    },
    Expected {
        name: "S4",
        vertices: 251_001,
        triangles: 500_000,
        vertex_sum: [50200100.400087, 50199899.400085, 1187423.371329],
        index_sum: 164_625_094_062_875_000,
        direction_sums: [
            [866184.98013, 729578.152671, -113630.272485],
            [-3.666972, -3.077756, -0.74377],
            [862.55079, -1897.143519, 2463.320221],
        ],
        random_origin_sum: [200018235.997756, 199995672.565735, 1020345.223697],
    },
];

#[test]
fn scenes_are_as_recorded() {
    for expected in &EXPECTED {
        let scene = Scene::new(expected.name);
        let mesh = &scene.mesh;
        assert_eq!(mesh.vertices.len(), expected.vertices, "{}", expected.name);
        assert_eq!(mesh.triangles.len(), expected.triangles, "{}", expected.name);
        near(sum(&mesh.vertices), expected.vertex_sum, mesh.vertices.len(), expected.name);
        let indices = mesh.triangles.as_flattened().iter().zip(1_u64..);
        let index_sum = indices.fold(0_u64, |sum, (&index, at)| sum.wrapping_add(at * u64::from(index)));
        assert_eq!(index_sum, expected.index_sum, "{}", expected.name);

        for (name, expected_sum) in ["R1", "R3", "R5"].into_iter().zip(expected.direction_sums) {
            let rays = RaySet::new(name, &scene);
            near(sum(&rays.directions), expected_sum, rays.len(), name);
            if name == "R5" {
                near(sum(&rays.origins), expected.random_origin_sum, rays.len(), name);
            }
        }
    }
}

fn sum(vectors: &[[f32; 3]]) -> [f64; 3] {
    let weighted = vectors.iter().zip((0..7).cycle());
    weighted
        .fold([0.0; 3], |sum, (v, i)| [0, 1, 2].map(|axis| sum[axis] + f64::from(1 + i) * f64::from(v[axis])))
}

/// A single vector may differ by the last bit of a sine.
fn near(sum: [f64; 3], expected: [f64; 3], count: usize, what: &str) {
    for axis in 0..3 {
        let off = (sum[axis] - expected[axis]).abs();
        assert!(off < 4e-7 * (1.0 + count as f64), "{what}: {sum:?} is not {expected:?}");
    }
}

#[test]
fn scenes_equal_the_files() {
    let Ok(directory) = std::env::var("RAYCAST_DATA") else {
        return; // There are no files to compare with. `scenes_are_as_recorded` has the sums of the same files.
    };
    for name in SCENES {
        let scene = Scene::new(name);
        let words = words(&find(&directory, &format!("{name}_"), ".scn"));
        let vertices = words[1] as usize;
        assert_eq!([vertices, words[2] as usize], [scene.mesh.vertices.len(), scene.mesh.triangles.len()]);
        let (theirs, triangles) = words[3..].split_at(3 * vertices);
        assert!(triangles == scene.mesh.triangles.as_flattened(), "{name}: triangles");
        same(scene.mesh.vertices.as_flattened(), theirs, name);
        for set in RAYS {
            let rays = RaySet::new(set, &scene);
            let words = self::words(&find(&directory, &format!("{name}_"), &format!(".{set}_")));
            assert_eq!(words[1..4], [rays.len() as u32, rays.width as u32, rays.height as u32]);
            let (origins, directions) = words[5..].split_at(3 * rays.len());
            let ours: Vec<[f32; 3]> = (0..rays.len()).map(|ray| rays.origin(ray)).collect();
            same(ours.as_flattened(), origins, set);
            same(rays.directions.as_flattened(), directions, set);
        }
    }
}

fn find(directory: &str, start: &str, part: &str) -> std::path::PathBuf {
    let entries = std::fs::read_dir(Path::new(directory)).expect("RAYCAST_DATA is a directory");
    let mut paths = entries.map(|entry| entry.expect("readable").path());
    let is_it = |path: &std::path::PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with(start) && name.contains(part)
    };
    paths.find(is_it).unwrap_or_else(|| panic!("no {start}*{part}* in {directory}"))
}

fn words(path: &Path) -> Vec<u32> {
    let bytes = std::fs::read(path).expect("readable");
    bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect()
}

fn same(ours: &[f32], theirs: &[u32], what: &str) {
    assert_eq!(ours.len(), theirs.len(), "{what}");
    let mut different = 0;
    for (at, (&ours, &theirs)) in ours.iter().zip(theirs).enumerate() {
        let theirs = f32::from_bits(theirs);
        different += usize::from(ours != theirs);
        let off = (ours - theirs).abs();
        assert!(off <= 1e-6 * theirs.abs().max(1.0), "{what}: value {at} is {ours}, not {theirs}");
    }
    println!("{what}: {different} of {} values differ in their last bits", ours.len());
}
