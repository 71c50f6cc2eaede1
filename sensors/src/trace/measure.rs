//! How far the rays of a block reach.

use super::grid::Band;
use super::image::{GRAZING, NO_HIT, Projection};
use super::resolve::Resolver;
use super::tile::{BLOCKS, TILE_HEIGHT, across_f32};
use crate::pose::Pose;
use crate::scene::tree::WIDTH;
use crate::simd::{LANES, Lanes, store_row};
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, u32x16};
use glam::DMat3;

/// Measures distances and depths of a sensor.
pub(crate) struct Measure {
    /// From the sensor's axes to the world's.
    axes: DMat3,
    /// Its rows, in single precision.
    rows: [[f32; 3]; 3],
}

impl Measure {
    pub(crate) fn new(world_from_sensor: &Pose) -> Self {
        let axes = world_from_sensor.rotation_matrix();
        Self { axes, rows: axes.transpose().as_mat3().to_cols_array_2d() }
    }

    /// t of a block's hits, or metres along the rays unless it is `DEPTH` that is asked for; +∞ where nothing is
    /// hit. Where a ray grazes a triangle, it is worked out in double precision.
    #[inline(always)]
    pub(crate) fn block<S: Simd, P: Projection, const DEPTH: bool>(
        &self,
        simd: S,
        band: &Band<'_, P>,
        resolver: &mut Resolver<'_>,
        [column, row]: [usize; 2],
    ) -> [f32; WIDTH] {
        let fan = band.projection.fan();
        let block = (row - *band.block_rows().start()) * fan.blocks_across() + column;
        let slots = u32x16::load_array_ref(simd, &band.target.slot[block]);
        let inverse = f32x16::load_array_ref(simd, &band.target.inverse[block]);
        let hit = slots.simd_ne(u32x16::splat(simd, NO_HIT));
        let far = if DEPTH {
            f32x16::splat(simd, 1.0) / inverse
        } else {
            band.projection.distances(simd, inverse, column, row)
        };
        let mut values = [0.0; WIDTH];
        hit.select(far, f32x16::splat(simd, f32::INFINITY)).store_array(&mut values);
        let mut lanes = (slots.simd_ge(u32x16::splat(simd, GRAZING)) & hit).to_bitmask();
        if lanes == 0 {
            return values;
        }
        let directions = band.projection.unit_directions(simd, column, row);
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
                let (x, y) = fan.lane_position(lane);
                let ray = [(column << fan.shift_x) + x, (row << fan.shift_y) + y];
                let mut direction = band.projection.direction(ray[0] as i32, ray[1] as i32);
                if !DEPTH {
                    direction = direction.normalize();
                }
                values[lane] = resolver.exact(&hit, self.axes * direction, f64::from(values[lane])) as f32;
            }
        }
        values
    }

    /// Depths of a tile of a pinhole camera, row after row.
    #[inline(always)]
    pub(crate) fn tile<S: Simd, P: Projection>(
        &self,
        simd: S,
        band: &Band<'_, P>,
        resolver: &mut Resolver<'_>,
        [tile_column, row]: [usize; 2],
    ) -> Lanes<f32> {
        let mut blocks = [[f32::INFINITY; WIDTH]; BLOCKS];
        let first = tile_column * BLOCKS;
        for part in 0..BLOCKS.min(band.projection.fan().blocks_across() - first) {
            blocks[part] = self.block::<S, P, true>(simd, band, resolver, [first + part, row]);
        }
        // Moved in registers: what is stored in parts and then loaded as a whole waits for the memory.
        let mut depths = [0.0; LANES];
        for row in 0..TILE_HEIGHT {
            store_row(across_f32(simd, &blocks.each_ref(), row), &mut depths, row);
        }
        depths
    }
}
