//! Cube textures, on surfaces and as the sky: the face, and the place on it, that a direction shows.
//!
//! What [`Shader`] calls is compiled once for each level and never inlined, so that tiles without cube textures do not
//! pay for it.

use super::axes::{load, local_points};
use super::surface::Footprint;
use super::texels::Reading;
use super::texture::Sampler;
use super::tile::{Steps, Tile};
use super::{Colours, ROWS, Shader, lanes_in, light_of, store_where};
use crate::optics::rays::dot;
use crate::scene::{ColourSpace, Instance, Kind, NO_TEXTURE, Scene, Solid};
use crate::simd::{Lanes, WIDTH, load_row};
use crate::trace::placed::view::{Placed, View};
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, mask32x16, u32x16};

/// A vector for each pixel of a row.
type Vectors<S> = [f32x16<S>; 3];

/// Where the pixels of a row look in a cube.
struct Aim<S: Simd> {
    /// Directions of any length.
    direction: Vectors<S>,
    /// Changes of the direction to the next pixel along the row, and down the column.
    steps: [Vectors<S>; 2],
}

impl<S: Simd> Aim<S> {
    /// The colours that are seen, RGB in [0, 1]. Only lanes in `mine` are used, of which there must be at least one.
    /// Compiled once for surfaces and the sky.
    #[inline(never)]
    fn sample(&self, simd: S, scene: &Scene<'_>, sampler: &Sampler, mine: mask32x16<S>) -> Vectors<S> {
        simd.vectorize(
            #[inline(always)]
            || {
                let is_srgb = scene.colour_space == ColourSpace::Srgb;
                let reading = if is_srgb { Reading::Light } else { Reading::Numbers };
                let faces = Faces::of(simd, &self.direction);
                let [right, up, outwards] = faces.turn(&self.direction);
                let per_outwards = f32x16::splat(simd, 1.0) / outwards;
                let place = [right * per_outwards, up * per_outwards];
                let mut footprint = Footprint::nothing(simd);
                for axis in 0..2 {
                    footprint.uv[axis] = place[axis] * 0.5 + 0.5;
                }
                for side in 0..2 {
                    let [right, up, outwards] = faces.turn(&self.steps[side]);
                    let half = per_outwards * 0.5;
                    footprint.steps[side] =
                        [(right - place[0] * outwards) * half, (up - place[1] * outwards) * half];
                }
                sampler.sample_face::<S, true>(simd, scene, (faces.number(simd), &footprint), mine, reading)
            },
        )
    }
}

/// The faces at which a row of directions points.
struct Faces<S: Simd> {
    is_x: mask32x16<S>,
    is_y: mask32x16<S>,
    /// 1 for faces at the positive ends of the axes, and −1 for the others.
    side: f32x16<S>,
}

impl<S: Simd> Faces<S> {
    #[inline(always)]
    fn of(simd: S, [x, y, z]: &Vectors<S>) -> Self {
        let [along_x, along_y, along_z] = [x.abs(), y.abs(), z.abs()];
        let is_x = along_x.simd_ge(along_y) & along_x.simd_ge(along_z);
        let is_y = !is_x & along_y.simd_ge(along_z);
        let outwards = is_x.select(*x, is_y.select(*y, *z));
        let one = f32x16::splat(simd, 1.0);
        Self { is_x, is_y, side: outwards.simd_lt(0.0).select(one * -1.0, one) }
    }

    /// The parts of vectors to the right and up in the images of the faces, and outwards.
    #[inline(always)]
    fn turn(&self, [x, y, z]: &Vectors<S>) -> Vectors<S> {
        let Self { is_x, is_y, side } = *self;
        let [x_out, y_out, z_out] = [*x * side, *y * side, *z * side];
        [
            is_x.select(z_out * -1.0, is_y.select(*x, x_out)),
            is_y.select(z_out * -1.0, *y),
            is_x.select(x_out, is_y.select(y_out, z_out)),
        ]
    }

