//! The reading end of a stream.

use crate::failures::raised;
use crate::frame::Frame;
use crate::own::Own;
use belvedere_bridge::Error;
use pyo3::prelude::*;
use std::os::fd::{AsRawFd as _, RawFd};
use std::time::{Duration, Instant};

/// The longest time that another thread, or a signal handler, waits for a thread that sleeps.
const PATIENCE: Duration = Duration::from_millis(50);
/// The timeout used for infinite waits.
const FOR_EVER: Duration = Duration::from_secs(365 * 86_400);

#[pyclass(frozen, module = "belvedere._native")]
pub(crate) struct Subscriber(Own<End>);

enum End {
    Open(Box<belvedere_bridge::Subscriber>),
    /// The last known values.
    Closed {
        missed_total: u64,
        silent_since: Instant,
    },
}

impl Subscriber {
    pub(crate) fn new(subscriber: belvedere_bridge::Subscriber) -> Self {
        Self(Own::new(End::Open(Box::new(subscriber))))
    }

    fn taken(
        &self,
        py: Python<'_>,
        take: impl FnOnce(&mut belvedere_bridge::Subscriber) -> Result<Option<belvedere_bridge::Frame>, Error>
        + Send,
    ) -> PyResult<Option<Frame>> {
        let taken = self.0.with(py, |end| match end {
            End::Open(subscriber) => take(subscriber),
            End::Closed { .. } => Ok(None),
        })?;
        Ok(taken.map_err(raised)?.map(|frame| Frame::new(py, frame)))
    }
}

#[pymethods]
impl Subscriber {
    /// Sleeps until a frame is available. Returns false if the timeout in seconds passes, or the subscriber is closed.
    fn wait(&self, py: Python<'_>, timeout: Option<f64>) -> PyResult<bool> {
        let deadline = Instant::now() + duration(timeout);
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            let come = self.0.with(py, |end| match end {
                End::Open(subscriber) => subscriber.wait(left.min(PATIENCE)).map(Some),
                End::Closed { .. } => Ok(None),
            })?;
            match come.map_err(raised)? {
                None => return Ok(false),
                Some(true) => return Ok(true),
                Some(false) => py.check_signals()?,
            }
            if left.is_zero() {
                return Ok(false);
            }
        }
    }

    fn take(&self, py: Python<'_>) -> PyResult<Option<Frame>> {
        self.taken(py, belvedere_bridge::Subscriber::take)
    }

    fn take_newest(&self, py: Python<'_>) -> PyResult<Option<Frame>> {
        self.taken(py, belvedere_bridge::Subscriber::take_newest)
    }

    /// Returns a descriptor that is readable if `take` should be called; −1 after the subscriber was closed.
    fn fileno(&self, py: Python<'_>) -> PyResult<RawFd> {
        let fd = self.0.with(py, |end| match end {
            End::Open(subscriber) => subscriber.readiness().map(|fd| fd.as_raw_fd()),
            End::Closed { .. } => Ok(-1),
        })?;
        fd.map_err(raised)
    }

    #[getter]
    fn publishers(&self, py: Python<'_>) -> PyResult<usize> {
        self.0.with(py, |end| match end {
            End::Open(subscriber) => subscriber.publishers(),
            End::Closed { .. } => 0,
        })
    }

    #[getter]
    fn missed_total(&self, py: Python<'_>) -> PyResult<u64> {
        self.0.with(py, |end| match end {
            End::Open(subscriber) => subscriber.missed_total(),
            End::Closed { missed_total, .. } => *missed_total,
        })
    }

    /// Returns the seconds since the last frame, or since the subscriber was created.
    #[getter]
    fn silence(&self, py: Python<'_>) -> PyResult<f64> {
        self.0.with(py, |end| match end {
            End::Open(subscriber) => subscriber.silence().as_secs_f64(),
            End::Closed { silent_since, .. } => silent_since.elapsed().as_secs_f64(),
        })
    }

    /// Closes the subscription; frames that are held remain valid.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        self.0.with(py, |end| {
            if let End::Open(subscriber) = end {
                let silent_since =
                    Instant::now().checked_sub(subscriber.silence()).unwrap_or_else(Instant::now);
                *end = End::Closed { missed_total: subscriber.missed_total(), silent_since };
            }
        })
    }
}

/// Converts seconds; `None` is an infinite wait.
fn duration(seconds: Option<f64>) -> Duration {
    match seconds {
        None => FOR_EVER,
        Some(seconds) if seconds > 0.0 => {
            Duration::try_from_secs_f64(seconds).map_or(FOR_EVER, |time| time.min(FOR_EVER))
        }
        Some(_) => Duration::ZERO,
    }
}
