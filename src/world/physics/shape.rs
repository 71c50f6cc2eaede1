//! Collision geometry as shapes of rapier.

use crate::description::model::{Geometry, Heights, Mesh};
use belvedere_sensors::Pose;
use glam::{DQuat, DVec3, Vec3};
use rapier3d_f64::geometry::SharedShape;
use rapier3d_f64::parry::utils::Array2;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};
use std::ops::RangeInclusive;

/// Sizes in m that a shape may have. With others, parry's squares and products of sizes would be 0 or infinite.
const SIZES_M: RangeInclusive<f64> = f32::MIN_POSITIVE as f64..=f32::MAX as f64;

/// Returns a shape and its pose in the frame of the geometry, or the reason why it cannot collide.
///
/// A mesh that moves becomes its convex hull. A triangle mesh is hollow, so moving ones would sink into each other.
pub(super) fn shape(geometry: &Geometry, moves: bool) -> Result<(SharedShape, Pose), String> {
    let positive = |value: f64, what: &str| {
        if SIZES_M.contains(&value) { Ok(value) } else { Err(format!("its {what} is {value}, not above 0")) }
    };
    // The axis of parry's cylinders is y; here it is z.
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
            (SharedShape::halfspace(normal), Pose::IDENTITY)
        }
        Geometry::Ellipsoid { radii } => {
            let radii = radii.to_array().map(|radius| positive(radius, "radius"));
            let [x, y, z] = radii;
            (ellipsoid(DVec3::new(x?, y?, z?))?, Pose::IDENTITY)
        }
        Geometry::Cone { radius, length } => {
            (SharedShape::cone(positive(length * 0.5, "length")?, positive(*radius, "radius")?), z_from_y)
        }
        Geometry::Mesh(mesh) => (triangles(mesh, moves)?, Pose::IDENTITY),
        Geometry::HeightMap(map) => {
            let ([rows, columns], [x, y]) = (map.heights.grid, map.heights.size);
            let metres = Array2::new(rows as usize, columns as usize, by_columns(&map.heights));
            let size = DVec3::new(positive(x, "size")?, 1.0, positive(y, "size")?);
            // parry's rows go along z, which this turns to −y: from the top of the image to its bottom.
            (SharedShape::heightfield(metres, size), Pose::new(map.offset, z_from_y.rotation()))
        }
    })
}

/// Returns the hull of points on an ellipsoid, which parry lacks. It is at most 4 % of a radius inside the surface.
fn ellipsoid(radii: DVec3) -> Result<SharedShape, String> {
    const SLICES: usize = 16;
    let points = (0..=SLICES / 2).flat_map(|row| {
        let (ring, up) = libm::sincos(row as f64 / SLICES as f64 * TAU);
        (0..SLICES).map(move |column| {
            let (y, x) = libm::sincos(column as f64 / SLICES as f64 * TAU);
            DVec3::new(ring * x, ring * y, up) * radii
        })
    });
    SharedShape::convex_hull(&points.collect::<Vec<_>>()).ok_or_else(|| "its radii enclose nothing".into())
}

/// Returns heights in the order of parry's arrays.
fn by_columns(heights: &Heights) -> Vec<f64> {
    let [rows, columns] = heights.grid.map(|count| count as usize);
    let metres = |row, column| f64::from(heights.metres[row * columns + column]);
    (0..columns).flat_map(|column| (0..rows).map(move |row| metres(row, column))).collect()
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
    let points: Vec<DVec3> = mesh.positions.iter().map(|point| Vec3::from_array(*point).as_dvec3()).collect();
    if moves {
        SharedShape::convex_hull(&points).ok_or_else(|| format!("mesh '{file}' encloses no volume"))
    } else {
        SharedShape::trimesh(points, mesh.triangles.clone())
            .map_err(|error| format!("mesh '{file}' cannot collide: {error}"))
    }
}