    /// The numbers of the faces: +x, −x, +y, −y, +z, −z.
    #[inline(always)]
    fn number(&self, simd: S) -> u32x16<S> {
        let (x, y, z) = (u32x16::splat(simd, 0), u32x16::splat(simd, 2), u32x16::splat(simd, 4));
        let axis = self.is_x.select(x, self.is_y.select(y, z));
        self.side.simd_lt(0.0).select(axis + 1, axis)
    }
}

/// How points of a shape, along its own axes, become directions in its cube.
struct Fit {
    factors: [f32; 3],
    /// The straight part of a capsule ends here, and the factor is another beyond.
    straight: f32,
    beyond: f32,
}

impl Fit {
    fn new(instance: &Instance, stretch: [f32; 3]) -> Self {
        let size = instance.size;
        let (lengths, straight) = match instance.kind() {
            Kind::Triangles(_) | Kind::Solid(Solid::Plane) => ([1.0; 3], f32::INFINITY),
            Kind::Solid(Solid::Rectangle) => ([size[0], size[1], 1.0], f32::INFINITY),
            Kind::Solid(Solid::Capsule) => ([size[0], size[0], size[1]], size[1] as f32),
            Kind::Solid(solid) => (solid.half_extents(size), f32::INFINITY),
        };
        let [x, y, z] = stretch;
        let [a, b, c] = lengths.map(|length| (1.0 / length) as f32);
        Self { factors: [x * a, y * b, z * c], straight, beyond: z * a }
    }

    /// Where the lanes of a row look that hit the shape.
    #[inline(always)]
    fn aim<S: Simd>(
        &self,
        simd: S,
        placed: &Placed,
        normal: &[Lanes<f32>; 3],
        (tile, row): (&Tile, usize),
        steps: &Steps,
    ) -> Aim<S> {
        let points = local_points(placed, tile, row);
        let mut direction = [f32x16::splat(simd, 0.0); 3];
        for axis in 0..3 {
            let mut values = [0.0; WIDTH];
            for lane in 0..WIDTH {
                values[lane] = points[axis][lane] as f32;
            }
            direction[axis] = load(simd, &values);
        }
        let straight = f32x16::splat(simd, self.straight);
        let is_beyond = direction[2].abs().simd_gt(straight);
        let slope = is_beyond.select(f32x16::splat(simd, self.beyond), f32x16::splat(simd, self.factors[2]));

        // From one pixel to the next, the hit moves on the surface's plane.
        let (ray, normal) = (rows(simd, &tile.direction, row), rows(simd, normal, row));
        let per_approach = f32x16::splat(simd, 1.0) / dot(&normal, &ray);
        let t = load_row(simd, &tile.t, row);
        let mut changes = ray_steps(simd, (tile, row), steps);
        for change in &mut changes {
            let back = dot(&normal, change) * per_approach;
            let mut moved = *change;
            for axis in 0..3 {
                moved[axis] = (change[axis] - ray[axis] * back) * t;
            }
            for axis in 0..3 {
                let [a, b, c] = placed.inverse[axis].map(|part| part as f32);
                change[axis] = (moved[0] * a + moved[1] * b) + moved[2] * c;
            }
            *change = [change[0] * self.factors[0], change[1] * self.factors[1], change[2] * slope];
        }
        let end = direction[2].simd_lt(0.0).select(straight * -1.0, straight);
        let beyond = (direction[2] - end) * self.beyond + end * self.factors[2];
        let along = is_beyond.select(beyond, direction[2] * self.factors[2]);
        Aim {
            direction: [direction[0] * self.factors[0], direction[1] * self.factors[1], along],
            steps: changes,
        }
    }
}

/// A row of vectors.
#[inline(always)]
fn rows<S: Simd>(simd: S, [x, y, z]: &[Lanes<f32>; 3], row: usize) -> Vectors<S> {
    [load_row(simd, x, row), load_row(simd, y, row), load_row(simd, z, row)]
}

