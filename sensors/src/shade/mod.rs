//! The colour of what a camera sees.
//!
//! colour = emissive + texture · (ambient · ambient light + Σ diffuse · lamp · max(0, n·l) · attenuation ·
//! shadow), in the space of the files' colours without gamma, as Gazebo classic renders.
//!
//! A tile sees few instances. One after the other gives its lanes their normals and their albedo, sixteen at a time;
//! then come the lamps, for all lanes at once.

mod face;
mod lamp;
mod lift;
mod occluders;
mod shadow;
mod surface;
mod texture;
pub(crate) mod tile;

use crate::scene::{Kind, NO_TEXTURE};
use crate::simd::{LANES, Lanes, WIDTH, load_row, store_row};
use crate::trace::packet::MISS;
use crate::trace::view::View;
use face::{Face, faces};
use fearless_simd::{Bytes, Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16, u32x16};
use shadow::Shadows;
use surface::{Footprint, Surfaces};
use texture::Sampler;
use tile::{Steps, Tile};

/// Rows of a tile.
const ROWS: usize = LANES / WIDTH;

/// A colour per lane: all reds, all greens, all blues.
pub(crate) type Colours = [Lanes<f32>; 3];

/// What shading a tile works on; kept from tile to tile.
pub(crate) struct Shader {
    surfaces: Surfaces,
    /// The flat face met last: instance and number, and what is known of it.
    face_of: (u32, u32),
    face: Face,
    sampler: Sampler,
    /// Diffuse colour times texture; black where nothing was hit.
    albedo: Colours,
    shadows: Shadows,
    /// What is seen by each lane, if that is kept: [`Shader::seen`].
    seen: Option<Lanes<u32>>,
}

impl Shader {
    pub(crate) const fn new() -> Self {
        Self {
            surfaces: Surfaces::new(),
            face_of: (MISS, 0),
            face: Face::NONE,
            sampler: Sampler::new(),
            albedo: [[0.0; LANES]; 3],
            shadows: Shadows::new(),
            seen: None,
        }
    }

    /// A shader that also tells what is [seen](Shader::seen).
    pub(crate) const fn telling() -> Self {
        Self { seen: Some([0; LANES]), ..Self::new() }
    }

    /// Of the tile shaded last, a number of seven bits for what each lane shows. It is another on each instance, face and
    /// side of a shadow, but for chance; on one surface under the same lamps it stays, or changes in places.
    pub(crate) fn seen(&self) -> Option<&Lanes<u32>> {
        self.seen.as_ref()
    }

