//! An oracle that tests every triangle, in double precision.

use super::Mesh;
use crate::trace::Faces;
use glam::DVec3;

/// If a ray passes this near to an edge, relative to its length, it may hit or miss.
const EDGE: f64 = 1e-6;

pub(super) enum Answer {
    Miss,
    Hit {
        t: f64,
        normal: DVec3,
    },
    /// The ray passes an edge, or ends at a triangle, too closely for a certain answer.
    Doubtful,
}

fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::new(v[0].into(), v[1].into(), v[2].into())
}

/// The nearest hit of a ray.
pub(super) fn nearest(
    mesh: &Mesh,
    origin: [f32; 3],
    direction: [f32; 3],
    range: [f32; 2],
    faces: Faces,
) -> Answer {
    let (o, d) = (wide(origin), wide(direction));
    let (mut sure, mut possible) = (f64::INFINITY, f64::INFINITY);
    let mut normal = DVec3::ZERO;
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|index| wide(mesh.vertices[index as usize]) - o);
        let n = (b - a).cross(c - a);
        let slope = n.dot(d);
        if slope == 0.0 || n == DVec3::ZERO || (faces == Faces::Front && slope > 0.0) {
            continue;
        }
        let t = n.dot(a) / slope;
        let way = [a, b, c].map(DVec3::length).into_iter().fold(0.0, f64::max);
        let point = d * t;
        // The distance from each edge, inwards in the plane of the triangle; perpendicular to the ray if it is seen at
        // an angle.
        let unit = n.normalize();
        let tilt = (slope.abs() / (n.length() * d.length())).max(1e-3);
        let inside = [(a, b), (b, c), (c, a)]
            .map(|(p, q)| unit.dot((q - p).cross(point - p)) / (q - p).length())
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        let near_end = |end: f32| {
            let end = f64::from(end);
            (t - end).abs() * d.length() < 1e-6 * way.max(end * d.length()) / tilt
        };
        let reach = EDGE * way / tilt;
        let within = t >= f64::from(range[0]) && t <= f64::from(range[1]);
        if inside < -reach || !(within || near_end(range[0]) || near_end(range[1])) {
            continue;
        }
        possible = possible.min(t);
        if inside > reach && within && !near_end(range[0]) && !near_end(range[1]) && t < sure {
            (sure, normal) = (t, unit);
        }
    }
    if possible < sure {
        return Answer::Doubtful;
    }
    if sure < f64::INFINITY { Answer::Hit { t: sure, normal } } else { Answer::Miss }
}

/// A small random number generator (splitmix64).
pub(super) struct Random(pub(super) u64);

impl Random {
    /// A number in [0, 1).
    pub(super) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(super) fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// A point in a cube of this half edge.
    pub(super) fn point(&mut self, half: f32) -> [f32; 3] {
        [0; 3].map(|_| half * (2.0 * self.unit() - 1.0) as f32)
    }

    /// A direction of length 1.
    pub(super) fn direction(&mut self) -> [f32; 3] {
        let z = 2.0 * self.unit() - 1.0;
        let (sin, cos) = (core::f64::consts::TAU * self.unit()).sin_cos();
        let s = (1.0 - z * z).sqrt();
        [(s * cos) as f32, (s * sin) as f32, z as f32]
    }
}

/// Random triangles in a cube of half edge 1.
pub(super) fn soup(random: &mut Random, count: usize, size: f32) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let mut vertices = Vec::new();
    for _ in 0..count {
        let middle = random.point(1.0);
        for _ in 0..3 {
            let offset = random.point(size);
            vertices.push([middle[0] + offset[0], middle[1] + offset[1], middle[2] + offset[2]]);
        }
    }
    let triangles = (0..count as u32).map(|index| [3 * index, 3 * index + 1, 3 * index + 2]).collect();
    (vertices, triangles)
}

/// A closed sphere around the origin, with outward winding.
pub(super) fn sphere(rings: u32, radius: f32) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let around = 2 * rings;
    let mut vertices = vec![[0.0, 0.0, radius], [0.0, 0.0, -radius]];
    for ring in 1..rings {
        let (sin, cos) = (core::f64::consts::PI * f64::from(ring) / f64::from(rings)).sin_cos();
        for step in 0..around {
            let (y, x) = (core::f64::consts::TAU * f64::from(step) / f64::from(around)).sin_cos();
            vertices.push([x * sin, y * sin, cos].map(|v| (v * f64::from(radius)) as f32));
        }
    }
    let at = |ring: u32, step: u32| 2 + (ring - 1) * around + step % around;
    let mut triangles = Vec::new();
    for step in 0..around {
        triangles.push([0, at(1, step), at(1, step + 1)]);
        triangles.push([1, at(rings - 1, step + 1), at(rings - 1, step)]);
        for ring in 1..rings - 1 {
            let [a, b] = [at(ring, step), at(ring, step + 1)];
            let [c, d] = [at(ring + 1, step), at(ring + 1, step + 1)];
            triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    (vertices, triangles)
}
