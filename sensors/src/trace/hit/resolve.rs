//! From the slot of a hit back to what was hit.

use crate::scene::tree::Facet;
use crate::scene::{Kind, Triangles};
use crate::simd::{WIDTH, sqrt_f32};
use crate::trace::image::{GRAZING, GRAZING_SQUARED, NO_HIT};
use crate::trace::placed::view::{Placed, View};
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, u32x16};
use glam::DVec3;

/// How many instances a [`Resolver`] remembers beside the last.
const REMEMBERED: usize = 4;

/// Finds the instances of slots; remembers the last few, as neighbours mostly hit the same.
pub(crate) struct Resolver<'a> {
    view: &'a View<'a>,
    /// The last instance found, and the slots that are its own.
    placed: u32,
    slots: core::ops::Range<u32>,
    /// Those before it, and which of them is the oldest.
    before: [(u32, core::ops::Range<u32>); REMEMBERED],
    oldest: usize,
}

/// The lanes that have hit anything, a bit each.
#[inline(always)]
pub(crate) fn hit_lanes<S: Simd>(simd: S, slots: &[u32; WIDTH]) -> u16 {
    u32x16::load_array_ref(simd, slots).simd_ne(u32x16::splat(simd, NO_HIT)).to_bitmask() as u16
}

/// A slot, counted from its instance's first.
#[inline(always)]
pub(crate) fn local_slot(slot: u32, instance: &Placed) -> u32 {
    (slot & !GRAZING) - instance.first_slot
}

/// What a slot stands for.
#[derive(Clone, Copy)]
pub(crate) struct Hit<'a> {
    /// Index among the placed instances.
    pub(crate) placed: u32,
    pub(crate) instance: &'a Placed,
    /// Slot, counted from the instance's first.
    pub(crate) local: u32,
}

impl Hit<'_> {
    /// Index of the triangle of a mesh among the scene's facets.
    #[inline(always)]
    fn facet(&self) -> usize {
        self.instance.first_block as usize * WIDTH + self.local as usize
    }
}

/// What the rays of a block have hit.
#[derive(Clone, Copy)]
pub(crate) enum SurfaceHit<'a> {
    Nothing,
    /// All rays the same instance.
    One(Hit<'a>),
    /// These lanes, anything.
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

    /// The hit of a slot, which is not [`NO_HIT`].
    #[inline(always)]
    pub(crate) fn hit(&mut self, slot: u32) -> Hit<'a> {
        let slot = slot & !GRAZING;
        if !self.slots.contains(&slot) {
            self.find(slot);
        }
        let instance = &self.view.placed[self.placed as usize];
        Hit { placed: self.placed, instance, local: slot - instance.first_slot }
    }

    /// What the rays of a block have hit.
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

    /// The slots of the instance found last.
    #[inline(always)]
    pub(crate) fn slots(&self) -> core::ops::Range<u32> {
        self.slots.clone()
    }

    /// Whether all slots are of the instance found last.
    #[inline(always)]
    pub(crate) fn are_of_last<S: Simd>(&self, simd: S, slots: &[u32; WIDTH]) -> bool {
        let slots = u32x16::load_array_ref(simd, slots) & u32x16::splat(simd, !GRAZING);
        let own = slots.simd_ge(u32x16::splat(simd, self.slots.start))
            & slots.simd_lt(u32x16::splat(simd, self.slots.end));
        own.all_true()
    }

    /// What the first of some lanes has hit, and which lanes have hit the same instance.
    #[inline(always)]
    pub(crate) fn first_of<S: Simd>(&mut self, simd: S, slots: &[u32; WIDTH], lanes: u16) -> (Hit<'a>, u16) {
        let hit = self.hit(slots[lanes.trailing_zeros() as usize % WIDTH]);
        let slots = u32x16::load_array_ref(simd, slots) & u32x16::splat(simd, !GRAZING);
        let own = slots.simd_ge(u32x16::splat(simd, self.slots.start))
            & slots.simd_lt(u32x16::splat(simd, self.slots.end));
        (hit, own.to_bitmask() as u16)
    }

    /// The instance found last and the facets from its own on, if it is a mesh and all slots are its own.
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

    /// The intensity that a lidar reports for a slot's instance.
    #[inline(always)]
    pub(crate) fn laser_retro(&mut self, slot: u32) -> f32 {
        let hit = self.hit(slot);
        self.laser_retro_of(&hit)
    }

    #[inline(always)]
    fn laser_retro_of(&self, hit: &Hit<'_>) -> f32 {
        self.view.scene.instances[hit.instance.instance as usize].laser_retro
    }

    /// The intensities that a lidar reports for the instances that some lanes have hit, a bit each; 0 in the others.
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

    /// Which triangle of its mesh or height field was hit, in the order of its maker; 0 for other shapes.
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

    /// The corners of the triangle that was hit, in its instance.
    fn corners(&self, hit: &Hit<'_>) -> [DVec3; 3] {
        self.view.corners(hit.instance, hit.local)
    }

    /// Whether a ray runs so nearly along the triangle that it hits that single precision is not enough.
    #[inline(always)]
    pub(crate) fn grazes(&self, hit: &Hit<'_>, direction: [f32; 3]) -> bool {
        let [x, y, z] = self.triangle_normal(hit);
        let sine = (x * direction[0] + y * direction[1]) + z * direction[2];
        sine * sine < 1.0 / GRAZING_SQUARED
    }

    /// t of a ray from the frame's origin on the plane of the triangle that it hits, in double precision, and no nearer
    /// or farther than its corners: of a ray that all but lies in the plane, rounding makes any t.
    pub(crate) fn exact(&self, hit: &Hit<'_>, direction: DVec3, rough: f64) -> f64 {
        let [a, b, c] = self.corners(hit);
        let normal = (b - a).cross(c - a);
        let direction = hit.instance.vector_in_instance(direction);
        let origin = DVec3::from_array(hit.instance.origin_in_instance);
        let t = normal.dot(a - origin) / normal.dot(direction);
        // A ray along the plane has no better answer.
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
