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
    /// Holds nothing; growing it by a box gives that box.
    pub(crate) const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    /// The smallest box that holds the given interval. The margin of 1e-6 relative covers the rounding from f64
    /// and of the traversal itself.
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
