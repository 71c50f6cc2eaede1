//! Scenes that are hard to trace, for the tests of exactness.

use super::brute::Pair;
use belvedere_sensors::Pose;
use belvedere_sensors::scene::Shape;
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Numbers in [0, 1), the same on every machine (Steele et al. 2014, "Fast splittable pseudorandom number generators").
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    pub(crate) fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A point in [−1, 1)³.
    pub(crate) fn cube(&mut self) -> DVec3 {
        DVec3::new(self.roll(), self.roll(), self.roll()) * 2.0 - 1.0
    }

    pub(crate) fn turn(&mut self) -> DVec3 {
        self.cube() * 3.0
    }
}

/// Vertices and triangles.
pub(crate) type Soup = (Vec<[f32; 3]>, Vec<[u32; 3]>);

/// An octahedron on the unit ball, each of whose faces is divided into four `rounds` times.
pub(crate) fn geosphere(rounds: u32) -> Soup {
    let mut corners = vec![Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
    let mut triangles =
        vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    for _ in 0..rounds {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                corners.push((corners[a as usize] + corners[b as usize]).normalize());
                corners.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    (corners.into_iter().map(|corner| corner.to_array()).collect(), triangles)
}

/// A dented ball of about 1 m.
fn blob(rounds: u32) -> Soup {
    let (vertices, triangles) = geosphere(rounds);
    let dent = |[x, y, z]: [f32; 3]| {
        let wave = |v: f32| (v * 3.0).fract().abs() - 0.5;
        let radius = 1.0 + 0.2 * wave(x + y) + 0.1 * wave(z - x);
        [x * radius, y * radius, z * radius]
    };
    (vertices.into_iter().map(dent).collect(), triangles)
}

fn moved((vertices, triangles): Soup, scale: f32, by: [f32; 3]) -> Soup {
    let at = |v: [f32; 3]| [v[0] * scale + by[0], v[1] * scale + by[1], v[2] * scale + by[2]];
    (vertices.into_iter().map(at).collect(), triangles)
}

/// Triangles of all shapes: normal ones, needles, and triangles without area.
fn splinters(dice: &mut Dice, count: usize) -> Soup {
    let mut vertices: Vec<[f32; 3]> = Vec::new();
    for index in 0..count {
        let a = dice.cube() * 2.0;
        let along = dice.cube();
        let across = dice.cube();
        let (b, c) = match index % 6 {
            0 => (a + along, a + along + across * 1e-4),
            1 => (a + along, a + along * 0.5 + across * 1e-3),
            2 => (a + along, a + along),
            3 => (a + along * 0.5, a + along),
            4 => (a, a),
            _ => (a + along * 0.4, a + across * 0.4),
        };
        vertices.extend([a, b, c].map(|v| v.as_vec3().to_array()));
    }
    let triangles = (0..count as u32).map(|index| [3 * index, 3 * index + 1, 3 * index + 2]).collect();
    (vertices, triangles)
}

/// All shapes that do not consist of triangles, about 1 m in size.
pub(crate) const SOLIDS: [Shape; 8] = [
    Shape::Box { size: [0.9, 0.5, 0.7] },
    Shape::Rectangle { size: [1.2, 0.8] },
    Shape::Sphere { radius: 0.45 },
    Shape::Ellipsoid { radii: [0.5, 0.2, 0.35] },
    Shape::Cylinder { radius: 0.3, length: 0.9 },
    Shape::Capsule { radius: 0.25, length: 0.6 },
    Shape::Cone { radius: 0.4, length: 0.8 },
    Shape::Plane,
];

/// A scene, and the size of its visible part around `centre`.
pub(crate) struct Scenario {
    pub(crate) name: &'static str,
    pub(crate) pair: Pair,
    pub(crate) centre: DVec3,
    pub(crate) size: f64,
}

fn scenario(name: &'static str, centre: DVec3, size: f64, fill: impl FnOnce(&mut Pair)) -> Scenario {
    let mut pair = Pair::new();
    fill(&mut pair);
    Scenario { name, pair, centre, size }
}

/// Adds mirrored and stretched meshes around `centre`.
fn crowd(pair: &mut Pair, soup: &Soup, centre: DVec3, size: f64) {
    let mesh = pair.mesh(&soup.0, &soup.1);
    let mut dice = Dice(5);
    for scale in [[1.0; 3], [-0.5, 0.5, 0.5], [0.3, -1.4, -0.6], [-0.7, -0.2, -0.9]] {
        let pose = Pose::from_xyz_rpy(centre + dice.cube() * (2.0 * size), dice.turn());
        pair.add(mesh, pose, scale);
    }
}

/// All scenes.
pub(crate) fn scenarios() -> Vec<Scenario> {
    let far = DVec3::new(1e5, -7e4, 3e3);
    let mut all = Vec::new();
    all.push(scenario("one mesh", DVec3::ZERO, 1.0, |pair| {
        let (vertices, triangles) = blob(4);
        let mesh = pair.mesh(&vertices, &triangles);
        pair.add(mesh, Pose::IDENTITY, [1.0; 3]);
    }));
    all.push(scenario("crowd", DVec3::ZERO, 1.0, |pair| crowd(pair, &blob(3), DVec3::ZERO, 1.0)));
    all.push(scenario("crowd 100 km away", far, 1.0, |pair| crowd(pair, &blob(3), far, 1.0)));
    for (name, size) in [("1e-6 m", 1e-6), ("1e4 m", 1e4)] {
        all.push(scenario(name, DVec3::ZERO, size, |pair| {
            crowd(pair, &moved(blob(3), size as f32, [0.0; 3]), DVec3::ZERO, size);
        }));
    }
    let away = [1e5, 5e4, -2e4];
    let shift = away.map(f64::from);
    all.push(scenario(
        "vertices 100 km from the origin of their mesh",
        DVec3::from_array(shift),
        10.0,
        |pair| {
            let (vertices, triangles) = moved(blob(3), 10.0, away);
            let mesh = pair.mesh(&vertices, &triangles);
            pair.add(mesh, Pose::IDENTITY, [1.0; 3]);
        },
    ));
    all.push(scenario("splinters", DVec3::ZERO, 1.0, |pair| {
        let (vertices, triangles) = splinters(&mut Dice(11), 600);
        let mesh = pair.mesh(&vertices, &triangles);
        pair.add(mesh, Pose::IDENTITY, [1.0; 3]);
        pair.add(mesh, Pose::from_xyz_rpy(DVec3::ONE, DVec3::new(0.3, 0.5, 2.0)), [1.0, 0.3, -2.0]);
    }));
    all.push(scenario("0 and 1 triangles", DVec3::ZERO, 1.0, |pair| {
        let nothing = pair.mesh(&[], &[]);
        let one = pair.mesh(&[[0.5, -1.0, -1.0], [0.5, 1.0, -1.0], [0.5, 0.0, 1.0]], &[[0, 2, 1]]);
        pair.add(nothing, Pose::IDENTITY, [1.0; 3]);
        pair.add(one, Pose::IDENTITY, [1.0; 3]);
    }));
    for (name, centre) in [("solids", DVec3::ZERO), ("solids 100 km away", far)] {
        all.push(scenario(name, centre, 1.0, |pair| {
            let mut dice = Dice(3);
            pair.add(SOLIDS[7], Pose::from_translation(centre - DVec3::Z * 2.5), [1.0; 3]);
            for index in 0..28 {
                let scale = [[1.0; 3], [1.5, 0.4, 0.8], [-0.6, 1.0, 1.3]][index / 7 % 3];
                let pose = Pose::from_xyz_rpy(centre + dice.cube() * 2.0, dice.turn());
                pair.add(SOLIDS[index % 7], pose, scale);
            }
        }));
    }
    all.push(scenario("terrain", DVec3::ZERO, 2.0, |pair| {
        let mut dice = Dice(9);
        let heights: Vec<_> = (0..21 * 34).map(|_| (dice.roll() * 0.3 - 0.6) as f32).collect();
        let field = pair.height_field(21, 34, [8.0, 6.0], &heights);
        pair.add(field, Pose::from_xyz_rpy(DVec3::new(0.3, 0.1, -0.5), DVec3::Z), [1.0; 3]);
        pair.add(field, Pose::from_xyz_rpy(DVec3::Z * 2.0, DVec3::new(0.2, 0.0, 1.0)), [0.7, -1.0, -1.0]);
    }));
    all
}

/// Poses of sensors in a scene: outside, inside along the axes, and rotated.
pub(crate) fn stands(scenario: &Scenario) -> [Pose; 3] {
    let Scenario { centre, size, .. } = *scenario;
    [
        Pose::from_translation(centre + DVec3::new(-4.0, 0.125, 0.25) * size),
        Pose::from_translation(centre),
        Pose::from_xyz_rpy(centre + DVec3::new(1.1, 1.7, -0.9) * size, DVec3::new(0.4, 0.3, -2.1)),
    ]
}
