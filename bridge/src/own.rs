//! [`Own`]: ports and frames that a child made by `fork` has a copy of and leaves alone.

use std::{
    fmt,
    ops::{Deref, DerefMut},
    process,
};

/// Owns what has files or places in shared memory, which are given back when it is dropped.
///
/// After `fork` the child has a copy of it, but what lies in shared memory is still its parent's. Dropping the copy, as
/// happens when the child returns from `main`, would remove the parent's files and return frames that the parent still
/// reads. So there it is leaked instead.
pub(crate) struct Own<T> {
    process: u32,
    /// Only `None` while it is dropped.
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
