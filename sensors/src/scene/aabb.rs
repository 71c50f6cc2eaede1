//! Axis-aligned boxes.

use bytemuck::{Pod, Zeroable};

/// An axis-aligned box in single precision, rounded outwards.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Aabb {
    pub(crate) min: [f32; 3],
    pub(crate) max: [f32; 3],
}

impl Aabb {
    /// The empty box: growing it by another box gives that box.
    pub(crate) const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    /// The smallest box that contains the given intervals, enlarged by a relative margin of 1e-6 that covers the
    /// rounding from f64 and the rounding errors of the traversal.
    pub(crate) fn from_f64(min: [f64; 3], max: [f64; 3]) -> Self {
        let mut bounds = Self::EMPTY;
        for axis in 0..3 {
            let margin = 1e-6 * (1e-3 + min[axis].abs().max(max[axis].abs()));
            bounds.min[axis] = (min[axis] - margin) as f32;
            bounds.max[axis] = (max[axis] + margin) as f32;
        }
        bounds
    }
}
