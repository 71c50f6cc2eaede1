//! Casting many rays in a scene.

use super::bundle::RAYS;
use super::describe::{Description, on_triangle};
use super::doubt_of;
use super::ray::FrameRay;
use super::scene::{SceneHit, Stacks, hit_in_view, in_instance, mesh_tree};
use super::walk::MeshTree;
use super::wave::{Wave, WaveScratch};
use crate::execution::{SplitRows, for_each_row};
use crate::scene::Scene;
use crate::scene::tree::NONE;
use crate::simd::{Level, WIDTH, dispatch};
use crate::trace::error::check_output;
use crate::trace::placed::memory::view_lines;
use crate::trace::placed::view::{Placed, View, check_moment};
use crate::trace::{Faces, Hits, SenseError, Workspace};
use crate::{Moment, Pose};
use bytemuck::Zeroable;
use fearless_simd::Simd;
use glam::DVec3;

/// Rays p(t) = origin + t·direction, in metres, relative to a reference point, along the world's axes.
#[derive(Debug, Clone, Copy)]
pub struct Rays<'a> {
    /// The origins: one per ray, or one for all.
    pub origins: &'a [[f32; 3]],
    /// The directions: one per ray, finite, not 0, of any length.
    pub directions: &'a [[f32; 3]],
    /// The least and greatest t that count, one pair per ray; by default 0 to ∞.
    pub ranges: Option<&'a [[f32; 2]]>,
}

impl Rays<'_> {
    #[inline(always)]
    fn get(&self, index: usize) -> FrameRay {
        FrameRay {
            origin: if self.origins.len() == 1 { self.origins[0] } else { self.origins[index] },
            direction: self.directions[index],
            range: self.ranges.map_or([0.0, f32::INFINITY], |ranges| ranges[index]),
        }
    }

    /// Checks that there is one origin for all rays or one per ray, and one range per ray. Returns the number of rays.
    fn check(&self) -> Result<usize, SenseError> {
        let need = self.directions.len();
        let wrong = |parameter, value| Err(SenseError::Input { parameter, value, need });
        match (self.origins.len(), self.ranges) {
            (value, _) if value != 1 && value != need => wrong("origins", value),
            (_, Some(ranges)) if ranges.len() != need => wrong("ranges", ranges.len()),
            _ => Ok(need),
        }
    }
}

/// Finds the first hit of each ray on an instance whose mask has a bit in common with `visibility`. The rays are
/// independent of each other. `world_from_instance` has a pose for each instance of the scene; there is no sensor, so a
/// whole [`Moment`] is not needed.
///
/// # Errors
/// If an input or output does not have one element per ray, if the workspace has less than [`workspace_len`], or if
/// there is not one pose for each instance. Nothing is written in that case.
#[allow(clippy::too_many_arguments, reason = "each is one thing the answer depends on")]
pub fn cast_rays(
    scene: &Scene<'_>,
    world_from_instance: &[Pose],
    reference_in_world: DVec3,
    rays: &Rays<'_>,
    visibility: u32,
    faces: Faces,
    workspace: &mut Workspace<'_>,
    hits: Hits<'_>,
) -> Result<(), SenseError> {
    hits.check(rays.check()?)?;
    let what = (rays, faces, Output::Hits(hits));
    cast_in_view(scene, (world_from_instance, reference_in_world), visibility, workspace, what)
}

/// Finds out which rays hit anything within their ranges, as for shadows.
///
/// # Errors
/// The errors of [`cast_rays`].
#[allow(clippy::too_many_arguments, reason = "each is one thing the answer depends on")]
pub fn occluded_rays(
    scene: &Scene<'_>,
    world_from_instance: &[Pose],
    reference_in_world: DVec3,
    rays: &Rays<'_>,
    visibility: u32,
    faces: Faces,
    workspace: &mut Workspace<'_>,
    occluded: &mut [bool],
) -> Result<(), SenseError> {
    check_output("occluded", Some(occluded.len()), rays.check()?)?;
    let what = (rays, faces, Output::Occluded(occluded));
    cast_in_view(scene, (world_from_instance, reference_in_world), visibility, workspace, what)
}

