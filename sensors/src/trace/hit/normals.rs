//! Normals of the surfaces that the rays of a block hit: instance by instance, for all lanes at once.
//!
//! They are computed in single precision, from the points given by 1/t. The error corresponds to a shift of some 1e-4
//! of a pixel, no more than the rounding of the ray itself.

use crate::optics::rays::Points;
use crate::scene::{Kind, Solid};
use crate::simd::WIDTH;
use crate::trace::grid::Band;
use crate::trace::hit::cache::HitCache;
use crate::trace::hit::curved::{Curved, along, normal_to_frame};
use crate::trace::hit::point::block_index;
use crate::trace::hit::resolve::{Hit, Resolver, SurfaceHit};
use crate::trace::packet::Faces;
use crate::trace::placed::view::View;
use fearless_simd::{Select, Simd, SimdBase, f32x16};
use glam::{DMat3, DVec3, Vec3};

/// Unit normals in the frame; 0 where nothing is hit.
#[derive(Clone, Copy)]
pub(crate) enum Normals<S: Simd> {
    /// The same normal for all lanes.
    Same([f32; 3]),
    Each(Points<S>),
}

impl<S: Simd> Normals<S> {
    #[inline(always)]
    fn points(self, simd: S) -> Points<S> {
        match self {
            Self::Same([x, y, z]) => [f32x16::splat(simd, x), f32x16::splat(simd, y), f32x16::splat(simd, z)],
            Self::Each(points) => points,
        }
    }

    /// Returns the normals lane by lane.
    #[inline(always)]
    pub(crate) fn each(self, simd: S) -> [[f32; 3]; WIDTH] {
        let [x, y, z] = arrays(self.points(simd));
        let mut normals = [[0.0; 3]; WIDTH];
        for lane in 0..WIDTH {
            normals[lane] = [x[lane], y[lane], z[lane]];
        }
        normals
    }
}

#[inline(always)]
fn arrays<S: Simd>([x, y, z]: Points<S>) -> [[f32; WIDTH]; 3] {
    let mut arrays = [[0.0; WIDTH]; 3];
    x.store_array(&mut arrays[0]);
    y.store_array(&mut arrays[1]);
    z.store_array(&mut arrays[2]);
    arrays
}

/// The values that are the same for all rays that hit a solid.
#[derive(Clone, Copy)]
enum SolidFaces {
    /// The sensor sees only flat faces of it, of which this is the number.
    Flat([Face; 3], usize),
    Curved(Curved),
}

/// A flat face that is turned to the sensor.
#[derive(Clone, Copy)]
struct Face {
    /// The unit normal in the frame.
    normal: [f32; 3],
    /// The normal in the sensor's axes, of any length; and its dot product with the points of the face.
    across: [f32; 3],
    at: f32,
}

impl SolidFaces {
    fn new(view: &View<'_>, solid: Solid, index: u32, faces: Faces) -> Self {
        let (instance, placed) = (view.instance(index), &view.placed[index as usize]);
        let rows = view.rows_from_sensor(placed);
        let (size, origin) = (instance.size, placed.origin_in_instance);
        let mut seen = [Face { normal: [0.0; 3], across: [0.0; 3], at: 0.0 }; 3];
        let mut count = 0;
        for axis in 0..3 {
            // For a box, only faces that are turned to the sensor are visible, unless insides are visible too.
            let is_seen = match solid {
                Solid::Box => faces == Faces::Front && origin[axis].abs() > size[axis],
                Solid::Rectangle | Solid::Plane => axis == 2,
                _ => false,
            };
            if !is_seen {
                continue;
            }
            let sign = if solid == Solid::Box && origin[axis] < 0.0 { -1.0 } else { 1.0 };
            let normal = normal_to_frame(placed) * (DVec3::AXES[axis] * sign);
            seen[count] = Face {
                normal: normal.normalize_or_zero().as_vec3().to_array(),
                across: (DVec3::from_array(rows[axis]) * sign).as_vec3().to_array(),
                // Rounded after the subtraction, so that points near the sensor are resolved however large the box is.
                at: (size[axis] - origin[axis].abs()) as f32,
            };
            count += 1;
        }
        if count > 0 {
            return Self::Flat(seen, count);
        }
        Self::Curved(Curved::new((solid, size), placed, &rows))
    }
}

