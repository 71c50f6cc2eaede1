//! Tiles of a single colour, as in most of a floor, a wall or the sky.
//!
//! Under lamps with parallel light and without shadows, a flat face without a texture has a single colour. If all rays
//! of a tile hit the same face, its colour is computed once and cached for neighbouring tiles. The operations are the
//! same as for a lane, so the bits are the same too.

use super::face::{Face, VisibleFaces};
use super::light_of;
use super::surface::triangle_normal;
use super::tile::CameraRays;
use crate::scene::{Air, Form, Kind, Material, Scene};
use crate::trace::grid::Band;
use crate::trace::grid::tiling::{BLOCKS, Tiling, place_in_blocks};
use crate::trace::hit::resolve::{Hit, Resolver};
use crate::trace::image::{GRAZING, NO_HIT};
use crate::trace::packet::Faces;
use crate::trace::placed::view::{Placed, View};
use fearless_simd::{Simd, SimdBase, SimdMask, u32x16};
use glam::DVec3;

/// Number of cached colours.
const KEPT: usize = 16;

/// The face number of a triangle, and of a solid of which only one face is visible.
const ONLY_FACE: u32 = 6;

/// Finds tiles of a single colour.
pub(crate) struct UniformTiles {
    /// Slot and face of the cached colours, each at the index derived from them; [`ONLY_FACE`] if there is only one
    /// face.
    of: [(u32, u32); KEPT],
    colours: [[f32; 3]; KEPT],
    /// The sides of surfaces that are visible.
    faces: Faces,
}

impl UniformTiles {
    /// Creates the cache, or `None` if the light of a scene's lamps varies from point to point, or if there is fog or
    /// a sky.
    pub(crate) fn new(scene: &Scene<'_>, faces: Faces) -> Option<Self> {
        if scene.air != Air::default() {
            return None;
        }
        let mut lights = scene.lights.iter();
        lights.all(|light| light.form() == Form::Directional && light.cast_shadows == 0).then_some(Self {
            of: [(NO_HIT, 0); KEPT],
            colours: [[0.0; 3]; KEPT],
            faces,
        })
    }

    /// The colour of all rays of a tile, if they are known to have the same colour.
    #[inline(always)]
    pub(crate) fn colour<S: Simd>(
        &mut self,
        simd: S,
        band: &Band<'_>,
        resolver: &mut Resolver<'_>,
        rays: &CameraRays<'_>,
        tile: [usize; 2],
    ) -> Option<[f32; 3]> {
        let across = band.rays.ray_grid().blocks_across();
        let first = (tile[1] - *band.block_rows().start()) * across + tile[0] * BLOCKS;
        let blocks = BLOCKS.min(across - tile[0] * BLOCKS);
        let slot = band.target.slot[first][0] & !GRAZING;
        let all = u32x16::splat(simd, slot);
        for slots in &band.target.slot[first..first + blocks] {
            let slots = u32x16::load_array_ref(simd, slots) & u32x16::splat(simd, !GRAZING);
            if !slots.simd_eq(all).all_true() {
                return None;
            }
        }
        let scene = &band.view.scene;
        if slot == NO_HIT & !GRAZING {
            return Some(light_of(scene.environment.background, scene.colour_space));
        }
        if blocks < BLOCKS {
            return None;
        }
        if let Some(colour) = self.kept((slot, ONLY_FACE)) {
            return Some(colour);
        }
        let hit = resolver.hit(slot);
        let mut face = ONLY_FACE;
        if let Kind::Solid(solid) = hit.instance.kind() {
            if !solid.has_flat_faces() {
                return None;
            }
            let visible =
                VisibleFaces::new((band.view.instance(hit.placed), solid), hit.instance, self.faces);
            if visible.only().is_none() {
                face = common_face(&visible, band, rays, (tile, first))?;
            }
        }
        if let Some(colour) = self.kept((slot, face)) {
            return Some(colour);
        }
        let material = &scene.materials[band.view.instance(hit.placed).material as usize];
        let plain = is_plain(material) && !is_smooth(band.view, hit.instance);
        let colour = plain.then(|| shine(band.view, material, &hit, (face, self.faces)))?;
        let place = place((slot, face));
        (self.of[place], self.colours[place]) = ((slot, face), colour);
        Some(colour)
    }

