//! Ctrl-C, and what other signals raise, while something takes long.

use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

/// How long a signal waits at the most before it is looked for.
const PATIENCE: Duration = Duration::from_millis(50);

/// Tells those who work that they are to leave off.
#[derive(Default)]
pub(crate) struct Interrupt(AtomicBool);

impl Interrupt {
    /// Whether to leave off.
    pub(crate) fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Runs the handlers of signals that have come, if the last look is some time ago: for a caller that works itself.
    ///
    /// # Errors
    /// What a handler raised.
    pub(crate) fn look(&self, last: &mut Instant) -> PyResult<()> {
        if last.elapsed() < PATIENCE {
            return Ok(());
        }
        *last = Instant::now();
        self.raise()
    }

    /// Waits for an answer of those who work, and has them leave off when a handler raises; none if they are gone.
    ///
    /// # Errors
    /// What a handler raised, when their answer has come.
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
