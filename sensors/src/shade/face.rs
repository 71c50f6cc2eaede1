//! Flat faces of boxes, rectangles and planes.
//!
//! On a plane, texture coordinates are linear functions of the point, and the normal is constant. Everything that needs
//! double precision is therefore computed once per face, at the position of the sensor. What remains for the rays is
//! proportional to the distance from there, for which single precision is sufficient.

use super::surface::Footprint;
use super::tile::{self, Steps, Tile};
use super::{ROWS, Shader, lanes_in, store_where};
use crate::scene::{Instance, NO_TEXTURE, Solid};
use crate::simd::{LANES, Lanes, WIDTH, floor, load_row};
use crate::trace::packet::{Faces, MISS};
use crate::trace::placed::view::{Placed, View};
use crate::trace::shapes::solid_surface;
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, u32x16};
use glam::DVec3;

/// A face, in the axes of the world, with the sensor as the origin.
#[derive(Clone, Copy)]
pub(crate) struct Face {
    /// Unit normal, pointing outwards.
    pub(crate) normal: [f32; 3],
    /// Texture coordinates at the foot point of the sensor, without whole repetitions.
    uv: [f32; 2],
    /// Gradients of u and of v, per metre.
    pub(crate) gradient: [[f32; 3]; 2],
    /// For a pinhole camera, the changes to the ray of the next pixel along the row and down the column: of the ray's
    /// component towards the face, and of u and v at t = 1.
    approach: [f32; 2],
    change: [[f32; 2]; 2],
}

/// The faces that a tile and its neighbours have hit, each at the index derived from its number.
pub(super) struct KnownFaces {
    /// Instance and number of each face.
    of: [(u32, u32); KNOWN],
    known: [Face; KNOWN],
}

/// Number of cached faces.
const KNOWN: usize = 16;

impl KnownFaces {
    pub(super) const fn new() -> Self {
        Self { of: [(MISS, 0); KNOWN], known: [Face::NONE; KNOWN] }
    }

    /// A face of an instance, which is computed if it is not cached.
    #[inline(always)]
    pub(super) fn find(&mut self, of: (u32, u32), make: impl FnOnce() -> Face) -> &Face {
        // From outside, a box shows at most three faces, on three axes.
        let place = of.0.wrapping_mul(3).wrapping_add(of.1 / 2) as usize % KNOWN;
        if self.of[place] != of {
            (self.of[place], self.known[place]) = (of, make());
        }
        &self.known[place]
    }
}

impl Face {
    /// An unused entry.
    const NONE: Self = Self {
        normal: [0.0; 3],
        uv: [0.0; 2],
        gradient: [[0.0; 3]; 2],
        approach: [0.0; 2],
        change: [[0.0; 2]; 2],
    };

    /// Creates face `face` of an instance of a solid, numbered as in [`VisibleFaces`].
    #[inline(always)]
    pub(crate) fn new(
        (instance, solid): (&Instance, Solid),
        placed: &Placed,
        face: u32,
        repeat: [f32; 2],
        steps: &Steps,
    ) -> Self {
        let point = Self::point((instance, solid), face);
        let surface = solid_surface(solid, instance.size, point);
        let inverse = placed.inverse.map(DVec3::from_array);
        // Normals and gradients are transformed by the inverse transpose.
        let in_frame = |v: DVec3| inverse[0] * v.x + inverse[1] * v.y + inverse[2] * v.z;
        let normal = in_frame(surface.normal).normalize_or_zero();
        let below = DVec3::from_array(placed.origin_in_instance) - point;
        let mut face = Self {
            normal: normal.as_vec3().to_array(),
            uv: [0.0; 2],
            gradient: [[0.0; 3]; 2],
            approach: steps.map_or([0.0; 2], |steps| steps.map(|step| normal.dot(step) as f32)),
            change: [[0.0; 2]; 2],
        };
        for axis in 0..2 {
            let repeat = f64::from(repeat[axis]);
            let uv = (surface.uv[axis] + surface.uv_gradient[axis].dot(below)) * repeat;
            let gradient = in_frame(surface.uv_gradient[axis]) * repeat;
            face.uv[axis] = (uv - floor(uv)) as f32;
            face.gradient[axis] = gradient.as_vec3().to_array();
            for (change, step) in face.change.iter_mut().zip(steps.iter().flatten()) {
                change[axis] = gradient.dot(*step) as f32;
            }
        }
        face
    }

