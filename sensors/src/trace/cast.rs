//! Casting grids of rays, for applications that need hits rather than a sensor's frame.

use super::error::{SenseError, check_output};
use super::grid::{Band, BandWork, Frame, Sight};
use super::image::NO_HIT;
use super::packet::Faces;
use crate::execution::{SplitRows, split_at};
use crate::moment::{Moment, Shutter};
use crate::optics::Optics;
use crate::pose::Pose;
use crate::scene::Scene;
use crate::simd::WIDTH;
use crate::trace::grid::place::{Place, for_each_block};
use crate::trace::hit::measure::Measure;
use crate::trace::hit::normals::{NormalFinder, Normals};
use crate::trace::hit::point::{HitPoints, block_index, has_solids};
use crate::trace::hit::resolve::{Resolver, hit_lanes, local_slot};
use crate::trace::placed::memory::Workspace;
use fearless_simd::{Simd, SimdBase, SimdMask, u32x16};

/// The output buffers of [`cast_grid`], one element per ray in row-major order. Channels that are `None` are not
/// computed.
#[derive(Debug, Default)]
pub struct Hits<'a> {
    /// Distances along the ray, in units of the length of its direction. In a grid this length is 1, so they are
    /// metres; +∞ where nothing is hit.
    pub distance: Option<&'a mut [f32]>,
    /// Outward unit normals in the axes of the world; not written where nothing is hit.
    pub normal: Option<&'a mut [[f32; 3]]>,
    /// Indices of instances in the scene; `u32::MAX` where nothing is hit.
    pub instance: Option<&'a mut [u32]>,
    /// Indices of triangles of meshes, in the order in which they were given; 0 for other shapes, `u32::MAX` where
    /// nothing is hit.
    pub primitive: Option<&'a mut [u32]>,
    /// Barycentric coordinates: the weights of the second and third corner of the triangle. They are 0 for other
    /// shapes, and not written where nothing is hit.
    pub barycentrics: Option<&'a mut [[f32; 2]]>,
}

/// Casts a grid of rays from the origin of a sensor and finds the first hit of each.
///
/// `range` holds the least and the greatest distance in metres; for a pinhole these are depths. Only instances whose
/// mask has a bit in common with `visibility` are hit.
///
/// # Errors
/// Returns a [`SenseError`] that names the invalid input. Nothing is written in that case.
#[allow(clippy::too_many_arguments, reason = "each is one thing the answer depends on")]
pub fn cast_grid(
    scene: &Scene<'_>,
    moment: &Moment<'_>,
    grid: &Optics<'_>,
    range: [f64; 2],
    visibility: u32,
    faces: Faces,
    workspace: &mut Workspace<'_>,
    hits: Hits<'_>,
) -> Result<(), SenseError> {
    grid.check()?;
    let [least, most] = range;
    if !(least >= 0.0 && least < most) {
        return Err(SenseError::Range { least, most });
    }
    let [width, height] = grid.size();
    hits.check(width * height)?;
    let execution = workspace.execution;
    let mut memory = workspace.cut(grid_workspace_len(scene, grid))?;
    let shutter = Shutter::Global(*moment);
    let frame = Frame::new(scene, grid, &shutter, visibility, execution, &mut memory)?;
    let output = HitRows { hits, rays_in_block_row: frame.rays_in_row() };
    let sight = Sight { faces, range, within: f64::INFINITY };
    frame.trace(&sight, &mut memory, output, &Cast { sight });
    Ok(())
}

/// Returns the number of cache lines of [`Workspace`] memory that [`cast_grid`] needs.
pub fn grid_workspace_len(scene: &Scene<'_>, grid: &Optics<'_>) -> usize {
    let nowhere = Moment { world_from_sensor: Pose::IDENTITY, world_from_instance: &[] };
    Frame::workspace_len(scene, grid, &Shutter::Global(nowhere))
}

impl Hits<'_> {
    /// Splits off the outputs of the first `rays` rays.
    pub(super) fn split_at(self, rays: usize) -> (Self, Self) {
        let (distance, distance_rest) = split_at(self.distance, rays);
        let (normal, normal_rest) = split_at(self.normal, rays);
        let (instance, instance_rest) = split_at(self.instance, rays);
        let (primitive, primitive_rest) = split_at(self.primitive, rays);
        let (barycentrics, barycentrics_rest) = split_at(self.barycentrics, rays);
        let rest = Self {
            distance: distance_rest,
            normal: normal_rest,
            instance: instance_rest,
            primitive: primitive_rest,
            barycentrics: barycentrics_rest,
        };
        (Self { distance, normal, instance, primitive, barycentrics }, rest)
    }

    /// Checks that each output has `rays` elements.
    pub(super) fn check(&self, rays: usize) -> Result<(), SenseError> {
        check_output("distance", self.distance.as_ref().map(|values| values.len()), rays)?;
        check_output("normal", self.normal.as_ref().map(|values| values.len()), rays)?;
        check_output("instance", self.instance.as_ref().map(|values| values.len()), rays)?;
        check_output("primitive", self.primitive.as_ref().map(|values| values.len()), rays)?;
        check_output("barycentrics", self.barycentrics.as_ref().map(|values| values.len()), rays)
    }
}