    /// Colours of a traced tile; the background where nothing was hit.
    pub(crate) fn shade<S: Simd>(
        &mut self,
        simd: S,
        view: &View<'_>,
        tile: &Tile,
        steps: &Steps,
        colours: &mut Colours,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let all = !0;
                if tile.hits != all {
                    for channel in 0..3 {
                        colours[channel] = [view.scene.environment.background[channel]; LANES];
                    }
                    self.albedo = [[0.0; LANES]; 3];
                    self.surfaces.normal = [[0.0; LANES]; 3];
                }
                let mut rest = tile.hits;
                while rest != 0 {
                    let placed = tile.placed[rest.trailing_zeros() as usize % LANES];
                    let lanes = tile.lanes_of(simd, placed) & rest;
                    rest &= !lanes;
                    self.add_instance(simd, view, tile, steps, (placed, lanes), colours);
                }
                if let Some(seen) = &mut self.seen {
                    tell_surfaces(simd, tile, &self.surfaces, seen);
                }
            },
        );
        if tile.hits != 0 {
            for (number, light) in view.scene.lights.iter().enumerate() {
                self.add_lamp(simd, view, (number, light), tile, colours);
            }
        }
    }

    /// Normals and albedo of the lanes that have hit an instance, and the part of their colours that needs no lamp.
    #[inline(always)]
    fn add_instance<S: Simd>(
        &mut self,
        simd: S,
        view: &View<'_>,
        tile: &Tile,
        steps: &Steps,
        (placed, lanes): (u32, u64),
        colours: &mut Colours,
    ) {
        let scene = &view.scene;
        let instance = view.instance(placed);
        let material = &scene.materials[instance.material as usize];
        let textured = material.texture != NO_TEXTURE;
        let repeat = material.texture_repeat;

        // Step 1: normals, and what the pixels cover of the texture.
        let mut footprints = [Footprint::nothing(simd); ROWS];
        if let Kind::Solid(solid) = instance.kind()
            && solid.has_flat_faces()
        {
            let faces = faces(simd, view, tile, (placed, solid), lanes);
            let mut rest = lanes;
            while rest != 0 {
                let number = faces[rest.trailing_zeros() as usize % LANES];
                if self.face_of != (placed, number) {
                    self.face_of = (placed, number);
                    self.face =
                        Face::new((instance, solid), &view.placed[placed as usize], number, repeat, steps);
                }
                let face = &self.face;
                for row in 0..ROWS {
                    let found = u32x16::load_array_ref(simd, &faces.as_chunks().0[row]);
                    let mine = lanes_in(simd, rest, row) & found.simd_eq(number);
                    rest &= !(mine.to_bitmask() << (row * WIDTH));
                    for axis in 0..3 {
                        let normal = f32x16::splat(simd, face.normal[axis]);
                        store_where(simd, mine, normal, &mut self.surfaces.normal[axis], row);
                    }
                    if textured && mine.any_true() {
                        let footprint = if steps.is_some() {
                            face.footprint::<S, true>(simd, tile, row)
                        } else {
                            face.footprint::<S, false>(simd, tile, row)
                        };
                        footprints[row].take(mine, &footprint);
                    }
                }
            }
        } else {
            self.surfaces.add(view, tile, placed, textured.then_some(repeat), steps);
            for row in 0..ROWS {
                footprints[row] = self.surfaces.footprint(simd, row);
            }
        }

        // Step 2: colours.
        if textured {
            self.sampler.turn_to(scene, material.texture);
        }
        for row in 0..ROWS {
            let mine = lanes_in(simd, lanes, row);
            if !mine.any_true() {
                continue;
            }
            let mut texture = [f32x16::splat(simd, 1.0); 3];
            if textured {
                texture = self.sampler.sample(simd, scene, &footprints[row], mine);
            }
            for channel in 0..3 {
                let ambient = material.ambient[channel] * scene.environment.ambient[channel];
                let colour = texture[channel] * ambient + material.emissive[channel];
                store_where(simd, mine, colour, &mut colours[channel], row);
                let albedo = texture[channel] * material.diffuse[channel];
                store_where(simd, mine, albedo, &mut self.albedo[channel], row);
            }
        }
    }
}

/// Numbers for the surfaces of a tile: from the instance, the normal, and how far the plane through the point with that
/// normal is from the sensor, the last two in coarse steps.
#[inline(always)]
fn tell_surfaces<S: Simd>(simd: S, tile: &Tile, surfaces: &Surfaces, seen: &mut Lanes<u32>) {
    for row in 0..ROWS {
        let zero = f32x16::splat(simd, 0.0);
        let mut offset = zero;
        let mut number = u32x16::load_array_ref(simd, &tile.placed.as_chunks().0[row]);
        for axis in 0..3 {
            let normal = load_row(simd, &surfaces.normal[axis], row);
            offset += normal * load_row(simd, &tile.point[axis], row);
            let step = normal * 2.3 + 2.5;
            // What is not a number becomes one.
            let step = step.simd_gt(zero).select(step, zero);
            number = number * 5 + step.to_int::<u32x16<S>>();
        }
        // Steps of a quarter, whose bounds lie at no round number of metres.
        let steps: u32x16<S> = (offset * 1.37).bitcast();
        let mixed = (number * 0x9e37_79b1 + (steps >> 21)) * 0x85eb_ca6b;
        (mixed >> 25).store_array(&mut seen.as_chunks_mut().0[row]);
    }
}

/// Those lanes of a row whose bits are set.
#[inline(always)]
fn lanes_in<S: Simd>(simd: S, lanes: u64, row: usize) -> mask32x16<S> {
    simd.from_bitmask_mask32x16(lanes >> (row * WIDTH) & 0xffff)
}

/// Puts values into those lanes of a row that are `mine`.
#[inline(always)]
fn store_where<S: Simd>(simd: S, mine: mask32x16<S>, values: f32x16<S>, lanes: &mut Lanes<f32>, row: usize) {
    store_row(mine.select(values, load_row(simd, lanes, row)), lanes, row);
}
