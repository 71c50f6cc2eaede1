//! Arrays in huge pages, if the system has them: a tree of 40 MB then needs 20 TLB entries instead of 10,000.

use bytemuck::Pod;
use memmap2::{Advice, MmapMut};
use std::marker::PhantomData;

/// A zeroed array. Pages that are never touched cost nothing.
pub(crate) struct Array<T> {
    /// `None` if the array is empty.
    map: Option<MmapMut>,
    length: usize,
    element: PhantomData<T>,
}

impl<T: Pod> Array<T> {
    /// Allocates `length` elements.
    pub(crate) fn new(length: usize) -> std::io::Result<Self> {
        let map = if length == 0 {
            None
        } else {
            let map = MmapMut::map_anon(length * size_of::<T>())?;
            // Without huge pages it is only slower.
            #[cfg(target_os = "linux")]
            let _ = map.advise(Advice::HugePage);
            Some(map)
        };
        Ok(Self { map, length, element: PhantomData })
    }

    pub(crate) fn as_slice(&self) -> &[T] {
        self.map.as_ref().map_or(&[], |map| &bytemuck::cast_slice(map)[..self.length])
    }

    pub(crate) fn as_mut_slice(&mut self) -> &mut [T] {
        match &mut self.map {
            Some(map) => &mut bytemuck::cast_slice_mut(map)[..self.length],
            None => &mut [],
        }
    }
}
