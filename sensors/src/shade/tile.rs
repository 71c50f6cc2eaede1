//! Sixty-four neighbouring rays of a traced band, the unit of shading: tiles of 16 × 4 pixels, or of 64 × 1.
//!
//! Coordinates are metres along the world's axes, relative to the sensor, in single precision. The rounding error is
//! proportional to the distance, and less than a thousandth of a pixel at any distance.

use crate::optics::rays::Rays;
use crate::pose::Pose;
use crate::scene::{Scene, Sky};
use crate::simd::{LANES, Lanes, WIDTH, load_row, store_row};
use crate::trace::grid::Band;
use crate::trace::grid::tiling::{BLOCKS, Tiling, lane_in_tile, line_f32, line_u32};
use crate::trace::hit::resolve::Resolver;
use crate::trace::image::{GRAZING, NO_HIT};
use crate::trace::packet::{MISS, Packet};
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, mask32x16, u32x16};
use glam::{DMat3, DVec3};

/// The rays of a camera in the axes of the world.
pub(crate) struct CameraRays<'a> {
    rays: Rays<'a>,
    /// The sensor's axes as columns: forward, left and up.
    axes: DMat3,
    /// The axes in single precision.
    columns: [[f32; 3]; 3],
    /// For a pinhole camera, the principal point in pixels and 1/focal length in 1/pixels.
    centre: [f32; 2],
    per_focal: [f32; 2],
    pub(crate) steps: Steps,
}

/// For a pinhole camera, the change of a ray's direction to the next pixel along a row, and down a column. For other
/// cameras it differs from pixel to pixel; see [`Tile::steps`].
pub(crate) type Steps = Option<[DVec3; 2]>;

impl<'a> CameraRays<'a> {
    pub(crate) fn new(rays: &Rays<'a>, world_from_sensor: &Pose) -> Self {
        let axes = world_from_sensor.rotation_matrix();
        let columns = axes.as_mat3().to_cols_array_2d();
        let mut made =
            Self { rays: *rays, axes, columns, centre: [0.0; 2], per_focal: [0.0; 2], steps: None };
        if let Rays::Pinhole(pinhole) = rays {
            let lens = pinhole.intrinsics();
            made.centre = [lens.cx as f32, lens.cy as f32];
            made.per_focal = [(1.0 / lens.fx) as f32, (1.0 / lens.fy) as f32];
            made.steps = Some([axes.y_axis * (-1.0 / lens.fx), axes.z_axis * (-1.0 / lens.fy)]);
        }
        made
    }

    /// The optical axis.
    #[inline(always)]
    pub(crate) fn forward(&self) -> [f32; 3] {
        self.columns[0]
    }

    /// Width of the image in pixels.
    #[inline(always)]
    pub(crate) fn width(&self) -> usize {
        self.rays.ray_grid().width as usize
    }

    /// Directions of sixteen rays of a pinhole camera, starting at a pixel and along its row, with length 1 along the
    /// optical axis.
    #[inline(always)]
    fn pinhole_row<S: Simd>(&self, simd: S, column: usize, row: usize) -> [f32x16<S>; 3] {
        let [forward, left, up] = &self.columns;
        let columns = f32x16::load_array_ref(simd, &ACROSS) + column as f32;
        let across = (f32x16::splat(simd, self.centre[0]) - columns) * self.per_focal[0];
        let above = (self.centre[1] - row as f32) * self.per_focal[1];
        let mut directions = [across; 3];
        for axis in 0..3 {
            directions[axis] = across * left[axis] + (forward[axis] + up[axis] * above);
        }
        directions
    }

    /// The point that a pinhole camera's ray hits at 1/t, computed with the same operations as in [`Tile::take`].
    #[inline(always)]
    pub(super) fn pinhole_point(&self, [column, row]: [usize; 2], inverse: f32) -> [f32; 3] {
        let [forward, left, up] = &self.columns;
        let across = (self.centre[0] - column as f32) * self.per_focal[0];
        let above = (self.centre[1] - row as f32) * self.per_focal[1];
        let t = 1.0 / inverse;
        let mut point = [0.0; 3];
        for axis in 0..3 {
            point[axis] = (across * left[axis] + (forward[axis] + up[axis] * above)) * t;
        }
        point
    }

