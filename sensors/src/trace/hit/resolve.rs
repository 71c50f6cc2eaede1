//! Finds the instance and triangle of a slot.

use crate::scene::tree::Facet;
use crate::scene::{Kind, Triangles};
use crate::simd::{WIDTH, sqrt_f32};
use crate::trace::image::{GRAZING, GRAZING_SQUARED, NO_HIT};
use crate::trace::placed::view::{Placed, View};
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, u32x16};
use glam::DVec3;

/// The number of instances that a [`Resolver`] caches in addition to the last.
const REMEMBERED: usize = 4;

/// Finds the instances of slots, and caches the last few, because neighbours mostly hit the same.
pub(crate) struct Resolver<'a> {
    view: &'a View<'a>,
    /// The last instance found, and the range of its slots.
    placed: u32,
    slots: core::ops::Range<u32>,
    /// The instances found before it, and the index of the oldest.
    before: [(u32, core::ops::Range<u32>); REMEMBERED],
    oldest: usize,
}

/// The lanes that have hit anything, a bit each.
#[inline(always)]
pub(crate) fn hit_lanes<S: Simd>(simd: S, slots: &[u32; WIDTH]) -> u16 {
    u32x16::load_array_ref(simd, slots).simd_ne(u32x16::splat(simd, NO_HIT)).to_bitmask() as u16
}

/// A slot, counted from the first of its instance.
#[inline(always)]
pub(crate) fn local_slot(slot: u32, instance: &Placed) -> u32 {
    (slot & !GRAZING) - instance.first_slot
}

/// The instance and triangle that a slot refers to.
#[derive(Clone, Copy)]
pub(crate) struct Hit<'a> {
    /// Index among the placed instances.
    pub(crate) placed: u32,
    pub(crate) instance: &'a Placed,
    /// The slot, counted from the instance's first.
    pub(crate) local: u32,
}

impl Hit<'_> {
    /// The index of a mesh's triangle among the facets of the scene.
    #[inline(always)]
    fn facet(&self) -> usize {
        self.instance.first_block as usize * WIDTH + self.local as usize
    }
}

/// The hits of the rays of a block.
#[derive(Clone, Copy)]
pub(crate) enum SurfaceHit<'a> {
    Nothing,
    /// All rays hit the same instance.
    One(Hit<'a>),
    /// These lanes hit any instances.
    Several(u16),
}

impl SurfaceHit<'_> {
    /// The lanes that have hit anything, a bit each.
    #[inline(always)]
    pub(crate) fn lanes(&self) -> u16 {
        match self {
            Self::Nothing => 0,
            Self::One(_) => u16::MAX,
            Self::Several(lanes) => *lanes,
        }
    }
}

impl<'a> Resolver<'a> {
    pub(crate) fn new(view: &'a View<'a>) -> Self {
        Self { view, placed: 0, slots: 0..0, before: [const { (0, 0..0) }; REMEMBERED], oldest: 0 }
    }

