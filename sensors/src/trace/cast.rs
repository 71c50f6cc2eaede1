//! Casting whole grids of rays, for those who want hits rather than a sensor's frame.

use super::grid::{Band, BandWork, RayGrid, Sight, trace_grid};
use super::image::{Fan, GRAZING, NO_HIT, Projection};
use super::memory::Workspace;
use super::packet::Faces;
use super::resolve::Resolver;
use super::view::View;
use crate::execution::SplitRows;
use crate::pose::Pose;
use crate::scene::Scene;
use crate::scene::tree::WIDTH;
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
    trace_grid(&view, grid, &sight, execution, &mut memory, output, &Cast::new(world_from_sensor));
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
    /// Its rows, in single precision.
    rows: [[f32; 3]; 3],
}

impl BandWork<Rows<'_>> for Cast {
    #[inline(always)]
    fn finish<S: Simd, P: Projection>(&self, simd: S, band: &Band<'_, P>, output: Rows<'_>) {
        let mut hits = output.hits;
        let mut resolver = Resolver::new(band.view);
        // Two loops: short ones keep what they need in registers.
        if let Some(distance) = hits.distance.as_deref_mut() {
            for_each_block(
                band,
                #[inline(always)]
                |place, block| {
                    place.write(&self.distances(simd, band, &mut resolver, place, block), distance);
                },
            );
        }
        if hits.normal.is_some() || hits.instance.is_some() || hits.primitive.is_some() {
            for_each_block(
                band,
                #[inline(always)]
                |place, _| {
                    let slots = &band.target.slot[place.block];
                    if all_same(simd, slots) {
                        write_same(&mut resolver, slots[0], place, &mut hits);
                    } else {
                        write_each(simd, &mut resolver, slots, place, &mut hits);
                    }
                },
            );
        }
    }
}

#[inline(always)]
fn for_each_block<P: Projection>(band: &Band<'_, P>, mut work: impl FnMut(&Place, [usize; 2])) {
    let fan = band.projection.fan();
    for row in band.block_rows() {
        for column in 0..fan.blocks_across() {
            work(&Place::new(fan, band.rows, column, row), [column, row]);
        }
    }
}

/// Whether all rays of a block have hit the same: so it is with most, if triangles are large.
#[inline(always)]
fn all_same<S: Simd>(simd: S, slots: &[u32; WIDTH]) -> bool {
    u32x16::load_array_ref(simd, slots).simd_eq(u32x16::splat(simd, slots[0])).all_true()
}

#[inline(always)]
fn write_same(resolver: &mut Resolver<'_>, slot: u32, place: &Place, hits: &mut Hits<'_>) {
    let found = Found::new(resolver, slot);
    if let (Some(output), true) = (hits.normal.as_deref_mut(), slot != NO_HIT) {
        let [x, y, z] = found.normal;
        place.write_normals(&[x, y, z, x, y, z, x, y, z, x, y, z], output);
    }
    if let Some(output) = hits.instance.as_deref_mut() {
        place.fill(found.instance, output);
    }
    if let Some(output) = hits.primitive.as_deref_mut() {
        place.fill(found.primitive, output);
    }
}

/// Ray by ray.
#[inline(always)]
fn write_each<S: Simd>(
    simd: S,
    resolver: &mut Resolver<'_>,
    slots: &[u32; WIDTH],
    place: &Place,
    hits: &mut Hits<'_>,
) {
    let mut normals = [[0.0; 3]; WIDTH];
    let (mut instances, mut primitives) = ([0; WIDTH], [0; WIDTH]);
    let mut missed = false;
    if let Some((instance, facets)) = resolver.common_instance(simd, slots) {
        instances = [instance.instance; WIDTH];
        for lane in 0..WIDTH {
            let facet = &facets[((slots[lane] & !GRAZING) - instance.first_slot) as usize];
            normals[lane] = instance.normal_in_frame(facet.normal);
            primitives[lane] = facet.triangle;
        }
    } else {
        for lane in 0..WIDTH {
            let found = Found::new(resolver, slots[lane]);
            missed |= slots[lane] == NO_HIT;
            normals[lane] = found.normal;
            instances[lane] = found.instance;
            primitives[lane] = found.primitive;
        }
    }
    if let Some(output) = hits.normal.as_deref_mut() {
        if missed {
            place.write_where(&normals, slots, output);
        } else {
            place.write(&normals, output);
        }
    }
    if let Some(output) = hits.instance.as_deref_mut() {
        place.write(&instances, output);
    }
    if let Some(output) = hits.primitive.as_deref_mut() {
        place.write(&primitives, output);
    }
}

