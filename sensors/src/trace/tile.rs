//! Sixty-four neighbouring rays of a traced band, as the cameras work on them: tiles of 16 × 4 pixels.
//!
//! Coordinates are metres along the world's axes, relative to the sensor, in single precision: what that loses is
//! in proportion to the distance, and less than a thousandth of a pixel at any.

use super::grid::Band;
use super::image::{GRAZING, NO_HIT, Projection};
use super::packet::MISS;
use super::resolve::Resolver;
use crate::lens::Pinhole;
use crate::pose::Pose;
use crate::scene::tree::WIDTH;
use crate::simd::{LANES, Lanes, store_row};
use fearless_simd::{Select, Simd, SimdBase, SimdCombine, SimdMask, f32x4, f32x16, u32x4, u32x16};
use glam::DVec3;

/// Pixels across a tile: a row of one is one vector.
pub(crate) const TILE_WIDTH: usize = WIDTH;
/// Pixels down a tile.
pub(crate) const TILE_HEIGHT: usize = LANES / TILE_WIDTH;
/// Blocks of 4 × 4 in a tile.
pub(super) const BLOCKS: usize = TILE_WIDTH / 4;

/// The rays of a camera in the axes of the world.
pub(crate) struct CameraRays {
    centre: [f32; 2],
    /// 1/focal length, in 1/pixels.
    per_focal: [f32; 2],
    /// Forward, left and up.
    axes: [[f32; 3]; 3],
    /// How a ray's direction changes to the next pixel along a row, and to that down a column.
    pub(crate) steps: [DVec3; 2],
}

impl CameraRays {
    pub(crate) fn new(lens: &Pinhole, world_from_sensor: &Pose) -> Self {
        let axes = world_from_sensor.rotation_matrix();
        Self {
            centre: [lens.cx as f32, lens.cy as f32],
            per_focal: [(1.0 / lens.fx) as f32, (1.0 / lens.fy) as f32],
            axes: axes.as_mat3().to_cols_array_2d(),
            steps: [axes.y_axis * (-1.0 / lens.fx), axes.z_axis * (-1.0 / lens.fy)],
        }
    }

    /// Directions of sixteen rays from a pixel on along its row, of length 1 along the optical axis.
    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, column: usize, row: usize) -> [f32x16<S>; 3] {
        let [forward, left, up] = &self.axes;
        let columns = f32x16::load_array_ref(simd, &ACROSS) + column as f32;
        let across = (f32x16::splat(simd, self.centre[0]) - columns) * self.per_focal[0];
        let above = (self.centre[1] - row as f32) * self.per_focal[1];
        let mut directions = [across; 3];
        for axis in 0..3 {
            directions[axis] = across * left[axis] + (forward[axis] + up[axis] * above);
        }
        directions
    }
}

#[inline(always)]
fn across_u32<S: Simd>(simd: S, blocks: &[&[u32; WIDTH]; BLOCKS], row: usize) -> u32x16<S> {
    let [a, b, c, d] = blocks;
    let part = row * 4..row * 4 + 4;
    let left = u32x4::from_slice(simd, &a[part.clone()]).combine(u32x4::from_slice(simd, &b[part.clone()]));
    let right = u32x4::from_slice(simd, &c[part.clone()]).combine(u32x4::from_slice(simd, &d[part]));
    left.combine(right)
}

/// Row `row` of four blocks side by side.
#[inline(always)]
pub(super) fn across_f32<S: Simd>(simd: S, blocks: &[&[f32; WIDTH]; BLOCKS], row: usize) -> f32x16<S> {
    let [a, b, c, d] = blocks;
    let part = row * 4..row * 4 + 4;
    let left = f32x4::from_slice(simd, &a[part.clone()]).combine(f32x4::from_slice(simd, &b[part.clone()]));
    let right = f32x4::from_slice(simd, &c[part.clone()]).combine(f32x4::from_slice(simd, &d[part]));
    left.combine(right)
}

const ACROSS: [f32; TILE_WIDTH] =
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

/// What the rays of a tile have hit, row after row.
pub(crate) struct Tile {
    /// Of length 1 along the optical axis.
    pub(crate) direction: [Lanes<f32>; 3],
    /// The point that was hit; the sensor itself where none was.
    pub(crate) point: [Lanes<f32>; 3],
    /// Depth of the point along the optical axis; 0 where nothing was hit.
    pub(crate) depth: Lanes<f32>,
    /// Index among the placed instances, or [`MISS`].
    pub(crate) placed: Lanes<u32>,
    /// Of meshes and height fields, which triangle: its slot from the instance's first.
    pub(crate) local: Lanes<u32>,
    /// The lanes that have hit something, a bit each.
    pub(crate) hits: u64,
    /// Least and most of the points that were hit, along each axis.
    pub(crate) bounds: [[f32; 2]; 3],
}

impl Tile {
    pub(crate) const fn new() -> Self {
        Self {
            direction: [[0.0; LANES]; 3],
            point: [[0.0; LANES]; 3],
            depth: [0.0; LANES],
            placed: [MISS; LANES],
            local: [0; LANES],
            hits: 0,
            bounds: [[0.0; 2]; 3],
        }
    }

