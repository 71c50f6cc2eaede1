//! [`PlayClock`]: recorded times as times of day.

use std::time::{Duration, Instant};

/// When recorded times are due.
pub(super) struct PlayClock {
    pub(super) first_ns: u64,
    /// Whether a frame was reached that is to be played.
    pub(super) has_begun: bool,
    /// A recorded time, and when it was.
    last_ns: u64,
    last_at: Instant,
}

impl PlayClock {
    pub(super) fn new(first_ns: u64) -> Self {
        Self { first_ns, has_begun: false, last_ns: first_ns, last_at: Instant::now() }
    }

    /// Time does not pass.
    pub(super) fn stand(&mut self) {
        self.last_at = Instant::now();
    }

    /// This recorded time is now.
    pub(super) fn skip_to(&mut self, time_ns: u64) {
        self.last_ns = time_ns;
        self.stand();
    }

    /// How long it is to a recorded time; it becomes the last one when that is nothing.
    pub(super) fn left(&mut self, time_ns: u64, rate: f64) -> Duration {
        let recorded = time_ns.saturating_sub(self.last_ns) as f64 * 1e-9;
        // More than a year is for ever.
        let due = Duration::from_secs_f64((recorded / rate).min(3e7));
        let left = due.saturating_sub(self.last_at.elapsed());
        if left.is_zero() {
            (self.last_ns, self.last_at) = (time_ns, self.last_at + due);
        }
        left
    }
}
