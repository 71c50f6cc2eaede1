//! Light of lamps on surfaces of microscopic facets: [`Pbr`](crate::scene::Pbr) has the formula.
//!
//! The functions are compiled once for each level and never inlined, so that tiles without such surfaces do not pay for
//! them.

use super::lamp_ray::{Ray, row_of};
use super::surface::Footprint;
use super::texels::Reading;
use super::tile::Tile;
use super::{Colours, Gloss, ROWS, Shader, lanes_in, store_where};
use crate::scene::{Form, Light, Material, Scene};
use crate::simd::{Lanes, load_row, store_row};
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16};
use glam::DVec3;

/// The reflectance of surfaces without metal that are seen head-on.
const DIELECTRIC: f32 = 0.04;
/// The least α: facets closer to a mirror would show the rounding of normals.
const LEAST_ALPHA: f32 = 1e-3;
/// How much less a rough surface scatters than a smooth one, so that it does not reflect more light than it receives.
const LOSS: f32 = 1.0 - 1.0 / 1.51;

impl Gloss {
    /// Adds the facets of lanes. Their base colour, in `albedo`, becomes the part that is scattered below the surface.
    #[inline(never)]
    pub(super) fn add_facets<S: Simd>(
        &mut self,
        simd: S,
        material: &Material,
        lanes: u64,
        albedo: &mut Colours,
    ) {
        self.facets |= lanes;
        simd.vectorize(
            #[inline(always)]
            || {
                let own = [material.roughness, material.metalness].map(|own| f32x16::splat(simd, own));
                for row in 0..ROWS {
                    let mine = lanes_in(simd, lanes, row);
                    self.set_facets(simd, material, own, (mine, row), albedo);
                }
            },
        );
    }

    /// Sets the facets of the lanes of a row.
    #[inline(always)]
    fn set_facets<S: Simd>(
        &mut self,
        simd: S,
        material: &Material,
        [roughness, metalness]: [f32x16<S>; 2],
        (mine, row): (mask32x16<S>, usize),
        albedo: &mut Colours,
    ) {
        for channel in 0..3 {
            let base = load_row(simd, &albedo[channel], row);
            let head_on = (base - DIELECTRIC) * metalness + DIELECTRIC;
            store_where(simd, mine, head_on, &mut self.specular[channel], row);
            let scattered = base * (f32x16::splat(simd, 1.0) - metalness);
            store_where(simd, mine, scattered, &mut albedo[channel], row);
            let factor = f32x16::splat(simd, material.specular[channel]);
            store_where(simd, mine, factor, &mut self.factor[channel], row);
        }
        store_where(simd, mine, roughness, &mut self.shininess, row);
    }
}

impl Shader {
    /// [`Gloss::add_facets`] with a roughness and a metalness for each pixel, from the material's map.
    #[inline(never)]
    pub(super) fn add_mapped_facets<S: Simd>(
        &mut self,
        simd: S,
        scene: &Scene<'_>,
        material: &Material,
        footprints: &[Footprint<S>; ROWS],
        lanes: u64,
    ) {
        let Self { gloss, albedo, maps, .. } = self;
        gloss.facets |= lanes;
        maps.turn_to(scene, material.pbr_map);
        simd.vectorize(
            #[inline(always)]
            || {
                for row in 0..ROWS {
                    let mine = lanes_in(simd, lanes, row);
                    if !mine.any_true() {
                        continue;
                    }
                    let texel = maps.sample(simd, scene, &footprints[row], mine, Reading::Numbers);
                    let own = [texel[1] * material.roughness, texel[2] * material.metalness];
                    gloss.set_facets(simd, material, own, (mine, row), albedo);
                }
            },
        );
    }
}

