//! Room in the caller's memory for what would take much of the stack. Whatever is in it is written before it is read.

use super::behind::{Found, Paths};
use super::rays::wave::Room;
use super::shapes::LocalRays;
use crate::simd::WIDTH;
use bytemuck::{Pod, Zeroable};

/// Room for casting a volley of rays.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct VolleyRoom {
    pub(super) wave: Room,
    pub(super) local: LocalRays,
}

/// Room for following the rays of a block of a grid beyond mirrors and panes.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct GridRoom {
    pub(super) volley: VolleyRoom,
    pub(super) found: Found<WIDTH>,
    pub(super) paths: Paths<WIDTH>,
}