/// The changes of the rays of a row to the next pixel along the row, and down the column.
#[inline(always)]
fn ray_steps<S: Simd>(simd: S, (tile, row): (&Tile, usize), steps: &Steps) -> [Vectors<S>; 2] {
    let mut changes = [[f32x16::splat(simd, 0.0); 3]; 2];
    for side in 0..2 {
        changes[side] = if let Some(steps) = steps {
            let [x, y, z] = steps[side].as_vec3().to_array();
            [f32x16::splat(simd, x), f32x16::splat(simd, y), f32x16::splat(simd, z)]
        } else {
            rows(simd, &tile.steps[side], row)
        };
    }
    changes
}

impl Shader {
    /// Multiplies the colours of lanes by the cube texture of the instance that they hit.
    #[inline(never)]
    pub(super) fn wrap<S: Simd>(
        &mut self,
        simd: S,
        (view, tile): (&View<'_>, &Tile),
        steps: &Steps,
        (placed, lanes): (u32, u64),
        colours: &mut Colours,
    ) {
        let (scene, instance) = (&view.scene, view.instance(placed));
        let material = &scene.materials[instance.material as usize];
        let emissive = light_of(material.emissive, scene.colour_space);
        let fit = Fit::new(instance, material.cube_stretch);
        let (by_light, is_first) = (material.cube_by_light != 0, material.light_texture == NO_TEXTURE);
        let Self { maps, surfaces, gloss, albedo, .. } = self;
        if by_light {
            self.modulated |= lanes;
        }
        maps.turn_to(scene, material.cube_texture);
        simd.vectorize(
            #[inline(always)]
            || {
                for row in 0..ROWS {
                    let mine = lanes_in(simd, lanes, row);
                    if !mine.any_true() {
                        continue;
                    }
                    let on = &view.placed[placed as usize];
                    let aim = fit.aim(simd, on, &surfaces.normal, (tile, row), steps);
                    let texel = aim.sample(simd, scene, maps, mine);
                    for channel in 0..3 {
                        if by_light {
                            let other = load_row(simd, &gloss.factor[channel], row);
                            let factor = if is_first { texel[channel] } else { texel[channel] * other };
                            store_where(simd, mine, factor, &mut gloss.factor[channel], row);
                            continue;
                        }
                        let diffuse = load_row(simd, &albedo[channel], row) * texel[channel];
                        store_where(simd, mine, diffuse, &mut albedo[channel], row);
                        let ambient = load_row(simd, &colours[channel], row) - emissive[channel];
                        let colour = ambient * texel[channel] + emissive[channel];
                        store_where(simd, mine, colour, &mut colours[channel], row);
                    }
                }
            },
        );
    }

    /// Sets the lanes of a tile that hit nothing to a sky of a cube texture, whose y axis points up.
    #[inline(never)]
    pub(super) fn paint_cube<S: Simd>(
        &mut self,
        simd: S,
        scene: &Scene<'_>,
        texture: u32,
        (tile, steps): (&Tile, &Steps),
        colours: &mut Colours,
    ) {
        let sampler = &mut self.maps;
        sampler.turn_to(scene, texture);
        simd.vectorize(
            #[inline(always)]
            || {
                for row in 0..ROWS {
                    let mine = lanes_in(simd, !tile.hits, row);
                    if !mine.any_true() {
                        continue;
                    }
                    let [right, down] = ray_steps(simd, (tile, row), steps);
                    let ray = rows(simd, &tile.direction, row);
                    let aim = Aim { direction: upright(&ray), steps: [upright(&right), upright(&down)] };
                    let texel = aim.sample(simd, scene, sampler, mine);
                    for channel in 0..3 {
                        store_where(simd, mine, texel[channel], &mut colours[channel], row);
                    }
                }
            },
        );
    }
}

/// Turns vectors so that z becomes y.
#[inline(always)]
fn upright<S: Simd>([x, y, z]: &Vectors<S>) -> Vectors<S> {
    [*x, *z, *y * -1.0]
}
