//! What is drawn at a time: a leaf of a tree, and what counts as a hit of it.

use super::sharp::Source;
use crate::optics::rays::Points;
use crate::trace::packet::Faces;
use fearless_simd::Simd;

/// A leaf to draw.
#[derive(Clone, Copy)]
pub(super) struct Leaf<'a, S: Simd> {
    pub(super) source: Source<'a>,
    /// Corners in the sensor's frame.
    pub(super) corners: &'a [Points<S>; 3],
    /// Slot of the first triangle; the others follow.
    pub(super) first_slot: u32,
    /// Rectangle of the grid that holds all: columns, rows.
    pub(super) columns: [i32; 2],
    pub(super) rows: [i32; 2],
    /// Bound of 1/t from above for all.
    pub(super) nearest: f32,
}

/// What counts as a hit.
#[derive(Clone, Copy)]
pub(super) struct Rules {
    pub(super) faces: Faces,
    /// The instance is mirrored: its triangles run the other way round.
    pub(super) mirrored: bool,
    /// 1/t of the nearest that counts.
    pub(super) inverse_near: f32,
    /// And t itself.
    pub(super) near: f64,
    /// First row of blocks of the target.
    pub(super) first_block_row: usize,
}