    /// Directions of the rays of a tile, of length 1, row by row.
    #[inline(always)]
    fn unit_rows<S: Simd>(&self, simd: S, [tile_column, row]: [usize; 2], directions: &mut [Lanes<f32>; 3]) {
        let tiling = Tiling::of(self.rays.ray_grid());
        let [forward, left, up] = &self.columns;
        let mut blocks = [[[0.0; WIDTH]; BLOCKS]; 3];
        let first = tile_column * BLOCKS;
        for part in 0..BLOCKS.min(self.rays.ray_grid().blocks_across() - first) {
            let [x, y, z] = self.rays.unit_directions(simd, first + part, row);
            for axis in 0..3 {
                (x * forward[axis] + (y * left[axis] + z * up[axis])).store_array(&mut blocks[axis][part]);
            }
        }
        for axis in 0..3 {
            for line in 0..BLOCKS {
                let values = line_f32(simd, tiling, &blocks[axis].each_ref(), line);
                store_row(values, &mut directions[axis], line);
            }
        }
    }

    /// The change of direction from a pixel's ray to the next along its row, and down its column; from the previous one
    /// if there is no next.
    fn steps_at(&self, column: usize, row: usize) -> [DVec3; 2] {
        let ray_grid = self.rays.ray_grid();
        let [column, row] = [column as i32, row as i32];
        let step = |side: usize| {
            let size = [ray_grid.width, ray_grid.height][side];
            for offset in [1, -1] {
                let mut next = [column, row];
                next[side] += offset;
                if (0..size).contains(&next[side]) && self.rays.has(next[0], next[1]) {
                    let change = self.rays.direction(next[0], next[1]) - self.rays.direction(column, row);
                    return self.axes * change * f64::from(offset);
                }
            }
            DVec3::ZERO
        };
        [step(0), step(1)]
    }
}

/// The lanes of a tile without a ray.
#[inline(always)]
pub(crate) fn missing_lanes(rays: &Rays<'_>, [tile_column, block_row]: [usize; 2]) -> u64 {
    let tiling = Tiling::of(rays.ray_grid());
    let first = tile_column * BLOCKS;
    let mut lanes = 0;
    for part in 0..BLOCKS.min(rays.ray_grid().blocks_across() - first) {
        let mut missing = rays.missing(first + part, block_row);
        while missing != 0 {
            lanes |= 1 << lane_in_tile(tiling, part, missing.trailing_zeros() as usize);
            missing &= missing - 1;
        }
    }
    lanes
}

const ACROSS: [f32; WIDTH] =
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

/// The hits of a tile's rays, row by row.
pub(crate) struct Tile {
    /// Directions in units of t.
    pub(crate) direction: [Lanes<f32>; 3],
    /// The point that was hit; the position of the sensor if there is none.
    pub(crate) point: [Lanes<f32>; 3],
    /// Position of the point on its ray; 0 if nothing was hit.
    pub(crate) t: Lanes<f32>,
    /// Changes of the direction to the next pixel along the row, and down the column, if these are not constant over
    /// the image.
    pub(crate) steps: [[Lanes<f32>; 3]; 2],
    /// Index of the placed instance that was hit, or [`MISS`].
    pub(crate) placed: Lanes<u32>,
    /// For meshes and height fields, the slot of the triangle, counted from the instance's first.
    pub(crate) local: Lanes<u32>,
    /// The lanes that hit something, as one bit each.
    pub(crate) hits: u64,
    /// The lanes without a ray.
    pub(crate) missing: u64,
    /// Bounds of the points that were hit, along each axis. Only set if lamps cast shadows.
    pub(crate) bounds: [[f32; 2]; 3],
}

impl Tile {
    pub(crate) const fn new() -> Self {
        Self {
            direction: [[0.0; LANES]; 3],
            point: [[0.0; LANES]; 3],
            t: [0.0; LANES],
            steps: [[[0.0; LANES]; 3]; 2],
            placed: [MISS; LANES],
            local: [0; LANES],
            hits: 0,
            missing: 0,
            bounds: [[0.0; 2]; 3],
        }
    }

    /// Copies the hits of a tile from a band. Rays outside the grid miss. Compiled once per level, for all kinds of
    /// sensors.
    #[inline(never)]
    pub(crate) fn take<S: Simd>(
        &mut self,
        simd: S,
        band: &Band<'_>,
        resolver: &mut Resolver<'_>,
        rays: &CameraRays<'_>,
        tile: [usize; 2],
    ) {
        // Compiled separately, so that the loop for a pinhole camera is as short as possible.
        simd.vectorize(
            #[inline(always)]
            || {
                if rays.steps.is_some() {
                    self.take_rays::<S, true>(simd, band, resolver, rays, tile);
                } else {
                    self.take_rays::<S, false>(simd, band, resolver, rays, tile);
                }
            },
        );
    }