/// Outputs of hits, split between rows of blocks.
struct HitRows<'a> {
    hits: Hits<'a>,
    rays_in_block_row: usize,
}

impl SplitRows for HitRows<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        let Self { hits, rays_in_block_row } = self;
        let (hits, rest) = hits.split_at(rows * rays_in_block_row);
        (Self { hits, rays_in_block_row }, Self { hits: rest, rays_in_block_row })
    }
}

struct Cast {
    sight: Sight,
}

impl BandWork<HitRows<'_>> for Cast {
    #[inline(always)]
    fn finish<S: Simd>(&self, simd: S, band: &Band<'_>, output: &mut HitRows<'_>) {
        let world_from_sensor = &band.view.world_from_sensor;
        let measure = Measure::new(world_from_sensor);
        write_hits(simd, band, &measure, self.sight.faces, &mut output.hits);
    }
}

/// Writes the hits of the rays of a band.
#[inline(always)]
fn write_hits<S: Simd>(simd: S, band: &Band<'_>, measure: &Measure, faces: Faces, hits: &mut Hits<'_>) {
    let mut resolver = Resolver::new(band.view);
    // Two loops, because short ones keep their values in registers.
    if let Some(distance) = hits.distance.as_deref_mut() {
        for_each_block(
            band,
            #[inline(always)]
            |place, block| {
                place.write_f32(simd, measure.block::<S, false>(simd, band, &mut resolver, block), distance);
            },
        );
    }
    // The normals of solids depend on the point that is hit, not only on the slot.
    let mut normal = if has_solids(band.view) { hits.normal.take() } else { None };
    if let Some(normal) = normal.as_deref_mut() {
        let mut finder = NormalFinder::new(faces);
        for_each_block(
            band,
            #[inline(always)]
            |place, block| {
                let (normals, lanes) = finder.block(simd, band, &mut resolver, block);
                match normals {
                    _ if lanes != u16::MAX => place.write_where(&normals.each(simd), lanes, normal),
                    Normals::Same(same) => place.write_normal(simd, same, normal),
                    Normals::Each(each) => place.write_normals(simd, each, normal),
                }
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
                    write_same(simd, &mut resolver, slots[0], place, hits);
                } else {
                    write_each(simd, &mut resolver, slots, place, hits);
                }
            },
        );
    }
    hits.normal = hits.normal.take().or(normal);
    if let Some(barycentrics) = hits.barycentrics.as_deref_mut() {
        let points = HitPoints::new(&band.view.world_from_sensor);
        for_each_block(band, |place, block| {
            let weights = points.barycentrics(band, &mut resolver, block);
            let lanes = hit_lanes(simd, &band.target.slot[block_index(band, block)]);
            place.write_where(&weights, lanes, barycentrics);
        });
    }
}

/// Returns true if all rays of a block hit the same slot, which is common if triangles are large.
#[inline(always)]
fn all_same<S: Simd>(simd: S, slots: &[u32; WIDTH]) -> bool {
    u32x16::load_array_ref(simd, slots).simd_eq(u32x16::splat(simd, slots[0])).all_true()
}

#[inline(always)]
fn write_same<S: Simd>(simd: S, resolver: &mut Resolver<'_>, slot: u32, place: &Place, hits: &mut Hits<'_>) {
    let found = FoundPrimitive::new(resolver, slot);
    if let (Some(output), true) = (hits.normal.as_deref_mut(), slot != NO_HIT) {
        place.write_normal(simd, found.normal, output);
    }
    if let Some(output) = hits.instance.as_deref_mut() {
        place.fill(found.instance, output);
    }
    if let Some(output) = hits.primitive.as_deref_mut() {
        place.fill(found.primitive, output);
    }
}

/// Writes the outputs ray by ray.
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
            let found = FoundPrimitive::new(resolver, slots[lane]);
            missed |= slots[lane] == NO_HIT;
            normals[lane] = found.normal;
            instances[lane] = found.instance;
            primitives[lane] = found.primitive;
        }
    }
    if let Some(output) = hits.normal.as_deref_mut() {
        if missed {
            place.write_where(&normals, hit_lanes(simd, slots), output);
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

/// The values that are reported for a slot.
#[derive(Clone, Copy)]
struct FoundPrimitive {
    normal: [f32; 3],
    instance: u32,
    primitive: u32,
}

impl FoundPrimitive {
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
