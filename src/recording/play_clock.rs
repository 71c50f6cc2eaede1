//! [`PlayClock`]: converts recorded times to wall-clock times.

use std::time::{Duration, Instant};

/// Determines when recorded times are due.
pub(super) struct PlayClock {
    pub(super) first_ns: u64,
    /// True once a frame that is to be played has been reached.
    pub(super) has_begun: bool,
    /// The last recorded time that was reached; `last_at` is the moment when it was reached.
    last_ns: u64,
    last_at: Instant,
}

impl PlayClock {
    pub(super) fn new(first_ns: u64) -> Self {
        Self { first_ns, has_begun: false, last_ns: first_ns, last_at: Instant::now() }
    }

    /// Keeps the clock at its recorded time, while paused.
    pub(super) fn stand(&mut self) {
        self.last_at = Instant::now();
    }

    /// Sets the clock to this recorded time.
    pub(super) fn skip_to(&mut self, time_ns: u64) {
        self.last_ns = time_ns;
        self.stand();
    }

    /// Returns the wait until a recorded time. When the wait is over, moves the clock to that time.
    pub(super) fn left(&mut self, time_ns: u64, rate: f64) -> Duration {
        let recorded = time_ns.saturating_sub(self.last_ns) as f64 * 1e-9;
        // Waits are limited to about a year.
        let due = Duration::from_secs_f64((recorded / rate).min(3e7));
        let left = due.saturating_sub(self.last_at.elapsed());
        if left.is_zero() {
            (self.last_ns, self.last_at) = (time_ns, self.last_at + due);
        }
        left
    }
}
