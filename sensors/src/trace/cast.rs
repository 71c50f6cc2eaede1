//! Casting whole grids of rays, for those who want hits rather than a sensor's frame.

use super::grid::{Band, BandWork, RayGrid, Sight, trace_grid};
use super::image::{Fan, GRAZING, NO_HIT, Projection};
use super::memory::Workspace;
use super::packet::Faces;
use super::resolve::Resolver;
use super::view::View;
use crate::execution::SplitRows;
use crate::pose::Pose;
use crate::scene::tree::WIDTH;
use crate::scene::{KIND_MESH, Scene};
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, u32x16};
use glam::DMat3;

/// Where the answers go, one for each ray, row after row; what is none is not worked out.
#[derive(Debug, Default)]
pub struct Hits<'a> {
    /// Along the ray, in units of its direction's length (1 in a grid), so metres; +∞ where nothing is hit.
    pub distance: Option<&'a mut [f32]>,
    /// Unit normals, outwards, in the axes of the world; left as they are where nothing is hit.
    pub normal: Option<&'a mut [[f32; 3]]>,
    /// Indices of instances in the scene; `u32::MAX` where nothing is hit.
    pub instance: Option<&'a mut [u32]>,
    /// Triangles of meshes, as they were given; 0 for other shapes; `u32::MAX` where nothing is hit.
    pub primitive: Option<&'a mut [u32]>,
    /// Weights of the second and third corner of the triangle; 0 for other shapes, left as they are where nothing
    /// is hit.
    pub barycentrics: Option<&'a mut [[f32; 2]]>,
}

/// Casts a grid of rays from the origin of a sensor, and finds where each first hits something between `range`
/// (least and most distance in metres; for a pinhole, depth) on an instance that `visibility` has a bit in
/// common with.
///
/// # Panics
/// When an output is not one element a ray, or the workspace does not fit: see [`Workspace::fits`].
#[allow(clippy::too_many_arguments, reason = "each is one thing the answer depends on")]
pub fn cast_grid(
    scene: &Scene<'_>,
    world_from_sensor: &Pose,
    grid: &RayGrid,
    range: [f64; 2],
    visibility: u32,
    faces: Faces,
    workspace: &mut Workspace<'_>,
    hits: Hits<'_>,
) {
    let [width, height] = grid.size();
    let check = |length: Option<usize>| {
        assert!(
            length.is_none_or(|length| length == width * height),
            "an output must hold one element a ray"
        );
    };
    check(hits.distance.as_ref().map(|values| values.len()));
    check(hits.normal.as_ref().map(|values| values.len()));
    check(hits.instance.as_ref().map(|values| values.len()));
    check(hits.primitive.as_ref().map(|values| values.len()));
    check(hits.barycentrics.as_ref().map(|values| values.len()));
    let execution = workspace.execution;
    let mut memory = workspace.cut(scene, grid.rays());
    let view = View::new(scene, world_from_sensor, visibility, memory.view(scene.instances().len()));
    let rays_in_block_row = width << grid.fan().shift_y;
    let output = Rows { hits, rays_in_block_row };
    let sight = Sight { faces, range };
    trace_grid(
        &view,
        grid,
        &sight,
        execution,
        &mut memory,
        output,
        &Cast { axes: world_from_sensor.rotation_matrix() },
    );
}

/// Hits, cut between rows of blocks.
struct Rows<'a> {
    hits: Hits<'a>,
    rays_in_block_row: usize,
}

impl SplitRows for Rows<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        fn cut<'a, T>(values: Option<&'a mut [T]>, at: usize) -> (Option<&'a mut [T]>, Option<&'a mut [T]>) {
            values.map_or((None, None), |values| {
                let (first, second) = values.split_at_mut(at.min(values.len()));
                (Some(first), Some(second))
            })
        }
        let Self { hits, rays_in_block_row } = self;
        let at = rows * rays_in_block_row;
        let (distance, distance_rest) = cut(hits.distance, at);
        let (normal, normal_rest) = cut(hits.normal, at);
        let (instance, instance_rest) = cut(hits.instance, at);
        let (primitive, primitive_rest) = cut(hits.primitive, at);
        let (barycentrics, barycentrics_rest) = cut(hits.barycentrics, at);
        let rest = Hits {
            distance: distance_rest,
            normal: normal_rest,
            instance: instance_rest,
            primitive: primitive_rest,
            barycentrics: barycentrics_rest,
        };
        let hits = Hits { distance, normal, instance, primitive, barycentrics };
        (Self { hits, rays_in_block_row }, Self { hits: rest, rays_in_block_row })
    }
}

struct Cast {
    /// From the sensor's axes to the world's.
    axes: DMat3,
}

