//! The clock that publisher and subscriber share.

use rustix::time::{ClockId, clock_gettime};

/// `CLOCK_MONOTONIC` in nanoseconds: the same clock in every process of one machine, so that
/// `mono_ns() - header.publish_mono_ns` in a consumer is the time since the frame was sent.
#[must_use]
pub fn mono_ns() -> u64 {
    let now = clock_gettime(ClockId::Monotonic);
    now.tv_sec as u64 * 1_000_000_000 + now.tv_nsec as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_does_not_run_backwards() {
        let first = mono_ns();
        std::thread::sleep(std::time::Duration::from_millis(2));
        let elapsed_ns = mono_ns() - first;
        assert!((2_000_000..2_000_000_000).contains(&elapsed_ns), "{elapsed_ns}");
    }
}