/// What is answered for a slot.
#[derive(Clone, Copy)]
struct Found {
    normal: [f32; 3],
    instance: u32,
    primitive: u32,
}

impl Found {
    #[inline(always)]
    fn new(resolver: &mut Resolver<'_>, slot: u32) -> Self {
        if slot == NO_HIT {
            return Self { normal: [0.0; 3], instance: u32::MAX, primitive: u32::MAX };
        }
        let hit = resolver.hit(slot);
        let facet = resolver.facet(&hit);
        Self {
            normal: hit.instance.normal_in_frame(facet.normal),
            instance: hit.instance.instance,
            primitive: facet.triangle,
        }
    }
}

impl Cast {
    fn new(world_from_sensor: &Pose) -> Self {
        let axes = world_from_sensor.rotation_matrix();
        Self { axes, rows: axes.transpose().as_mat3().to_cols_array_2d() }
    }

    /// Distances of a block; those of grazing hits in double precision.
    #[inline(always)]
    fn distances<S: Simd, P: Projection>(
        &self,
        simd: S,
        band: &Band<'_, P>,
        resolver: &mut Resolver<'_>,
        place: &Place,
        [block_column, block_row]: [usize; 2],
    ) -> [f32; WIDTH] {
        let slots = u32x16::load_array_ref(simd, &band.target.slot[place.block]);
        let inverse = f32x16::load_array_ref(simd, &band.target.inverse[place.block]);
        let hit = slots.simd_ne(u32x16::splat(simd, NO_HIT));
        let distances = band.projection.distances(simd, inverse, block_column, block_row);
        let mut values = [0.0; WIDTH];
        hit.select(distances, f32x16::splat(simd, f32::INFINITY)).store_array(&mut values);
        let mut lanes = (slots.simd_ge(u32x16::splat(simd, GRAZING)) & hit).to_bitmask();
        if lanes == 0 {
            return values;
        }
        let directions = band.projection.unit_directions(simd, block_column, block_row);
        let mut rough = [[0.0; WIDTH]; 3];
        for axis in 0..3 {
            let [x, y, z] = self.rows[axis];
            ((directions[0] * x + directions[1] * y) + directions[2] * z).store_array(&mut rough[axis]);
        }
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize & (WIDTH - 1);
            lanes &= lanes - 1;
            let hit = resolver.hit(band.target.slot[place.block][lane]);
            let rough = [rough[0][lane], rough[1][lane], rough[2][lane]];
            if let (true, Some([column, row])) = (resolver.grazes(&hit, rough), place.ray(lane)) {
                let direction = band.projection.direction(column as i32, row as i32);
                let direction = self.axes * direction.normalize();
                values[lane] = resolver.exact(&hit, direction, f64::from(values[lane])) as f32;
            }
        }
        values
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

    /// Writes those lanes that have hit something.
    fn write_where<T: Copy>(&self, values: &[T; WIDTH], slots: &[u32; WIDTH], output: &mut [T]) {
        for lane in 0..WIDTH {
            if let (true, Some([column, row])) = (slots[lane] != NO_HIT, self.ray(lane)) {
                output[(row - self.first_row) * self.width + column] = values[lane];
            }
        }
    }

    /// Fills the block with one normal, given four times.
    #[inline(always)]
    fn write_normals(&self, four: &[f32; 12], output: &mut [[f32; 3]]) {
        for line in 0..self.down {
            let output = output[self.index(line)..][..self.across].as_flattened_mut();
            for output in output.chunks_mut(12) {
                match <&mut [f32; 12]>::try_from(&mut *output) {
                    Ok(output) => *output = *four,
                    Err(_) => output.copy_from_slice(&four[..output.len()]),
                }
            }
        }
    }

    #[inline(always)]
    fn fill<T: Copy>(&self, value: T, output: &mut [T]) {
        for line in 0..self.down {
            let output = &mut output[self.index(line)..];
            match self.across {
                4 => output[..4].copy_from_slice(&[value; 4]),
                16 => output[..16].copy_from_slice(&[value; 16]),
                across => output[..across].fill(value),
            }
        }
    }
}
