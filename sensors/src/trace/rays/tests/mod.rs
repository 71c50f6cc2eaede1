//! Rays against an oracle in double precision that tests every triangle, at every SIMD level.

mod edges;
mod instances;
mod oracle;

use super::{MeshTree, Rays, cast_mesh, occluded_by_mesh};
use crate::Execution;
use crate::scene::build;
use crate::simd::Level;
use crate::trace::{Faces, Hits};
use oracle::{Answer, Random, sphere};

/// Every level of this machine.
fn levels() -> Vec<Level> {
    let best = Level::new();
    #[cfg(target_arch = "x86_64")]
    return [
        best.as_sse2().map(Level::Sse2),
        best.as_avx2().map(Level::Avx2),
        best.as_avx512().map(Level::Avx512),
    ]
    .into_iter()
    .flatten()
    .collect();
    #[cfg(not(target_arch = "x86_64"))]
    return vec![Level::baseline(), best];
}

/// A mesh with its tree.
pub(super) struct Mesh {
    pub(super) vertices: Vec<[f32; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
    tree: build::Tree,
}

/// The outputs for each ray.
#[derive(Debug, PartialEq)]
pub(super) struct Found {
    pub(super) distance: Vec<f32>,
    pub(super) normal: Vec<[f32; 3]>,
    pub(super) primitive: Vec<u32>,
    pub(super) occluded: Vec<bool>,
}

impl Mesh {
    pub(super) fn new((vertices, triangles): (Vec<[f32; 3]>, Vec<[u32; 3]>)) -> Self {
        let tree = build::Tree::build(&vertices, &triangles, build::Quality::High, Execution::default())
            .expect("a valid mesh");
        Self { vertices, triangles, tree }
    }

    fn cast_at(&self, level: Level, rays: &Rays<'_>, faces: Faces) -> Found {
        let count = rays.directions.len();
        let mut found = Found {
            distance: vec![-1.0; count],
            normal: vec![[0.0; 3]; count],
            primitive: vec![7; count],
            occluded: vec![false; count],
        };
        let tree = MeshTree { nodes: &self.tree.nodes, blocks: &self.tree.blocks };
        let mut hits = Hits {
            distance: Some(&mut found.distance),
            normal: Some(&mut found.normal),
            primitive: Some(&mut found.primitive),
            ..Hits::default()
        };
        cast_mesh(level, tree, rays, faces, &mut hits).expect("outputs of the right size");
        occluded_by_mesh(level, tree, rays, faces, &mut found.occluded).expect("outputs of the right size");
        found
    }

    /// Casts at every level, checks that all give the same bits, and returns the hits.
    pub(super) fn cast(&self, rays: &Rays<'_>, faces: Faces) -> Found {
        let mut answers = levels().into_iter().map(|level| (level, self.cast_at(level, rays, faces)));
        let (_, first) = answers.next().expect("a level");
        for (level, other) in answers {
            let bits = |found: &Found| found.distance.iter().map(|t| t.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&first), bits(&other), "{level:?}");
            assert!(first == other, "{level:?}");
        }
        for (distance, occluded) in first.distance.iter().zip(&first.occluded) {
            assert_eq!(distance.is_finite(), *occluded);
        }
        first
    }

    /// Casts, and compares with the oracle: hits and misses may differ only if the ray passes an edge within 1e-6 of
    /// its length, and distances by at most 1e-5 of themselves. Returns the number of hits.
    pub(super) fn check(&self, rays: &Rays<'_>, faces: Faces) -> usize {
        let found = self.cast(rays, faces);
        self.compare(rays, faces, &found.distance, &found.normal, 0.0)
    }

    /// Compares the outputs with the oracle's; vertices have errors of up to `rounding` metres.
    pub(super) fn compare(
        &self,
        rays: &Rays<'_>,
        faces: Faces,
        distance: &[f32],
        normal: &[[f32; 3]],
        rounding: f64,
    ) -> usize {
        for index in 0..rays.directions.len() {
            let origin = if rays.origins.len() == 1 { rays.origins[0] } else { rays.origins[index] };
            let range = rays.ranges.map_or([0.0, f32::INFINITY], |ranges| ranges[index]);
            let answer = oracle::nearest(self, origin, rays.directions[index], range, faces);
            let t = distance[index];
            match answer {
                Answer::Doubtful => {}
                Answer::Miss => assert!(t == f32::INFINITY, "ray {index}: {t} instead of a miss"),
                Answer::Hit { t: expected, normal: across } => {
                    let error = ((f64::from(t) - expected).abs() - rounding) / expected.abs().max(1e-30);
                    assert!(error < 1e-5, "ray {index}: {t} instead of {expected}");
                    let n = normal[index];
                    let cosine: f64 = (0..3).map(|axis| f64::from(n[axis]) * across[axis]).sum();
                    assert!((cosine - 1.0).abs() < 1e-4, "ray {index}: {n:?} instead of {across}");
                }
            }
        }
        distance.iter().filter(|t| t.is_finite()).count()
    }
}

