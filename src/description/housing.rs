//! What a ray sensor looks through: the shapes of its own robot that it sits in.
//!
//! A scanner is drawn as a box or a mesh with the mirror inside it, and its rays start there: taken at its word, it
//! would see its housing and nothing else. So a collision shape that encloses the sensor, and that nothing can move
//! against it, is not there for it. What stands beside the sensor, a mast or the plate above it, still is.

use super::diagnostics::Diagnostics;
use super::model::{Collision, Geometry, LinkIndex, Mesh, Model, Sensor};
use belvedere_sensors::Pose;
use glam::DVec3;
use std::f64::consts::PI;

/// Directions in which a mesh is looked for.
const DIRECTIONS: usize = 256;
/// A mesh that is met in so many of them is a housing: real ones have windows, and files leave faces out.
const ENCLOSED: usize = DIRECTIONS * 9 / 10;
/// A sensor this near to a solid's surface counts as inside, in m.
const ON_SURFACE_M: f64 = 1e-6;

/// A collision shape of a model: its link, and its number there.
pub type CollisionIndex = (LinkIndex, usize);

/// The collision shapes that a sensor at `link_from_sensor` looks through: they enclose it, and fixed joints hold them.
pub fn housings(model: &Model, link: LinkIndex, link_from_sensor: &Pose) -> Vec<CollisionIndex> {
    let body = model.rigid_root(link);
    around(model, link, link_from_sensor).filter(|(other, _)| model.rigid_root(*other) == body).collect()
}

/// The collision shapes of a model that a sensor is in, with every joint at zero.
fn around<'m>(
    model: &'m Model,
    link: LinkIndex,
    link_from_sensor: &Pose,
) -> impl Iterator<Item = CollisionIndex> + 'm {
    let model_from_sensor = model.links[link].model_from_link * *link_from_sensor;
    let origin = model_from_sensor.translation();
    model.links.iter().enumerate().flat_map(move |(number, other)| {
        let from_model = other.model_from_link.inverse();
        let shapes = other.collisions.iter().enumerate();
        shapes
            .filter(move |(_, shape)| encloses(shape, from_model.transform_point(origin)))
            .map(move |(shape, _)| (number, shape))
    })
}

/// Tells which ray sensors of a robot start inside a collision shape, and what comes of it.
pub(super) fn report(model: &Model, gazebo_compat: bool, diagnostics: &mut Diagnostics) {
    let is_ray = |sensor: &&Sensor| sensor.kind.casts_rays();
    for sensor in model.sensors.iter().filter(is_ray) {
        for (link, shape) in around(model, sensor.link, &sensor.link_from_sensor) {
            let source = &model.links[link].collisions[shape].source;
            let what = format!(
                "the sensor '{}' is inside a collision shape of the link '{}' ({source})",
                sensor.name, model.links[link].name
            );
            let is_rigid = model.rigid_root(link) == model.rigid_root(sensor.link);
            if gazebo_compat {
                diagnostics.warning(
                    &sensor.source,
                    format!("{what}: it sees that where it is beyond the least range, as in Gazebo"),
                    "let the shape end at the sensor, or leave --gazebo-compat out",
                );
            } else if is_rigid {
                diagnostics.note(&sensor.source, format!("{what}: it looks through it"), "");
            } else {
                diagnostics.warning(
                    &sensor.source,
                    format!("{what}, which a joint moves: it sees nothing else"),
                    "move the sensor, or fix that link to the sensor's",
                );
            }
        }
    }
}

/// Whether a point in the link's frame is inside a shape.
fn encloses(shape: &Collision, point: DVec3) -> bool {
    let point = shape.link_from_collision.inverse().transform_point(point);
    let beyond = |length: f64| point.z.abs() - 0.5 * length;
    let across = point.truncate().length();
    match &shape.geometry {
        Geometry::Box { size } => (point.abs() - *size * 0.5).max_element() <= ON_SURFACE_M,
        Geometry::Sphere { radius } => point.length() <= radius + ON_SURFACE_M,
        Geometry::Cylinder { radius, length } => {
            beyond(*length) <= ON_SURFACE_M && across <= radius + ON_SURFACE_M
        }
        Geometry::Capsule { radius, length } => {
            DVec3::new(point.x, point.y, beyond(*length).max(0.0)).length() <= radius + ON_SURFACE_M
        }
        // Without an inside.
        Geometry::Plane { .. } => false,
        Geometry::Mesh(mesh) => surrounds(mesh, point),
    }
}

/// Whether a mesh is met in nearly all directions from a point.
fn surrounds(mesh: &Mesh, point: DVec3) -> bool {
    let corner =
        |vertex: u32| mesh.positions.get(vertex as usize).map(|at| DVec3::from(at.map(f64::from)) - point);
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for at in &mesh.positions {
        let at = DVec3::from(at.map(f64::from)) - point;
        (low, high) = (low.min(at), high.max(at));
    }
    if low.max_element() > 0.0 || high.min_element() < 0.0 {
        return false;
    }
    let triangles: Vec<[DVec3; 3]> =
        mesh.triangles.iter().filter_map(|[a, b, c]| Some([corner(*a)?, corner(*b)?, corner(*c)?])).collect();
    let mut missed = 0;
    directions().all(|direction| {
        missed += usize::from(!triangles.iter().any(|triangle| meets(direction, triangle)));
        missed <= DIRECTIONS - ENCLOSED
    })
}

/// Whether a ray from the origin meets a triangle (Möller–Trumbore).
fn meets(direction: DVec3, [a, b, c]: &[DVec3; 3]) -> bool {
    let (ab, ac) = (*b - *a, *c - *a);
    let across = direction.cross(ac);
    let volume = ab.dot(across);
    let (u, cross) = (-a.dot(across) / volume, (-*a).cross(ab));
    let v = direction.dot(cross) / volume;
    // Not so of a flat one, whose numbers are not finite.
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && ac.dot(cross) / volume > 0.0
}

/// Directions spread evenly over the sphere, along a spiral of golden angles.
fn directions() -> impl Iterator<Item = DVec3> {
    (0..DIRECTIONS).map(|number| {
        let z = 1.0 - (2 * number + 1) as f64 / DIRECTIONS as f64;
        let (sin, cos) = libm::sincos(PI * (3.0 - libm::sqrt(5.0)) * number as f64);
        let across = libm::sqrt(1.0 - z * z);
        DVec3::new(across * cos, across * sin, z)
    })
}
