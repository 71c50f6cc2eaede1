//! From the slot of a hit back to what was hit.

use super::image::{GRAZING, GRAZING_SQUARED, NO_HIT};
use super::view::{Placed, View};
use crate::scene::KIND_MESH;
use crate::scene::tree::{Facet, WIDTH};
use fearless_simd::{Simd, SimdBase, SimdMask, u32x16};
use glam::DVec3;

/// Finds the instances of slots; remembers the last, as neighbours mostly hit the same.
pub(crate) struct Resolver<'a> {
    view: &'a View<'a>,
    /// The last instance found, and the slots that are its own.
    placed: u32,
    slots: core::ops::Range<u32>,
}

/// What a slot stands for.
#[derive(Clone, Copy)]
pub(crate) struct Hit<'a> {
    /// Index among the placed instances.
    pub(crate) placed: u32,
    pub(crate) instance: &'a Placed,
    /// Triangle, counted through the blocks of the scene; meaningless for other shapes.
    pub(crate) facet: usize,
}

impl<'a> Resolver<'a> {
    pub(crate) fn new(view: &'a View<'a>) -> Self {
        Self { view, placed: 0, slots: 0..0 }
    }

    /// The hit of a slot, which is not [`NO_HIT`].
    #[inline(always)]
    pub(crate) fn hit(&mut self, slot: u32) -> Hit<'a> {
        let slot = slot & !GRAZING;
        if !self.slots.contains(&slot) {
            self.find(slot);
        }
        let instance = &self.view.placed[self.placed as usize];
        let facet = instance.first_block as usize * WIDTH + (slot - instance.first_slot) as usize;
        Hit { placed: self.placed, instance, facet }
    }

    /// The instance found last, if all slots are of its triangles; and these.
    #[inline(always)]
    pub(crate) fn common_instance<S: Simd>(
        &self,
        simd: S,
        slots: &[u32; WIDTH],
    ) -> Option<(&'a Placed, &'a [Facet])> {
        let slots = u32x16::load_array_ref(simd, slots) & u32x16::splat(simd, !GRAZING);
        let own = slots.simd_ge(u32x16::splat(simd, self.slots.start))
            & slots.simd_lt(u32x16::splat(simd, self.slots.end));
        if !own.all_true() {
            return None;
        }
        let instance = &self.view.placed[self.placed as usize];
        let facets = &self.view.scene.facets[instance.first_block as usize * WIDTH..];
        (instance.kind == KIND_MESH).then_some((instance, facets))
    }

    #[cold]
    fn find(&mut self, slot: u32) {
        let after = self.view.placed.partition_point(|placed| placed.first_slot <= slot);
        self.placed = after as u32 - 1;
        let end = self.view.placed.get(after).map_or(NO_HIT & !GRAZING, |next| next.first_slot);
        self.slots = self.view.placed[after - 1].first_slot..end;
    }

    /// The triangle of a hit on a mesh.
    #[inline(always)]
    pub(crate) fn facet(&self, hit: &Hit<'_>) -> &'a Facet {
        &self.view.scene.facets[hit.facet]
    }

    /// The corners of a triangle that was hit, in its mesh.
    pub(crate) fn corners(&self, hit: &Hit<'_>) -> [DVec3; 3] {
        let block = &self.view.scene.blocks[hit.facet / WIDTH];
        let lane = hit.facet % WIDTH;
        block.corners.map(|[x, y, z]| DVec3::new(x[lane].into(), y[lane].into(), z[lane].into()))
    }

    /// Whether a ray runs so nearly along the triangle that it hits that single precision is not enough.
    #[inline(always)]
    pub(crate) fn grazes(&self, hit: &Hit<'_>, direction: [f32; 3]) -> bool {
        if hit.instance.kind != KIND_MESH {
            return false;
        }
        let [x, y, z] = hit.instance.normal_in_frame(self.facet(hit).normal);
        let sine = (x * direction[0] + y * direction[1]) + z * direction[2];
        sine * sine < 1.0 / GRAZING_SQUARED
    }

    /// t of a ray from the frame's origin on the plane of a triangle, in double precision; `otherwise` for other
    /// shapes, whose t is exact already.
    pub(crate) fn exact(&self, hit: &Hit<'_>, direction: DVec3, otherwise: f64) -> f64 {
        if hit.instance.kind != KIND_MESH {
            return otherwise;
        }
        let [a, b, c] = self.corners(hit);
        let normal = (b - a).cross(c - a);
        let direction = hit.instance.vector_in_instance(direction);
        let origin = DVec3::from_array(hit.instance.origin_in_instance);
        let t = normal.dot(a - origin) / normal.dot(direction);
        // A ray along the plane has no better answer.
        if t.is_finite() && t > 0.0 { t } else { otherwise }
    }
}