/// Rays that start around a box of this half size, in all directions.
fn around(random: &mut Random, count: usize, half: f32) -> (Vec<[f32; 3]>, Vec<[f32; 3]>) {
    let origins = (0..count).map(|_| random.point(half)).collect();
    let directions = (0..count).map(|_| random.direction()).collect();
    (origins, directions)
}

#[test]
fn triangles_anywhere_agree_with_the_oracle() {
    let mut random = Random(1);
    for (count, size) in [(1, 1.0), (2, 1.0), (16, 1.0), (17, 0.5), (300, 0.3), (3000, 0.1)] {
        let mesh = Mesh::new(oracle::soup(&mut random, count, size));
        let (origins, directions) = around(&mut random, 1000, 1.5);
        for faces in [Faces::Both, Faces::Front] {
            mesh.check(&Rays { origins: &origins, directions: &directions, ranges: None }, faces);
        }
    }
}

#[test]
fn no_triangles_no_hits() {
    let mesh = Mesh::new((Vec::new(), Vec::new()));
    let (origins, directions) = around(&mut Random(2), 100, 1.0);
    assert_eq!(
        mesh.check(&Rays { origins: &origins, directions: &directions, ranges: None }, Faces::Both),
        0
    );
    assert_eq!(mesh.check(&Rays { origins: &[], directions: &[], ranges: None }, Faces::Both), 0);
}

#[test]
fn sizes_from_a_micrometre_to_ten_kilometres() {
    for size in [1e-6, 1e-3, 1.0, 1e4] {
        let mesh = Mesh::new(sphere(24, size));
        let mut random = Random(3);
        let (origins, directions) = around(&mut random, 2000, 2.0 * size);
        let hits =
            mesh.check(&Rays { origins: &origins, directions: &directions, ranges: None }, Faces::Both);
        assert!(hits > 200, "{hits}");
    }
}

#[test]
fn directions_of_any_length() {
    let mesh = Mesh::new(sphere(24, 1.0));
    for length in [1e-30_f32, 1e-9, 1e-3, 1e3, 1e9, 1e30] {
        let mut random = Random(4);
        let (origins, mut directions) = around(&mut random, 500, 2.0);
        for direction in &mut directions {
            *direction = direction.map(|component| component * length);
        }
        let hits =
            mesh.check(&Rays { origins: &origins, directions: &directions, ranges: None }, Faces::Both);
        assert!(hits > 50, "{hits}");
    }
}

#[test]
fn ranges_cut_hits_off() {
    let mesh = Mesh::new(oracle::soup(&mut Random(5), 500, 0.3));
    let mut random = Random(6);
    let (origins, directions) = around(&mut random, 3000, 1.0);
    let ranges: Vec<[f32; 2]> = (0..3000)
        .map(|_| {
            let from = random.unit() as f32;
            [from, from + random.unit() as f32]
        })
        .collect();
    let rays = Rays { origins: &origins, directions: &directions, ranges: Some(&ranges) };
    let hits = mesh.check(&rays, Faces::Both);
    assert!(hits > 500 && hits < 2900, "{hits}");
}

#[test]
fn the_nearest_of_close_layers() {
    // Parallel squares 2⁻¹² of their distance apart: single precision alone could choose the wrong one for rays at a
    // small angle.
    let mut mesh = (Vec::new(), Vec::new());
    for layer in 0..32_u16 {
        let z = f32::from(layer) / 4096.0;
        let first = mesh.0.len() as u32;
        mesh.0.extend([[-1.0, -1.0, z], [1.0, -1.0, z], [1.0, 1.0, z], [-1.0, 1.0, z]]);
        mesh.1.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    let mesh = Mesh::new(mesh);
    let mut random = Random(7);
    let origins: Vec<_> = (0..4000).map(|_| [-1.5, random.point(0.9)[1], 0.1]).collect();
    let directions: Vec<_> = (0..4000).map(|_| [1.0, 0.0, -0.05 - 0.02 * random.unit() as f32]).collect();
    let hits = mesh.check(&Rays { origins: &origins, directions: &directions, ranges: None }, Faces::Both);
    assert!(hits > 2000, "{hits}");
}
