//! A leaf of a tree to be drawn, and the criteria for hits.

use super::sharp::Source;
use crate::optics::rays::Points;
use crate::trace::packet::Faces;
use fearless_simd::Simd;

/// A leaf to draw.
#[derive(Clone, Copy)]
pub(super) struct Leaf<'a, S: Simd> {
    pub(super) source: Source<'a>,
    /// The corners in the sensor's frame.
    pub(super) corners: &'a [Points<S>; 3],
    /// The slot of the first triangle; the others follow.
    pub(super) first_slot: u32,
    /// The rectangle of the grid that contains all triangles: columns, rows.
    pub(super) columns: [i32; 2],
    pub(super) rows: [i32; 2],
    /// An upper bound on 1/t of all triangles.
    pub(super) nearest: f32,
}

/// The criteria for a hit.
#[derive(Clone, Copy)]
pub(super) struct Rules {
    pub(super) faces: Faces,
    /// True if the instance is mirrored, which reverses the winding of its triangles.
    pub(super) mirrored: bool,
    /// 1/t of the nearest hit that counts.
    pub(super) inverse_near: f32,
    /// t of the nearest hit that counts.
    pub(super) near: f64,
    /// The first row of blocks of the target.
    pub(super) first_block_row: usize,
}
