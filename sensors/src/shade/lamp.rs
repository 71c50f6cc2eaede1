//! The contribution of one lamp, with highlights and shadows.

use super::power::power;
use super::tile::Tile;
use super::{Colours, Gloss, Shader};
use crate::scene::{Form, Light};
use crate::simd::{LANES, Lanes, WIDTH, load_row, store_row};
use crate::trace::placed::view::View;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16, u32x16};
use glam::DVec3;

impl Shader {
    /// Adds the lamp's light to the colours of the lanes that it reaches. `number` is the number of the lamp.
    pub(super) fn add_lamp<S: Simd>(
        &mut self,
        simd: S,
        view: &View<'_>,
        (number, light): (usize, &Light),
        tile: &Tile,
        colours: &mut Colours,
    ) {
        let Self { surfaces, albedo, gloss, bumps, shadows, seen, back, .. } = self;
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
                        Ray::to(simd, light, position, row_of(simd, &tile.point, row)).shine_on(simd, normal)
                    };
                    // NaN, from a lamp that lies in the surface, gives no light.
                    let on = gain.simd_gt(0.0);
                    store_row(on.select(gain, f32x16::splat(simd, 0.0)), &mut brightness, row);
                    lit |= on.to_bitmask() << (row * WIDTH);
                }
            },
        );
        lit &= tile.hits;
        if lit & bumps.lanes != 0 {
            lit &= !bumps.turned_away(light, position, tile);
        }
        if lit == 0 {
            return;
        }
        let dark = match (light.cast_shadows != 0, parallel) {
            (false, _) => 0,
            (true, false) => shadows.of_lamp(simd, view, tile, (number, position), (lit, *back)),
            (true, true) => {
                let towards = -DVec3::from_array(light.direction);
                shadows.of_parallel(simd, view, tile, towards, (lit, *back))
            }
        };
        let lit = lit & !dark;
        simd.vectorize(
            #[inline(always)]
            || {
                add_light(simd, light, albedo, &brightness, lit, colours);
                if lit & gloss.lanes != 0 {
                    add_highlights(simd, (light, position), tile, &surfaces.normal, gloss, lit, colours);
                }
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

/// Changes the fingerprints of the lanes that a lamp lights.
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

/// The rays from the points of a row to a lamp.
struct Ray<S: Simd> {
    /// Vectors to the lamp, in metres.
    way: [f32x16<S>; 3],
    per_distance: f32x16<S>,
    /// Light that reaches a surface facing the lamp.
    gain: f32x16<S>,
}

impl<S: Simd> Ray<S> {
    /// Rays to a point light or spot, whose position is given in the view.
    #[inline(always)]
    fn to(simd: S, light: &Light, position: DVec3, point: [f32x16<S>; 3]) -> Self {
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
    fn shine_on(&self, simd: S, normal: [f32x16<S>; 3]) -> f32x16<S> {
        let [x, y, z] = self.way;
        let zero = f32x16::splat(simd, 0.0);
        let facing = ((normal[0] * x + normal[1] * y) + normal[2] * z) * self.per_distance;
        (facing.simd_gt(zero) & self.gain.simd_gt(zero)).select(facing * self.gain, zero)
    }
}

/// Adds the lamp's Blinn–Phong highlights: the specular colours · (n·h)^shininess, where h is the half-vector between
/// the directions to the lamp and to the sensor. As in Ogre's shader, they end abruptly where the surface faces away
/// from the lamp.
#[inline(always)]
fn add_highlights<S: Simd>(
    simd: S,
    (light, position): (&Light, DVec3),
    tile: &Tile,
    normal: &[Lanes<f32>; 3],
    gloss: &Gloss,
    lit: u64,
    colours: &mut Colours,
) {
    let one = f32x16::splat(simd, 1.0);
    for row in 0..LANES / WIDTH {
        let glossy = (lit & gloss.lanes) >> (row * WIDTH) & 0xffff;
        if glossy == 0 {
            continue;
        }
        let glossy: mask32x16<S> = simd.from_bitmask_mask32x16(glossy);
        let point = row_of(simd, &tile.point, row);
        let (to_lamp, gain) = if light.form() == Form::Directional {
            (light.direction.map(|along| f32x16::splat(simd, -along as f32)), one)
        } else {
            let ray = Ray::to(simd, light, position, point);
            (ray.way.map(|way| way * ray.per_distance), ray.gain)
        };
        let [x, y, z] = point;
        let per_range = one / ((x * x + y * y) + z * z).sqrt();
        let middle = [0, 1, 2].map(|axis| to_lamp[axis] - point[axis] * per_range);
        let [x, y, z] = middle;
        let length = ((x * x + y * y) + z * z).sqrt();
        let [a, b, c] = row_of(simd, normal, row);
        let cos = ((a * x + b * y) + c * z) / length;
        let highlight = power(simd, cos, load_row(simd, &gloss.shininess, row)) * gain;
        let highlight = glossy.select(highlight, f32x16::splat(simd, 0.0));
        for channel in 0..3 {
            let added = (load_row(simd, &gloss.specular[channel], row) * light.specular[channel]) * highlight;
            store_row(load_row(simd, &colours[channel], row) + added, &mut colours[channel], row);
        }
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
