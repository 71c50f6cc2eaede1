//! [`Triangles`]: shapes as triangle meshes.

use crate::description::model::{Geometry, HeightMap};
use glam::{DMat3, DQuat, DVec3, Vec3};
use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Number of segments of a full circle, and of half of one for a ball.
const ROUND: u32 = 32;
const HALF_ROUND: u32 = 16;
/// Most rows and columns of a terrain.
const MAX_TERRAIN: u32 = 256;

/// Triangles counter-clockwise seen from outside; normals and texture coordinates (v up) for each vertex, or none.
#[derive(Debug, Default)]
pub(super) struct Triangles<'a> {
    pub(super) positions: Cow<'a, [[f32; 3]]>,
    pub(super) normals: Vec<[f32; 3]>,
    pub(super) uvs: Cow<'a, [[f32; 2]]>,
    pub(super) corners: Cow<'a, [[u32; 3]]>,
}

impl<'a> Triangles<'a> {
    /// Returns the triangles of a shape. Readers shade meshes without normals flat, as cameras do.
    pub(super) fn of(geometry: &'a Geometry) -> Self {
        let mut shape = Self::default();
        match geometry {
            Geometry::Mesh(mesh) => {
                return Self {
                    positions: Cow::Borrowed(&mesh.positions),
                    normals: mesh.normals.clone(),
                    uvs: Cow::Borrowed(&mesh.uvs),
                    corners: Cow::Borrowed(&mesh.triangles),
                };
            }
            Geometry::Box { size } => {
                // Normal and right; up is their cross product.
                for (normal, right) in [
                    (DVec3::X, DVec3::Y),
                    (DVec3::NEG_X, DVec3::NEG_Y),
                    (DVec3::Y, DVec3::NEG_X),
                    (DVec3::NEG_Y, DVec3::X),
                    (DVec3::Z, DVec3::X),
                    (DVec3::NEG_Z, DVec3::X),
                ] {
                    let half = *size * 0.5;
                    let up = normal.cross(right);
                    shape.rectangle(normal * half, right * half, up * half, normal);
                }
            }
            Geometry::Plane { normal, size: [width, height] } => {
                let turn = facing(*normal);
                let (right, up) = (turn * DVec3::X, turn * DVec3::Y);
                shape.rectangle(DVec3::ZERO, right * (width * 0.5), up * (height * 0.5), *normal);
            }
            Geometry::Sphere { radius } => shape.ball(*radius, 0.0),
            Geometry::Capsule { radius, length } => shape.ball(*radius, length * 0.5),
            Geometry::Cylinder { radius, length } => {
                shape.tube([*radius; 2], length * 0.5);
                shape.lid(*radius, length * 0.5, 1.0);
                shape.lid(*radius, length * 0.5, -1.0);
            }
            Geometry::Cone { radius, length } => {
                shape.tube([*radius, 0.0], length * 0.5);
                shape.lid(*radius, length * 0.5, -1.0);
            }
            Geometry::Ellipsoid { radii } => {
                shape.ball(1.0, 0.0);
                for (place, normal) in shape.positions.to_mut().iter_mut().zip(&mut shape.normals) {
                    let unit = Vec3::from(*normal).as_dvec3();
                    *place = (unit * *radii).as_vec3().to_array();
                    *normal = (unit / *radii).normalize_or(DVec3::Z).as_vec3().to_array();
                }
            }
            Geometry::HeightMap(map) => shape.terrain(map),
        }
        shape
    }

    fn vertex(&mut self, position: DVec3, normal: DVec3, uv: [f64; 2]) -> u32 {
        let positions = self.positions.to_mut();
        positions.push(position.as_vec3().to_array());
        self.normals.push(normal.as_vec3().to_array());
        self.uvs.to_mut().push(uv.map(|value| value as f32));
        positions.len() as u32 - 1
    }

