//! Where rays meet the surfaces that they hit, in double precision, and what is told of that point: normals of
//! solids, barycentrics of triangles.

use super::grid::Band;
use super::image::NO_HIT;
use super::packet::Faces;
use super::resolve::{Hit, Resolver};
use super::shapes::match_solid;
use super::shapes::solid_surface;
use super::view::View;
use crate::pose::Pose;
use crate::scene::{Kind, Solid};
use crate::simd::WIDTH;
use glam::{DMat3, DVec3};

/// Finds the points that the rays of a grid have hit.
pub(crate) struct HitPoints {
    /// From the sensor's axes to the world's.
    axes: DMat3,
    /// The least t that counts.
    near: f64,
    both: bool,
}

/// Index of a block, given by column and row among those of the grid, in its band.
#[inline(always)]
pub(crate) fn block_index(band: &Band<'_>, [column, row]: [usize; 2]) -> usize {
    (row - *band.block_rows().start()) * band.rays.fan().blocks_across() + column
}

/// Whether anything in view is not made of triangles.
pub(crate) fn has_solids(view: &View<'_>) -> bool {
    view.placed.iter().any(|placed| placed.kind().is_solid())
}

impl HitPoints {
    pub(crate) fn new(world_from_sensor: &Pose, near: f64, faces: Faces) -> Self {
        Self { axes: world_from_sensor.rotation_matrix(), near, both: faces == Faces::Both }
    }

    /// Unit normals in the frame where rays of a block hit solids; the slots of the others are [`NO_HIT`].
    pub(crate) fn solid_normals(
        &self,
        band: &Band<'_>,
        resolver: &mut Resolver<'_>,
        block: [usize; 2],
    ) -> ([u32; WIDTH], [[f32; 3]; WIDTH]) {
        let mut slots = band.target.slot[block_index(band, block)];
        let mut normals = [[0.0; 3]; WIDTH];
        let mut directions = None;
        for lane in 0..WIDTH {
            if slots[lane] == NO_HIT {
                continue;
            }
            let hit = resolver.hit(slots[lane]);
            let Kind::Solid(solid) = hit.instance.kind() else {
                slots[lane] = NO_HIT;
                continue;
            };
            let directions = directions.get_or_insert_with(|| band.rays.exact_block(block[0], block[1]));
            let rough = 1.0 / f64::from(band.target.inverse[block_index(band, block)][lane]);
            let point = self.on_solid(band.view, (&hit, solid), directions.map(|axis| axis[lane]), rough);
            let size = band.view.instance(hit.placed).size;
            let normal = solid_surface::<false>(solid, size, point).normal;
            // Normals go by the inverse transpose, whose columns are the rows of the inverse.
            let transposed = DMat3::from_cols_array_2d(&hit.instance.inverse);
            normals[lane] = (transposed * normal).normalize_or_zero().as_vec3().to_array();
        }
        (slots, normals)
    }

    /// Angles between the rays of a block, backwards, and the normals of what they hit; NaN elsewhere.
    pub(crate) fn incidence(
        &self,
        band: &Band<'_>,
        resolver: &mut Resolver<'_>,
        block: [usize; 2],
    ) -> [f32; WIDTH] {
        let (solids, mut normals) = self.solid_normals(band, resolver, block);
        let slots = &band.target.slot[block_index(band, block)];
        let directions = band.rays.exact_block(block[0], block[1]);
        let mut angles = [f32::NAN; WIDTH];
        for lane in 0..WIDTH {
            if slots[lane] == NO_HIT {
                continue;
            }
            if solids[lane] == NO_HIT {
                let hit = resolver.hit(slots[lane]);
                normals[lane] = resolver.triangle_normal(&hit);
            }
            let ray = (self.axes * DVec3::from_array(directions.map(|axis| axis[lane]))).normalize();
            let normal = glam::Vec3::from_array(normals[lane]).as_dvec3();
            angles[lane] = libm::acos(ray.dot(-normal).clamp(-1.0, 1.0)) as f32;
        }
        angles
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

    /// The point of a solid that a ray hits, in its instance. `rough` is t in single precision.
    fn on_solid(
        &self,
        view: &View<'_>,
        (hit, solid): (&Hit<'_>, Solid),
        direction: [f64; 3],
        rough: f64,
    ) -> DVec3 {
        let direction = DVec3::from_array(direction);
        let local = view.rows_from_sensor(hit.instance).map(|[x, y, z]| {
            // In the order of the kernel that found the hit, so that it is found again.
            x * direction.x + y * direction.y + z * direction.z
        });
        let origin = hit.instance.origin_in_instance;
        let size = view.instance(hit.placed).size;
        let t = match_solid!(solid, size, inside => inside(origin, local).first(self.near, self.both));
        let t = if t.is_finite() { t } else { rough };
        DVec3::from_array(origin) + DVec3::from_array(local) * t
    }
}

/// Weights of the second and third corner at a point of a triangle's plane: areas of the parts that the point
/// cuts it into, as shares of the whole.
pub(crate) fn triangle_weights([a, b, c]: [DVec3; 3], point: DVec3) -> [f32; 2] {
    let (ab, ac, ap) = (b - a, c - a, point - a);
    let normal = ab.cross(ac);
    let per_area = 1.0 / normal.length_squared();
    [ap.cross(ac).dot(normal) * per_area, ab.cross(ap).dot(normal) * per_area].map(|weight| weight as f32)
}
