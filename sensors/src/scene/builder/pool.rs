//! A pool: memory that is shared by elements of different length.

use crate::scene::SceneError;
use alloc::vec::Vec;
use bytemuck::Pod;
use core::ops::Range;

/// Elements in one slice, with a list of the ranges that are free.
#[derive(Debug, Clone)]
pub(super) struct Pool<T> {
    items: Vec<T>,
    /// Free ranges in ascending order; no two are adjacent, and none is at the end.
    free: Vec<Range<usize>>,
}

impl<T> Default for Pool<T> {
    fn default() -> Self {
        Self { items: Vec::new(), free: Vec::new() }
    }
}

impl<T: Pod> Pool<T> {
    pub(super) fn items(&self) -> &[T] {
        &self.items
    }

    /// The `count` elements from `start` on, mutable.
    pub(super) fn slice_mut(&mut self, start: u32, count: usize) -> &mut [T] {
        &mut self.items[start as usize..][..count]
    }

    /// Finds a position for `count` elements: the smallest free range that fits, or the end.
    ///
    /// # Errors
    /// [`SceneError::TooMany`] if the number of elements would not fit into `bits` bits.
    pub(super) fn place(&self, count: usize, bits: u32) -> Result<usize, SceneError> {
        let fitting = self.free.iter().filter(|range| range.len() >= count);
        let start = match fitting.min_by_key(|range| range.len()) {
            Some(range) if count > 0 => range.start,
            _ => self.items.len(),
        };
        let fits = start.checked_add(count).is_some_and(|end| (end as u64) < 1 << bits);
        if fits { Ok(start) } else { Err(SceneError::TooMany) }
    }

    /// Stores elements at a position returned by [`Pool::place`].
    pub(super) fn put(&mut self, start: usize, items: &[T]) {
        let end = start + items.len();
        if start == self.items.len() {
            self.items.extend_from_slice(items);
            return;
        }
        self.items[start..end].copy_from_slice(items);
        if let Some(index) = self.free.iter().position(|range| range.start == start) {
            self.free[index].start = end;
            if self.free[index].is_empty() {
                self.free.remove(index);
            }
        }
    }

    /// Marks a range as free.
    pub(super) fn release(&mut self, start: u32, count: usize) {
        if count == 0 {
            return;
        }
        let mut gone = start as usize..start as usize + count;
        let mut index = self.free.partition_point(|range| range.start < gone.start);
        if self.free.get(index).is_some_and(|next| next.start == gone.end) {
            gone.end = self.free.remove(index).end;
        }
        if index > 0 && self.free[index - 1].end == gone.start {
            index -= 1;
            gone.start = self.free.remove(index).start;
        }
        if gone.end == self.items.len() {
            self.items.truncate(gone.start);
        } else {
            self.free.insert(index, gone);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_used_again() {
        let mut pool = Pool::default();
        for (value, count) in [(1_u32, 3_usize), (2, 2), (3, 4)] {
            let start = pool.place(count, 32).unwrap();
            pool.put(start, &[value; 4][..count]);
        }
        assert_eq!(pool.items(), [1, 1, 1, 2, 2, 3, 3, 3, 3]);
        pool.release(0, 3);
        pool.release(3, 2);
        assert_eq!((pool.free.len(), pool.free[0].clone()), (1, 0..5));
        assert_eq!(pool.place(6, 32), Ok(9));
        assert_eq!(pool.place(4, 32), Ok(0));
        pool.put(0, &[7; 4]);
        assert_eq!(pool.items(), [7, 7, 7, 7, 2, 3, 3, 3, 3]);
        pool.release(5, 4);
        assert_eq!((pool.items(), pool.free.len()), (&[7; 4][..], 0));
        assert_eq!(pool.place(4, 3), Err(SceneError::TooMany));
    }
}
