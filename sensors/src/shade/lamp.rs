//! The contribution of one lamp, with highlights and shadows.

use super::facets;
use super::lamp_ray::{Ray, dot, row_of};
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
        if lit & gloss.facets != 0 {
            let surfaces = (tile, &surfaces.normal);
            facets::reflect(simd, (light, position), surfaces, (gloss, albedo, &brightness), lit, colours);
        }
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
