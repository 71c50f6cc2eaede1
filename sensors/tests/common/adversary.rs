//! Random scenes and sensor poses that are hard to trace: all sizes, thin and huge triangles, sensors near their
//! planes, meshes far from their own and the world's origin, and different scales per axis.

use super::brute::Pair;
use super::exactness::{Dice, Scenario, Soup};
use belvedere_sensors::Pose;
use glam::DVec3;

/// The difficulty of a scene.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Kind {
    Fair,
    Needles,
    /// Triangles a few hundred times as large as their distance.
    Huge,
    /// Sensors are in the planes of triangles, and near them.
    NearPlanes,
    /// Vertices are ten thousand times the size of the mesh away from its origin.
    FarVertices,
    /// The instance is 100 km from the world's origin, with different scales per axis.
    FarScaled,
    /// Dense clumps of triangles, each about as large as the distance between two rays.
    Clumps,
}

pub(crate) const KINDS: [Kind; 7] = [
    Kind::Fair,
    Kind::Needles,
    Kind::Huge,
    Kind::NearPlanes,
    Kind::FarVertices,
    Kind::FarScaled,
    Kind::Clumps,
];

/// The number of triangles of a clump.
const CLUMP: u32 = 50;

/// Ten to a random power between two limits.
pub(crate) fn magnitude(dice: &mut Dice, low: f64, high: f64) -> f64 {
    10_f64.powf(low + (high - low) * dice.roll())
}

fn soup(dice: &mut Dice, kind: Kind, size: f64) -> Soup {
    let mut vertices: Vec<[f32; 3]> = Vec::new();
    let offset = if kind == Kind::FarVertices { dice.cube() * 1e4 * size } else { DVec3::ZERO };
    let count = if kind == Kind::Clumps { 12 * CLUMP } else { 30 };
    let mut clump = DVec3::ZERO;
    for index in 0..count {
        if kind == Kind::Clumps {
            if index % CLUMP == 0 {
                clump = dice.cube() * 2.0;
            }
            let a = clump + dice.cube() * 0.03;
            let corners = [a, a + dice.cube() * 0.02, a + dice.cube() * 0.02].map(|corner| corner * size);
            vertices.extend(corners.map(|corner| corner.as_vec3().to_array()));
            continue;
        }
        let a = dice.cube() * 2.0;
        let (mut along, mut across) = (dice.cube() * 1.5, dice.cube() * 1.5);
        match kind {
            Kind::Needles => across = along * dice.roll() + across * magnitude(dice, -4.0, -1.0),
            Kind::Huge if index % 2 == 0 => {
                let factor = magnitude(dice, 1.0, 3.0);
                (along, across) = (along * factor, across * factor);
            }
            _ => {}
        }
        let a = if kind == Kind::Huge { a - (along + across) / 3.0 } else { a };
        let corners = [a, a + along, a + across].map(|corner| corner * size + offset);
        vertices.extend(corners.map(|corner| corner.as_vec3().to_array()));
    }
    let triangles = (0..count).map(|index| [3 * index, 3 * index + 1, 3 * index + 2]).collect();
    (vertices, triangles)
}

/// A scene, and poses of sensors in it.
pub(crate) struct Hard {
    pub(crate) kind: Kind,
    pub(crate) scenario: Scenario,
    pub(crate) poses: Vec<Pose>,
    /// The corners of all triangles, in the world.
    pub(crate) corners: Vec<[DVec3; 3]>,
}

/// With equal probability, a point of a triangle or one so near to an edge that half of them are within a ten
/// thousandth of the distance from `place`.
pub(crate) fn aim(dice: &mut Dice, [a, b, c]: [DVec3; 3], place: DVec3) -> DVec3 {
    let (u, v) = (dice.roll(), dice.roll());
    if dice.roll() < 0.5 {
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        return a + (b - a) * u + (c - a) * v;
    }
    let at = a + (b - a) * u;
    at + dice.cube() * (magnitude(dice, -5.7, -2.0) * (at - place).length())
}

/// Makes a scene.
pub(crate) fn scene(dice: &mut Dice, kind: Kind) -> Hard {
    let size = magnitude(dice, -6.0, 4.0);
    let (vertices, triangles) = soup(dice, kind, size);
    let mut pair = Pair::new();
    let mesh = pair.mesh(&vertices, &triangles);
    let far = DVec3::new(1e5, -7e4, 3e3);
    let (centre, pose, scale) = match kind {
        Kind::FarScaled => (far, Pose::from_xyz_rpy(far, dice.turn()), [0.3, -1.7, 0.9]),
        Kind::FarVertices => (DVec3::ZERO, Pose::from_xyz_rpy(DVec3::ZERO, dice.turn()), [1.0; 3]),
        Kind::Clumps => (DVec3::ZERO, Pose::from_xyz_rpy(DVec3::ZERO, dice.turn()), [1.3, 0.6, -1.0]),
        _ if dice.roll() < 0.5 => (DVec3::ZERO, Pose::IDENTITY, [1.0; 3]),
        _ => (DVec3::ZERO, Pose::from_xyz_rpy(DVec3::ZERO, dice.turn()), [1.0; 3]),
    };
    pair.add(mesh, pose, scale);
    let corner = |vertex: usize| {
        let [x, y, z] = vertices[vertex].map(f64::from);
        pose.rotation() * (DVec3::new(x, y, z) * DVec3::from_array(scale)) + pose.translation()
    };
    let poses = (0..6)
        .map(|_| {
            let triangle = (dice.roll() * triangles.len() as f64) as usize * 3;
            let [a, b, c] = [corner(triangle), corner(triangle + 1), corner(triangle + 2)];
            let beside = if dice.roll() < 0.5 { 1.0 } else { 3.0 };
            let (u, v) = (dice.roll() * beside, dice.roll() * beside);
            let on_plane = a + (b - a) * u * 0.5 + (c - a) * v * 0.5;
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let away = match kind {
                // As a fraction of the size: from almost nothing to a tenth.
                Kind::NearPlanes => normal * (magnitude(dice, -9.0, -1.0) * size),
                Kind::Huge => normal * (magnitude(dice, -4.0, 0.0) * size),
                _ => dice.cube() * size,
            };
            Pose::from_xyz_rpy(on_plane + away, dice.turn())
        })
        .collect();
    let corners =
        (0..triangles.len()).map(|triangle| [0, 1, 2].map(|vertex| corner(3 * triangle + vertex))).collect();
    Hard { kind, scenario: Scenario { name: "random", pair, centre, size }, poses, corners }
}
