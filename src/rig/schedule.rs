//! [`Schedule`]: the times at which a channel's frames are due.

use super::Rate;

/// Frames at exact timestamps. A new rate starts a new schedule, but frame numbers continue, so that each frame has its
/// own noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Schedule {
    rate: Rate,
    /// Timestamp of the first frame at this rate; `from_frame` is its number.
    from_ns: u64,
    from_frame: u64,
    next: u64,
    last_ns: Option<u64>,
}

impl Schedule {
    /// Creates a schedule that starts at time 0.
    pub fn new(rate: Rate) -> Self {
        Self::starting(rate, 0)
    }

    /// Creates a schedule that starts at a given time.
    pub fn starting(rate: Rate, from_ns: u64) -> Self {
        Self { rate, from_ns, from_frame: 0, next: 0, last_ns: None }
    }

    /// Returns the number of the next frame.
    pub fn next(&self) -> u64 {
        self.next
    }

    /// Returns the timestamp in ns of the next frame.
    pub fn next_ns(&self) -> u64 {
        self.from_ns.saturating_add(self.rate.stamp_ns(self.next - self.from_frame))
    }

    /// Advances to the next frame.
    pub fn advance(&mut self) {
        self.last_ns = Some(self.next_ns());
        self.next += 1;
    }

    /// Changes the rate at `now_ns`. The next frame is due one new period after the last one, or now if that has
    /// passed, so that frequent changes do not postpone it for ever.
    pub fn change_rate(&mut self, rate: Rate, now_ns: u64) {
        let due_ns = self.last_ns.map_or(0, |last_ns| last_ns.saturating_add(rate.stamp_ns(1)));
        *self = Self { rate, from_ns: due_ns.max(now_ns), from_frame: self.next, ..*self };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamps(schedule: &mut Schedule, count: usize) -> Vec<u64> {
        let mut next = || {
            let stamp_ns = schedule.next_ns();
            schedule.advance();
            stamp_ns
        };
        (0..count).map(|_| next()).collect()
    }

    #[test]
    fn a_new_rate_continues_from_the_last_frame() {
        let rate = |hz| Rate::from_hz(hz).unwrap();
        let mut schedule = Schedule::new(rate(10.0));
        assert_eq!(stamps(&mut schedule, 3), [0, 100_000_000, 200_000_000]);
        // Faster: due 33.3 ms after the last one.
        schedule.change_rate(rate(30.0), 210_000_000);
        assert_eq!(stamps(&mut schedule, 4), [233_333_333, 266_666_666, 299_999_999, 333_333_333]);
        // That would have been before now.
        schedule.change_rate(rate(100.0), 350_000_000);
        assert_eq!(stamps(&mut schedule, 2), [350_000_000, 360_000_000]);
        // Slower, with repeated changes: still one period after the last frame.
        for now_ms in [361, 362, 365] {
            schedule.change_rate(rate(50.0), now_ms * 1_000_000);
        }
        assert_eq!((schedule.next(), stamps(&mut schedule, 2)), (9, vec![380_000_000, 400_000_000]));
        // Never the same timestamp twice, even if the rate changes at the moment of a frame.
        schedule.change_rate(rate(1e6), 400_000_000);
        assert_eq!(schedule.next_ns(), 400_001_000);
    }

    #[test]
    fn before_the_first_frame_it_stays_due_at_once() {
        let mut schedule = Schedule::new(Rate::from_hz(10.0).unwrap());
        schedule.change_rate(Rate::from_hz(3.0).unwrap(), 0);
        assert_eq!(stamps(&mut schedule, 3), [0, 333_333_333, 666_666_666]);
    }
}
