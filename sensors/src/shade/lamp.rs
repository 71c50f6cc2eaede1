//! What one lamp adds, with its shadows.

use super::tile::Tile;
use super::{Colours, Shader};
use crate::scene::{Form, Light};
use crate::simd::{LANES, Lanes, WIDTH, load_row, store_row};
use crate::trace::view::View;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16, u32x16};
use glam::DVec3;

impl Shader {
    /// Adds the lamp's light to the colours of the lanes that it reaches. Lamps are numbered.
    pub(super) fn add_lamp<S: Simd>(
        &mut self,
        simd: S,
        view: &View<'_>,
        (number, light): (usize, &Light),
        tile: &Tile,
        colours: &mut Colours,
    ) {
        let Self { surfaces, albedo, shadows, seen, .. } = self;
        let parallel = light.form() == Form::Directional;
        let position = view.point_in_frame(light.position);
        let mut brightness = [0.0; LANES];
        let mut lit = 0;
        simd.vectorize(
            #[inline(always)]
            || {
                for row in 0..LANES / WIDTH {
                    let normal = row_of(simd, &surfaces.normal, row);
                    let gain = if parallel {
                        dot(simd, &normal, &DVec3::from_array(light.direction)) * -1.0
                    } else {
                        shine_from(simd, light, position, normal, row_of(simd, &tile.point, row))
                    };
                    // A NaN, from a lamp that lies in the surface, lights nothing.
                    let on = gain.simd_gt(0.0);
                    store_row(on.select(gain, f32x16::splat(simd, 0.0)), &mut brightness, row);
                    lit |= on.to_bitmask() << (row * WIDTH);
                }
            },
        );
        lit &= tile.hits;
        if lit == 0 {
            return;
        }
        let dark = match (light.cast_shadows != 0, parallel) {
            (false, _) => 0,
            (true, false) => shadows.of_lamp(simd, view, tile, (number, position), lit),
            (true, true) => shadows.of_parallel(simd, view, tile, -DVec3::from_array(light.direction), lit),
        };
        let lit = lit & !dark;
        simd.vectorize(
            #[inline(always)]
            || {
                add_light(simd, light, albedo, &brightness, lit, colours);
                if let Some(seen) = seen {
                    tell_lit(simd, number, lit, seen);
                }
            },
        );
    }
}

#[inline(always)]
fn add_light<S: Simd>(
    simd: S,
    light: &Light,
    albedo: &Colours,
    brightness: &Lanes<f32>,
    lit: u64,
    colours: &mut Colours,
) {
    for row in 0..LANES / WIDTH {
        let on: mask32x16<S> = simd.from_bitmask_mask32x16(lit >> (row * WIDTH) & 0xffff);
        let brightness = on.select(load_row(simd, brightness, row), f32x16::splat(simd, 0.0));
        for channel in 0..3 {
            let added = (load_row(simd, &albedo[channel], row) * light.diffuse[channel]) * brightness;
            store_row(load_row(simd, &colours[channel], row) + added, &mut colours[channel], row);
        }
    }
}

/// Changes the numbers of what is seen where a lamp shines.
#[inline(always)]
fn tell_lit<S: Simd>(simd: S, number: usize, lit: u64, seen: &mut Lanes<u32>) {
    let change = ((number as u32 + 1).wrapping_mul(0x9e37_79b1) >> 25) | 1;
    for row in 0..LANES / WIDTH {
        let on: mask32x16<S> = simd.from_bitmask_mask32x16(lit >> (row * WIDTH) & 0xffff);
        let place = &mut seen.as_chunks_mut().0[row];
        let old = u32x16::load_array_ref(simd, place);
        on.select(old ^ change, old).store_array(place);
    }
}

#[inline(always)]
fn row_of<S: Simd>(simd: S, vectors: &[Lanes<f32>; 3], row: usize) -> [f32x16<S>; 3] {
    [load_row(simd, &vectors[0], row), load_row(simd, &vectors[1], row), load_row(simd, &vectors[2], row)]
}

#[inline(always)]
fn dot<S: Simd>(_simd: S, vectors: &[f32x16<S>; 3], with: &DVec3) -> f32x16<S> {
    let [x, y, z] = vectors;
    (*x * with.x as f32 + *y * with.y as f32) + *z * with.z as f32
}

/// Light from a point, in a cone if it is a spot.
#[inline(always)]
fn shine_from<S: Simd>(
    simd: S,
    light: &Light,
    position: DVec3,
    normal: [f32x16<S>; 3],
    point: [f32x16<S>; 3],
) -> f32x16<S> {
    let one = f32x16::splat(simd, 1.0);
    let x = f32x16::splat(simd, position.x as f32) - point[0];
    let y = f32x16::splat(simd, position.y as f32) - point[1];
    let z = f32x16::splat(simd, position.z as f32) - point[2];
    let distance = ((x * x + y * y) + z * z).sqrt();
    let per_distance = one / distance;
    let facing = ((normal[0] * x + normal[1] * y) + normal[2] * z) * per_distance;

    let [constant, linear, quadratic] = light.attenuation;
    let loss = distance * linear + (distance * distance) * quadratic + constant;
    let lossy = loss.simd_gt(1.0);
    let mut gain = if lossy.any_true() { lossy.select(one / loss, one) } else { one };
    gain = distance.simd_gt(light.range_m).select(f32x16::splat(simd, 0.0), gain);
    if light.form() == Form::Spot {
        let along = dot(simd, &[x, y, z], &DVec3::from_array(light.direction));
        gain *= cone(simd, light, along * per_distance * -1.0);
    }
    let zero = f32x16::splat(simd, 0.0);
    (facing.simd_gt(zero) & gain.simd_gt(zero)).select(facing * gain, zero)
}

/// Full inside the inner cone, none outside the outer, linear in the cosine between.
#[inline(always)]
fn cone<S: Simd>(simd: S, light: &Light, cos_angle: f32x16<S>) -> f32x16<S> {
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    let between = (cos_angle - light.cos_outer) / (light.cos_inner - light.cos_outer);
    let outside = cos_angle.simd_le(light.cos_outer).select(zero, between);
    cos_angle.simd_ge(light.cos_inner).select(one, outside)
}