/// Places the instances around the reference point, checks the rays and casts them.
fn cast_in_view(
    scene: &Scene<'_>,
    (world_from_instance, reference_in_world): (&[Pose], DVec3),
    visibility: u32,
    workspace: &mut Workspace<'_>,
    (rays, faces, output): (&Rays<'_>, Faces, Output<'_>),
) -> Result<(), SenseError> {
    let execution = workspace.execution;
    let mut memory = workspace.cut(workspace_len(scene))?;
    let world_from_sensor = Pose::from_translation(reference_in_world);
    let moment = Moment { world_from_sensor, world_from_instance };
    check_moment(scene, &moment)?;
    let view = View::new(scene, &moment, visibility, memory.views(scene.instances().len(), 1));
    let count = rays.check()?;
    for_each_row(execution, 0..count.div_ceil(CHUNK), output, &|chunk, output| {
        let first = chunk * CHUNK;
        let last = count.min(first + CHUNK);
        dispatch!(execution.level, simd => cast_chunk(simd, &view, rays, first..last, faces, output));
    });
    Ok(())
}

/// Returns the number of cache lines of [`Workspace`] memory that [`cast_rays`] and [`occluded_rays`] need.
pub fn workspace_len(scene: &Scene<'_>) -> usize {
    view_lines(scene.instances().len(), 1)
}

/// The number of rays that one thread casts at a time.
const CHUNK: usize = 4096;

/// The output buffers.
enum Output<'a> {
    Hits(Hits<'a>),
    Occluded(&'a mut [bool]),
}

impl SplitRows for Output<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        let at = rows * CHUNK;
        match self {
            Self::Occluded(values) => {
                let (first, second) = values.split_at_mut(at.min(values.len()));
                (Self::Occluded(first), Self::Occluded(second))
            }
            Self::Hits(hits) => {
                let (first, second) = hits.split_at(at);
                (Self::Hits(first), Self::Hits(second))
            }
        }
    }
}

#[inline(always)]
fn cast_chunk<S: Simd>(
    simd: S,
    view: &View<'_>,
    rays: &Rays<'_>,
    range: core::ops::Range<usize>,
    faces: Faces,
    output: Output<'_>,
) {
    // If the scene consists of a single mesh, rays traverse only its tree.
    match view.placed {
        [only] if only.kind().is_mesh() => cast_at_mesh(simd, (view, only), rays, range, faces, output),
        _ => cast_one_by_one(simd, view, rays, range, faces, output),
    }
}

/// Casts rays at the only mesh, many at a time.
#[inline(never)]
fn cast_at_mesh<S: Simd>(
    simd: S,
    (view, only): (&View<'_>, &Placed),
    rays: &Rays<'_>,
    range: core::ops::Range<usize>,
    faces: Faces,
    mut output: Output<'_>,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            let tree = mesh_tree(view, only);
            let doubt = doubt_of(tree.nodes.first());
            let mut room = WaveScratch::zeroed();
            let mut wave = Wave::new(&mut room);
            let mut first = range.start;
            while first < range.end {
                let count = RAYS.min(range.end - first);
                for id in 0..count.next_multiple_of(WIDTH) {
                    // Unused lanes repeat the last ray.
                    let ray = rays.get(first + id.min(count - 1));
                    if only.is_turned() || only.translation != [0.0; 3] {
                        let [origin, direction] = in_instance(only, &ray);
                        wave.set(id, origin, direction, ray.range);
                    } else {
                        wave.bundle.set(id, &ray);
                    }
                }
                wave.bundle.prepare(simd, count, doubt);
                match &mut output {
                    Output::Hits(hits) => {
                        wave.nearest_hits(simd, tree, count, faces == Faces::Front);
                        for id in 0..count {
                            let at = first + id - range.start;
                            store_mesh_hit(view, tree, &wave, id, rays, first + id, at, hits);
                        }
                    }
                    Output::Occluded(occluded) => {
                        wave.any_hits(simd, tree, count, faces == Faces::Front);
                        for id in 0..count {
                            occluded[first + id - range.start] = wave.bundle.hit[id][0] != NONE;
                        }
                    }
                }
                first += count;
            }
        },
    );
}

