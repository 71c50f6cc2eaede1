//! What touches: collision geometry as rapier's shapes.

use crate::description::model::{Geometry, Mesh};
use belvedere_sensors::Pose;
use glam::{DQuat, DVec3};
use rapier3d::geometry::SharedShape;
use rapier3d::math::Vector;
use std::f64::consts::FRAC_1_SQRT_2;

/// A shape and its pose in the geometry's frame, or why it cannot collide.
///
/// Triangles of something that moves become their convex hull: a hollow triangle mesh has no inside, so moving
/// ones would sink into each other.
pub(super) fn shape(geometry: &Geometry, moves: bool) -> Result<(SharedShape, Pose), String> {
    let positive = |value: f64, what: &str| {
        let narrow = value as f32;
        if narrow.is_finite() && narrow > 0.0 {
            Ok(narrow)
        } else {
            Err(format!("its {what} is {value}, not above 0"))
        }
    };
    // parry's cylinders stand along y, ours along z.
    let z_from_y = Pose::new(DVec3::ZERO, DQuat::from_xyzw(FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2));
    Ok(match geometry {
        Geometry::Box { size } => {
            let half = [size.x, size.y, size.z].map(|edge| positive(edge * 0.5, "size"));
            let [x, y, z] = half;
            (SharedShape::cuboid(x?, y?, z?), Pose::IDENTITY)
        }
        Geometry::Cylinder { radius, length } => {
            (SharedShape::cylinder(positive(length * 0.5, "length")?, positive(*radius, "radius")?), z_from_y)
        }
        Geometry::Sphere { radius } => (SharedShape::ball(positive(*radius, "radius")?), Pose::IDENTITY),
        Geometry::Capsule { radius, length } => (
            SharedShape::capsule_z(positive(length * 0.5, "length")?, positive(*radius, "radius")?),
            Pose::IDENTITY,
        ),
        Geometry::Plane { normal, .. } => {
            let normal = normal.try_normalize().ok_or("its normal has no direction")?;
            (SharedShape::halfspace(normal.as_vec3().normalize()), Pose::IDENTITY)
        }
        Geometry::Mesh(mesh) => (triangles(mesh, moves)?, Pose::IDENTITY),
    })
}

fn triangles(mesh: &Mesh, moves: bool) -> Result<SharedShape, String> {
    let file = mesh.path.display();
    if mesh.positions.iter().flatten().any(|coordinate| !coordinate.is_finite()) {
        return Err(format!("mesh '{file}' has a vertex that is not finite"));
    }
    let count = mesh.positions.len();
    if let Some(vertex) = mesh.triangles.iter().flatten().find(|vertex| **vertex as usize >= count) {
        return Err(format!("mesh '{file}' has {count} vertices, and a triangle that names vertex {vertex}"));
    }
    let points: Vec<Vector> = mesh.positions.iter().map(|point| Vector::from_array(*point)).collect();
    if moves {
        SharedShape::convex_hull(&points).ok_or_else(|| format!("mesh '{file}' encloses no volume"))
    } else {
        SharedShape::trimesh(points, mesh.triangles.clone())
            .map_err(|error| format!("mesh '{file}' cannot collide: {error}"))
    }
}
