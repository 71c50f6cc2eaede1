//! An oracle for the first hits of rays: it tests every triangle and every solid, in f64.

use super::oracle::{Ray, first_hit_scaled};
use belvedere_sensors::Pose;
use belvedere_sensors::scene::{InstanceConfig, MaterialId, SceneBuilder, Shape};
use glam::DVec3;

/// If a ray passes this near to an edge, relative to its distance, it may hit or miss.
pub(crate) const EDGE: f64 = 1e-6;
/// The largest error of a distance, relative to it.
pub(crate) const DISTANCE: f64 = 1e-5;

/// An instance as the oracle sees it.
struct Body {
    shape: Shape,
    pose: Pose,
    scale: DVec3,
    /// Corners in the world, relative to the instance's position; wound outwards even if the instance is mirrored.
    triangles: Vec<[DVec3; 3]>,
}

/// The same scene for the library and for the oracle.
#[derive(Default)]
pub(crate) struct Pair {
    pub(crate) builder: SceneBuilder,
    bodies: Vec<Body>,
    /// The triangles of the meshes and height fields that were added.
    soups: Vec<(Shape, Vec<[DVec3; 3]>)>,
}

/// A possible hit of a ray.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    t: f64,
    instance: u32,
    primitive: u32,
    sure: bool,
}

/// The counts of all comparisons.
#[derive(Default, Debug)]
pub(crate) struct Tally {
    pub(crate) rays: usize,
    pub(crate) hits: usize,
    /// Rays that passed within [`EDGE`] of an edge.
    pub(crate) doubtful: usize,
    pub(crate) worst: f64,
}

/// The library's result for a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Found {
    pub(crate) distance: f32,
    pub(crate) instance: u32,
    pub(crate) primitive: u32,
    pub(crate) barycentrics: [f32; 2],
    pub(crate) normal: [f32; 3],
}

fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::new(v[0].into(), v[1].into(), v[2].into())
}

impl Pair {
    pub(crate) fn new() -> Self {
        let mut pair = Self::default();
        pair.builder.add_material(&belvedere_sensors::scene::MaterialConfig::default()).unwrap();
        pair
    }

