//! Normal maps: images of normals in the axes of the surface, right (u), up (v) and outwards.

use super::surface::Footprint;
use super::texels::Reading;
use super::tile::Tile;
use super::{ROWS, Shader, lanes_in, store_where};
use crate::scene::{Form, Light, Material, Scene};
use crate::simd::{LANES, Lanes, load_row};
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16};
use glam::DVec3;

type Vector<S> = [f32x16<S>; 3];

/// The lanes of a tile whose normals come from a map.
pub(super) struct Bumps {
    /// The lanes, as one bit each.
    pub(super) lanes: u64,
    /// The normals of the map; after [`Bumps::swap`], the normals of the surface itself.
    pub(super) normal: [Lanes<f32>; 3],
}

impl Bumps {
    pub(super) const fn new() -> Self {
        Self { lanes: 0, normal: [[0.0; LANES]; 3] }
    }

    /// Swaps the normals of the map and those of the surfaces.
    pub(super) fn swap(&mut self, normal: &mut [Lanes<f32>; 3]) {
        for (own, normal) in self.normal.iter_mut().zip(normal) {
            for lane in 0..LANES {
                if self.lanes >> lane & 1 != 0 {
                    core::mem::swap(&mut own[lane], &mut normal[lane]);
                }
            }
        }
    }

    /// The lanes that a lamp, whose position is given in the view, does not reach because the surface itself faces away
    /// from it, whatever the normal of the map.
    pub(super) fn turned_away(&self, light: &Light, position: DVec3, tile: &Tile) -> u64 {
        let mut lanes = 0;
        for lane in 0..LANES {
            let mut facing = 0.0;
            for axis in 0..3 {
                let to_lamp = if light.form() == Form::Directional {
                    -light.direction[axis] as f32
                } else {
                    position[axis] as f32 - tile.point[axis][lane]
                };
                facing += self.normal[axis][lane] * to_lamp;
            }
            lanes |= u64::from(facing <= 0.0) << lane;
        }
        lanes & self.lanes
    }
}

impl Shader {
    /// Reads the normals of the given lanes from the normal map of their material.
    pub(super) fn bump<S: Simd>(
        &mut self,
        simd: S,
        scene: &Scene<'_>,
        material: &Material,
        footprints: &[Footprint<S>; ROWS],
        lanes: u64,
    ) {
        let Self { bumps, surfaces, maps, .. } = self;
        maps.turn_to(scene, material.normal_map);
        bumps.lanes |= lanes;
        simd.vectorize(
            #[inline(always)]
            || {
                for row in 0..ROWS {
                    let mine = lanes_in(simd, lanes, row);
                    if !mine.any_true() {
                        continue;
                    }
                    let texel = maps.sample(simd, scene, &footprints[row], mine, Reading::Numbers);
                    let normal = vectors(simd, &surfaces.normal, row);
                    let [to_u, to_v] = [0, 1].map(|side| vectors(simd, &surfaces.gradient[side], row));
                    let mapped = mapped(simd, texel, normal, to_u, to_v);
                    for axis in 0..3 {
                        store_where(simd, mine, mapped[axis], &mut bumps.normal[axis], row);
                    }
                }
            },
        );
    }
}

/// The normal for a texel, given the gradients of u and v.
#[inline(always)]
fn mapped<S: Simd>(
    simd: S,
    texel: Vector<S>,
    normal: Vector<S>,
    to_u: Vector<S>,
    to_v: Vector<S>,
) -> Vector<S> {
    let zero = f32x16::splat(simd, 0.0);
    // Along the surface, in the direction in which u increases and v is constant; and perpendicular to that, in the
    // direction in which v increases.
    let right = towards(simd, unit(simd, cross(to_v, normal)), to_u);
    let up = towards(simd, cross(normal, right), to_v);
    let [x, y, z] = texel.map(|value| value * 2.0 - 1.0);
    let mixed = [0, 1, 2].map(|axis| right[axis] * x + up[axis] * y + normal[axis] * z);
    let mapped = unit(simd, mixed);
    // Where the map has no direction, use the surface's normal.
    let says = dot(mapped, mapped).simd_gt(zero);
    [0, 1, 2].map(|axis| says.select(mapped[axis], normal[axis]))
}

#[inline(always)]
fn vectors<S: Simd>(simd: S, lanes: &[Lanes<f32>; 3], row: usize) -> Vector<S> {
    [load_row(simd, &lanes[0], row), load_row(simd, &lanes[1], row), load_row(simd, &lanes[2], row)]
}

#[inline(always)]
fn dot<S: Simd>(a: Vector<S>, b: Vector<S>) -> f32x16<S> {
    (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
}

#[inline(always)]
fn cross<S: Simd>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The vector scaled to length 1, or 0 if it has no direction.
#[inline(always)]
fn unit<S: Simd>(simd: S, vector: Vector<S>) -> Vector<S> {
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    let per_length = one / dot(vector, vector).sqrt();
    let there = per_length.simd_gt(zero) & per_length.simd_lt(f32x16::splat(simd, f32::MAX));
    let per_length = there.select(per_length, zero);
    vector.map(|value| there.select(value * per_length, zero))
}

/// The vector or its opposite, whichever has a positive component along another vector.
#[inline(always)]
fn towards<S: Simd>(simd: S, vector: Vector<S>, along: Vector<S>) -> Vector<S> {
    let away = dot(vector, along).simd_lt(f32x16::splat(simd, 0.0));
    vector.map(|value| away.select(value * -1.0, value))
}
