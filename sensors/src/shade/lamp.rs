//! What one lamp adds, with its shadows.

use super::{Colours, Shader};
use crate::scene::{LIGHT_DIRECTIONAL, LIGHT_SPOT, Light};
use crate::simd::{LANES, Lanes, sqrt_f32};
use crate::trace::packet::{Faces, MISS, Packet};
use crate::trace::shadow::occluded;
use crate::trace::surface::Surfaces;
use crate::trace::view::View;
use fearless_simd::Simd;

/// Shadow rays stop this part of the way before the surface that they are to light, and parallel ones start
/// this many metres above it.
const SHADOW_BIAS: f64 = 1e-6;

impl Shader {
    /// Adds the lamp's light to the colours of the lanes that it reaches; `hit` names their instances.
    pub(super) fn add_lamp<S: Simd>(
        &mut self,
        simd: S,
        view: &View<'_>,
        light: &Light,
        hit: &Lanes<u32>,
        colours: &mut Colours,
    ) {
        let Self { surfaces, albedo, shadow_rays, .. } = self;
        let parallel = light.kind == LIGHT_DIRECTIONAL;
        let mut brightness = [0.0; LANES];
        let left_out = simd.vectorize(
            #[inline(always)]
            || {
                match light.kind {
                    LIGHT_DIRECTIONAL => shine_parallel(light, surfaces, &mut brightness),
                    LIGHT_SPOT => shine_from::<true>(view, light, surfaces, &mut brightness),
                    _ => shine_from::<false>(view, light, surfaces, &mut brightness),
                }
                let mut brightest = 0.0_f32;
                for lane in 0..LANES {
                    let one = brightness[lane];
                    brightest = if one > brightest { one } else { brightest };
                }
                if brightest == 0.0 {
                    return None;
                }
                if light.cast_shadows == 0 {
                    return Some(MISS);
                }
                if parallel {
                    aim_against(light, surfaces, &brightness, shadow_rays);
                } else {
                    aim_from(view, light, surfaces, &brightness, shadow_rays);
                }
                Some(only_convex(view, &brightness, hit))
            },
        );
        let Some(left_out) = left_out else { return };
        if light.cast_shadows != 0 {
            // Front faces only: the bulb around a lamp does not keep its light in.
            let (faces, t_max) = if parallel { (Faces::Both, f32::INFINITY) } else { (Faces::Front, 1.0) };
            occluded(simd, view, shadow_rays, faces, t_max, left_out);
        }
        simd.vectorize(
            #[inline(always)]
            || {
                if light.cast_shadows != 0 {
                    for lane in 0..LANES {
                        let lit = shadow_rays.placed[lane] == MISS;
                        brightness[lane] = if lit { brightness[lane] } else { 0.0 };
                    }
                }
                for channel in 0..3 {
                    let diffuse = light.diffuse[channel];
                    for lane in 0..LANES {
                        colours[channel][lane] += albedo[channel][lane] * diffuse * brightness[lane];
                    }
                }
            },
        );
    }
}

/// The convex instance that all lit lanes lie on, if so: it cannot stand in its own light.
#[inline(always)]
fn only_convex(view: &View<'_>, brightness: &Lanes<f32>, hit: &Lanes<u32>) -> u32 {
    // All are the same where the least and the greatest are.
    let (mut least, mut greatest) = (MISS, 0);
    for lane in 0..LANES {
        let lit = brightness[lane] > 0.0;
        least = least.min(if lit { hit[lane] } else { MISS });
        greatest = greatest.max(if lit { hit[lane] } else { 0 });
    }
    if least == greatest && view.instance(least).is_convex() { least } else { MISS }
}

/// Light from a point, in a cone if it is a spot.
#[inline(always)]
fn shine_from<const SPOT: bool>(
    view: &View<'_>,
    light: &Light,
    surfaces: &Surfaces,
    brightness: &mut Lanes<f32>,
) {
    let position = view.point_in_frame(light.position);
    let axis = light.direction.map(|x| x as f32);
    let Surfaces { point, normal, .. } = surfaces;
    for lane in 0..LANES {
        let x = (position.x - point[0][lane]) as f32;
        let y = (position.y - point[1][lane]) as f32;
        let z = (position.z - point[2][lane]) as f32;
        let distance = sqrt_f32(x * x + y * y + z * z);
        let facing = (normal[0][lane] * x + normal[1][lane] * y + normal[2][lane] * z) / distance;
        let mut gain = attenuation(light, distance);
        if SPOT {
            gain *= cone(light, -(axis[0] * x + axis[1] * y + axis[2] * z) / distance);
        }
        // A NaN, from a lamp that lies in the surface, lights nothing.
        brightness[lane] = if facing > 0.0 && gain > 0.0 { facing * gain } else { 0.0 };
    }
}

/// The same light everywhere.
#[inline(always)]
fn shine_parallel(light: &Light, surfaces: &Surfaces, brightness: &mut Lanes<f32>) {
    let [x, y, z] = light.direction.map(|x| x as f32);
    let normal = &surfaces.normal;
    for lane in 0..LANES {
        let facing = -(normal[0][lane] * x + normal[1][lane] * y + normal[2][lane] * z);
        brightness[lane] = if facing > 0.0 { facing } else { 0.0 };
    }
}

#[inline(always)]
fn attenuation(light: &Light, distance: f32) -> f32 {
    let [constant, linear, quadratic] = light.attenuation;
    let loss = constant + linear * distance + quadratic * (distance * distance);
    let gain = 1.0 / if loss > 1.0 { loss } else { 1.0 };
    if distance > light.range_m { 0.0 } else { gain }
}

/// Full inside the inner cone, none outside the outer, linear in the cosine between.
#[inline(always)]
fn cone(light: &Light, cos_angle: f32) -> f32 {
    let between = (cos_angle - light.cos_outer) / (light.cos_inner - light.cos_outer);
    if cos_angle >= light.cos_inner {
        1.0
    } else if cos_angle <= light.cos_outer {
        0.0
    } else {
        between
    }
}

/// Shadow rays from the lamp to the lit surfaces, so that they share its origin and stay together.
#[inline(always)]
fn aim_from(view: &View<'_>, light: &Light, surfaces: &Surfaces, brightness: &Lanes<f32>, rays: &mut Packet) {
    let position = view.point_in_frame(light.position);
    for axis in 0..3 {
        rays.origin[axis] = [position[axis]; LANES];
        for lane in 0..LANES {
            rays.direction[axis][lane] = surfaces.point[axis][lane] - position[axis];
        }
    }
    rays.shared_origin = true;
    aim(0.0, 1.0 - SHADOW_BIAS, brightness, rays);
}

/// Shadow rays from the lit surfaces against the direction of parallel light.
#[inline(always)]
fn aim_against(light: &Light, surfaces: &Surfaces, brightness: &Lanes<f32>, rays: &mut Packet) {
    rays.origin = surfaces.point;
    rays.direction = light.direction.map(|component| [-component; LANES]);
    rays.shared_origin = false;
    aim(SHADOW_BIAS, f64::INFINITY, brightness, rays);
}

/// Only lit lanes take part.
#[inline(always)]
fn aim(t_min: f64, t_max: f64, brightness: &Lanes<f32>, rays: &mut Packet) {
    rays.t_min = t_min;
    rays.placed = [MISS; LANES];
    for lane in 0..LANES {
        rays.t[lane] = if brightness[lane] > 0.0 { t_max } else { f64::NEG_INFINITY };
    }
}