    /// A point on face `face` of an instance of a solid, in the axes of the instance.
    #[inline(always)]
    pub(super) fn point((instance, solid): (&Instance, Solid), face: u32) -> DVec3 {
        let mut point = DVec3::ZERO;
        if solid == Solid::Box {
            let axis = (face / 2) as usize % 3;
            point[axis] = if face.is_multiple_of(2) { instance.size[axis] } else { -instance.size[axis] };
        }
        point
    }

    /// The footprints of a row's pixels on the texture: how far the hit moves on the face from one pixel to the next
    /// (Igehy 1999, "Tracing ray differentials").
    #[inline(always)]
    pub(crate) fn footprint<S: Simd, const PINHOLE: bool>(
        &self,
        simd: S,
        tile: &Tile,
        row: usize,
    ) -> Footprint<S> {
        let t = load_row(simd, &tile.t, row);
        let moved = [
            along(simd, &self.gradient[0], &tile.point, row),
            along(simd, &self.gradient[1], &tile.point, row),
        ];
        let per_approach = f32x16::splat(simd, 1.0) / along(simd, &self.normal, &tile.direction, row);
        let mut steps = [[t; 2]; 2];
        for side in 0..2 {
            if PINHOLE {
                let back = per_approach * self.approach[side];
                for axis in 0..2 {
                    steps[side][axis] = t * self.change[side][axis] - moved[axis] * back;
                }
            } else {
                let back = per_approach * along(simd, &self.normal, &tile.steps[side], row);
                for axis in 0..2 {
                    let change = along(simd, &self.gradient[axis], &tile.steps[side], row);
                    steps[side][axis] = t * change - moved[axis] * back;
                }
            }
        }
        Footprint { uv: [moved[0] + self.uv[0], moved[1] + self.uv[1]], steps }
    }
}

