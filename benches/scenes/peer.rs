//! The reference: parry3d's triangle mesh, with one ray per call.

use super::{Mesh, RaySet};
use parry3d::math::{Pose, Vector};
use parry3d::partitioning::{Bvh, BvhBuildStrategy};
use parry3d::query::{Ray, RayCast as _};
use parry3d::shape::{Cuboid, TriMesh};

/// A mesh of parry3d.
pub struct Built(TriMesh);

impl Built {
    /// Builds the tree.
    pub fn new(mesh: &Mesh) -> Self {
        let vertices = mesh.vertices.iter().map(|vertex| Vector::from_array(*vertex)).collect();
        Self(TriMesh::new(vertices, mesh.triangles.clone()).expect("a mesh with triangles"))
    }

    /// Refits the tree to moved vertices: new boxes, the same structure.
    pub fn refit(&mut self, vertices: &[[f32; 3]]) {
        self.0.update_vertices(|ours| {
            for (ours, vertex) in ours.iter_mut().zip(vertices) {
                *ours = Vector::from_array(*vertex);
            }
        });
    }

    /// Casts the chosen rays. `distances` gets one value per ray, infinite for a miss.
    pub fn cast(&self, rays: &RaySet, chosen: impl Iterator<Item = usize>, distances: &mut Vec<f32>) {
        distances.clear();
        distances.extend(chosen.map(|ray| {
            let (origin, direction) = (rays.origin(ray), rays.directions[ray]);
            let ray = Ray::new(Vector::from_array(origin), Vector::from_array(direction));
            let hit = self.0.cast_local_ray_and_get_normal(&ray, f32::MAX, false);
            // The normal is part of the result and must not be optimised away.
            std::hint::black_box(&hit).map_or(f32::INFINITY, |hit| hit.time_of_impact)
        }));
    }
}

/// Boxes with a tree that is rebuilt in each frame.
pub struct Moving {
    bvh: Bvh,
    cuboid: Cuboid,
}

impl Moving {
    /// Creates a number of boxes.
    pub fn new(count: usize) -> Self {
        let half = super::moving::SIZE.map(|edge| edge as f32 * 0.5);
        let cuboid = Cuboid::new(Vector::from_array(half));
        let aabbs = vec![cuboid.aabb(&Pose::IDENTITY); count];
        Self { bvh: Bvh::from_leaves(BvhBuildStrategy::Binned, &aabbs), cuboid }
    }

    /// Moves the boxes and builds the tree again.
    pub fn frame(&mut self, poses: &[belvedere_sensors::Pose]) {
        let leaves = poses.iter().map(|pose| {
            let pose = Pose::from_parts(pose.translation().as_vec3(), pose.rotation().as_quat());
            self.cuboid.aabb(&pose)
        });
        self.bvh = Bvh::from_iter(BvhBuildStrategy::Binned, leaves.enumerate());
        std::hint::black_box(&self.bvh);
    }
}