/// Turns the light that [`add_light`](super::lamp) has added to lanes with facets, as to any other surface, into what
/// these scatter, and adds their highlights. `brightness` is the light of the lamp that reaches each surface.
#[inline(never)]
pub(super) fn reflect<S: Simd>(
    simd: S,
    (light, position): (&Light, DVec3),
    (tile, normal): (&Tile, &[Lanes<f32>; 3]),
    (gloss, albedo, brightness): (&Gloss, &Colours, &Lanes<f32>),
    lit: u64,
    colours: &mut Colours,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
            for row in 0..ROWS {
                let mine = lanes_in(simd, lit & gloss.facets, row);
                let mut to_lamp = [zero; 3];
                let point = row_of(simd, &tile.point, row);
                if light.form() == Form::Directional {
                    for axis in 0..3 {
                        to_lamp[axis] = f32x16::splat(simd, -light.direction[axis] as f32);
                    }
                } else {
                    let ray = Ray::to(simd, light, position, point);
                    for axis in 0..3 {
                        to_lamp[axis] = ray.way[axis] * ray.per_distance;
                    }
                }
                let per_range = one / dot(&point, &point).sqrt();
                let (mut to_sensor, mut middle) = ([zero; 3], [zero; 3]);
                for axis in 0..3 {
                    to_sensor[axis] = point[axis] * per_range * -1.0;
                    middle[axis] = to_lamp[axis] + to_sensor[axis];
                }
                let normal = row_of(simd, normal, row);
                let squared = dot(&middle, &middle);
                let lamp_cos = share(simd, dot(&normal, &to_lamp));
                let sensor_cos = share(simd, dot(&normal, &to_sensor));
                let middle_cos = share(simd, dot(&to_sensor, &middle) / squared.sqrt());

                // The square of the sine between normal and middle, from their cross product: 1 − cos² would have the
                // rounding of 1.
                let across = cross(&normal, &middle);
                let sin2 = dot(&across, &across) / squared;
                let roughness = load_row(simd, &gloss.shininess, row);
                let alpha = roughness * roughness;
                let alpha = alpha.simd_gt(LEAST_ALPHA).select(alpha, f32x16::splat(simd, LEAST_ALPHA));
                let alpha2 = alpha * alpha;
                let rest = one - alpha2;
                let spread = alpha2 + rest * sin2;
                let facing = alpha2 / (spread * spread);
                let by_sensor = lamp_cos * (alpha2 + rest * (sensor_cos * sensor_cos)).sqrt();
                let by_lamp = sensor_cos * (alpha2 + rest * (lamp_cos * lamp_cos)).sqrt();
                let highlight = facing / ((by_sensor + by_lamp) * 2.0 + 1e-6);

                let grazing = fifth(one - middle_cos);
                let mut most = zero;
                let mut mirrored = [zero; 3];
                for channel in 0..3 {
                    let head_on = load_row(simd, &gloss.specular[channel], row);
                    let whole = head_on + (one - head_on) * grazing;
                    most = whole.simd_gt(most).select(whole, most);
                    mirrored[channel] = whole;
                }
                let bend = roughness * (middle_cos * middle_cos * 2.0 + 0.5) - 1.0;
                let at_lamp = bend * fifth(one - lamp_cos) + 1.0;
                let at_sensor = bend * fifth(one - sensor_cos) + 1.0;
                let scattered = (one - most) * (one - roughness * LOSS) * (at_lamp * at_sensor);

                let brightness = load_row(simd, brightness, row);
                for channel in 0..3 {
                    let albedo = load_row(simd, &albedo[channel], row) * light.diffuse[channel];
                    let factor = load_row(simd, &gloss.factor[channel], row) * light.specular[channel];
                    let change = albedo * (scattered - 1.0) + mirrored[channel] * highlight * factor;
                    let added = mine.select(change * brightness, zero);
                    store_row(load_row(simd, &colours[channel], row) + added, &mut colours[channel], row);
                }
            }
        },
    );
}

/// A number between 0 and 1; 0 for NaN.
#[inline(always)]
fn share<S: Simd>(simd: S, value: f32x16<S>) -> f32x16<S> {
    let positive = value.simd_gt(0.0).select(value, f32x16::splat(simd, 0.0));
    positive.simd_lt(1.0).select(positive, f32x16::splat(simd, 1.0))
}

#[inline(always)]
fn dot<S: Simd>(a: &[f32x16<S>; 3], b: &[f32x16<S>; 3]) -> f32x16<S> {
    (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
}

#[inline(always)]
fn cross<S: Simd>(a: &[f32x16<S>; 3], b: &[f32x16<S>; 3]) -> [f32x16<S>; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
fn fifth<S: Simd>(x: f32x16<S>) -> f32x16<S> {
    let square = x * x;
    square * square * x
}
