//! Cases in which rounding could let a ray through.

use super::oracle::{Random, soup, sphere};
use super::{Mesh, around};
use crate::trace::Faces;
use crate::trace::rays::Rays;

fn shifted(mut mesh: (Vec<[f32; 3]>, Vec<[u32; 3]>), by: [f32; 3]) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    for vertex in &mut mesh.0 {
        for axis in 0..3 {
            vertex[axis] += by[axis];
        }
    }
    mesh
}

/// Casts rays from inside a closed mesh and checks that none escapes.
fn none_escapes(mesh: &Mesh, origins: &[[f32; 3]], directions: &[[f32; 3]]) {
    let found = mesh.cast(&Rays { origins, directions, ranges: None }, Faces::Both);
    let escaped = found.distance.iter().filter(|t| t.is_infinite()).count();
    assert_eq!(escaped, 0, "of {}", directions.len());
}

#[test]
fn no_ray_escapes_from_a_sphere() {
    for by in [[0.0; 3], [100.0, -37.0, 5.0], [1e5, 2e5, -3e5]] {
        let radius = if by[0] > 1e4 { 100.0 } else { 1.0 };
        let mesh = Mesh::new(shifted(sphere(40, radius), by));
        let mut random = Random(11);
        let (origins, directions) = around(&mut random, 50_000, 0.5 * radius);
        let origins: Vec<_> = origins.iter().map(|o| [o[0] + by[0], o[1] + by[1], o[2] + by[2]]).collect();
        none_escapes(&mesh, &origins, &directions);
    }
}

#[test]
fn no_ray_escapes_through_a_vertex_or_an_edge() {
    let mesh = Mesh::new(sphere(40, 1.0));
    let mut random = Random(12);
    let (mut origins, mut directions) = (Vec::new(), Vec::new());
    for _ in 0..50_000 {
        let origin = random.point(0.5);
        let triangle = mesh.triangles[random.below(mesh.triangles.len())];
        let [a, b] = [mesh.vertices[triangle[0] as usize], mesh.vertices[triangle[1] as usize]];
        let weight = [0.0, 1.0, 0.5, random.unit() as f32][random.below(4)];
        origins.push(origin);
        directions.push([0, 1, 2].map(|axis| a[axis] + (b[axis] - a[axis]) * weight - origin[axis]));
    }
    none_escapes(&mesh, &origins, &directions);
}

/// A cube of squares whose corners are integers: rays along the axes hit edges and vertices exactly.
fn cube() -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let mut mesh = (Vec::new(), Vec::new());
    for axis in 0..3 {
        for side in [-4.0_f32, 4.0] {
            for p in -4..4_i8 {
                for q in -4..4_i8 {
                    let first = mesh.0.len() as u32;
                    for [dp, dq] in [[0, 0], [1, 0], [1, 1], [0, 1]] {
                        let mut vertex = [0.0; 3];
                        vertex[axis] = side;
                        vertex[(axis + 1) % 3] = f32::from(p + dp);
                        vertex[(axis + 2) % 3] = f32::from(q + dq);
                        mesh.0.push(vertex);
                    }
                    mesh.1.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
                }
            }
        }
    }
    mesh
}

#[test]
fn directions_with_zeros_meet_edges_and_vertices() {
    let mesh = Mesh::new(cube());
    let (mut origins, mut directions) = (Vec::new(), Vec::new());
    for x in -3..=3_i8 {
        for y in -3..=3_i8 {
            for z in [-0.0, 0.0, 0.5, 1.0] {
                for axis in 0..3 {
                    for zero in [0.0_f32, -0.0] {
                        for sign in [1.0_f32, -1.0] {
                            let mut direction = [zero; 3];
                            direction[axis] = sign;
                            origins.push([f32::from(x), f32::from(y), z]);
                            directions.push(direction);
                            direction[(axis + 1) % 3] = 1.0;
                            origins.push([f32::from(x), f32::from(y), z]);
                            directions.push(direction);
                        }
                    }
                }
            }
        }
    }
    let found = mesh.cast(&Rays { origins: &origins, directions: &directions, ranges: None }, Faces::Both);
    for index in 0..directions.len() {
        let expected = (0..3)
            .filter(|&axis| directions[index][axis] != 0.0)
            .map(|axis| {
                (4.0_f32.copysign(directions[index][axis]) - origins[index][axis]) / directions[index][axis]
            })
            .fold(f32::INFINITY, f32::min);
        assert_eq!(found.distance[index], expected, "{:?} {:?}", origins[index], directions[index]);
    }
}