    /// The hit of a slot other than [`NO_HIT`].
    #[inline(always)]
    pub(crate) fn hit(&mut self, slot: u32) -> Hit<'a> {
        let slot = slot & !GRAZING;
        if !self.slots.contains(&slot) {
            self.find(slot);
        }
        let instance = &self.view.placed[self.placed as usize];
        Hit { placed: self.placed, instance, local: slot - instance.first_slot }
    }

    /// The hits of the rays of a block.
    #[inline(always)]
    pub(crate) fn met<S: Simd>(&mut self, simd: S, slots: &[u32; WIDTH]) -> SurfaceHit<'a> {
        let lanes = hit_lanes(simd, slots);
        if lanes == 0 {
            return SurfaceHit::Nothing;
        }
        if lanes == u16::MAX {
            let hit = self.hit(slots[0]);
            if self.are_of_last(simd, slots) {
                return SurfaceHit::One(hit);
            }
        }
        SurfaceHit::Several(lanes)
    }

    /// The slots of the instance that was found last.
    #[inline(always)]
    pub(crate) fn slots(&self) -> core::ops::Range<u32> {
        self.slots.clone()
    }

    /// Returns true if all slots belong to the instance that was found last.
    #[inline(always)]
    pub(crate) fn are_of_last<S: Simd>(&self, simd: S, slots: &[u32; WIDTH]) -> bool {
        let slots = u32x16::load_array_ref(simd, slots) & u32x16::splat(simd, !GRAZING);
        let own = slots.simd_ge(u32x16::splat(simd, self.slots.start))
            & slots.simd_lt(u32x16::splat(simd, self.slots.end));
        own.all_true()
    }

    /// The hit of the first of some lanes, and the lanes that have hit the same instance.
    #[inline(always)]
    pub(crate) fn first_of<S: Simd>(&mut self, simd: S, slots: &[u32; WIDTH], lanes: u16) -> (Hit<'a>, u16) {
        let hit = self.hit(slots[lanes.trailing_zeros() as usize % WIDTH]);
        let slots = u32x16::load_array_ref(simd, slots) & u32x16::splat(simd, !GRAZING);
        let own = slots.simd_ge(u32x16::splat(simd, self.slots.start))
            & slots.simd_lt(u32x16::splat(simd, self.slots.end));
        (hit, own.to_bitmask() as u16)
    }

    /// The instance that was found last, and the facets from its first on, if it is a mesh and all slots belong to it.
    #[inline(always)]
    pub(crate) fn common_mesh<S: Simd>(
        &self,
        simd: S,
        slots: &[u32; WIDTH],
    ) -> Option<(&'a Placed, &'a [Facet])> {
        if !self.are_of_last(simd, slots) {
            return None;
        }
        let instance = &self.view.placed[self.placed as usize];
        let facets = &self.view.scene.facets[instance.first_block as usize * WIDTH..];
        instance.kind().is_mesh().then_some((instance, facets))
    }

    #[inline(never)]
    fn find(&mut self, slot: u32) {
        let last = (self.placed, self.slots.clone());
        if let Some(known) = self.before.iter_mut().find(|(_, slots)| slots.contains(&slot)) {
            (self.placed, self.slots) = core::mem::replace(known, last);
            return;
        }
        self.before[self.oldest % REMEMBERED] = last;
        self.oldest += 1;
        let after = self.view.placed.partition_point(|placed| placed.first_slot <= slot);
        self.placed = after as u32 - 1;
        let end = self.view.placed.get(after).map_or(NO_HIT & !GRAZING, |next| next.first_slot);
        self.slots = self.view.placed[after - 1].first_slot..end;
    }

    /// The [`laser_retro`](crate::scene::InstanceConfig::laser_retro) of a slot's instance.
    #[inline(always)]
    pub(crate) fn laser_retro(&mut self, slot: u32) -> f32 {
        let hit = self.hit(slot);
        self.laser_retro_of(&hit)
    }

    #[inline(always)]
    fn laser_retro_of(&self, hit: &Hit<'_>) -> f32 {
        self.view.scene.instances[hit.instance.instance as usize].laser_retro
    }

    /// The [`laser_retro`](crate::scene::InstanceConfig::laser_retro) of the instances that the given lanes have hit; 0
    /// in the other lanes.
    #[inline(always)]
    pub(crate) fn laser_retros<S: Simd>(
        &mut self,
        simd: S,
        slots: &[u32; WIDTH],
        mut lanes: u16,
    ) -> f32x16<S> {
        let mut retros = f32x16::splat(simd, 0.0);
        while lanes != 0 {
            let (hit, own) = self.first_of(simd, slots, lanes);
            let here = simd.from_bitmask_mask32x16(u64::from(own & lanes));
            retros = here.select(f32x16::splat(simd, self.laser_retro_of(&hit)), retros);
            lanes &= !own;
        }
        retros
    }

    /// The index of the triangle that was hit, in the order in which the triangles were given; 0 for other shapes.
    #[inline(always)]
    pub(crate) fn triangle(&self, hit: &Hit<'_>) -> u32 {
        match hit.instance.kind() {
            Kind::Triangles(Triangles::Mesh) => self.view.scene.facets[hit.facet()].triangle,
            Kind::Triangles(Triangles::HeightField) => {
                let width = WIDTH as u32;
                self.view.height_grid(hit.instance).triangle_of(hit.local / width, hit.local % width)
            }
            Kind::Solid(_) => 0,
        }
    }

    /// Unit normal of the triangle that was hit, in the frame; 0 for shapes without triangles.
    #[inline(always)]
    pub(crate) fn triangle_normal(&self, hit: &Hit<'_>) -> [f32; 3] {
        match hit.instance.kind() {
            Kind::Triangles(Triangles::Mesh) => {
                hit.instance.normal_in_frame(self.view.scene.facets[hit.facet()].normal)
            }
            Kind::Triangles(Triangles::HeightField) => {
                let [x, y, z] = self.view.height_field_normal(hit.instance, hit.local);
                let length = sqrt_f32((x * x + y * y) + z * z);
                hit.instance.normal_in_frame([x / length, y / length, z / length])
            }
            Kind::Solid(_) => [0.0; 3],
        }
    }

    /// The corners of the triangle that was hit, in the frame of its instance.
    fn corners(&self, hit: &Hit<'_>) -> [DVec3; 3] {
        self.view.corners(hit.instance, hit.local)
    }

    /// Returns true if a ray grazes the triangle that it hits at such an angle that single precision is not enough.
    #[inline(always)]
    pub(crate) fn grazes(&self, hit: &Hit<'_>, direction: [f32; 3]) -> bool {
        let [x, y, z] = self.triangle_normal(hit);
        let sine = (x * direction[0] + y * direction[1]) + z * direction[2];
        sine * sine < 1.0 / GRAZING_SQUARED
    }

    /// t at which a ray from the frame's origin hits the plane of its triangle, in double precision, limited to the
    /// range of the corners' t: if the ray nearly lies in the plane, rounding could give any t.
    pub(crate) fn exact(&self, hit: &Hit<'_>, direction: DVec3, rough: f64) -> f64 {
        let [a, b, c] = self.corners(hit);
        let normal = (b - a).cross(c - a);
        let direction = hit.instance.vector_in_instance(direction);
        let origin = DVec3::from_array(hit.instance.origin_in_instance);
        let t = normal.dot(a - origin) / normal.dot(direction);
        // For a ray in the plane, keep the rough value.
        let t = if t.is_finite() && t > 0.0 { t } else { rough };
        let per_square = 1.0 / direction.length_squared();
        let [a, b, c] = [a, b, c].map(|corner| (corner - origin).dot(direction) * per_square);
        let (least, most) = (a.min(b).min(c), a.max(b).max(c));
        if t < least {
            least
        } else if t > most && most > 0.0 {
            most
        } else {
            t
        }
    }
}
