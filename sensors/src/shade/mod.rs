//! The colour of what a camera sees.
//!
//! colour = emissive + texture · (ambient · ambient light + Σ diffuse · lamp · max(0, n·l) · attenuation ·
//! shadow), in the space of the files' colours without gamma, as Gazebo classic renders.

mod lamp;
mod texture;

use crate::scene::{Material, NO_TEXTURE};
use crate::simd::{LANES, Lanes};
use crate::trace::packet::{MISS, Packet};
use crate::trace::surface::{PixelSteps, Surfaces};
use crate::trace::view::View;
use fearless_simd::Simd;

/// A colour per lane: all reds, all greens, all blues.
pub(crate) type Colours = [Lanes<f32>; 3];

/// What shading a packet works on; kept from packet to packet.
pub(crate) struct Shader {
    surfaces: Surfaces,
    /// Of one instance; 1 without a texture.
    texture: Colours,
    /// Diffuse colour times texture; black where nothing was hit.
    albedo: Colours,
    /// From a lamp.
    shadow_rays: Packet,
}

impl Shader {
    pub(crate) const fn new() -> Self {
        Self {
            surfaces: Surfaces::new(),
            texture: [[1.0; LANES]; 3],
            albedo: [[0.0; LANES]; 3],
            shadow_rays: Packet::new(),
        }
    }

    /// Colours of a traced packet; the background where nothing was hit.
    pub(crate) fn shade<S: Simd>(
        &mut self,
        simd: S,
        view: &View<'_>,
        packet: &Packet,
        steps: &PixelSteps,
        colours: &mut Colours,
    ) {
        let scene = &view.scene;
        let Self { surfaces, texture, albedo, .. } = self;
        *colours = scene.environment.background.map(|background| [background; LANES]);
        let mut rest = lanes_where(simd, &packet.placed, |placed| placed != MISS);
        if rest == 0 {
            return;
        }
        simd.vectorize(
            #[inline(always)]
            || {
                surfaces.start(packet);
                *albedo = [[0.0; LANES]; 3];
            },
        );
        // One instance after the other, all its lanes at once.
        while rest != 0 {
            let placed = packet.placed[rest.trailing_zeros() as usize];
            let lanes = lanes_where(simd, &packet.placed, |other| other == placed);
            rest &= !lanes;
            let material = &scene.materials[view.instance(placed).material as usize];
            let textured = material.texture != NO_TEXTURE;
            simd.vectorize(
                #[inline(always)]
                || {
                    surfaces.add(view, packet, placed, textured.then_some(steps));
                    if textured {
                        texture::sample_lanes(simd, scene, material, surfaces, lanes, texture);
                    } else {
                        *texture = [[1.0; LANES]; 3];
                    }
                    let ambient = scene.environment.ambient;
                    paint(material, ambient, &packet.placed, placed, texture, albedo, colours);
                },
            );
        }
        for light in scene.lights {
            self.add_lamp(simd, view, light, &packet.placed, colours);
        }
    }
}

/// A bit for each lane whose value passes the test.
#[inline(always)]
fn lanes_where<S: Simd>(simd: S, values: &Lanes<u32>, test: impl Fn(u32) -> bool) -> u64 {
    simd.vectorize(
        #[inline(always)]
        || {
            let mut lanes = 0;
            for lane in 0..LANES {
                lanes |= u64::from(test(values[lane])) << lane;
            }
            lanes
        },
    )
}

/// The part of the colours that needs no lamp, on the lanes that have hit `placed`.
#[inline(always)]
fn paint(
    material: &Material,
    ambient_light: [f32; 3],
    hit: &Lanes<u32>,
    placed: u32,
    texture: &Colours,
    albedo: &mut Colours,
    colours: &mut Colours,
) {
    for channel in 0..3 {
        let ambient = material.ambient[channel] * ambient_light[channel];
        let (diffuse, emissive) = (material.diffuse[channel], material.emissive[channel]);
        for lane in 0..LANES {
            let mine = hit[lane] == placed;
            let texture = texture[channel][lane];
            let colour = emissive + ambient * texture;
            albedo[channel][lane] = if mine { diffuse * texture } else { albedo[channel][lane] };
            colours[channel][lane] = if mine { colour } else { colours[channel][lane] };
        }
    }
}
