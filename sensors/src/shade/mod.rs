//! The colour of what a camera sees.
//!
//! colour = emissive + texture · (ambient · ambient light + Σ diffuse · lamp · max(0, n·l) · attenuation ·
//! shadow), in the space of the files' colours without gamma, as Gazebo classic renders.

mod lamp;
mod texture;

use crate::scene::NO_TEXTURE;
use crate::simd::{LANES, Lanes};
use crate::trace::frame::Frame;
use crate::trace::packet::{MISS, Packet};
use crate::trace::surface::surface_at;
use fearless_simd::Simd;
use glam::DVec3;

/// How the direction changes from one pixel to the next, along a row and down a column.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PixelSteps {
    pub(crate) right: DVec3,
    pub(crate) down: DVec3,
}

/// What lamps need to know of each lane's surface.
pub(crate) struct Lit {
    pub(crate) point: Lanes<DVec3>,
    pub(crate) normal: Lanes<DVec3>,
    /// Diffuse colour times texture; black where nothing was hit.
    pub(crate) albedo: Lanes<[f32; 3]>,
}

/// Colours of a traced packet; the background where nothing was hit.
pub(crate) fn shade<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    packet: &Packet,
    steps: &PixelSteps,
    colours: &mut Lanes<[f32; 3]>,
) {
    let scene = &frame.scene;
    let ambient_light = scene.environment.ambient;
    let mut lit =
        Lit { point: [DVec3::ZERO; LANES], normal: [DVec3::ZERO; LANES], albedo: [[0.0; 3]; LANES] };
    let mut any_hit = false;
    for lane in 0..LANES {
        if packet.placed[lane] == MISS {
            colours[lane] = scene.environment.background;
            continue;
        }
        any_hit = true;
        let material = &scene.materials[frame.instance(packet.placed[lane]).material as usize];
        let textured = material.texture != NO_TEXTURE;
        let surface = surface_at(frame, packet, lane, textured);
        let mut texture = [1.0_f32; 3];
        if textured {
            let direction = packet.direction_of(lane);
            let away = surface.normal.dot(direction);
            // The pixel's footprint: how far the hit moves on the surface's plane from one pixel to the next
            // (Igehy 1999, "Tracing ray differentials").
            let footprint = |step: DVec3| {
                let moved = (step - direction * (surface.normal.dot(step) / away)) * packet.t[lane];
                surface.uv_gradient.map(|gradient| gradient.dot(moved))
            };
            texture = texture::sample(
                scene,
                material.texture,
                surface.uv,
                [footprint(steps.right), footprint(steps.down)],
                material.texture_repeat,
            );
        }
        lit.point[lane] = packet.point(lane);
        lit.normal[lane] = surface.normal;
        for channel in 0..3 {
            lit.albedo[lane][channel] = material.diffuse[channel] * texture[channel];
            colours[lane][channel] = material.emissive[channel]
                + material.ambient[channel] * ambient_light[channel] * texture[channel];
        }
    }
    if any_hit {
        for light in scene.lights {
            lamp::add(simd, frame, light, &lit, &packet.placed, colours);
        }
    }
}
