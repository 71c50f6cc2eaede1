//! Shading: the colours that a camera sees.
//!
//! colour = emissive + texture · (ambient · ambient light + Σ diffuse · lamp · max(0, n·l) · attenuation · shadow) + Σ
//! specular · lamp's specular · (n·h)^shininess · attenuation · shadow. Materials with a [`Pbr`](crate::scene::Pbr) have
//! the formula there instead. It is computed directly on the given colours, without gamma, as in Gazebo classic, unless
//! the scene's colours are sRGB. [`modulation`] has what differs for textures that are multiplied by all light.
//!
//! A tile sees few instances. For one instance after the other, its lanes get their normals and their albedo, sixteen
//! at a time; then the lamps are added for all lanes at once.

mod air;
mod axes;
mod bumps;
mod cube;
mod face;
mod facets;
mod gloss;
mod glow;
mod lamp;
mod lamp_ray;
mod modulation;
mod occluders;
mod opacity;
mod power;
mod ray_offset;
mod seen;
mod shadow;
mod smooth;
mod surface;
mod texels;
mod texture;
pub(crate) mod tile;
pub(crate) mod transparency;
pub(crate) mod uniform;

use crate::scene::{ColourSpace, Kind, Material, NO_TEXTURE, Scene, Sky};
use crate::simd::{LANES, Lanes, WIDTH, load_row, store_row};
use crate::srgb;
use crate::trace::packet::{Faces, Packet};
use crate::trace::placed::view::View;
use crate::trace::shapes::LocalRays;
use bumps::Bumps;
use face::KnownFaces;
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, mask32x16};
use gloss::Gloss;
use seen::tell_surfaces;
use shadow::Shadows;
use surface::{Footprint, Surfaces};
use texels::Reading;
use texture::Sampler;
use tile::{Steps, Tile};

/// Number of rows of sixteen lanes in a tile.
const ROWS: usize = LANES / WIDTH;

/// A colour per lane: all reds, all greens, all blues.
pub(crate) type Colours = [Lanes<f32>; 3];

/// The state of shading a tile, reused from tile to tile.
pub(crate) struct Shader {
    surfaces: Surfaces,
    known_faces: KnownFaces,
    sampler: Sampler,
    /// Diffuse colour multiplied by the texture; black where nothing was hit.
    albedo: Colours,
    gloss: Gloss,
    /// Reads the maps of materials, all textures but that of their colour, and cube textures.
    maps: Sampler,
    bumps: Bumps,
    /// The lanes whose texture is multiplied by all light, as one bit each; see [`modulation`].
    modulated: u64,
    /// Opacity of the surface in each lane, for the lanes in [`Shader::clear`].
    coverage: Lanes<f32>,
    /// The lanes through which something may be seen, as one bit each.
    clear: u64,
    shadows: Shadows,
    /// The sides of surfaces that are visible.
    faces: Faces,
    /// The lanes that see the inside of a surface, as one bit each. Their normals are flipped towards the sensor.
    back: u64,
    /// Fingerprints of what each lane sees, if they are recorded; see [`Shader::seen`].
    seen: Option<Lanes<u32>>,
}

impl Shader {
    /// A shader that does not record what is [seen](Shader::seen). It is a constant because the return value of a
    /// function that is then moved into a struct takes twice its size on the stack.
    pub(crate) const NEW: Self = Self {
        surfaces: Surfaces::new(),
        known_faces: KnownFaces::new(),
        sampler: Sampler::new(),
        albedo: [[0.0; LANES]; 3],
        gloss: Gloss::NONE,
        maps: Sampler::new(),
        bumps: Bumps::new(),
        modulated: 0,
        coverage: [1.0; LANES],
        clear: 0,
        shadows: Shadows::new(),
        faces: Faces::Both,
        back: 0,
        seen: None,
    };

    /// Sets which sides of surfaces are visible, and whether fingerprints of what is seen are recorded.
    pub(crate) fn set(&mut self, faces: Faces, tells: bool) {
        self.faces = faces;
        self.seen = tells.then_some([0; LANES]);
    }

    /// Returns scratch memory for rays. Nothing in it is kept from one call to the next.
    pub(crate) fn rays(&mut self) -> (&mut Packet, &mut LocalRays) {
        self.shadows.rays()
    }

    /// For the tile shaded last, a seven-bit fingerprint of what each lane shows. It differs for each instance, face
    /// and side of a shadow, except by chance. On one surface under the same lamps it is constant, or changes in
    /// places.
    pub(crate) fn seen(&self) -> Option<&Lanes<u32>> {
        self.seen.as_ref()
    }

