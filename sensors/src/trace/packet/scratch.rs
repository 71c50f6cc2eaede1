//! Scratch memory in the caller's workspace, for data that would take much of the stack. All of it is written before it
//! is read.

use crate::simd::WIDTH;
use crate::trace::packet::paths::{Found, Paths};
use crate::trace::rays::wave::WaveScratch;
use crate::trace::shapes::LocalRays;
use bytemuck::{Pod, Zeroable};

/// Scratch memory for casting a packet of moving rays.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct MovingScratch {
    pub(in crate::trace) wave: WaveScratch,
    pub(in crate::trace) local: LocalRays,
}

/// Scratch memory for following the rays of a block of a grid beyond mirrors and panes.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SpecularScratch {
    pub(in crate::trace) moving: MovingScratch,
    pub(in crate::trace) found: Found<WIDTH>,
    pub(in crate::trace) paths: Paths<WIDTH>,
}
