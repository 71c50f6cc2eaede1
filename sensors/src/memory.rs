//! Memory that the caller provides, split into typed slices.

use bytemuck::{Pod, Zeroable};

/// 64 bytes, aligned to 64: the unit in which callers provide memory to this crate.
///
/// ```
/// use belvedere_sensors::trace::CacheLine;
/// // Without a heap, a workspace is a static or a local array.
/// static BUFFER: [CacheLine; 4] = [CacheLine::ZERO; 4];
/// assert_eq!((size_of_val(&BUFFER), BUFFER.as_ptr() as usize % 64), (256, 0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct CacheLine([u8; 64]);

impl CacheLine {
    /// 64 zero bytes.
    pub const ZERO: Self = Self([0; 64]);
}

impl Default for CacheLine {
    fn default() -> Self {
        Self::ZERO
    }
}

/// Number of cache lines that hold the given number of bytes.
pub(crate) const fn lines(bytes: usize) -> usize {
    bytes.div_ceil(size_of::<CacheLine>())
}

/// Splits typed slices off a buffer.
pub(crate) struct Cutter<'a>(pub(crate) &'a mut [CacheLine]);

/// Reads the slices that a [`Cutter`] split off, in the same order.
pub(crate) struct Reader<'a>(pub(crate) &'a [CacheLine]);

impl<'a> Reader<'a> {
    /// The next `count` elements.
    pub(crate) fn take<T: Pod>(&mut self, count: usize) -> &'a [T] {
        let bytes = count * size_of::<T>();
        let (part, rest) = self.0.split_at(lines(bytes));
        self.0 = rest;
        bytemuck::cast_slice(&bytemuck::cast_slice::<CacheLine, u8>(part)[..bytes])
    }
}

impl<'a> Cutter<'a> {
    /// Splits off the next `count` elements, which start at a cache line.
    pub(crate) fn take<T: Pod>(&mut self, count: usize) -> &'a mut [T] {
        let bytes = count * size_of::<T>();
        let (part, rest) = core::mem::take(&mut self.0).split_at_mut(lines(bytes));
        self.0 = rest;
        bytemuck::cast_slice_mut(&mut bytemuck::cast_slice_mut::<CacheLine, u8>(part)[..bytes])
    }
}
