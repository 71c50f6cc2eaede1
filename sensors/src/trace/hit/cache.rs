//! A cache of values that were computed for recently hit instances.

/// The number of cached values. Neighbouring rays mostly hit the same few instances.
const KEPT: usize = 16;

/// Values that were computed for recently hit instances, by their numbers.
pub(crate) struct HitCache<T>([Option<(u32, T)>; KEPT]);

impl<T: Copy> HitCache<T> {
    pub(crate) const fn new() -> Self {
        Self([None; KEPT])
    }

    /// Returns the value for a number, and computes it if it is not cached.
    #[inline(always)]
    pub(crate) fn get(&mut self, number: u32, make: impl FnOnce() -> T) -> &T {
        let entry = &mut self.0[number as usize % KEPT];
        if entry.as_ref().is_none_or(|(kept, _)| *kept != number) {
            *entry = None;
        }
        &entry.get_or_insert_with(|| (number, make())).1
    }
}
