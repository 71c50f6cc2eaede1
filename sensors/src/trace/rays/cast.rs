//! Casting many rays, and what is told of their hits.

use super::block::{cross, dot, minus};
use super::ray::{Nearest, Ray};
use super::walk::Tree;
use super::wave::{Wave, nearest_hits};
use crate::scene::tree::{NONE, WIDTH};
use crate::simd::{Level, sqrt};
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
    /// Ray `index`.
    #[inline(always)]
    pub(super) fn get(&self, index: usize, doubt: f32) -> Ray {
        let origin = if self.origins.len() == 1 { self.origins[0] } else { self.origins[index] };
        let range = self.ranges.map_or([0.0, f32::INFINITY], |ranges| ranges[index]);
        Ray::new(origin, self.directions[index], range, doubt)
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

#[inline(always)]
fn cast<S: Simd>(simd: S, tree: Tree<'_>, rays: &Rays<'_>, faces: Faces, hits: &mut Hits<'_>) {
    let cull_back = faces == Faces::Front;
    let doubt = doubt(tree);
    let mut wave = Wave::new();
    nearest_hits(
        simd,
        tree,
        rays.directions.len(),
        cull_back,
        &mut wave,
        #[inline(always)]
        |index| rays.get(index, doubt),
        #[inline(always)]
        |index, ray, nearest| store(tree, ray, nearest, index, hits),
    );
}

/// How far t near 0 may be off in single precision: 2⁻²⁰ of the coordinates.
#[inline(always)]
fn doubt(tree: Tree<'_>) -> f32 {
    let mut size = 0.0_f32;
    if let Some(root) = tree.nodes.first() {
        for axis in 0..3 {
            for lane in 0..WIDTH {
                size = size.max(root.min[axis][lane].abs()).max(root.max[axis][lane].abs());
            }
        }
    }
    size * (1.0 / 1_048_576.0)
}

#[inline(always)]
fn store(tree: Tree<'_>, ray: &Ray, nearest: &Nearest, index: usize, hits: &mut Hits<'_>) {
    if let Some(distance) = hits.distance.as_mut().and_then(|all| all.get_mut(index)) {
        *distance = (nearest.t * f64::from(ray.unit)) as f32;
    }
    let block = tree.blocks.get(nearest.slot as usize / WIDTH);
    let lane = nearest.slot as usize % WIDTH;
    if let Some(primitive) = hits.primitive.as_mut().and_then(|all| all.get_mut(index)) {
        *primitive = block.map_or(NONE, |block| block.triangle[lane]);
    }
    if let Some(normal) = hits.normal.as_mut().and_then(|all| all.get_mut(index))
        && let Some(block) = block
    {
        let mut corners = [[0.0; 3]; 3];
        for corner in 0..3 {
            for axis in 0..3 {
                corners[corner][axis] = f64::from(block.corners[corner][axis][lane]);
            }
        }
        let [a, b, c] = corners;
        let n = cross(minus(b, a), minus(c, a));
        let scale = 1.0 / sqrt(dot(n, n));
        *normal = [(n[0] * scale) as f32, (n[1] * scale) as f32, (n[2] * scale) as f32];
    }
}
