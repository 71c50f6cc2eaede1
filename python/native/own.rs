//! What a process shares with others, as an object of Python: used by one thread at a time, and left alone by a process
//! that was forked.

use crate::failures::BridgeError;
use pyo3::prelude::*;
use std::process;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Owns ports, frames or a membership, whose files in shared memory go when it is dropped.
///
/// A child made by `fork` has a copy of this, but the files stay its parent's: there the copy refuses to be used, and is
/// leaked instead of dropped.
pub(crate) struct Own<T> {
    process: u32,
    /// Only `None` while it is dropped. In a box, since headers are aligned to 64 bytes and Python's objects to 16.
    inside: Option<Box<Mutex<T>>>,
    /// Held by the thread that is next. Without it a thread that waits in a loop would take `inside` again each time
    /// before another one has woken.
    next: Mutex<()>,
}

impl<T: Send> Own<T> {
    pub(crate) fn new(inside: T) -> Self {
        Self { process: process::id(), inside: Some(Box::new(Mutex::new(inside))), next: Mutex::new(()) }
    }

    /// Uses it without the interpreter's lock, which `act` cannot take: two threads cannot wait for each other.
    ///
    /// # Errors
    /// In a forked child.
    pub(crate) fn with<R: Send>(&self, py: Python<'_>, act: impl FnOnce(&mut T) -> R + Send) -> PyResult<R> {
        let inside = self.here()?;
        Ok(py.detach(|| {
            let next = lock(&self.next);
            let mut inside = lock(inside);
            drop(next);
            act(&mut inside)
        }))
    }

    /// Checks that this is the process that made it.
    ///
    /// # Errors
    /// In a forked child.
    pub(crate) fn check(&self) -> PyResult<()> {
        self.here().map(drop)
    }

    fn here(&self) -> PyResult<&Mutex<T>> {
        match &self.inside {
            Some(inside) if self.process == process::id() => Ok(inside),
            _ => Err(BridgeError::new_err(
                "this belongs to the process from which this one was forked: open a Node of its own here",
            )),
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<T> Drop for Own<T> {
    fn drop(&mut self) {
        if self.process != process::id() {
            std::mem::forget(self.inside.take());
        }
    }
}