    fn rectangle(&mut self, middle: DVec3, right: DVec3, up: DVec3, normal: DVec3) {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let [a, b, c, d] = corners.map(|(u, v)| {
            self.vertex(middle + right * u + up * v, normal, [f64::midpoint(u, 1.0), f64::midpoint(v, 1.0)])
        });
        self.corners.to_mut().extend([[a, b, c], [a, c, d]]);
    }

    /// Adds rings from one pole to the other, with a gap of twice `lift` at the equator.
    fn ball(&mut self, radius: f64, lift: f64) {
        let rows: Vec<(f64, f64)> = (0..=HALF_ROUND / 2)
            .map(|row| (row, -lift))
            .chain((HALF_ROUND / 2..=HALF_ROUND).map(|row| (row, lift)))
            .map(|(row, lift)| (f64::from(row) / f64::from(HALF_ROUND) * PI - FRAC_PI_2, lift))
            .collect();
        for (row, (latitude, lift)) in rows.iter().enumerate() {
            for column in 0..=ROUND {
                let turn = f64::from(column) / f64::from(ROUND);
                let normal = round(turn) * latitude.cos() + DVec3::Z * latitude.sin();
                let v = row as f64 / (rows.len() - 1) as f64;
                self.vertex(normal * radius + DVec3::Z * *lift, normal, [turn, v]);
            }
        }
        self.join(rows.len() as u32, ROUND);
    }

    /// Adds the side of a cylinder or cone with these radii below and above.
    fn tube(&mut self, [below, above]: [f64; 2], half: f64) {
        let slope = (below - above) / (2.0 * half);
        for (v, radius, z) in [(0.0, below, -half), (1.0, above, half)] {
            for column in 0..=ROUND {
                let turn = f64::from(column) / f64::from(ROUND);
                let normal = (round(turn) + DVec3::Z * slope).normalize_or(DVec3::Z);
                self.vertex(round(turn) * radius + DVec3::Z * z, normal, [turn, v]);
            }
        }
        self.join(2, ROUND);
    }

    /// Adds a disc that faces up (1) or down (-1).
    fn lid(&mut self, radius: f64, half: f64, side: f64) {
        let normal = DVec3::Z * side;
        let middle = self.vertex(normal * half, normal, [0.5, 0.5]);
        for column in 0..=ROUND {
            let edge = round(f64::from(column) / f64::from(ROUND) * side);
            let uv = [0.5 + 0.5 * edge.x, 0.5 + 0.5 * edge.y * side];
            let vertex = self.vertex(edge * radius + normal * half, normal, uv);
            if column > 0 {
                self.corners.to_mut().push([middle, vertex - 1, vertex]);
            }
        }
    }

    /// Adds a terrain, reduced to at most `MAX_TERRAIN` rows and columns. Readers shade it flat.
    fn terrain(&mut self, map: &HeightMap) {
        let heights = &map.heights;
        let [rows, columns] = heights.grid;
        let picked = |count: u32| -> Vec<u32> {
            let step = count.div_ceil(MAX_TERRAIN).max(1);
            let last = count.saturating_sub(1);
            (0..last).step_by(step as usize).chain([last]).collect()
        };
        let (rows_picked, columns_picked) = (picked(rows), picked(columns));
        // From -y to +y, as rings of vertices go up.
        for row in rows_picked.iter().rev() {
            for column in &columns_picked {
                let u = f64::from(*column) / f64::from(columns.saturating_sub(1).max(1));
                let v = 1.0 - f64::from(*row) / f64::from(rows.saturating_sub(1).max(1));
                let height =
                    heights.metres.get((row * columns + column) as usize).copied().unwrap_or_default();
                let flat =
                    DVec3::new((u - 0.5) * heights.size[0], (v - 0.5) * heights.size[1], height.into());
                self.vertex(map.offset + flat, DVec3::Z, [u, v]);
            }
        }
        self.normals.clear();
        self.join(rows_picked.len() as u32, columns_picked.len() as u32 - 1);
    }

