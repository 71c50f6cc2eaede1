//! What was worked out for the things met last.

/// Neighbouring rays mostly meet the same few things: so many of them are remembered.
const KEPT: usize = 16;

/// What was worked out for the things met last, by their numbers.
pub(crate) struct HitCache<T>([Option<(u32, T)>; KEPT]);

impl<T: Copy> HitCache<T> {
    pub(crate) const fn new() -> Self {
        Self([None; KEPT])
    }

    /// That of a number, which is worked out now if it was not lately.
    #[inline(always)]
    pub(crate) fn get(&mut self, number: u32, make: impl FnOnce() -> T) -> &T {
        let entry = &mut self.0[number as usize % KEPT];
        if entry.as_ref().is_none_or(|(kept, _)| *kept != number) {
            *entry = None;
        }
        &entry.get_or_insert_with(|| (number, make())).1
    }
}
