//! Arrays in huge pages, where the system has them: a tree of 40 MB needs 20 entries of the address cache then,
//! not 10 000.

use bytemuck::Pod;
use memmap2::{Advice, MmapMut};
use std::marker::PhantomData;

/// A zeroed array. Pages that are never touched cost nothing.
pub(crate) struct Array<T> {
    /// `None` when it is empty.
    map: Option<MmapMut>,
    length: usize,
    element: PhantomData<T>,
}

impl<T: Pod> Array<T> {
    /// Room for `length` elements.
    pub(crate) fn new(length: usize) -> std::io::Result<Self> {
        let map = if length == 0 {
            None
        } else {
            let map = MmapMut::map_anon(length * size_of::<T>())?;
            // Without huge pages it is slower and right all the same.
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