/// Casts rays in a scene.
#[inline(never)]
fn cast_one_by_one<S: Simd>(
    simd: S,
    view: &View<'_>,
    rays: &Rays<'_>,
    range: core::ops::Range<usize>,
    faces: Faces,
    mut output: Output<'_>,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            let mut stacks = const { Stacks::new() };
            for index in range.clone() {
                let ray = rays.get(index);
                let at = index - range.start;
                match &mut output {
                    Output::Hits(hits) => {
                        let hit = hit_in_view::<false, S>(simd, view, &ray, faces, &mut stacks);
                        store(view, &ray, &hit, at, hits);
                    }
                    Output::Occluded(occluded) => {
                        let hit = hit_in_view::<true, S>(simd, view, &ray, faces, &mut stacks);
                        occluded[at] = hit.placed != NONE;
                    }
                }
            }
        },
    );
}

/// Writes a hit on the only mesh: distance and triangle are known, and so is the normal unless the mesh is rotated.
#[allow(clippy::too_many_arguments, reason = "what is known of a hit lies in several places")]
#[inline(always)]
fn store_mesh_hit(
    view: &View<'_>,
    tree: MeshTree<'_>,
    wave: &Wave<'_>,
    id: usize,
    rays: &Rays<'_>,
    index: usize,
    at: usize,
    hits: &mut Hits<'_>,
) {
    let slot = wave.bundle.hit[id][0];
    let only = &view.placed[0];
    let t = wave.settled.t[id] * f64::from(wave.bundle.unit[id]);
    if hits.barycentrics.is_some() || only.is_turned() {
        let placed = if slot == NONE { NONE } else { 0 };
        let t = if slot == NONE { f64::INFINITY } else { t };
        store(view, &rays.get(index), &SceneHit { t, placed, slot }, at, hits);
        return;
    }
    if let Some(distance) = &mut hits.distance {
        distance[at] = if slot == NONE { f32::INFINITY } else { t as f32 };
    }
    if let Some(instance) = &mut hits.instance {
        instance[at] = if slot == NONE { NONE } else { only.instance };
    }
    if let Some(primitive) = &mut hits.primitive {
        let block = tree.blocks.get(slot as usize / WIDTH);
        primitive[at] = block.map_or(NONE, |block| block.triangle[slot as usize % WIDTH]);
    }
    if let Some(normal) = &mut hits.normal
        && slot != NONE
    {
        for axis in 0..3 {
            normal[at][axis] = (wave.settled.normal[axis][id] * wave.settled.per_length[id]) as f32;
        }
    }
}

/// Writes a hit on any instance.
#[inline(always)]
fn store(view: &View<'_>, ray: &FrameRay, hit: &SceneHit, at: usize, hits: &mut Hits<'_>) {
    if let Some(distance) = &mut hits.distance {
        distance[at] = hit.t as f32;
    }
    if hits.normal.is_none()
        && hits.instance.is_none()
        && hits.primitive.is_none()
        && hits.barycentrics.is_none()
    {
        return;
    }
    let description = Description::new(view, ray, hit);
    if let Some(instance) = &mut hits.instance {
        instance[at] = description.map_or(NONE, |description| description.instance);
    }
    if let Some(primitive) = &mut hits.primitive {
        primitive[at] = description.map_or(NONE, |description| description.primitive);
    }
    if let Some(description) = description {
        if let Some(normal) = &mut hits.normal {
            normal[at] = description.normal;
        }
        if let Some(barycentrics) = &mut hits.barycentrics {
            barycentrics[at] = description.barycentrics;
        }
    }
}

