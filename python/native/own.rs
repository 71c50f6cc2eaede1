//! Objects in memory shared with other processes, as Python objects: used by one thread at a time, and left alone by a
//! forked process.

use crate::failures::BridgeError;
use pyo3::prelude::*;
use std::process;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The owner of ports, frames or a node, whose files in shared memory are removed when it is dropped.
///
/// A child made by `fork` has a copy of this object, but the files belong to its parent: in the child the copy cannot
/// be used, and is leaked instead of dropped.
pub(crate) struct Own<T> {
    process: u32,
    /// `None` only during drop. Boxed, since headers are aligned to 64 bytes and Python objects to 16.
    inside: Option<Box<Mutex<T>>>,
    /// Held by the next thread in line. Without it, a thread that waits in a loop would lock `inside` again before
    /// another thread wakes.
    next: Mutex<()>,
}

impl<T: Send> Own<T> {
    pub(crate) fn new(inside: T) -> Self {
        Self { process: process::id(), inside: Some(Box::new(Mutex::new(inside))), next: Mutex::new(()) }
    }

    /// Uses the object with the interpreter's lock released. `act` cannot take that lock, so two threads cannot
    /// deadlock.
    ///
    /// # Errors
    /// If this process is a forked child.
    pub(crate) fn with<R: Send>(&self, py: Python<'_>, act: impl FnOnce(&mut T) -> R + Send) -> PyResult<R> {
        let inside = self.here()?;
        Ok(py.detach(|| {
            let next = lock(&self.next);
            let mut inside = lock(inside);
            drop(next);
            act(&mut inside)
        }))
    }

    /// Checks that this process created the object.
    ///
    /// # Errors
    /// If this process is a forked child.
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
