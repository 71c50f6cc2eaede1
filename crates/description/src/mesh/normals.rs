//! Normals of vertices: their transforms, and the normals of triangles where a file has none.

use crate::model::Mesh;
use glam::{DMat3, DVec3, Vec3};

/// Marks a vertex without a normal.
pub(super) const MISSING: [f32; 3] = [0.0; 3];

/// Returns the matrix for the normals of what `linear` transforms: its inverse transpose, up to a positive factor. It
/// exists for matrices without an inverse too.
pub(super) fn matrix(linear: DMat3) -> DMat3 {
    let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
    let sign = if linear.determinant() < 0.0 { -1.0 } else { 1.0 };
    DMat3::from_cols(y.cross(z) * sign, z.cross(x) * sign, x.cross(y) * sign)
}

/// Returns the normal with length 1, or [`MISSING`] if it has no direction.
pub(super) fn unit(normal: DVec3) -> [f32; 3] {
    // Divided first, so that no square overflows.
    let scaled = normal / normal.abs().max_element();
    scaled.try_normalize().map_or(MISSING, |unit| unit.as_vec3().to_array())
}

/// Transforms a normal of a file by a [`matrix`], with the same result as [`unit`].
pub(super) fn turned(matrix: &DMat3, normal: [f32; 3]) -> [f32; 3] {
    unit(*matrix * Vec3::from_array(normal).as_dvec3())
}

/// Gives triangles with a vertex without a normal their own vertices, which have the normal of the triangle, so that
/// they are flat. If no vertex has a normal, the mesh has none.
pub(super) fn complete(mesh: &mut Mesh) {
    if mesh.normals.len() != mesh.positions.len() || mesh.normals.iter().all(|normal| *normal == MISSING) {
        mesh.normals.clear();
        return;
    }
    for index in 0..mesh.triangles.len() {
        let corners = mesh.triangles[index].map(|vertex| vertex as usize);
        if corners.iter().all(|corner| mesh.normals[*corner] != MISSING) {
            continue;
        }
        let [a, b, c] = corners.map(|corner| Vec3::from_array(mesh.positions[corner]).as_dvec3());
        let normal = unit((b - a).cross(c - a));
        mesh.triangles[index] = corners.map(|corner| {
            mesh.positions.push(mesh.positions[corner]);
            mesh.normals.push(if normal == MISSING { [0.0, 0.0, 1.0] } else { normal });
            if !mesh.uvs.is_empty() {
                mesh.uvs.push(mesh.uvs[corner]);
            }
            mesh.positions.len() as u32 - 1
        });
    }
    // No triangle has these vertices any more.
    for normal in mesh.normals.iter_mut().filter(|normal| **normal == MISSING) {
        *normal = [0.0, 0.0, 1.0];
    }
}
