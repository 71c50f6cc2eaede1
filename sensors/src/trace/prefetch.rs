//! Prefetching of data while other data is processed.
//!
//! A large mesh does not fit into the caches, and a walk reads most of its leaves once per frame: without prefetching,
//! an OS1-128 over half a million triangles spends 28 % of its time waiting for the cache lines of leaves.

use crate::simd::WIDTH;
use bytemuck::Pod;

/// Prefetches all cache lines of an element. If the index is out of range, nothing is prefetched.
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
