//! Locks of values that threads share.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// A lock that holds whatever a panic left: every value is whole between two statements.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