    pub(crate) fn mesh(&mut self, vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> Shape {
        let shape = Shape::Mesh(self.builder.add_mesh(vertices, &[], triangles).unwrap());
        let soup = triangles.iter().map(|triangle| triangle.map(|v| wide(vertices[v as usize]))).collect();
        self.soups.push((shape, soup));
        shape
    }

    pub(crate) fn height_field(&mut self, rows: u32, columns: u32, size: [f64; 2], heights: &[f32]) -> Shape {
        let id = self.builder.add_height_field(rows, columns, size, heights).unwrap();
        let scene = self.builder.scene();
        let grid = scene.height_field(id).unwrap();
        let soup = (0..grid.field().triangles()).map(|t| grid.triangle(t).map(wide)).collect();
        self.soups.push((Shape::HeightField(id), soup));
        Shape::HeightField(id)
    }

    pub(crate) fn add(&mut self, shape: Shape, pose: Pose, scale: [f64; 3]) {
        let config = InstanceConfig {
            shape,
            world_from_instance: pose,
            scale,
            material: MaterialId(0),
            ..Default::default()
        };
        self.builder.add_instance(&config).unwrap();
        let scale = DVec3::from_array(scale);
        let soup = self.soups.iter().find(|(of, _)| *of == shape).map_or(&[][..], |(_, soup)| soup);
        let mirrored = scale.x * scale.y * scale.z < 0.0;
        let triangles = soup
            .iter()
            .map(|corners| {
                let [a, b, c] = corners.map(|corner| pose.rotation() * (corner * scale));
                if mirrored { [a, c, b] } else { [a, b, c] }
            })
            .collect();
        self.bodies.push(Body { shape, pose, scale, triangles });
    }

    /// All possible hits of a ray. It starts at `origin` + `offset`; t is in units of `direction`.
    fn candidates(
        &self,
        origin: DVec3,
        offset: DVec3,
        direction: DVec3,
        range: [f64; 2],
        both: bool,
    ) -> Vec<Candidate> {
        let mut found = Vec::new();
        for (instance, body) in self.bodies.iter().enumerate() {
            let instance = instance as u32;
            let from_body = (origin - body.pose.translation()) + offset;
            if matches!(body.shape, Shape::Mesh(_) | Shape::HeightField(_)) {
                for (primitive, corners) in body.triangles.iter().enumerate() {
                    if let Some((t, sure)) = triangle(corners, from_body, direction, range, both) {
                        found.push(Candidate { t, instance, primitive: primitive as u32, sure });
                    }
                }
            } else {
                found.extend(solid(body, from_body, direction, range, both).map(|(t, sure)| Candidate {
                    t,
                    instance,
                    primitive: 0,
                    sure,
                }));
            }
        }
        found
    }

    /// Compares the library's result with the possible hits. `per_t` is the distance per unit of t.
    #[allow(clippy::too_many_arguments, reason = "each is one thing the verdict depends on")]
    pub(crate) fn check(
        &self,
        what: &str,
        (origin, offset, direction): (DVec3, DVec3, DVec3),
        range: [f64; 2],
        both: bool,
        found: &Found,
        per_t: f64,
        tally: &mut Tally,
    ) {
        let mut candidates = self.candidates(origin, offset, direction, range, both);
        candidates.sort_by(|a, b| a.t.total_cmp(&b.t));
        let sure = candidates.iter().position(|candidate| candidate.sure);
        // Nothing behind the first certain hit counts, except for hits within the tolerance of its distance.
        let limit = sure.map_or(f64::INFINITY, |at| candidates[at].t * (1.0 + DISTANCE));
        let possible: Vec<_> = candidates.iter().filter(|candidate| candidate.t <= limit).collect();
        tally.rays += 1;
        let context = || {
            format!(
                "{what}: from {origin} + {offset} along {direction}: {found:?}, and there is {possible:?}"
            )
        };
        let ambiguous = sure.is_none_or(|at| candidates[..=at].iter().any(|candidate| !candidate.sure));
        if found.distance == f32::INFINITY {
            assert!(sure.is_none(), "missed: {}", context());
            assert!(found.instance == u32::MAX && found.primitive == u32::MAX, "{}", context());
            tally.doubtful += usize::from(!possible.is_empty());
            return;
        }
        tally.hits += 1;
        tally.doubtful += usize::from(ambiguous);
        let off = |candidate: &Candidate| (f64::from(found.distance) / (candidate.t * per_t) - 1.0).abs();
        let own = possible
            .iter()
            .filter(|candidate| {
                candidate.instance == found.instance && candidate.primitive == found.primitive
            })
            .map(|candidate| off(candidate))
            .fold(f64::INFINITY, f64::min);
        assert!(own <= DISTANCE, "{own:e} off: {}", context());
        tally.worst = tally.worst.max(own);
        let body = &self.bodies[found.instance as usize];
        if let Some(corners) = body.triangles.get(found.primitive as usize) {
            check_point(
                body,
                corners,
                (origin - body.pose.translation()) + offset,
                direction,
                found,
                &context,
            );
        }
        let length = wide(found.normal).length();
        assert!((length - 1.0).abs() < 1e-6, "normal of length {length}: {}", context());
    }
}

/// Checks barycentric coordinates and normal of a hit on a triangle.
fn check_point(
    body: &Body,
    &[a, b, c]: &[DVec3; 3],
    origin: DVec3,
    direction: DVec3,
    found: &Found,
    context: &impl Fn() -> String,
) {
    let mirrored = body.scale.x * body.scale.y * body.scale.z < 0.0;
    let normal = (b - a).cross(c - a);
    let unit = normal.normalize();
    // If the sides are nearly parallel, the normal depends on the rounding of the corners.
    let sharp = normal.length() / ((b - a).length() * (c - a).length()).max((c - b).length_squared());
    if sharp > 1e-3 {
        assert!((wide(found.normal) - unit).length() < 1e-5, "normal, not {unit}: {}", context());
    }
    let [second, third] = found.barycentrics.map(f64::from);
    let (b, c) = if mirrored { (c, b) } else { (b, c) };
    let point = a + (b - a) * second + (c - a) * third;
    // The distance of the point from the ray, compared with the resolution of f32 weights.
    let beside = (point - origin).cross(direction.normalize()).length();
    let size = (b - a).length().max((c - a).length());
    let way = (point - origin).length();
    assert!(beside <= 1e-5 * size + EDGE * way, "{beside:e} beside the ray: {}", context());
}

/// t, and whether the ray certainly hits; `None` if it certainly misses.
fn triangle(
    corners: &[DVec3; 3],
    origin: DVec3,
    direction: DVec3,
    range: [f64; 2],
    both: bool,
) -> Option<(f64, bool)> {
    let [a, b, c] = corners.map(|corner| corner - origin);
    let normal = (b - a).cross(c - a);
    let slope = normal.dot(direction);
    if slope == 0.0 || (!both && slope > 0.0) {
        return None;
    }
    let t = normal.dot(a) / slope;
    if !within(t, range)? {
        // Either end may be meant; in both cases the hit is doubtful.
        return inside(&[a, b, c], direction, slope).map(|_| (t, false));
    }
    inside(&[a, b, c], direction, slope).map(|sure| (t, sure))
}

/// Whether t is certainly in the range; `None` if it certainly is not.
fn within(t: f64, [near, far]: [f64; 2]) -> Option<bool> {
    if t.is_nan() || t <= 0.0 || t < near * (1.0 - EDGE) || t > far * (1.0 + EDGE) {
        return None;
    }
    Some(t >= near * (1.0 + EDGE) && t <= far * (1.0 - EDGE))
}

/// Whether a ray from 0 certainly passes between the edges, from the sines of its angles to the planes through 0 and
/// the edges.
fn inside(corners: &[DVec3; 3], direction: DVec3, slope: f64) -> Option<bool> {
    let side = if slope < 0.0 { -1.0 } else { 1.0 };
    let mut sure = true;
    for edge in 0..3 {
        let (p, q) = (corners[edge], corners[(edge + 1) % 3]);
        // (p + q) × (q − p) / 2 is more accurate than p × q if the two are close to each other.
        let plane = (p + q).cross(q - p) * 0.5;
        let sine = side * plane.dot(direction) / (plane.length() * direction.length());
        if sine < -EDGE {
            return None;
        }
        // For an edge through the origin there is no plane: the result is NaN, which is not certain.
        sure &= sine > EDGE;
    }
    Some(sure)
}

/// The same for a solid. The result is certain if rays slightly to all sides agree.
fn solid(body: &Body, origin: DVec3, direction: DVec3, range: [f64; 2], both: bool) -> Option<(f64, bool)> {
    let pose = Pose::new(DVec3::ZERO, body.pose.rotation());
    let hit = |direction: DVec3| {
        first_hit_scaled(&body.shape, &pose, body.scale, &Ray { origin, direction }, range[0], both)
            .filter(|&t| t <= range[1] && t > 0.0)
    };
    let (u, v) = direction.normalize().any_orthonormal_pair();
    let beside = [u, -u, v, -v].map(|side| hit(direction + side * (EDGE * direction.length())));
    match hit(direction) {
        Some(t) => {
            let same = |other: &Option<f64>| other.is_some_and(|other| (other / t - 1.0).abs() < 1e-2);
            Some((t, beside.iter().all(same)))
        }
        None => beside.iter().flatten().next().map(|&t| (t, false)),
    }
}