    /// The colour of a face, if it is cached.
    #[inline(always)]
    fn kept(&self, of: (u32, u32)) -> Option<[f32; 3]> {
        let place = place(of);
        (self.of[place] == of).then_some(self.colours[place])
    }
}

/// The index at which the colour of a face is cached. From outside, a box shows at most three faces, on three axes.
#[inline(always)]
fn place((slot, face): (u32, u32)) -> usize {
    slot.wrapping_mul(3).wrapping_add(face / 2) as usize % KEPT
}

/// The face of a box that all rays of a tile have hit. Since the box is convex, it is enough to test the rays at the
/// tile's corners. For a pinhole camera only, whose rays lie between straight lines.
#[inline(always)]
fn common_face(
    visible: &VisibleFaces,
    band: &Band<'_>,
    rays: &CameraRays<'_>,
    (tile, first): ([usize; 2], usize),
) -> Option<u32> {
    rays.steps?;
    let tiling = Tiling::of(band.rays.ray_grid());
    let [columns, rows] = tiling.size();
    let face = |[x, y]: [usize; 2]| {
        let (block, lane) = place_in_blocks(tiling, [x, y]);
        let pixel = [tile[0] * columns + x, tile[1] * rows + y];
        visible.of_point(rays.pinhole_point(pixel, band.target.inverse[first + block][lane]))
    };
    let of_first = face([0, 0]);
    let others = [[columns - 1, 0], [0, rows - 1], [columns - 1, rows - 1]];
    others.into_iter().all(|corner| face(corner) == of_first).then_some(of_first)
}

/// Returns true if the colour of a flat face depends only on the light.
fn is_plain(material: &Material) -> bool {
    !(material.is_mapped() || material.has_cube() || material.is_glossy() || material.is_clear())
}

/// Returns true if the normal differs from point to point of a triangle.
fn is_smooth(view: &View<'_>, placed: &Placed) -> bool {
    placed.kind().is_mesh() && view.scene.is_smooth(placed.mesh)
}

/// The colour of a face of a plain material.
#[inline(never)]
fn shine(view: &View<'_>, material: &Material, hit: &Hit<'_>, (face, faces): (u32, Faces)) -> [f32; 3] {
    let (scene, space) = (&view.scene, view.scene.colour_space);
    let (mut normal, point) = match hit.instance.kind() {
        Kind::Solid(solid) => {
            let instance = view.instance(hit.placed);
            let visible = VisibleFaces::new((instance, solid), hit.instance, faces);
            let face = visible.only().unwrap_or(face);
            let normal = Face::new((instance, solid), hit.instance, face, [1.0; 2], &None).normal;
            (normal, Face::point((instance, solid), face))
        }
        Kind::Triangles(triangles) => {
            let normal = triangle_normal(view, (hit.instance, triangles), hit.local);
            (normal, view.corners(hit.instance, hit.local)[0])
        }
    };
    if faces == Faces::Both {
        // Flip the face towards the sensor.
        let axes = hit.instance.axes.map(DVec3::from_array);
        let place = DVec3::from_array(hit.instance.translation)
            + (axes[0] * point.x + axes[1] * point.y + axes[2] * point.z);
        if place.dot(DVec3::from_array(normal.map(f64::from))) > 0.0 {
            normal = normal.map(|part| -part);
        }
    }
    let (ambient, diffuse, emissive) = (
        light_of(material.ambient, space),
        light_of(material.diffuse, space),
        light_of(material.emissive, space),
    );
    let mut colour = [0.0; 3];
    for channel in 0..3 {
        colour[channel] = ambient[channel] * scene.environment.ambient[channel] + emissive[channel];
    }
    for light in scene.lights {
        let [x, y, z] = DVec3::from_array(light.direction).as_vec3().to_array();
        let gain = -((normal[0] * x + normal[1] * y) + normal[2] * z);
        if gain > 0.0 {
            for channel in 0..3 {
                colour[channel] += (diffuse[channel] * light.diffuse[channel]) * gain;
            }
        }
    }
    colour
}
