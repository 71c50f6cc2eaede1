//! The distances of the hits of a block's rays.

use crate::optics::rays::Rays;
use crate::pose::Pose;
use crate::simd::WIDTH;
use crate::trace::grid::Band;
use crate::trace::hit::resolve::Resolver;
use crate::trace::image::{GRAZING, NO_HIT};
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, u32x16};
use glam::DMat3;

/// Computes distances and depths from a sensor.
pub(crate) struct Measure {
    /// The rotation from the sensor's axes to the world's.
    axes: DMat3,
    /// Its rows, in single precision.
    rows: [[f32; 3]; 3],
}

impl Measure {
    pub(crate) fn new(world_from_sensor: &Pose) -> Self {
        let axes = world_from_sensor.rotation_matrix();
        Self { axes, rows: axes.transpose().as_mat3().to_cols_array_2d() }
    }

    /// Distances in metres along the rays of a block, or along the optical axis if `DEPTH` is true; +∞ where nothing is
    /// hit. If a ray grazes a triangle, its distance is computed in double precision.
    #[inline(always)]
    pub(crate) fn block<S: Simd, const DEPTH: bool>(
        &self,
        simd: S,
        band: &Band<'_>,
        resolver: &mut Resolver<'_>,
        [column, row]: [usize; 2],
    ) -> f32x16<S> {
        let ray_grid = band.rays.ray_grid();
        let block = (row - *band.block_rows().start()) * ray_grid.blocks_across() + column;
        let slots = u32x16::load_array_ref(simd, &band.target.slot[block]);
        let inverse = f32x16::load_array_ref(simd, &band.target.inverse[block]);
        let hit = slots.simd_ne(u32x16::splat(simd, NO_HIT));
        let far = if DEPTH {
            band.rays.depths(simd, inverse, column, row)
        } else {
            band.rays.distances(simd, inverse, column, row)
        };
        let far = hit.select(far, f32x16::splat(simd, f32::INFINITY));
        let mut lanes = (slots.simd_ge(u32x16::splat(simd, GRAZING)) & hit).to_bitmask();
        if lanes == 0 {
            return far;
        }
        let mut values = [0.0; WIDTH];
        far.store_array(&mut values);
        let directions = band.rays.unit_directions(simd, column, row);
        let mut rough = [[0.0; WIDTH]; 3];
        for axis in 0..3 {
            let [x, y, z] = self.rows[axis];
            ((directions[0] * x + directions[1] * y) + directions[2] * z).store_array(&mut rough[axis]);
        }
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize & (WIDTH - 1);
            lanes &= lanes - 1;
            let hit = resolver.hit(band.target.slot[block][lane]);
            if resolver.grazes(&hit, [rough[0][lane], rough[1][lane], rough[2][lane]]) {
                let (x, y) = ray_grid.lane_position(lane);
                let ray = [(column << ray_grid.shift_x) + x, (row << ray_grid.shift_y) + y];
                let mut direction = band.rays.direction(ray[0] as i32, ray[1] as i32);
                // For a pinhole, t is the depth; for other rays it is counted along the ray.
                let forward = if DEPTH && !matches!(band.rays, Rays::Pinhole(_)) { direction.x } else { 1.0 };
                if !DEPTH {
                    direction = direction.normalize();
                }
                let rough = f64::from(values[lane]) / forward;
                values[lane] = (resolver.exact(&hit, self.axes * direction, rough) * forward) as f32;
            }
        }
        f32x16::load_array(simd, values)
    }
}
