//! Fetching what is needed next while the present is worked on.
//!
//! A large mesh does not fit into a cache, and a walk meets most of its leaves once a frame: without this, an
//! OS1-128 over half a million triangles spends 28 % of its time waiting for the lines of leaves.

use crate::simd::WIDTH;
use bytemuck::Pod;

/// Asks for all cache lines of an element. One that is not there is no error, and nothing is asked for.
#[inline(always)]
pub(crate) fn prefetch<T: Pod>(elements: &[T], index: u32) {
    #[cfg(feature = "std")]
    {
        let lines: &[[f32; WIDTH]] = bytemuck::cast_slice(elements);
        let lines_each = size_of::<T>() / size_of::<[f32; WIDTH]>();
        for line in 0..lines_each {
            prefetch_index::prefetch_index(
                lines,
                (index as usize).wrapping_mul(lines_each).wrapping_add(line),
            );
        }
    }
    #[cfg(not(feature = "std"))]
    let _ = (elements, index, WIDTH);
}
