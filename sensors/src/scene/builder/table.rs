//! A table of elements whose indices stay the same until they are removed.

use alloc::vec::Vec;

/// Elements by index. Indices of removed elements are reused, the last one first.
#[derive(Debug, Clone)]
pub(super) struct Table<T> {
    items: Vec<T>,
    /// Number of users of each element; `None` where there is no element.
    uses: Vec<Option<u32>>,
    free: Vec<u32>,
}

impl<T> Default for Table<T> {
    fn default() -> Self {
        Self { items: Vec::new(), uses: Vec::new(), free: Vec::new() }
    }
}

impl<T: Copy> Table<T> {
    /// All elements; a removed one is replaced by its blank.
    pub(super) fn items(&self) -> &[T] {
        &self.items
    }

    /// Returns true if all elements were removed, or none was ever added.
    pub(super) fn is_empty(&self) -> bool {
        self.free.len() == self.items.len()
    }

    /// Returns true if one more element has an index in 32 bits.
    pub(super) fn has_room(&self) -> bool {
        !self.free.is_empty() || self.items.len() < u32::MAX as usize
    }

    pub(super) fn add(&mut self, item: T) -> u32 {
        if let Some(index) = self.free.pop() {
            self.items[index as usize] = item;
            self.uses[index as usize] = Some(0);
            return index;
        }
        self.items.push(item);
        self.uses.push(Some(0));
        (self.items.len() - 1) as u32
    }

    pub(super) fn get(&self, index: u32) -> Option<&T> {
        self.uses(index)?;
        self.items.get(index as usize)
    }

    pub(super) fn get_mut(&mut self, index: u32) -> Option<&mut T> {
        self.uses(index)?;
        self.items.get_mut(index as usize)
    }

    /// Number of users of an element, or `None` if there is no such element.
    pub(super) fn uses(&self, index: u32) -> Option<u32> {
        *self.uses.get(index as usize)?
    }

    pub(super) fn use_one(&mut self, index: u32) {
        if let Some(Some(uses)) = self.uses.get_mut(index as usize) {
            *uses += 1;
        }
    }

    pub(super) fn leave_one(&mut self, index: u32) {
        if let Some(Some(uses)) = self.uses.get_mut(index as usize) {
            *uses = uses.saturating_sub(1);
        }
    }

    /// Removes an element, which must exist; `blank` takes its place until the index is reused.
    pub(super) fn remove(&mut self, index: u32, blank: T) {
        self.items[index as usize] = blank;
        self.uses[index as usize] = None;
        self.free.push(index);
    }
}
