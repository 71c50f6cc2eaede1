//! The reported properties of a hit: triangle, normal, barycentric coordinates.

use super::block;
use super::ray::FrameRay;
use super::scene::{SceneHit, in_instance, mesh_tree};
use crate::scene::tree::TriangleBlock;
use crate::scene::{Kind, Triangles};
use crate::simd::WIDTH;
use crate::trace::hit::point::triangle_weights;
use crate::trace::placed::view::{Placed, View};
use crate::trace::shapes::solid_normal;
use glam::{DMat3, DVec3};

/// The reported properties of a hit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Description {
    pub(super) instance: u32,
    pub(super) primitive: u32,
    /// The outward unit normal, in the frame.
    pub(super) normal: [f32; 3],
    pub(super) barycentrics: [f32; 2],
}

impl Description {
    /// Computes the properties of a ray's hit.
    pub(super) fn new(view: &View<'_>, ray: &FrameRay, hit: &SceneHit) -> Option<Self> {
        let placed = view.placed.get(hit.placed as usize)?;
        let instance = &view.scene.instances[placed.instance as usize];
        let [origin, direction] = in_instance(placed, ray);
        let point = origin + direction * hit.t;
        let lane = hit.slot as usize % WIDTH;
        let (normal, primitive, barycentrics) = match instance.kind() {
            Kind::Triangles(Triangles::Mesh) => {
                let block = mesh_tree(view, placed).blocks.get(hit.slot as usize / WIDTH)?;
                on_triangle(block, lane, point)
            }
            Kind::Triangles(Triangles::HeightField) => {
                on_triangle(&view.height_grid(placed).block(hit.slot / WIDTH as u32), lane, point)
            }
            Kind::Solid(solid) => {
                let normal = solid_normal(solid, instance.size, point.to_array());
                (DVec3::from_array(normal), 0, [0.0; 2])
            }
        };
        Some(Self { instance: placed.instance, primitive, normal: in_frame(placed, normal), barycentrics })
    }
}

/// Transforms a normal to the frame, by the inverse transpose.
fn in_frame(placed: &Placed, normal: DVec3) -> [f32; 3] {
    // A matrix whose columns are the rows of another is its transpose.
    let transposed = DMat3::from_cols_array_2d(&placed.inverse);
    (transposed * normal).normalize_or_zero().as_vec3().to_array()
}

/// The normal, the triangle, and the weights of the second and third corner at a point.
pub(super) fn on_triangle(block: &TriangleBlock, lane: usize, point: DVec3) -> (DVec3, u32, [f32; 2]) {
    let corner = |[x, y, z]: &[[f32; WIDTH]; 3]| DVec3::new(x[lane].into(), y[lane].into(), z[lane].into());
    let [a, b, c] = &block.corners;
    let corners = [corner(a), corner(b), corner(c)];
    let normal = DVec3::from_array(block::normal(block, lane));
    (normal, block.triangle[lane], triangle_weights(corners, point))
}
