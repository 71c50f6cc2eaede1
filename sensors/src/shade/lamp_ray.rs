//! The way of light from points to a lamp.

use super::power::power;
use crate::scene::{Form, Light};
use crate::simd::{Lanes, load_row};
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16};
use glam::DVec3;

#[inline(always)]
pub(super) fn row_of<S: Simd>(simd: S, vectors: &[Lanes<f32>; 3], row: usize) -> [f32x16<S>; 3] {
    [load_row(simd, &vectors[0], row), load_row(simd, &vectors[1], row), load_row(simd, &vectors[2], row)]
}

#[inline(always)]
pub(super) fn dot<S: Simd>(_simd: S, vectors: &[f32x16<S>; 3], with: &DVec3) -> f32x16<S> {
    let [x, y, z] = vectors;
    (*x * with.x as f32 + *y * with.y as f32) + *z * with.z as f32
}

/// The rays from the points of a row to a lamp.
pub(super) struct Ray<S: Simd> {
    /// Vectors to the lamp, in metres.
    pub(super) way: [f32x16<S>; 3],
    pub(super) per_distance: f32x16<S>,
    /// Light that reaches a surface facing the lamp.
    pub(super) gain: f32x16<S>,
}

impl<S: Simd> Ray<S> {
    /// Rays to a point light or spot, whose position is given in the view.
    #[inline(always)]
    pub(super) fn to(simd: S, light: &Light, position: DVec3, point: [f32x16<S>; 3]) -> Self {
        let one = f32x16::splat(simd, 1.0);
        let x = f32x16::splat(simd, position.x as f32) - point[0];
        let y = f32x16::splat(simd, position.y as f32) - point[1];
        let z = f32x16::splat(simd, position.z as f32) - point[2];
        let distance = ((x * x + y * y) + z * z).sqrt();
        let per_distance = one / distance;

        let [constant, linear, quadratic] = light.attenuation;
        let loss = distance * linear + (distance * distance) * quadratic + constant;
        let lossy = loss.simd_gt(1.0);
        let mut gain = if lossy.any_true() { lossy.select(one / loss, one) } else { one };
        gain = distance.simd_gt(light.range_m).select(f32x16::splat(simd, 0.0), gain);
        if light.form() == Form::Spot {
            let along = dot(simd, &[x, y, z], &DVec3::from_array(light.direction));
            gain *= cone(simd, light, along * per_distance * -1.0);
        }
        Self { way: [x, y, z], per_distance, gain }
    }

    /// Light that reaches surfaces with the given normals; 0 for surfaces facing away.
    #[inline(always)]
    pub(super) fn shine_on(&self, simd: S, normal: [f32x16<S>; 3]) -> f32x16<S> {
        let [x, y, z] = self.way;
        let zero = f32x16::splat(simd, 0.0);
        let facing = ((normal[0] * x + normal[1] * y) + normal[2] * z) * self.per_distance;
        (facing.simd_gt(zero) & self.gain.simd_gt(zero)).select(facing * self.gain, zero)
    }
}

/// Full light inside the inner cone, none outside the outer cone; in between, a power of a linear function of the
/// cosine.
#[inline(always)]
fn cone<S: Simd>(simd: S, light: &Light, cos_angle: f32x16<S>) -> f32x16<S> {
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    let mut between = (cos_angle - light.cos_outer) / (light.cos_inner - light.cos_outer);
    if light.falloff != 1.0 {
        between = power(simd, between, f32x16::splat(simd, light.falloff));
    }
    let outside = cos_angle.simd_le(light.cos_outer).select(zero, between);
    cos_angle.simd_ge(light.cos_inner).select(one, outside)
}