    /// Takes the hits of a tile out of a band. Rays outside the grid miss.
    #[inline(always)]
    pub(crate) fn take<S: Simd, P: Projection>(
        &mut self,
        simd: S,
        band: &Band<'_, P>,
        resolver: &mut Resolver<'_>,
        rays: &CameraRays,
        [tile_column, block_row]: [usize; 2],
    ) {
        let across = band.projection.fan().blocks_across();
        let first = (block_row - *band.block_rows().start()) * across;
        let (mut slots, mut inverses) = ([&[NO_HIT; WIDTH]; BLOCKS], [&[1.0; WIDTH]; BLOCKS]);
        for part in 0..BLOCKS.min(across - tile_column * BLOCKS) {
            let block = first + tile_column * BLOCKS + part;
            (slots[part], inverses[part]) = (&band.target.slot[block], &band.target.inverse[block]);
        }

        // Step 1: points, row by row, each of which runs through four blocks.
        let mut slot = [[0; TILE_WIDTH]; TILE_HEIGHT];
        let zero = f32x16::splat(simd, 0.0);
        let mut low = [f32x16::splat(simd, f32::MAX); 3];
        let mut high = [f32x16::splat(simd, f32::MIN); 3];
        let mut grazing = 0;
        self.hits = 0;
        for row in 0..TILE_HEIGHT {
            let (slots, inverse) = (across_u32(simd, &slots, row), across_f32(simd, &inverses, row));
            let hit = slots.simd_ne(u32x16::splat(simd, NO_HIT));
            let depth = hit.select(f32x16::splat(simd, 1.0) / inverse, zero);
            let direction = rays.row(simd, tile_column * TILE_WIDTH, block_row * TILE_HEIGHT + row);
            for axis in 0..3 {
                let point = direction[axis] * depth;
                store_row(direction[axis], &mut self.direction[axis], row);
                store_row(point, &mut self.point[axis], row);
                low[axis] = (hit & point.simd_lt(low[axis])).select(point, low[axis]);
                high[axis] = (hit & point.simd_gt(high[axis])).select(point, high[axis]);
            }
            store_row(depth, &mut self.depth, row);
            slots.store_array(&mut slot[row]);
            self.hits |= hit.to_bitmask() << (row * TILE_WIDTH);
            let doubtful = slots.simd_ge(u32x16::splat(simd, GRAZING)) & hit;
            grazing |= doubtful.to_bitmask() << (row * TILE_WIDTH);
        }
        for axis in 0..3 {
            self.bounds[axis] = [simd.reduce_min_f32x16(low[axis]), simd.reduce_max_f32x16(high[axis])];
        }

        // Step 2: what they lie on, one instance after the other.
        self.placed = [MISS; LANES];
        let mut rest = self.hits;
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize % LANES;
            let hit = resolver.hit(slot.as_flattened()[lane]);
            let own = resolver.slots();
            for row in 0..TILE_HEIGHT {
                let slots = u32x16::load_array_ref(simd, &slot[row]) & u32x16::splat(simd, !GRAZING);
                let mine = slots.simd_ge(u32x16::splat(simd, own.start))
                    & slots.simd_lt(u32x16::splat(simd, own.end));
                rest &= !(mine.to_bitmask() << (row * TILE_WIDTH));
                let placed = &mut self.placed.as_chunks_mut().0[row];
                let old = u32x16::load_array_ref(simd, placed);
                mine.select(u32x16::splat(simd, hit.placed), old).store_array(placed);
                let local = &mut self.local.as_chunks_mut().0[row];
                let old = u32x16::load_array_ref(simd, local);
                mine.select(slots - u32x16::splat(simd, own.start), old).store_array(local);
            }
        }

        // Step 3: where a ray runs along a triangle, in double precision.
        while grazing != 0 {
            let lane = grazing.trailing_zeros() as usize % LANES;
            grazing &= grazing - 1;
            let hit = resolver.hit(slot.as_flattened()[lane]);
            let direction = DVec3::from_array([0, 1, 2].map(|axis| f64::from(self.direction[axis][lane])));
            if resolver.grazes(&hit, direction.normalize().as_vec3().to_array()) {
                let depth = resolver.exact(&hit, direction, f64::from(self.depth[lane]));
                self.depth[lane] = depth as f32;
                for axis in 0..3 {
                    let point = (direction[axis] * depth) as f32;
                    self.point[axis][lane] = point;
                    let [low, high] = &mut self.bounds[axis];
                    (*low, *high) = (low.min(point), high.max(point));
                }
            }
        }
    }

    /// The lanes that have hit `placed`, a bit each.
    #[inline(always)]
    pub(crate) fn lanes_of<S: Simd>(&self, simd: S, placed: u32) -> u64 {
        let mut lanes = 0;
        for (row, found) in self.placed.as_chunks().0.iter().enumerate() {
            let mine = u32x16::load_array_ref(simd, found).simd_eq(u32x16::splat(simd, placed));
            lanes |= mine.to_bitmask() << (row * TILE_WIDTH);
        }
        lanes
    }
}