    /// Returns true if something may be visible behind the tile shaded last.
    pub(crate) fn is_clear(&self) -> bool {
        self.clear != 0
    }

    /// Computes the colours of a traced tile, with the background where nothing was hit. What lies behind clear
    /// surfaces is added by [`transparency`](mod@transparency).
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
                    let background = light_of(view.scene.environment.background, view.scene.colour_space);
                    for channel in 0..3 {
                        colours[channel] = [background[channel]; LANES];
                    }
                    self.albedo = [[0.0; LANES]; 3];
                    self.surfaces.normal = [[0.0; LANES]; 3];
                }
                (self.gloss.lanes, self.gloss.facets, self.bumps.lanes, self.clear) = (0, 0, 0, 0);
                self.modulated = 0;
                (self.surfaces.smooth, self.surfaces.smooth_away) = (0, 0);
                let mut rest = tile.hits;
                while rest != 0 {
                    let placed = tile.placed[rest.trailing_zeros() as usize % LANES];
                    let lanes = tile.lanes_of(simd, placed) & rest;
                    rest &= !lanes;
                    let lanes = (placed, lanes);
                    if view.scene.materials[view.instance(placed).material as usize].has_cube() {
                        self.add_cube_instance(simd, view, tile, steps, lanes, colours);
                    } else {
                        self.add_instance::<S, false>(simd, view, tile, steps, lanes, colours);
                    }
                }
                if self.faces == Faces::Both {
                    if self.surfaces.smooth == 0 {
                        self.turn_to_sensor::<S, false>(simd, tile);
                    } else {
                        self.turn_smooth_to_sensor(simd, tile);
                    }
                }
                if let Some(seen) = &mut self.seen {
                    tell_surfaces(simd, tile, &self.surfaces, seen);
                }
                if self.bumps.lanes != 0 {
                    self.bumps.swap(&mut self.surfaces.normal);
                }
            },
        );
        let scene = &view.scene;
        if let Some(sky) = &scene.air.sky
            && tile.hits != !0
        {
            match *sky {
                Sky::Clear { zenith, horizon } => {
                    air::paint_sky(simd, view, [zenith, horizon], tile, colours);
                }
                Sky::Cube(texture) => self.paint_cube(simd, scene, texture.0, (tile, steps), colours),
            }
        }
        if tile.hits != 0 {
            if self.modulated != 0 {
                self.begin_passes();
            }
            for (number, light) in scene.lights.iter().enumerate() {
                let alone = self.modulated != 0 && light.cast_shadows != 0;
                if alone {
                    self.begin_pass(simd, colours);
                }
                self.add_lamp(simd, view, (number, light), tile, colours);
                if alone {
                    self.end_pass(simd, colours);
                }
            }
            if self.modulated != 0 {
                self.apply_textures(simd, colours);
            }
            if let Some(fog) = &scene.air.fog {
                air::blend(simd, view, fog, (tile, steps.is_some()), colours);
            }
        }
    }

    /// [`Shader::turn_to_sensor`] for tiles with interpolated normals, compiled separately so that others do not pay for
    /// them.
    #[inline(never)]
    fn turn_smooth_to_sensor<S: Simd>(&mut self, simd: S, tile: &Tile) {
        simd.vectorize(
            #[inline(always)]
            || self.turn_to_sensor::<S, true>(simd, tile),
        );
    }

    /// Flips normals that face away from the sensor towards it, both those of maps and the surfaces' own. Interpolated
    /// ones are flipped where their triangle faces away.
    #[inline(always)]
    fn turn_to_sensor<S: Simd, const SMOOTH: bool>(&mut self, simd: S, tile: &Tile) {
        let mut back = 0;
        for row in 0..ROWS {
            let mut along = f32x16::splat(simd, 0.0);
            for axis in 0..3 {
                let normal = load_row(simd, &self.surfaces.normal[axis], row);
                along += normal * load_row(simd, &tile.direction[axis], row);
            }
            let mut away = along.simd_gt(f32x16::splat(simd, 0.0));
            if SMOOTH {
                let Surfaces { smooth, smooth_away, .. } = self.surfaces;
                away = (away & !lanes_in(simd, smooth, row)) | lanes_in(simd, smooth_away, row);
            }
            back |= away.to_bitmask() << (row * WIDTH);
            for axis in 0..3 {
                for normal in [&mut self.surfaces.normal[axis], &mut self.bumps.normal[axis]] {
                    let turned = load_row(simd, normal, row) * -1.0;
                    store_where(simd, away, turned, normal, row);
                }
            }
        }
        self.back = back & tile.hits;
    }

    /// [`Shader::add_instance`] for materials with a cube texture, compiled separately so that others do not pay for it.
    #[inline(never)]
    fn add_cube_instance<S: Simd>(
        &mut self,
        simd: S,
        view: &View<'_>,
        tile: &Tile,
        steps: &Steps,
        lanes: (u32, u64),
        colours: &mut Colours,
    ) {
        simd.vectorize(
            #[inline(always)]
            || self.add_instance::<S, true>(simd, view, tile, steps, lanes, colours),
        );
    }

    /// Sets the normals and the albedo of the lanes that hit an instance, and adds the part of their colours that does
    /// not depend on lamps.
    #[inline(always)]
    fn add_instance<S: Simd, const CUBE: bool>(
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
        let bumpy = material.normal_map != NO_TEXTURE;
        // True if the positions of the pixels on the texture are needed.
        let mapped = material.is_mapped();

        // Step 1: compute normals and footprints on the texture. Without lamps, nothing depends on normals.
        let mut footprints = [Footprint::nothing(simd); ROWS];
        let is_flat_light = scene.lights.is_empty() && self.seen.is_none();
        if is_flat_light && !(mapped || CUBE) {
            // Neither normals nor footprints are needed.
        } else if let Kind::Solid(solid) = instance.kind()
            && solid.has_flat_faces()
        {
            self.add_faces(simd, (view, tile), (placed, lanes), solid, steps, &mut footprints);
        } else {
            self.surfaces.wants_gradient = bumpy;
            let repeat = mapped.then_some(material.texture_repeat);
            self.surfaces.add(simd, (view, tile), (placed, lanes), repeat, steps, &mut footprints);
        }

        // Step 2: compute the colours.
        self.add_colours(simd, scene, material, &footprints, lanes, colours);
        if material.light_texture != NO_TEXTURE {
            self.modulate(simd, scene, material.light_texture, &footprints, lanes);
        }
        if CUBE {
            self.wrap(simd, (view, tile), steps, (placed, lanes), colours);
        }
        if material.emissive_map != NO_TEXTURE {
            self.glow(simd, scene, material, &footprints, lanes, colours);
        }
        if material.is_glossy() {
            if material.pbr_map != NO_TEXTURE {
                self.add_mapped_facets(simd, scene, material, &footprints, lanes);
            } else if material.is_pbr() {
                self.gloss.add_facets(simd, material, lanes, &mut self.albedo);
            } else {
                self.gloss.add(simd, material, lanes, scene.colour_space);
            }
        }
        if bumpy {
            self.bump(simd, scene, material, &footprints, lanes);
        }
        if material.is_clear() {
            self.uncover(simd, scene, material, &footprints, lanes);
        }
    }

    /// Sets the albedo of the lanes, and the part of their colours that does not depend on lamps.
    #[inline(always)]
    fn add_colours<S: Simd>(
        &mut self,
        simd: S,
        scene: &Scene<'_>,
        material: &Material,
        footprints: &[Footprint<S>; ROWS],
        lanes: u64,
        colours: &mut Colours,
    ) {
        let textured = material.texture != NO_TEXTURE;
        let space = scene.colour_space;
        let ambient = light_of(material.ambient, space);
        let (diffuse, emissive) = (light_of(material.diffuse, space), light_of(material.emissive, space));
        let reading = if space == ColourSpace::Srgb { Reading::Light } else { Reading::Numbers };
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
                texture = self.sampler.sample(simd, scene, &footprints[row], mine, reading);
            }
            for channel in 0..3 {
                let ambient = ambient[channel] * scene.environment.ambient[channel];
                let colour = texture[channel] * ambient + emissive[channel];
                store_where(simd, mine, colour, &mut colours[channel], row);
                let albedo = texture[channel] * diffuse[channel];
                store_where(simd, mine, albedo, &mut self.albedo[channel], row);
            }
        }
    }
}

/// Converts a colour to the values in which light is computed.
#[inline(always)]
fn light_of(colour: [f32; 3], space: ColourSpace) -> [f32; 3] {
    match space {
        ColourSpace::AsGiven => colour,
        ColourSpace::Srgb => colour.map(srgb::decode),
    }
}

/// A mask of the lanes of a row whose bits are set.
#[inline(always)]
fn lanes_in<S: Simd>(simd: S, lanes: u64, row: usize) -> mask32x16<S> {
    simd.from_bitmask_mask32x16(lanes >> (row * WIDTH) & 0xffff)
}

/// Stores values in the lanes of a row that are set in `mine`.
#[inline(always)]
fn store_where<S: Simd>(simd: S, mine: mask32x16<S>, values: f32x16<S>, lanes: &mut Lanes<f32>, row: usize) {
    store_row(mine.select(values, load_row(simd, lanes, row)), lanes, row);
}