/// Casts rays at one mesh in its own frame, with the results of a scene with one instance of it. For callers who have
/// trees but no scene.
///
/// # Errors
/// If an input or output does not have one element per ray.
pub fn cast_mesh(
    level: Level,
    tree: MeshTree<'_>,
    rays: &Rays<'_>,
    faces: Faces,
    hits: &mut Hits<'_>,
) -> Result<(), SenseError> {
    let count = rays.check()?;
    hits.check(count)?;
    dispatch!(level, simd => each_bundle(simd, tree, rays, #[inline(always)] |wave, first, count| {
        wave.nearest_hits(simd, tree, count, faces == Faces::Front);
        for id in 0..count {
            store_in_mesh(tree, wave, id, (rays, first + id), hits);
        }
    }));
    Ok(())
}

/// Finds out which rays hit anything of one mesh, in its own frame.
///
/// # Errors
/// The errors of [`cast_mesh`].
pub fn occluded_by_mesh(
    level: Level,
    tree: MeshTree<'_>,
    rays: &Rays<'_>,
    faces: Faces,
    occluded: &mut [bool],
) -> Result<(), SenseError> {
    let count = rays.check()?;
    check_output("occluded", Some(occluded.len()), count)?;
    dispatch!(level, simd => each_bundle(simd, tree, rays, #[inline(always)] |wave, first, count| {
        wave.any_hits(simd, tree, count, faces == Faces::Front);
        for id in 0..count {
            occluded[first + id] = wave.bundle.hit[id][0] != NONE;
        }
    }));
    Ok(())
}

#[inline(always)]
fn each_bundle<S: Simd>(
    simd: S,
    tree: MeshTree<'_>,
    rays: &Rays<'_>,
    mut work: impl FnMut(&mut Wave<'_>, usize, usize),
) {
    let doubt = doubt_of(tree.nodes.first());
    let mut room = WaveScratch::zeroed();
    let mut wave = Wave::new(&mut room);
    let mut first = 0;
    while first < rays.directions.len() {
        let count = RAYS.min(rays.directions.len() - first);
        for id in 0..count.next_multiple_of(WIDTH) {
            wave.bundle.set(id, &rays.get(first + id.min(count - 1)));
        }
        wave.bundle.prepare(simd, count, doubt);
        work(&mut wave, first, count);
        first += count;
    }
}

#[inline(always)]
fn store_in_mesh(
    tree: MeshTree<'_>,
    wave: &Wave<'_>,
    id: usize,
    (rays, index): (&Rays<'_>, usize),
    hits: &mut Hits<'_>,
) {
    let slot = wave.bundle.hit[id][0];
    let hit = slot != NONE;
    if let Some(distance) = &mut hits.distance {
        let t = (wave.settled.t[id] * f64::from(wave.bundle.unit[id])) as f32;
        distance[index] = if hit { t } else { f32::INFINITY };
    }
    if let Some(primitive) = &mut hits.primitive {
        let block = tree.blocks.get(slot as usize / WIDTH);
        primitive[index] = block.map_or(NONE, |block| block.triangle[slot as usize % WIDTH]);
    }
    if let Some(instance) = &mut hits.instance {
        instance[index] = if hit { 0 } else { NONE };
    }
    if let Some(barycentrics) = &mut hits.barycentrics
        && let Some(block) = tree.blocks.get(slot as usize / WIDTH)
    {
        let ray = rays.get(index);
        let wide = |v: [f32; 3]| DVec3::new(v[0].into(), v[1].into(), v[2].into());
        let point =
            wide(ray.origin) + wide(ray.direction) * (wave.settled.t[id] * f64::from(wave.bundle.unit[id]));
        let (_, _, weights) = on_triangle(block, slot as usize % WIDTH, point);
        barycentrics[index] = weights;
    }
    if let Some(normal) = &mut hits.normal
        && hit
    {
        for axis in 0..3 {
            normal[index][axis] = (wave.settled.normal[axis][id] * wave.settled.per_length[id]) as f32;
        }
    }
}
