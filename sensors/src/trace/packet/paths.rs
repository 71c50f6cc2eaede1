//! The paths of rays that panes transmit and mirrors reflect, and the hits at their ends.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

/// The largest number of surfaces that a ray hits one after the other behind the first.
pub(in crate::trace) const SURFACES: usize = 4;
/// The largest number of hits of a ray: those of the path through the first surface, and of the path reflected by it.
pub(crate) const SURFACES_BEYOND: usize = 2 * SURFACES;

/// A ray that continues after a surface.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Path {
    /// The lane of the original ray.
    pub(in crate::trace) lane: u64,
    pub(in crate::trace) origin: DVec3,
    pub(in crate::trace) direction: DVec3,
    /// The time, as a fraction of the interval from the view's moment to the next one.
    pub(in crate::trace) share: f64,
    /// The length of the path from the scanner or camera to this origin.
    pub(in crate::trace) range: f64,
    /// The fraction of the light that takes this path, there and back.
    pub(in crate::trace) light: f64,
}

/// A surface that scatters light back and is seen through panes or in mirrors.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Behind {
    /// The lane of the ray.
    pub(in crate::trace) lane: u32,
    pub(crate) slot: u32,
    pub(crate) instance: u32,
    pub(in crate::trace) cos_incidence: f32,
    /// The length of the whole path.
    pub(crate) range: f64,
    /// The fraction of the light that reaches the surface and returns, if the surface scatters all of it.
    pub(crate) light: f64,
}

impl Behind {
    /// The lane of the ray.
    pub(crate) fn lane(&self) -> usize {
        self.lane as usize
    }

    pub(crate) fn cos_incidence(&self) -> f64 {
        self.cos_incidence.into()
    }
}

/// The hits of up to this many rays.
pub(crate) type Found<const RAYS: usize> = [[Behind; SURFACES_BEYOND]; RAYS];

/// Paths of up to this many rays: those through the first surface, and those reflected by it.
pub(crate) type Paths<const RAYS: usize> = [[Path; RAYS]; 2];