/// Computes normals.
pub(crate) struct NormalFinder {
    faces: Faces,
    solids: HitCache<SolidFaces>,
}

impl NormalFinder {
    pub(crate) fn new(faces: Faces) -> Self {
        Self { faces, solids: HitCache::new() }
    }

    /// The normals of a block, and the lanes that have hit anything.
    #[inline(always)]
    pub(crate) fn block<S: Simd>(
        &mut self,
        simd: S,
        band: &Band<'_>,
        resolver: &mut Resolver<'_>,
        block: [usize; 2],
    ) -> (Normals<S>, u16) {
        let met = resolver.met(simd, &band.target.slot[block_index(band, block)]);
        (self.of(simd, band, resolver, block, &met), met.lanes())
    }

    /// The normals of a block with the given hits.
    #[inline(always)]
    pub(crate) fn of<S: Simd>(
        &mut self,
        simd: S,
        band: &Band<'_>,
        resolver: &mut Resolver<'_>,
        block: [usize; 2],
        met: &SurfaceHit<'_>,
    ) -> Normals<S> {
        let mut rest = match met {
            SurfaceHit::Nothing => return Normals::Same([0.0; 3]),
            SurfaceHit::One(hit) => return self.of_instance(simd, band, resolver, block, (hit, u16::MAX)),
            SurfaceHit::Several(lanes) => *lanes,
        };
        let slots = &band.target.slot[block_index(band, block)];
        let mut mixed = [f32x16::splat(simd, 0.0); 3];
        while rest != 0 {
            let (hit, own) = resolver.first_of(simd, slots, rest);
            rest &= !own;
            let found = self.of_instance(simd, band, resolver, block, (&hit, own)).points(simd);
            let own = simd.from_bitmask_mask32x16(u64::from(own));
            for axis in 0..3 {
                mixed[axis] = own.select(found[axis], mixed[axis]);
            }
        }
        Normals::Each(mixed)
    }

