//! Casting whole grids of rays, for those who want hits rather than a sensor's frame.

use super::grid::{Band, BandWork, RayGrid, Sight, trace_grid};
use super::hit_point::{HitPoints, block_index, has_solids};
use super::image::{NO_HIT, Projection};
use super::measure::Measure;
use super::memory::Workspace;
use super::packet::Faces;
use super::place::{Place, for_each_block};
use super::resolve::{Resolver, local_slot};
use super::view::View;
use crate::execution::SplitRows;
use crate::pose::Pose;
use crate::scene::Scene;
use crate::scene::tree::WIDTH;
use fearless_simd::{Simd, SimdBase, SimdMask, u32x16};

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
    grid: &RayGrid<'_>,
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
        &Cast {
            rays: Measure::new(world_from_sensor),
            points: HitPoints::new(world_from_sensor, range[0], faces),
        },
    );
}

/// Hits, cut between rows of blocks.
struct Rows<'a> {
    hits: Hits<'a>,
    rays_in_block_row: usize,
}

impl SplitRows for Rows<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        fn cut<T>(values: Option<&mut [T]>, at: usize) -> (Option<&mut [T]>, Option<&mut [T]>) {
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
    rays: Measure,
    points: HitPoints,
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
                    place.write(&self.rays.block::<S, P, false>(simd, band, &mut resolver, block), distance);
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
        // What depends on where a ray meets its surface, and not on which it is alone.
        if let Some(normal) = hits.normal.as_deref_mut()
            && has_solids(band.view)
        {
            for_each_block(band, |place, block| {
                let (slots, normals) = self.points.solid_normals(band, &mut resolver, block);
                place.write_where(&normals, &slots, normal);
            });
        }
        if let Some(barycentrics) = hits.barycentrics.as_deref_mut() {
            for_each_block(band, |place, block| {
                let weights = self.points.barycentrics(band, &mut resolver, block);
                let slots = &band.target.slot[block_index(band, block)];
                place.write_where(&weights, slots, barycentrics);
            });
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
    if let Some((instance, facets)) = resolver.common_mesh(simd, slots) {
        instances = [instance.instance; WIDTH];
        for lane in 0..WIDTH {
            let facet = &facets[local_slot(slots[lane], instance) as usize];
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
        Self {
            normal: resolver.triangle_normal(&hit),
            instance: hit.instance.instance,
            primitive: resolver.triangle(&hit),
        }
    }
}
