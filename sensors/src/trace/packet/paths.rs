//! The ways of rays by mirrors and panes, and what they meet there.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

/// Surfaces that a ray meets one behind the other after the first, at the most.
pub(in crate::trace) const SURFACES: usize = 4;
/// Most that a ray meets: of a way through a surface and of one back from it.
pub(crate) const SURFACES_BEYOND: usize = 2 * SURFACES;

/// A ray that goes on behind a surface.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Path {
    /// Of the ray that it was at first.
    pub(in crate::trace) lane: u64,
    pub(in crate::trace) origin: DVec3,
    pub(in crate::trace) direction: DVec3,
    /// Its time, as a share of the way from the view's moment to the next one.
    pub(in crate::trace) share: f64,
    /// From where it was sent to its origin.
    pub(in crate::trace) range: f64,
    /// What of the light comes this way, there and back.
    pub(in crate::trace) light: f64,
}

/// A surface that scatters light back by way of others.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Behind {
    /// Of the ray.
    pub(in crate::trace) lane: u32,
    pub(crate) slot: u32,
    pub(crate) instance: u32,
    pub(in crate::trace) cos_incidence: f32,
    /// All the way.
    pub(crate) range: f64,
    /// What of the light it scatters and comes back.
    pub(crate) light: f64,
}

impl Behind {
    /// Which ray it is of.
    pub(crate) fn lane(&self) -> usize {
        self.lane as usize
    }

    pub(crate) fn cos_incidence(&self) -> f64 {
        self.cos_incidence.into()
    }
}

/// What up to so many rays meet.
pub(crate) type Found<const RAYS: usize> = [[Behind; SURFACES_BEYOND]; RAYS];

/// Paths of up to so many rays: of those that go on through the first surface, and of those that go back from it.
pub(crate) type Paths<const RAYS: usize> = [[Path; RAYS]; 2];
