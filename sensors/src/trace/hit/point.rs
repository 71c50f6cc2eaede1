//! The points at which rays hit surfaces, in double precision, and their barycentric coordinates in triangles.

use crate::pose::Pose;
use crate::simd::WIDTH;
use crate::trace::grid::Band;
use crate::trace::hit::resolve::Resolver;
use crate::trace::image::NO_HIT;
use crate::trace::placed::view::View;
use glam::{DMat3, DVec3};

/// Computes the points that the rays of a grid have hit.
pub(crate) struct HitPoints {
    /// The rotation from the sensor's axes to the world's.
    axes: DMat3,
}

/// The index in its band of a block, given by its column and row in the grid.
#[inline(always)]
pub(crate) fn block_index(band: &Band<'_>, [column, row]: [usize; 2]) -> usize {
    (row - *band.block_rows().start()) * band.rays.ray_grid().blocks_across() + column
}

/// Returns true if any instance in view is not made of triangles.
pub(crate) fn has_solids(view: &View<'_>) -> bool {
    view.placed.iter().any(|placed| placed.kind().is_solid())
}

impl HitPoints {
    pub(crate) fn new(world_from_sensor: &Pose) -> Self {
        Self { axes: world_from_sensor.rotation_matrix() }
    }

    /// Weights of the second and third corners of the triangles that the rays of a block hit; 0 elsewhere.
    pub(crate) fn barycentrics(
        &self,
        band: &Band<'_>,
        resolver: &mut Resolver<'_>,
        block: [usize; 2],
    ) -> [[f32; 2]; WIDTH] {
        let index = block_index(band, block);
        let slots = &band.target.slot[index];
        let mut weights = [[0.0; 2]; WIDTH];
        let directions = band.rays.exact_block(block[0], block[1]);
        for lane in 0..WIDTH {
            if slots[lane] == NO_HIT {
                continue;
            }
            let hit = resolver.hit(slots[lane]);
            if !hit.instance.kind().is_solid() {
                let direction = self.axes * DVec3::from_array(directions.map(|axis| axis[lane]));
                let rough = 1.0 / f64::from(band.target.inverse[index][lane]);
                let t = resolver.exact(&hit, direction, rough);
                let origin = DVec3::from_array(hit.instance.origin_in_instance);
                let point = origin + hit.instance.vector_in_instance(direction) * t;
                weights[lane] = triangle_weights(band.view.corners(hit.instance, hit.local), point);
            }
        }
        weights
    }
}

/// The weights of the second and third corner at a point of a triangle's plane: the areas of the two opposite parts
/// into which the point divides the triangle, as fractions of the whole.
pub(crate) fn triangle_weights([a, b, c]: [DVec3; 3], point: DVec3) -> [f32; 2] {
    let (ab, ac, ap) = (b - a, c - a, point - a);
    let normal = ab.cross(ac);
    let per_area = 1.0 / normal.length_squared();
    [ap.cross(ac).dot(normal) * per_area, ab.cross(ap).dot(normal) * per_area].map(|weight| weight as f32)
}
