//! Time.

use rustix::time::{ClockId, clock_gettime};

/// Which time is taken.
#[derive(Debug, Clone, Copy)]
pub enum Clock {
    /// CPU time of the calling thread: what others do on the machine takes none of it.
    Thread,
    /// Time that passes, for what runs on several threads.
    Wall,
}

impl Clock {
    /// Seconds since some moment.
    pub fn now_s(self) -> f64 {
        let time = clock_gettime(match self {
            Self::Thread => ClockId::ThreadCPUTime,
            Self::Wall => ClockId::Monotonic,
        });
        time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
    }
}