    #[inline(always)]
    fn take_rays<S: Simd, const PINHOLE: bool>(
        &mut self,
        simd: S,
        band: &Band<'_>,
        resolver: &mut Resolver<'_>,
        rays: &CameraRays<'_>,
        [tile_column, block_row]: [usize; 2],
    ) {
        let across = band.rays.ray_grid().blocks_across();
        let tiling = Tiling::of(band.rays.ray_grid());
        let first = (block_row - *band.block_rows().start()) * across;
        let (mut slots, mut inverses) = ([&[NO_HIT; WIDTH]; BLOCKS], [&[1.0; WIDTH]; BLOCKS]);
        for part in 0..BLOCKS.min(across - tile_column * BLOCKS) {
            let block = first + tile_column * BLOCKS + part;
            (slots[part], inverses[part]) = (&band.target.slot[block], &band.target.inverse[block]);
        }

        if !PINHOLE {
            rays.unit_rows(simd, [tile_column, block_row], &mut self.direction);
            self.missing = missing_lanes(&band.rays, [tile_column, block_row]);
        }

        // Step 1: compute points, line by line. With square blocks, each line runs through four blocks.
        let mut slot = [[0; WIDTH]; BLOCKS];
        let zero = f32x16::splat(simd, 0.0);
        let mut grazing = 0;
        self.hits = 0;
        let [columns, rows] = tiling.size();
        for row in 0..BLOCKS {
            let slots = line_u32(simd, tiling, &slots, row);
            let inverse = line_f32(simd, tiling, &inverses, row);
            let hit = slots.simd_ne(u32x16::splat(simd, NO_HIT));
            let t = hit.select(f32x16::splat(simd, 1.0) / inverse, zero);
            let direction = if PINHOLE {
                let [x, y] = tiling.line(row);
                rays.pinhole_row(simd, tile_column * columns + x, block_row * rows + y)
            } else {
                let [x, y, z] = &self.direction;
                [load_row(simd, x, row), load_row(simd, y, row), load_row(simd, z, row)]
            };
            for axis in 0..3 {
                let point = direction[axis] * t;
                store_row(direction[axis], &mut self.direction[axis], row);
                store_row(point, &mut self.point[axis], row);
            }
            store_row(t, &mut self.t, row);
            slots.store_array(&mut slot[row]);
            self.hits |= hit.to_bitmask() << (row * WIDTH);
            let doubtful = slots.simd_ge(u32x16::splat(simd, GRAZING)) & hit;
            grazing |= doubtful.to_bitmask() << (row * WIDTH);
        }

        // Step 2: find the instances and triangles that were hit.
        self.resolve(simd, &slot, resolver);

        if !PINHOLE && band.view.scene.has_textures() {
            self.find_steps(&band.view.scene, rays, [tile_column, block_row]);
        }

        // Step 3: recompute rays that graze a triangle, in double precision.
        while grazing != 0 {
            let lane = grazing.trailing_zeros() as usize % LANES;
            grazing &= grazing - 1;
            let hit = resolver.hit(slot.as_flattened()[lane]);
            let direction = DVec3::from_array([0, 1, 2].map(|axis| f64::from(self.direction[axis][lane])));
            if resolver.grazes(&hit, direction.normalize().as_vec3().to_array()) {
                let t = resolver.exact(&hit, direction, f64::from(self.t[lane]));
                self.t[lane] = t as f32;
                for axis in 0..3 {
                    self.point[axis][lane] = (direction[axis] * t) as f32;
                }
            }
        }
        if band.view.scene.has_shadows() {
            self.find_bounds(simd);
        }
    }

    /// Computes the bounds of the points that were hit.
    #[inline(always)]
    fn find_bounds<S: Simd>(&mut self, simd: S) {
        for axis in 0..3 {
            let mut low = f32x16::splat(simd, f32::MAX);
            let mut high = f32x16::splat(simd, f32::MIN);
            for row in 0..BLOCKS {
                let hit: mask32x16<S> = simd.from_bitmask_mask32x16(self.hits >> (row * WIDTH) & 0xffff);
                let point = load_row(simd, &self.point[axis], row);
                low = (hit & point.simd_lt(low)).select(point, low);
                high = (hit & point.simd_gt(high)).select(point, high);
            }
            self.bounds[axis] = [simd.reduce_min_f32x16(low), simd.reduce_max_f32x16(high)];
        }
    }

