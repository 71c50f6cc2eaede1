//! [`Own`]: ports and frames that a forked child leaves alone.

use std::{
    fmt,
    ops::{Deref, DerefMut},
    process,
};

/// The owner of a value with files or slots in shared memory, which are released when it is dropped.
///
/// After `fork` the child has a copy of the value, but its shared memory still belongs to the parent. Dropping the
/// copy, as happens when the child returns from `main`, would remove the parent's files and return frames that the
/// parent still reads. So in the child, the value is leaked instead.
pub(crate) struct Own<T> {
    process: u32,
    /// `None` only during drop.
    inside: Option<T>,
}

impl<T> Own<T> {
    pub(crate) fn new(inside: T) -> Self {
        Self { process: process::id(), inside: Some(inside) }
    }

    pub(crate) fn into_inner(mut self) -> T {
        self.inside.take().expect(PRESENT)
    }
}

const PRESENT: &str = "present until dropped";

impl<T> Deref for Own<T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.inside.as_ref().expect(PRESENT)
    }
}

impl<T> DerefMut for Own<T> {
    fn deref_mut(&mut self) -> &mut T {
        self.inside.as_mut().expect(PRESENT)
    }
}

impl<T> Drop for Own<T> {
    fn drop(&mut self) {
        if self.inside.is_some() && self.process != process::id() {
            std::mem::forget(self.inside.take());
        }
    }
}

impl<T: fmt::Debug> fmt::Debug for Own<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}
