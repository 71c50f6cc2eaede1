//! When a message was recorded, in simulated time.

use belvedere_bridge::Kind;

/// What is stamped so much later than the clock is of a time before a reset.
const STALE_NS: u64 = 10_000_000_000;

/// Makes times that never go back, from stamps: a picture comes after what is stamped later, commands have no stamps,
/// and after a reset of the simulation stamps begin at 0 again.
#[derive(Debug, Default)]
#[allow(clippy::struct_field_names, reason = "the unit")]
pub(super) struct LogTime {
    /// The time at the last reset.
    base_ns: u64,
    clock_ns: u64,
    newest_ns: u64,
}

impl LogTime {
    /// The time of the next message, nanoseconds.
    pub(super) fn next(&mut self, kind: Option<Kind>, stamp_ns: u64) -> u64 {
        if kind == Some(Kind::Clock) {
            if stamp_ns < self.clock_ns {
                self.base_ns = self.newest_ns;
            }
            self.clock_ns = stamp_ns;
        }
        if stamp_ns <= self.clock_ns.saturating_add(STALE_NS) {
            self.newest_ns = self.newest_ns.max(self.base_ns.saturating_add(stamp_ns));
        }
        self.newest_ns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn never_goes_back() {
        let mut time = LogTime::default();
        let steps = [
            (Kind::Clock, 100, 100),
            (Kind::Image, 90, 100),
            (Kind::VelocityCommand, 0, 100),
            (Kind::Odometry, 110, 110),
            // A reset, and a picture that was on its way.
            (Kind::Clock, 0, 110),
            (Kind::Clock, 10, 120),
            (Kind::Image, STALE_NS + 11, 120),
            (Kind::Clock, 20, 130),
        ];
        for (kind, stamp_ns, expected) in steps {
            assert_eq!(time.next(Some(kind), stamp_ns), expected, "{kind} at {stamp_ns}");
        }
    }
}