#[test]
fn rays_along_the_faces_of_boxes() {
    // The walls are in the same planes as the boxes of their nodes. Rays run along them and hit the walls across.
    let mesh = Mesh::new(cube());
    let origins = vec![[-4.0, 0.3, 4.0], [-3.7, 4.0, 0.2], [4.0, -4.0, 0.1], [0.0, -4.0, 4.0]];
    let directions = vec![[1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let ranges = vec![[0.5, 100.0]; 4];
    let rays = Rays { origins: &origins, directions: &directions, ranges: Some(&ranges) };
    let found = mesh.cast(&rays, Faces::Both);
    for (t, expected) in found.distance.iter().zip([8.0, 7.7, 8.0, 8.0]) {
        assert!((t - expected).abs() < 1e-6, "{t} instead of {expected}");
    }
}

#[test]
fn from_a_surface_the_surface_itself_is_hit_at_zero_or_not_at_all() {
    let mesh = Mesh::new(sphere(40, 1.0));
    let mut random = Random(13);
    let (mut origins, mut directions) = (Vec::new(), Vec::new());
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|index| mesh.vertices[index as usize]);
        let origin = [0, 1, 2].map(|axis| (a[axis] + b[axis] + c[axis]) / 3.0);
        // Inwards, so that the opposite side is behind.
        let target = random.point(0.3);
        origins.push(origin);
        directions.push([0, 1, 2].map(|axis| target[axis] - origin[axis]));
    }
    let ranges = vec![[1e-3, f32::INFINITY]; origins.len()];
    let rays = Rays { origins: &origins, directions: &directions, ranges: Some(&ranges) };
    assert_eq!(mesh.check(&rays, Faces::Both), origins.len());
    let found = mesh.cast(&Rays { ranges: None, ..rays }, Faces::Both);
    assert!(found.distance.iter().all(|&t| t.abs() < 1e-6 || (t > 0.5 && t.is_finite())));
}

#[test]
fn triangles_without_area_are_not_hit() {
    let mut random = Random(14);
    let mut mesh = soup(&mut random, 200, 0.4);
    for triangle in mesh.1.iter_mut().step_by(3) {
        triangle[2] = triangle[1];
    }
    let first = mesh.0.len() as u32;
    mesh.0.extend([[0.0; 3], [0.5, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    mesh.1.push([first, first + 1, first + 2]);
    let mesh = Mesh::new(mesh);
    let (origins, mut directions) = around(&mut random, 3000, 1.5);
    // Some rays are aimed straight at the points to which triangles have collapsed.
    for index in 0..1000 {
        let vertex = mesh.vertices[mesh.triangles[index % 200][1] as usize];
        directions[index] = [0, 1, 2].map(|axis| vertex[axis] - origins[index][axis]);
    }
    mesh.check(&Rays { origins: &origins, directions: &directions, ranges: None }, Faces::Both);
}

#[test]
fn one_origin_for_all() {
    let mesh = Mesh::new(sphere(20, 1.0));
    let (_, directions) = around(&mut Random(15), 1000, 1.0);
    let rays = Rays { origins: &[[0.1, 0.2, 0.3]], directions: &directions, ranges: None };
    assert_eq!(mesh.check(&rays, Faces::Both), 1000);
    // No front face is visible from inside.
    assert_eq!(mesh.check(&rays, Faces::Front), 0);
}