    /// The normals of the lanes of a block that have hit an instance.
    #[inline(always)]
    fn of_instance<S: Simd>(
        &mut self,
        simd: S,
        band: &Band<'_>,
        resolver: &mut Resolver<'_>,
        block: [usize; 2],
        (hit, own): (&Hit<'_>, u16),
    ) -> Normals<S> {
        match hit.instance.kind() {
            Kind::Triangles(_) => triangles(simd, resolver, &band.target.slot[block_index(band, block)], own),
            Kind::Solid(solid) => {
                let make = || SolidFaces::new(band.view, solid, hit.placed, self.faces);
                match self.solids.get(hit.placed, make) {
                    SolidFaces::Flat(faces, 1) => Normals::Same(faces[0].normal),
                    SolidFaces::Flat(faces, count) => {
                        flat(simd, &points(simd, band, block), &faces[..*count])
                    }
                    SolidFaces::Curved(solid) => {
                        Normals::Each(solid.normals(simd, &points(simd, band, block)))
                    }
                }
            }
        }
    }

    /// Cosines of the angles between the reversed rays of a block and the normals of what they hit, in single
    /// precision; 1 where nothing is hit. If insides are visible, their normals are turned to the sensor first. `axes`
    /// are those of the sensor in the world, as columns.
    #[inline(always)]
    pub(crate) fn cosines<S: Simd>(
        &mut self,
        simd: S,
        band: &Band<'_>,
        axes: &[[f32; 3]; 3],
        resolver: &mut Resolver<'_>,
        block: [usize; 2],
    ) -> f32x16<S> {
        let (normals, hits) = self.block(simd, band, resolver, block);
        let one = f32x16::splat(simd, 1.0);
        if hits == 0 {
            return one;
        }
        let [forward, left, up] = match normals {
            Normals::Same([x, y, z]) => axes.map(|[a, b, c]| f32x16::splat(simd, (x * a + y * b) + z * c)),
            Normals::Each(normals) => {
                [along(&normals, axes[0]), along(&normals, axes[1]), along(&normals, axes[2])]
            }
        };
        let [x, y, z] = band.rays.unit_directions(simd, block[0], block[1]);
        let against = (x * forward + y * left) + z * up;
        let cosines = if self.faces == Faces::Both { against.abs() } else { -against };
        simd.from_bitmask_mask32x16(u64::from(hits)).select(cosines, one)
    }

    /// Angles between the reversed rays of a block and the normals of what they hit; NaN where nothing is hit.
    #[inline(always)]
    pub(crate) fn incidence<S: Simd>(
        &mut self,
        simd: S,
        band: &Band<'_>,
        axes: &DMat3,
        resolver: &mut Resolver<'_>,
        block: [usize; 2],
    ) -> [f32; WIDTH] {
        let (normals, hits) = self.block(simd, band, resolver, block);
        let mut angles = [f32::NAN; WIDTH];
        if hits == 0 {
            return angles;
        }
        let normals = normals.each(simd);
        let directions = band.rays.exact_block(block[0], block[1]);
        for lane in 0..WIDTH {
            if hits >> lane & 1 == 1 {
                let direction = DVec3::from_array(directions.map(|axis| axis[lane]));
                let ray = (*axes * direction).normalize();
                let normal = Vec3::from_array(normals[lane]).as_dvec3();
                angles[lane] = libm::acos(ray.dot(-normal).clamp(-1.0, 1.0)) as f32;
            }
        }
        angles
    }
}

/// The points that the rays of a block have hit, in the axes of the sensor.
#[inline(always)]
fn points<S: Simd>(simd: S, band: &Band<'_>, block: [usize; 2]) -> Points<S> {
    let inverse = f32x16::load_array_ref(simd, &band.target.inverse[block_index(band, block)]);
    let t = f32x16::splat(simd, 1.0) / inverse;
    let [x, y, z] = band.rays.directions(simd, block[0], block[1]);
    [x * t, y * t, z * t]
}

/// The normals of the faces of a box. Each point is on the face to which it is nearest.
#[inline(always)]
fn flat<S: Simd>(simd: S, points: &Points<S>, faces: &[Face]) -> Normals<S> {
    let mut nearest = f32x16::splat(simd, f32::INFINITY);
    let mut normals = [f32x16::splat(simd, 0.0); 3];
    for face in faces {
        let off = (along(points, face.across) - face.at).abs();
        let is_nearer = off.simd_lt(nearest);
        nearest = is_nearer.select(off, nearest);
        for axis in 0..3 {
            normals[axis] = is_nearer.select(f32x16::splat(simd, face.normal[axis]), normals[axis]);
        }
    }
    Normals::Each(normals)
}

/// The normals of the triangles that some lanes have hit.
#[inline(always)]
fn triangles<S: Simd>(simd: S, resolver: &mut Resolver<'_>, slots: &[u32; WIDTH], lanes: u16) -> Normals<S> {
    let [mut x, mut y, mut z] = [[0.0; WIDTH]; 3];
    let (mut last, mut normal, mut found) = (None, [0.0; 3], 0);
    for lane in 0..WIDTH {
        if lanes >> lane & 1 == 0 {
            continue;
        }
        if last != Some(slots[lane]) {
            (last, found) = (Some(slots[lane]), found + 1);
            let hit = resolver.hit(slots[lane]);
            normal = resolver.triangle_normal(&hit);
        }
        [x[lane], y[lane], z[lane]] = normal;
    }
    if found == 1 && lanes == u16::MAX {
        return Normals::Same(normal);
    }
    Normals::Each([
        f32x16::load_array_ref(simd, &x),
        f32x16::load_array_ref(simd, &y),
        f32x16::load_array_ref(simd, &z),
    ])
}
