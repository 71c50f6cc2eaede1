//! Casting whole grids of rays, for those who want hits rather than a sensor's frame.

use super::grid::{Band, BandWork, Sight, trace_grid};
use super::hit_point::{HitPoints, block_index, has_solids};
use super::image::NO_HIT;
use super::measure::Measure;
use super::memory::{Workspace, workspace_len};
use super::packet::Faces;
use super::place::{Place, for_each_block};
use super::resolve::{Resolver, local_slot};
use super::view::View;
use crate::execution::SplitRows;
use crate::moment::Moment;
use crate::optics::{MAX_GRID_SIZE, Optics};
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
/// # Errors
/// A [`CastError`] that names what cannot be: sizes, numbers, a range, an output that is not one element a ray, or a
/// workspace that is too small (see [`Workspace::fits`]). Nothing is written then.
///
/// # Panics
/// When the moment does not have one pose for each instance.
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
) -> Result<(), CastError> {
    check_grid(grid)?;
    let [least, most] = range;
    if !(least >= 0.0 && least < most) {
        return Err(CastError::Range { least, most });
    }
    if !moment.world_from_sensor.is_finite() {
        return Err(CastError::Pose);
    }
    let [width, height] = grid.size();
    let rays = width * height;
    for (parameter, length) in hits.lengths() {
        if let Some(value) = length
            && value != rays
        {
            return Err(CastError::Output { parameter, value, rays });
        }
    }
    let need = workspace_len(scene.instances().len(), grid.rays());
    if workspace.buffer.len() < need {
        return Err(CastError::Workspace { value: workspace.buffer.len(), need });
    }
    let execution = workspace.execution;
    let mut memory = workspace.cut(scene, grid.rays());
    let view = View::new(scene, moment, visibility, memory.view(scene.instances().len()));
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
            rays: Measure::new(&moment.world_from_sensor),
            points: HitPoints::new(&moment.world_from_sensor, range[0], faces),
        },
    );
    Ok(())
}

/// Why a grid cannot be cast.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum CastError {
    /// Columns, rows, width or height of a grid: not 1 to [`MAX_GRID_SIZE`].
    Size {
        /// Which of them.
        parameter: &'static str,
        /// What it is.
        value: u32,
    },
    /// An angle, a step or a centre is NaN or infinite.
    Number {
        /// Which of them.
        parameter: &'static str,
        /// What it is.
        value: f64,
    },
    /// Not 0 ≤ least < most distance.
    Range {
        /// Least distance.
        least: f64,
        /// Greatest.
        most: f64,
    },
    /// The sensor's pose is NaN or infinite.
    Pose,
    /// An output is not as long as the grid has rays.
    Output {
        /// Which of [`Hits`].
        parameter: &'static str,
        /// How long it is.
        value: usize,
        /// How long it must be.
        rays: usize,
    },
    /// The workspace is too small.
    Workspace {
        /// Its cache lines.
        value: usize,
        /// Those that it takes.
        need: usize,
    },
}

impl core::fmt::Display for CastError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::Size { parameter, value } => {
                write!(f, "{parameter} of the grid is {value}; it must be 1 to {MAX_GRID_SIZE}")
            }
            Self::Number { parameter, value } => {
                write!(f, "{parameter} of the grid is {value}; it must be a finite number")
            }
            Self::Range { least, most } => {
                write!(f, "the range is {least} to {most} m; it must be 0 <= least < most")
            }
            Self::Pose => f.write_str("the sensor's pose must be finite numbers"),
            Self::Output { parameter, value, rays } => {
                write!(f, "the output {parameter} holds {value} elements; it must hold one a ray, {rays}")
            }
            Self::Workspace { value, need } => {
                write!(f, "the workspace is {value} cache lines long; it must be {need} at least")
            }
        }
    }
}

impl core::error::Error for CastError {}

fn check_grid(grid: &Optics<'_>) -> Result<(), CastError> {
    let size = |parameter, value| {
        if (1..=MAX_GRID_SIZE).contains(&value) { Ok(()) } else { Err(CastError::Size { parameter, value }) }
    };
    let number = |parameter, value: f64| {
        if value.is_finite() { Ok(()) } else { Err(CastError::Number { parameter, value }) }
    };
    match grid {
        Optics::Pinhole(lens) => {
            let [width, height] = lens.size();
            size("width", width)?;
            size("height", height)
        }
        Optics::Spherical(grid) => {
            size("columns", grid.columns)?;
            size("rows", grid.rows)?;
            number("first_azimuth_rad", grid.first_azimuth_rad)?;
            number("azimuth_step_rad", grid.azimuth_step_rad)?;
            number("first_elevation_rad", grid.first_elevation_rad)?;
            number("elevation_step_rad", grid.elevation_step_rad)
        }
        // Checked when it was made.
        Optics::Table(_) => Ok(()),
    }
}

impl Hits<'_> {
    /// Elements of those outputs that there are.
    fn lengths(&self) -> [(&'static str, Option<usize>); 5] {
        [
            ("distance", self.distance.as_ref().map(|values| values.len())),
            ("normal", self.normal.as_ref().map(|values| values.len())),
            ("instance", self.instance.as_ref().map(|values| values.len())),
            ("primitive", self.primitive.as_ref().map(|values| values.len())),
            ("barycentrics", self.barycentrics.as_ref().map(|values| values.len())),
        ]
    }

    /// Panics unless each output holds `rays` elements.
    pub(super) fn check(&self, rays: usize) {
        for (parameter, length) in self.lengths() {
            assert!(
                length.is_none_or(|length| length == rays),
                "the output {parameter} must hold one element a ray"
            );
        }
    }
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
    fn finish<S: Simd>(&self, simd: S, band: &Band<'_>, output: Rows<'_>) {
        let mut hits = output.hits;
        let mut resolver = Resolver::new(band.view);
        // Two loops: short ones keep what they need in registers.
        if let Some(distance) = hits.distance.as_deref_mut() {
            for_each_block(
                band,
                #[inline(always)]
                |place, block| {
                    place.write(&self.rays.block::<S, false>(simd, band, &mut resolver, block), distance);
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
