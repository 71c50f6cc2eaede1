//! What one lamp adds, with its shadows.

use super::Lit;
use crate::scene::{LIGHT_DIRECTIONAL, LIGHT_SPOT, Light};
use crate::simd::{LANES, Lanes};
use crate::trace::frame::Frame;
use crate::trace::packet::{Faces, MISS, Packet};
use crate::trace::traverse::occluded;
use fearless_simd::Simd;
use glam::DVec3;

/// Shadow rays stop this part of the way before the surface that they are to light, and parallel ones start
/// this many metres above it.
const SHADOW_BIAS: f64 = 1e-6;

/// Adds the lamp's light to the colours of the lanes that it reaches.
pub(super) fn add<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    light: &Light,
    lit: &Lit,
    hit: &Lanes<u32>,
    colours: &mut Lanes<[f32; 3]>,
) {
    let position = frame.point_in_frame(light.position);
    let axis = DVec3::from_array(light.direction);
    let parallel = light.kind == LIGHT_DIRECTIONAL;

    // Rays from the lamp to the surfaces, so that they share its origin and stay together.
    let mut rays = Packet::at_frame_origin(if parallel { SHADOW_BIAS } else { 0.0 });
    rays.shared_origin = !parallel;
    let mut brightness = [0.0_f32; LANES];
    let mut any = false;
    for lane in 0..LANES {
        if hit[lane] == MISS {
            continue;
        }
        let (origin, direction, t_max) = if parallel {
            (lit.point[lane], -axis, f64::INFINITY)
        } else {
            (position, lit.point[lane] - position, 1.0 - SHADOW_BIAS)
        };
        // For parallel light the ray leaves the surface, for a lamp it arrives there.
        let towards = if parallel { direction } else { -direction };
        let distance = towards.length();
        let facing = lit.normal[lane].dot(towards) / distance;
        let gain = if parallel { 1.0 } else { attenuation(light, distance as f32) };
        let gain = gain
            * if light.kind == LIGHT_SPOT {
                cone(light, (axis.dot(-towards) / distance) as f32)
            } else {
                1.0
            };
        // A NaN, from a lamp that lies in the surface, lights nothing.
        if facing.is_nan() || facing <= 0.0 || gain <= 0.0 {
            continue;
        }
        any = true;
        brightness[lane] = facing as f32 * gain;
        for axis in 0..3 {
            rays.origin[axis][lane] = origin[axis];
            rays.direction[axis][lane] = direction[axis];
        }
        rays.t[lane] = t_max;
    }
    if !any {
        return;
    }
    if rays.shared_origin {
        // Lanes that take no part too: the packet's origin is read from lane 0.
        for axis in 0..3 {
            rays.origin[axis] = [position[axis]; LANES];
        }
    }
    if light.cast_shadows != 0 {
        // Front faces only: the bulb around a lamp does not keep its light in.
        occluded(simd, frame, &mut rays, if parallel { Faces::Both } else { Faces::Front });
    }
    for lane in 0..LANES {
        if rays.placed[lane] == MISS {
            for channel in 0..3 {
                colours[lane][channel] +=
                    lit.albedo[lane][channel] * light.diffuse[channel] * brightness[lane];
            }
        }
    }
}

fn attenuation(light: &Light, distance: f32) -> f32 {
    if distance > light.range_m {
        return 0.0;
    }
    let [constant, linear, quadratic] = light.attenuation;
    let loss = constant + linear * distance + quadratic * (distance * distance);
    if loss > 1.0 { 1.0 / loss } else { 1.0 }
}

/// Full inside the inner cone, none outside the outer, linear in the cosine between.
fn cone(light: &Light, cos_angle: f32) -> f32 {
    if cos_angle >= light.cos_inner {
        1.0
    } else if cos_angle <= light.cos_outer {
        0.0
    } else {
        (cos_angle - light.cos_outer) / (light.cos_inner - light.cos_outer)
    }
}
