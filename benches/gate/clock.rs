//! Clocks: CPU time of a thread, and wall time.

use rustix::time::{ClockId, clock_gettime};

/// The clock that is read.
#[derive(Debug, Clone, Copy)]
pub enum Clock {
    /// CPU time of the calling thread, which other processes do not prolong.
    Thread,
    /// Wall time, for work on several threads.
    Wall,
}

impl Clock {
    /// Returns the seconds since some moment.
    pub fn now_s(self) -> f64 {
        let time = clock_gettime(match self {
            Self::Thread => ClockId::ThreadCPUTime,
            Self::Wall => ClockId::Monotonic,
        });
        time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
    }
}