    /// Finds the instances and triangles of slots, one instance after the other.
    #[inline(always)]
    fn resolve<S: Simd>(&mut self, simd: S, slot: &[[u32; WIDTH]; BLOCKS], resolver: &mut Resolver<'_>) {
        self.placed = [MISS; LANES];
        let mut rest = self.hits;
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize % LANES;
            let hit = resolver.hit(slot.as_flattened()[lane]);
            let own = resolver.slots();
            for row in 0..BLOCKS {
                let slots = u32x16::load_array_ref(simd, &slot[row]) & u32x16::splat(simd, !GRAZING);
                let mine = slots.simd_ge(u32x16::splat(simd, own.start))
                    & slots.simd_lt(u32x16::splat(simd, own.end));
                rest &= !(mine.to_bitmask() << (row * WIDTH));
                let placed = &mut self.placed.as_chunks_mut().0[row];
                let old = u32x16::load_array_ref(simd, placed);
                mine.select(u32x16::splat(simd, hit.placed), old).store_array(placed);
                let local = &mut self.local.as_chunks_mut().0[row];
                let old = u32x16::load_array_ref(simd, local);
                mine.select(slots - u32x16::splat(simd, own.start), old).store_array(local);
            }
        }
    }

    /// Copies the first hits of a packet of rays from the sensor; inactive lanes miss.
    #[inline(always)]
    pub(crate) fn take_first_hits<S: Simd>(&mut self, simd: S, packet: &Packet, resolver: &mut Resolver<'_>) {
        (self.hits, self.missing) = (0, 0);
        let mut slot = [[NO_HIT; WIDTH]; BLOCKS];
        slot.as_flattened_mut().copy_from_slice(&packet.hit);
        for row in 0..BLOCKS {
            let hit = u32x16::load_array_ref(simd, &slot[row]).simd_ne(u32x16::splat(simd, MISS));
            self.hits |= hit.to_bitmask() << (row * WIDTH);
        }
        for lane in 0..LANES {
            self.t[lane] = if packet.hit[lane] == MISS { 0.0 } else { packet.t[lane] as f32 };
        }
        self.resolve(simd, &slot, resolver);
        for axis in 0..3 {
            for lane in 0..LANES {
                self.direction[axis][lane] = packet.direction[axis][lane] as f32;
            }
            for row in 0..BLOCKS {
                let point = load_row(simd, &self.direction[axis], row) * load_row(simd, &self.t, row);
                store_row(point, &mut self.point[axis], row);
            }
        }
        self.find_bounds(simd);
    }

    /// Computes the directions of the rays of a tile with square blocks.
    #[inline(always)]
    pub(crate) fn take_directions<S: Simd>(
        &mut self,
        simd: S,
        rays: &CameraRays<'_>,
        [column, row]: [usize; 2],
    ) {
        if rays.steps.is_none() {
            rays.unit_rows(simd, [column, row], &mut self.direction);
            return;
        }
        for line in 0..BLOCKS {
            let [x, y] = Tiling::Square.lines([column, row])[line];
            let direction = rays.pinhole_row(simd, x, y);
            for axis in 0..3 {
                store_row(direction[axis], &mut self.direction[axis], line);
            }
        }
    }

    /// Computes [`Tile::steps`] for the lanes that see a texture: those that hit something, or all if the sky is one.
    fn find_steps(&mut self, scene: &Scene<'_>, rays: &CameraRays<'_>, [tile_column, block_row]: [usize; 2]) {
        let ray_grid = rays.rays.ray_grid();
        let size = [ray_grid.width as usize, ray_grid.height as usize];
        let tiling = Tiling::of(ray_grid);
        let [columns, rows] = tiling.size();
        let mut rest = self.hits;
        if let Some(Sky::Cube(_)) = scene.air.sky {
            rest = !self.missing;
        }
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize % LANES;
            rest &= rest - 1;
            let [x, y] = tiling.line(lane / WIDTH);
            let [column, row] = [tile_column * columns + x + lane % WIDTH, block_row * rows + y];
            if column >= size[0] || row >= size[1] {
                continue;
            }
            let steps = rays.steps_at(column, row);
            for side in 0..2 {
                for axis in 0..3 {
                    self.steps[side][axis][lane] = steps[side][axis] as f32;
                }
            }
        }
    }

    /// The lanes that hit `placed`, as one bit each.
    #[inline(always)]
    pub(crate) fn lanes_of<S: Simd>(&self, simd: S, placed: u32) -> u64 {
        lanes_with(simd, &self.placed, placed)
    }
}

/// The lanes that contain a number, as one bit each.
#[inline(always)]
pub(super) fn lanes_with<S: Simd>(simd: S, numbers: &Lanes<u32>, number: u32) -> u64 {
    let mut lanes = 0;
    for (row, found) in numbers.as_chunks().0.iter().enumerate() {
        let mine = u32x16::load_array_ref(simd, found).simd_eq(u32x16::splat(simd, number));
        lanes |= mine.to_bitmask() << (row * WIDTH);
    }
    lanes
}
