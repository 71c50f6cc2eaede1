//! [`LogTime`]: the simulated time at which a message was recorded.

use belvedere_bridge::Kind;

/// A frame whose timestamp is this much later than the clock dates from before a reset.
const STALE_NS: u64 = 10_000_000_000;

/// Converts timestamps to times that never go back. An image may follow frames with later timestamps, commands have no
/// timestamps, and after a reset of the simulation timestamps start at 0 again.
#[derive(Debug, Default)]
#[allow(clippy::struct_field_names, reason = "the unit")]
pub(super) struct LogTime {
    /// The recorded time of the last reset.
    base_ns: u64,
    clock_ns: u64,
    newest_ns: u64,
}

impl LogTime {
    /// Returns the time of the next message, nanoseconds.
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
            // A reset, and an image that was sent before it.
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
