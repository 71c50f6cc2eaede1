//! The yardstick: parry3d's triangle mesh, one ray a call.

use super::{Mesh, RaySet};
use parry3d::math::Vector;
use parry3d::query::{Ray, RayCast as _};
use parry3d::shape::TriMesh;

/// parry3d's form of a mesh.
pub struct Built(TriMesh);

impl Built {
    /// Builds its tree.
    pub fn new(mesh: &Mesh) -> Self {
        let vertices = mesh.vertices.iter().map(|vertex| Vector::from_array(*vertex)).collect();
        Self(TriMesh::new(vertices, mesh.triangles.clone()).expect("a mesh with triangles"))
    }

    /// Moves the vertices and refits the tree.
    pub fn refit(&mut self, vertices: &[[f32; 3]]) {
        self.0.update_vertices(|old| {
            for (old, new) in old.iter_mut().zip(vertices) {
                *old = Vector::from_array(*new);
            }
        });
    }

    /// Casts the chosen rays; `distances` gets one a ray, infinite for a miss.
    pub fn cast(&self, rays: &RaySet, chosen: impl Iterator<Item = usize>, distances: &mut Vec<f32>) {
        distances.clear();
        distances.extend(chosen.map(|ray| {
            let (origin, direction) = (rays.origin(ray), rays.directions[ray]);
            let ray = Ray::new(Vector::from_array(origin), Vector::from_array(direction));
            let hit = self.0.cast_local_ray_and_get_normal(&ray, f32::MAX, false);
            // The normal is part of what is asked for: it must not be optimised away.
            std::hint::black_box(&hit).map_or(f32::INFINITY, |hit| hit.time_of_impact)
        }));
    }
}
