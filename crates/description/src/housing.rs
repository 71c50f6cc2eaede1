//! Housings: shapes of its own robot that enclose a ray sensor and that it looks through.
//!
//! A scanner is drawn as a box or a mesh, and its rays start inside. Without special treatment it would see only its own
//! housing. So a ray sensor ignores a shape that encloses it and that nothing can move against it: a collision shape, or a
//! visual for sensors that see visuals. Shapes beside the sensor, such as a mast or the plate above it, are still seen.

use super::diagnostics::Diagnostics;
use super::model::{Geometry, Link, LinkIndex, Mesh, Model, RaySensor, Sensor};
use belvedere_sensors::Pose;
use glam::DVec3;
use std::f64::consts::PI;

/// Number of directions in which a mesh is tested.
const DIRECTIONS: usize = 256;
/// A mesh that is hit in this many directions is a housing: real ones have windows, and files leave faces out.
const ENCLOSED: usize = DIRECTIONS * 9 / 10;
/// Distance to a solid's surface, in m, up to which a sensor counts as inside.
const ON_SURFACE_M: f64 = 1e-6;

/// A shape of a model: its link and its index there.
pub type ShapeIndex = (LinkIndex, Part);

/// A shape of a link, by its index among those of its kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// One of its visuals.
    Visual(usize),
    /// One of its collision shapes.
    Collision(usize),
}

/// Returns the shapes that a ray sensor looks through: they enclose it, and fixed joints connect them to it.
pub fn housings(model: &Model, sensor: &Sensor) -> Vec<ShapeIndex> {
    let Some(ray) = sensor.kind.ray() else { return Vec::new() };
    let body = model.rigid_root(sensor.link);
    around(model, sensor, ray).filter(|(other, _)| model.rigid_root(*other) == body).collect()
}

/// Returns the shapes of a model that a ray sensor can see and that enclose it, with every joint at zero.
fn around<'m>(model: &'m Model, sensor: &Sensor, ray: &RaySensor) -> impl Iterator<Item = ShapeIndex> + 'm {
    let model_from_sensor = model.links[sensor.link].model_from_link * sensor.link_from_sensor;
    let (origin, sees_visuals) = (model_from_sensor.translation(), ray.sees_visuals);
    model.links.iter().enumerate().flat_map(move |(number, link)| {
        let point = link.model_from_link.inverse().transform_point(origin);
        shapes(link, sees_visuals)
            .filter(move |(_, pose, geometry)| encloses(geometry, pose.inverse().transform_point(point)))
            .map(move |(part, ..)| (number, part))
    })
}

/// Returns the visuals of a link, or its collision shapes, with their poses in it.
fn shapes(link: &Link, visuals: bool) -> impl Iterator<Item = (Part, Pose, &Geometry)> {
    let (seen, hit) = if visuals { (&link.visuals[..], &[][..]) } else { (&[][..], &link.collisions[..]) };
    let seen = seen.iter().enumerate();
    let seen = seen.map(|(number, shape)| (Part::Visual(number), shape.link_from_visual, &shape.geometry));
    let hit = hit.iter().enumerate();
    let hit =
        hit.map(|(number, shape)| (Part::Collision(number), shape.link_from_collision, &shape.geometry));
    seen.chain(hit)
}

/// Reports which ray sensors of a robot start inside a shape that they can see, and the consequence.
pub(super) fn report(model: &Model, gazebo_compat: bool, diagnostics: &mut Diagnostics) {
    for sensor in &model.sensors {
        let Some(ray) = sensor.kind.ray() else { continue };
        for (link, part) in around(model, sensor, ray) {
            let (shape, source) = match part {
                Part::Visual(number) => ("visual", &model.links[link].visuals[number].source),
                Part::Collision(number) => ("collision shape", &model.links[link].collisions[number].source),
            };
            let what = format!(
                "the sensor '{}' is inside a {shape} of the link '{}' ({source})",
                sensor.name, model.links[link].name
            );
            let is_rigid = model.rigid_root(link) == model.rigid_root(sensor.link);
            match part {
                Part::Visual(_) if gazebo_compat || !is_rigid => {
                    // Of the enclosing mesh it could only see back faces, which are culled, and parts inside.
                }
                _ if gazebo_compat => diagnostics.warning(
                    &sensor.source,
                    format!("{what}: the sensor sees it beyond the least range, as in Gazebo"),
                    "let the shape end at the sensor, or leave --gazebo-compat out",
                ),
                _ if is_rigid => diagnostics.note(&sensor.source, format!("{what} and looks through it"), ""),
                _ => diagnostics.warning(
                    &sensor.source,
                    format!("{what}, which a joint moves: the sensor sees nothing else"),
                    "move the sensor, or fix that link to the sensor's",
                ),
            }
        }
    }
}

/// Returns true if a point in the frame of a shape is inside it.
fn encloses(geometry: &Geometry, point: DVec3) -> bool {
    let beyond = |length: f64| point.z.abs() - 0.5 * length;
    let across = point.truncate().length();
    match geometry {
        Geometry::Box { size } => (point.abs() - *size * 0.5).max_element() <= ON_SURFACE_M,
        Geometry::Sphere { radius } => point.length() <= radius + ON_SURFACE_M,
        Geometry::Cylinder { radius, length } => {
            beyond(*length) <= ON_SURFACE_M && across <= radius + ON_SURFACE_M
        }
        Geometry::Capsule { radius, length } => {
            DVec3::new(point.x, point.y, beyond(*length).max(0.0)).length() <= radius + ON_SURFACE_M
        }
        Geometry::Ellipsoid { radii } => (point / (*radii + ON_SURFACE_M)).length() <= 1.0,
        Geometry::Cone { radius, length } => {
            let here = radius * (0.5 - point.z / length);
            beyond(*length) <= ON_SURFACE_M && across <= here + ON_SURFACE_M
        }
        // These shapes have no inside.
        Geometry::Plane { .. } | Geometry::HeightMap(_) => false,
        Geometry::Mesh(mesh) => surrounds(mesh, point),
    }
}

/// Returns true if rays from a point hit a mesh in nearly all directions.
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

/// Returns true if a ray from the origin hits a triangle (Möller–Trumbore).
fn meets(direction: DVec3, [a, b, c]: &[DVec3; 3]) -> bool {
    let (ab, ac) = (*b - *a, *c - *a);
    let across = direction.cross(ac);
    let volume = ab.dot(across);
    let (u, cross) = (-a.dot(across) / volume, (-*a).cross(ab));
    let v = direction.dot(cross) / volume;
    // False for a degenerate triangle, whose numbers are not finite.
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && ac.dot(cross) / volume > 0.0
}

/// Returns directions that are evenly distributed over the sphere, along a spiral of golden angles.
fn directions() -> impl Iterator<Item = DVec3> {
    (0..DIRECTIONS).map(|number| {
        let z = 1.0 - (2 * number + 1) as f64 / DIRECTIONS as f64;
        let (sin, cos) = libm::sincos(PI * (3.0 - libm::sqrt(5.0)) * number as f64);
        let across = libm::sqrt(1.0 - z * z);
        DVec3::new(across * cos, across * sin, z)
    })
}