impl BandWork<Rows<'_>> for Cast {
    #[inline(always)]
    fn finish<S: Simd, P: Projection>(&self, simd: S, band: &Band<'_, P>, output: Rows<'_>) {
        let fan = band.projection.fan();
        let mut hits = output.hits;
        let mut resolver = Resolver::new(band.view);
        for block_row in band.block_rows() {
            for block_column in 0..fan.blocks_across() {
                let place = Place::new(fan, band.rows, block_column, block_row);
                let slots = &band.target.slot[place.block];
                if let Some(distance) = hits.distance.as_deref_mut() {
                    let inverse = f32x16::load_array_ref(simd, &band.target.inverse[place.block]);
                    let distances = band.projection.distances(simd, inverse, block_column, block_row);
                    let hit = u32x16::load_array_ref(simd, slots).simd_ne(u32x16::splat(simd, NO_HIT));
                    let mut values = [0.0; WIDTH];
                    hit.select(distances, f32x16::splat(simd, f32::INFINITY)).store_array(&mut values);
                    let grazing =
                        u32x16::load_array_ref(simd, slots).simd_ge(u32x16::splat(simd, GRAZING)) & hit;
                    let mut lanes = grazing.to_bitmask();
                    while lanes != 0 {
                        let lane = lanes.trailing_zeros() as usize & (WIDTH - 1);
                        lanes &= lanes - 1;
                        self.refine(band, &mut resolver, &place, lane, &mut values[lane]);
                    }
                    place.write(&values, distance);
                }
                if hits.normal.is_none()
                    && hits.instance.is_none()
                    && hits.primitive.is_none()
                    && hits.barycentrics.is_none()
                {
                    continue;
                }
                let first = slots[0];
                let same = u32x16::load_array_ref(simd, slots).simd_eq(u32x16::splat(simd, first));
                if same.all_true() && first != NO_HIT && hits.barycentrics.is_none() {
                    // Most blocks of a scene of large surfaces.
                    let hit = resolver.hit(first);
                    if hit.instance.kind == KIND_MESH {
                        if let Some(normal) = hits.normal.as_deref_mut() {
                            place.fill(hit.instance.normal_in_frame(resolver.facet(&hit).normal), normal);
                        }
                        if let Some(instance) = hits.instance.as_deref_mut() {
                            place.fill(hit.instance.instance, instance);
                        }
                        if let Some(primitive) = hits.primitive.as_deref_mut() {
                            place.fill(resolver.primitive(&hit), primitive);
                        }
                        continue;
                    }
                }
                self.write_lanes(band, &mut resolver, &place, &mut hits);
            }
        }
    }
}

impl Cast {
    /// Recomputes a distance to a triangle that is seen edge-on, if this ray grazes it.
    fn refine<P: Projection>(
        &self,
        band: &Band<'_, P>,
        resolver: &mut Resolver<'_>,
        place: &Place,
        lane: usize,
        distance: &mut f32,
    ) {
        let Some([column, row]) = place.ray(lane) else { return };
        let hit = resolver.hit(band.target.slot[place.block][lane]);
        let direction = self.axes * band.projection.direction(column as i32, row as i32).normalize();
        *distance = resolver.exact(&hit, direction, f64::from(*distance)) as f32;
    }

    /// Everything but the distance, ray by ray.
    #[inline(always)]
    fn write_lanes<P: Projection>(
        &self,
        band: &Band<'_, P>,
        resolver: &mut Resolver<'_>,
        place: &Place,
        hits: &mut Hits<'_>,
    ) {
        for lane in 0..WIDTH {
            let Some([column, row]) = place.ray(lane) else { continue };
            let index = (row - place.first_row) * place.width + column;
            let slot = band.target.slot[place.block][lane];
            if slot == NO_HIT {
                if let Some(instance) = hits.instance.as_deref_mut() {
                    instance[index] = u32::MAX;
                }
                if let Some(primitive) = hits.primitive.as_deref_mut() {
                    primitive[index] = u32::MAX;
                }
                continue;
            }
            let hit = resolver.hit(slot);
            if let Some(instance) = hits.instance.as_deref_mut() {
                instance[index] = hit.instance.instance;
            }
            if let Some(primitive) = hits.primitive.as_deref_mut() {
                primitive[index] = resolver.primitive(&hit);
            }
            if let Some(normal) = hits.normal.as_deref_mut() {
                normal[index] = hit.instance.normal_in_frame(resolver.facet(&hit).normal);
            }
        }
    }
}

/// Where the rays of a block lie in a band's output.
struct Place {
    /// Index of the block in the band.
    block: usize,
    /// Rays across the grid.
    width: usize,
    /// First ray, in the grid and in the output.
    column: usize,
    row: usize,
    first_row: usize,
    /// Rays of the block that are in the grid.
    across: usize,
    down: usize,
    shift_x: u32,
}

impl Place {
    #[inline(always)]
    fn new(fan: &Fan, rows: [i32; 2], block_column: usize, block_row: usize) -> Self {
        let (column, row) = (block_column << fan.shift_x, block_row << fan.shift_y);
        Self {
            block: (block_row - (rows[0] >> fan.shift_y) as usize) * fan.blocks_across() + block_column,
            width: fan.width as usize,
            column,
            row,
            first_row: rows[0] as usize,
            across: (1 << fan.shift_x).min(fan.width as usize - column),
            down: (1 << fan.shift_y).min(rows[1] as usize + 1 - row),
            shift_x: fan.shift_x,
        }
    }

    /// Column and row of a lane's ray in the grid; none if it lies outside.
    #[inline(always)]
    fn ray(&self, lane: usize) -> Option<[usize; 2]> {
        let (x, y) = (lane & ((1 << self.shift_x) - 1), lane >> self.shift_x);
        (x < self.across && y < self.down).then_some([self.column + x, self.row + y])
    }

    /// Index of the first ray of a line of the block in the band's output.
    #[inline(always)]
    fn index(&self, line: usize) -> usize {
        (self.row - self.first_row + line) * self.width + self.column
    }

    #[inline(always)]
    fn write<T: Copy>(&self, values: &[T; WIDTH], output: &mut [T]) {
        for line in 0..self.down {
            let values = &values[line << self.shift_x..];
            let output = &mut output[self.index(line)..];
            // Of known length they are single moves.
            match self.across {
                4 => output[..4].copy_from_slice(&values[..4]),
                16 => output[..16].copy_from_slice(&values[..16]),
                across => output[..across].copy_from_slice(&values[..across]),
            }
        }
    }

    #[inline(always)]
    fn fill<T: Copy>(&self, value: T, output: &mut [T]) {
        self.write(&[value; WIDTH], output);
    }
}