impl Shader {
    /// Sets the normals of the lanes that hit a solid with flat faces, and, where its material has a texture or a normal
    /// map, their footprints.
    #[inline(always)]
    pub(super) fn add_faces<S: Simd>(
        &mut self,
        simd: S,
        (view, tile): (&View<'_>, &Tile),
        (placed, lanes): (u32, u64),
        solid: Solid,
        steps: &Steps,
        footprints: &mut [Footprint<S>; ROWS],
    ) {
        let (instance, on) = (view.instance(placed), &view.placed[placed as usize]);
        let material = &view.scene.materials[instance.material as usize];
        let bumpy = material.normal_map != NO_TEXTURE;
        let mapped = material.is_mapped();
        let visible = VisibleFaces::new((instance, solid), on, self.faces);
        let numbers = if visible.only().is_some() { None } else { Some(visible.of_tile(simd, tile, lanes)) };
        let mut rest = lanes;
        while rest != 0 {
            let (mut number, mut mine) = (visible.only().unwrap_or(0), rest);
            if let Some(numbers) = &numbers {
                number = numbers[rest.trailing_zeros() as usize % LANES];
                mine &= tile::lanes_with(simd, numbers, number);
            }
            rest &= !mine;
            let face = self.known_faces.find((placed, number), || {
                Face::new((instance, solid), on, number, material.texture_repeat, steps)
            });
            for row in 0..ROWS {
                let mine = lanes_in(simd, mine, row);
                if !mine.any_true() {
                    continue;
                }
                for axis in 0..3 {
                    let normal = f32x16::splat(simd, face.normal[axis]);
                    store_where(simd, mine, normal, &mut self.surfaces.normal[axis], row);
                }
                if bumpy {
                    for (place, gradient) in self.surfaces.gradient.iter_mut().zip(&face.gradient) {
                        for axis in 0..3 {
                            let gradient = f32x16::splat(simd, gradient[axis]);
                            store_where(simd, mine, gradient, &mut place[axis], row);
                        }
                    }
                }
                if mapped {
                    let footprint = if steps.is_some() {
                        face.footprint::<S, true>(simd, tile, row)
                    } else {
                        face.footprint::<S, false>(simd, tile, row)
                    };
                    footprints[row].take(mine, &footprint);
                }
            }
        }
    }
}

/// Dot products of a vector with the vectors of a row.
#[inline(always)]
fn along<S: Simd>(simd: S, vector: &[f32; 3], with: &[Lanes<f32>; 3], row: usize) -> f32x16<S> {
    let [x, y, z] = *vector;
    (load_row(simd, &with[0], row) * x + load_row(simd, &with[1], row) * y)
        + load_row(simd, &with[2], row) * z
}

/// The faces of a box that a sensor may see: from outside, at most one per axis, and of walls only one; all faces if
/// insides are visible. For shapes with a single face, that face. The number of a face is twice its axis, plus 1 if it
/// faces the negative end of the axis.
pub(super) struct VisibleFaces {
    faces: [VisibleFace; 6],
    count: usize,
}

/// A face of a box that may be visible.
#[derive(Clone, Copy)]
struct VisibleFace {
    number: u32,
    /// The axis of the box.
    axis: [f32; 3],
    /// Distance from the sensor along the axis.
    distance: f32,
}

impl VisibleFaces {
    #[inline(always)]
    pub(super) fn new((instance, solid): (&Instance, Solid), placed: &Placed, faces: Faces) -> Self {
        let mut seen =
            Self { faces: [VisibleFace { number: 0, axis: [0.0; 3], distance: 0.0 }; 6], count: 0 };
        if solid != Solid::Box {
            return seen;
        }
        for axis in 0..3 {
            let (half, origin) = (instance.size[axis], placed.origin_in_instance[axis]);
            for negative in [false, true] {
                if faces == Faces::Front && (origin.abs() <= half || negative != (origin < 0.0)) {
                    continue;
                }
                let number = 2 * axis as u32 + u32::from(negative);
                // The distance from the sensor is rounded after the subtraction, so that points near the sensor are
                // resolved however large the box is.
                let distance = (if negative { -half - origin } else { half - origin }) as f32;
                let axis = DVec3::from_array(placed.inverse[axis]).as_vec3().to_array();
                seen.faces[seen.count] = VisibleFace { number, axis, distance };
                seen.count += 1;
            }
        }
        seen
    }

    /// The face on which all points lie, if that is known without looking at them.
    #[inline(always)]
    pub(super) fn only(&self) -> Option<u32> {
        (self.count <= 1).then_some(self.faces[0].number)
    }

    /// The face that each ray of the tile has hit; undefined for rows in which none of the `lanes` is set.
    #[inline(always)]
    pub(super) fn of_tile<S: Simd>(&self, simd: S, tile: &Tile, lanes: u64) -> Lanes<u32> {
        let mut faces = [0; LANES];
        for row in 0..LANES / WIDTH {
            if (lanes >> (row * WIDTH)) as u16 == 0 {
                continue;
            }
            // The face is the one nearest to the point.
            let mut nearest = f32x16::splat(simd, f32::INFINITY);
            let mut number = u32x16::splat(simd, self.faces[0].number);
            for face in &self.faces[..self.count] {
                let distance = (along(simd, &face.axis, &tile.point, row) - face.distance).abs();
                let nearer = distance.simd_lt(nearest);
                nearest = nearer.select(distance, nearest);
                number = nearer.select(u32x16::splat(simd, face.number), number);
            }
            number.store_array(&mut faces.as_chunks_mut().0[row]);
        }
        faces
    }

    /// The face on which a single point lies.
    #[inline(always)]
    pub(super) fn of_point(&self, [x, y, z]: [f32; 3]) -> u32 {
        let (mut nearest, mut number) = (f32::INFINITY, self.faces[0].number);
        for face in &self.faces[..self.count] {
            let distance = ((x * face.axis[0] + y * face.axis[1]) + z * face.axis[2] - face.distance).abs();
            if distance < nearest {
                (nearest, number) = (distance, face.number);
            }
        }
        number
    }
}
