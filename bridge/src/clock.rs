//! The clock that publisher and subscriber share.

use std::time::{Duration, Instant};

use rustix::time::{ClockId, clock_gettime};

/// Returns `CLOCK_MONOTONIC` in nanoseconds. All processes of one machine share this clock, so
/// `mono_ns() - header.publish_mono_ns` in a consumer is the time since the frame was sent.
#[must_use]
pub fn mono_ns() -> u64 {
    let now = clock_gettime(ClockId::Monotonic);
    now.tv_sec as u64 * 1_000_000_000 + now.tv_nsec as u64
}

/// Returns when a wait of `timeout` ends. [`Instant`] panics on overflow, so the wait is limited to one year.
pub(crate) fn deadline(timeout: Duration) -> Instant {
    Instant::now() + timeout.min(Duration::from_secs(365 * 86_400))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_wait_does_not_overflow() {
        assert!(deadline(Duration::MAX) > Instant::now() + Duration::from_secs(86_400));
        assert!(deadline(Duration::from_secs(1)) <= Instant::now() + Duration::from_secs(1));
    }

    #[test]
    fn the_clock_advances_with_real_time() {
        let first = mono_ns();
        std::thread::sleep(Duration::from_millis(2));
        let elapsed_ns = mono_ns() - first;
        assert!((2_000_000..2_000_000_000).contains(&elapsed_ns), "{elapsed_ns}");
    }
}
