//! Casting many rays, and what is told of their hits.

use super::bundle::{Bundle, RAYS};
use super::doubt_of;
use super::walk::Tree;
use super::wave::Wave;
use crate::scene::tree::{NONE, WIDTH};
use crate::simd::Level;
use crate::trace::Faces;
use fearless_simd::{Simd, dispatch};

/// Rays p(t) = origin + t·direction. Metres, relative to a common reference point.
#[derive(Debug, Clone, Copy)]
pub struct Rays<'a> {
    /// One per ray, or one for all.
    pub origins: &'a [[f32; 3]],
    /// One per ray, finite, not 0, of any length.
    pub directions: &'a [[f32; 3]],
    /// Least and greatest t that count, per ray; 0 to ∞ without.
    pub ranges: Option<&'a [[f32; 2]]>,
}

impl Rays<'_> {
    /// Puts `count` rays from `first` on into the bundle. Lanes that are left get the last ray.
    #[inline(always)]
    fn load(&self, first: usize, count: usize, bundle: &mut Bundle) {
        for id in 0..count.next_multiple_of(WIDTH).min(RAYS) {
            let index = first + id.min(count - 1);
            let origin = if self.origins.len() == 1 { self.origins[0] } else { self.origins[index] };
            let direction = self.directions[index];
            let range = self.ranges.map_or([0.0, f32::INFINITY], |ranges| ranges[index]);
            for axis in 0..3 {
                bundle.origin[axis][id] = origin[axis];
                bundle.direction[axis][id] = direction[axis];
            }
            (bundle.range[0][id], bundle.range[1][id]) = (range[0], range[1]);
        }
    }
}

/// Where hits go: only what is asked for is computed. Each slice has one element per ray.
#[derive(Debug, Default)]
pub struct Hits<'a> {
    /// t in units of the direction's length; +∞ on a miss.
    pub distance: Option<&'a mut [f32]>,
    /// Unit geometric normal, outward by winding; untouched on a miss.
    pub normal: Option<&'a mut [[f32; 3]]>,
    /// Triangle in the caller's order; [`NONE`] on a miss.
    pub primitive: Option<&'a mut [u32]>,
}

/// Casts rays at one mesh, in its own frame.
pub fn cast_mesh(level: Level, tree: Tree<'_>, rays: &Rays<'_>, faces: Faces, hits: &mut Hits<'_>) {
    dispatch!(level, simd => cast(simd, tree, rays, faces, hits));
}

/// Tells which of the rays hit anything of one mesh, in its own frame.
pub fn occluded_by_mesh(level: Level, tree: Tree<'_>, rays: &Rays<'_>, faces: Faces, occluded: &mut [bool]) {
    dispatch!(level, simd => any(simd, tree, rays, faces, occluded));
}

#[inline(always)]
fn any<S: Simd>(simd: S, tree: Tree<'_>, rays: &Rays<'_>, faces: Faces, occluded: &mut [bool]) {
    let doubt = doubt_of(tree.nodes.first());
    let mut wave = Wave::new();
    let total = rays.directions.len().min(occluded.len());
    let mut first = 0;
    while first < total {
        let count = RAYS.min(total - first);
        rays.load(first, count, &mut wave.bundle);
        wave.bundle.prepare(simd, count, doubt);
        wave.any_hits(simd, tree, count, faces == Faces::Front, doubt);
        for id in 0..count {
            occluded[first + id] = wave.bundle.hit[id][0] != NONE;
        }
        first += count;
    }
}

#[inline(always)]
fn cast<S: Simd>(simd: S, tree: Tree<'_>, rays: &Rays<'_>, faces: Faces, hits: &mut Hits<'_>) {
    let cull_back = faces == Faces::Front;
    let doubt = doubt_of(tree.nodes.first());
    let mut wave = Wave::new();
    let total = rays.directions.len();
    let mut first = 0;
    while first < total {
        let count = RAYS.min(total - first);
        rays.load(first, count, &mut wave.bundle);
        wave.bundle.prepare(simd, count, doubt);
        wave.nearest_hits(simd, tree, count, cull_back, doubt);
        for id in 0..count {
            store(tree, &wave, id, first + id, hits);
        }
        first += count;
    }
}

#[inline(always)]
fn store(tree: Tree<'_>, wave: &Wave, id: usize, index: usize, hits: &mut Hits<'_>) {
    let slot = wave.bundle.hit[id][0];
    let hit = slot != NONE;
    if let Some(distance) = hits.distance.as_mut().and_then(|all| all.get_mut(index)) {
        let t = (wave.settled.t[id] * f64::from(wave.bundle.unit[id])) as f32;
        *distance = if hit { t } else { f32::INFINITY };
    }
    if let Some(primitive) = hits.primitive.as_mut().and_then(|all| all.get_mut(index)) {
        let block = tree.blocks.get(slot as usize / WIDTH);
        *primitive = block.map_or(NONE, |block| block.triangle[slot as usize % WIDTH]);
    }
    if let Some(normal) = hits.normal.as_mut().and_then(|all| all.get_mut(index))
        && hit
    {
        for axis in 0..3 {
            normal[axis] = (wave.settled.normal[axis][id] * wave.settled.per_length[id]) as f32;
        }
    }
}