    /// Adds triangles between rows of vertices with `steps` segments each, from the bottom up.
    fn join(&mut self, rows: u32, steps: u32) {
        let triangles = self.corners.to_mut();
        for row in 1..rows {
            for column in 1..=steps {
                let at = |row: u32, column: u32| row * (steps + 1) + column;
                let [a, b] = [at(row - 1, column - 1), at(row - 1, column)];
                let [d, c] = [at(row, column - 1), at(row, column)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
}

fn round(turn: f64) -> DVec3 {
    let (sin, cos) = (turn * TAU).sin_cos();
    DVec3::new(cos, sin, 0.0)
}

/// Returns the rotation of z to a normal with which a plane's texture lies as on the face of a box with that normal;
/// for other normals, its right is horizontal.
fn facing(normal: DVec3) -> DQuat {
    let right = if normal.z.abs() > 0.999 { DVec3::X } else { DVec3::Z.cross(normal).normalize_or(DVec3::Y) };
    let up = normal.cross(right).normalize_or(DVec3::Y);
    DQuat::from_mat3(&DMat3::from_cols(up.cross(normal), up, normal))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::model::Heights;
    use std::sync::Arc;

    #[test]
    fn surfaces_face_outwards() {
        for geometry in [
            Geometry::Box { size: DVec3::new(1.0, 2.0, 3.0) },
            Geometry::Sphere { radius: 0.5 },
            Geometry::Cylinder { radius: 0.3, length: 2.0 },
            Geometry::Capsule { radius: 0.3, length: 1.0 },
            Geometry::Cone { radius: 0.3, length: 1.0 },
            Geometry::Ellipsoid { radii: DVec3::new(0.2, 1.0, 0.5) },
        ] {
            let shape = Triangles::of(&geometry);
            for triangle in shape.corners.iter() {
                let [a, b, c] =
                    triangle.map(|vertex| Vec3::from(shape.positions[vertex as usize]).as_dvec3());
                let normal = (b - a).cross(c - a);
                assert!(normal.dot(a + b + c) >= -1e-9, "{geometry:?}: {triangle:?}");
                for vertex in triangle {
                    let stored = Vec3::from(shape.normals[*vertex as usize]).as_dvec3();
                    // Triangles at the poles have no area.
                    assert!(normal.length() < 1e-9 || stored.dot(normal) > 0.0);
                }
            }
        }
    }

    #[test]
    fn a_terrain_has_north_at_the_top_and_faces_up() {
        let heights = Heights {
            path: "picture.png".into(),
            grid: [2, 3],
            size: [4.0, 2.0],
            metres: vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
        };
        let map = HeightMap { heights: Arc::new(heights), offset: DVec3::Z, material: None };
        let geometry = Geometry::HeightMap(map);
        let shape = Triangles::of(&geometry);
        assert!(shape.positions.contains(&[-2.0, 1.0, 2.0]) && shape.positions.contains(&[2.0, -1.0, 7.0]));
        assert_eq!(shape.corners.len(), 4);
        for triangle in shape.corners.iter() {
            let [a, b, c] = triangle.map(|vertex| Vec3::from(shape.positions[vertex as usize]));
            assert!((b - a).cross(c - a).z > 0.0);
        }
    }

    #[test]
    fn planes_are_oriented_like_the_faces_of_boxes() {
        for (normal, right) in [
            (DVec3::X, DVec3::Y),
            (DVec3::NEG_X, DVec3::NEG_Y),
            (DVec3::Y, DVec3::NEG_X),
            (DVec3::NEG_Y, DVec3::X),
            (DVec3::Z, DVec3::X),
            (DVec3::NEG_Z, DVec3::X),
        ] {
            let turn = facing(normal);
            assert!((turn * DVec3::Z - normal).length() < 1e-12, "{normal}");
            assert!((turn * DVec3::X - right).length() < 1e-12, "{normal}");
        }
    }
}
