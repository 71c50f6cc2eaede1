//! Handling of Ctrl-C and other signals during long operations.

use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

/// The longest delay until a signal is handled.
const PATIENCE: Duration = Duration::from_millis(50);

/// A flag that asks workers to stop.
#[derive(Default)]
pub(crate) struct Interrupt(AtomicBool);

impl Interrupt {
    /// Returns true if workers should stop.
    pub(crate) fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Runs the handlers of pending signals, unless that was done recently: for a caller that works itself.
    ///
    /// # Errors
    /// The exception of a handler.
    pub(crate) fn look(&self, last: &mut Instant) -> PyResult<()> {
        if last.elapsed() < PATIENCE {
            return Ok(());
        }
        *last = Instant::now();
        self.raise()
    }

    /// Waits for an answer of the workers, and asks them to stop if a handler raises. Returns `None` if they are gone.
    ///
    /// # Errors
    /// The exception of a handler, once the answer has arrived.
    pub(crate) fn wait<T>(&self, answer: &Receiver<T>) -> PyResult<Option<T>> {
        loop {
            match answer.recv_timeout(PATIENCE) {
                Ok(answer) => return Ok(Some(answer)),
                Err(RecvTimeoutError::Disconnected) => return Ok(None),
                Err(RecvTimeoutError::Timeout) => self.raise().inspect_err(|_| {
                    let _ = answer.recv();
                })?,
            }
        }
    }

    fn raise(&self) -> PyResult<()> {
        #[expect(clippy::redundant_closure_for_method_calls, reason = "the method is of one lifetime")]
        let looked = Python::attach(|py| py.check_signals());
        looked.inspect_err(|_| self.0.store(true, Ordering::Relaxed))
    }
}
